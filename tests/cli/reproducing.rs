//! `phicam reproduce`: items by name, refusals, going on.

use crate::workspace::{Workspace, assert_same};

#[test]
#[ignore = "slow"]
fn items_by_name_become_files_and_pages() {
    let workspace = Workspace::new();
    let ended = workspace.phicam("reproduce table2 fig18 -o r").exits(0);
    assert!(
        ended
            .stdout
            .contains("table2  reproduced (26 of 26 checks hold)"),
        "{}",
        ended.account()
    );
    for name in [
        "table2.csv",
        "table2.svg",
        "table2.png",
        "fig17.csv",
        "fig17.svg",
        "fig17-images.png",
    ] {
        assert!(!workspace.read(&format!("r/{name}")).is_empty());
    }
    let page = workspace.text("r/reproduction.md");
    assert!(page.contains("## table2") && page.contains("## fig17") && !page.contains("## table3"));
    // The page is whole in itself: figures with their data, tables to be saved, no file beside it.
    let page = workspace.text("r/reproduction.html");
    assert!(page.contains("data-name=\"table2\"") && page.contains("<metadata>"));
    assert!(page.contains("download=\"table2.csv\"") && !page.contains("href=\"table2"));
    assert!(page.contains("phicam reproduce table2 fig17 --most-elements 64 --seeds 20 --seed 1"));

    // Finished items are not repeated; one that lacks a file or has other settings is. Pages tell of
    // all.
    let written = |name: &str| {
        std::fs::metadata(workspace.path(name))
            .unwrap()
            .modified()
            .unwrap()
    };
    let before = written("r/table2.csv");
    std::fs::remove_file(workspace.path("r/fig17.svg")).unwrap();
    let ended = workspace
        .phicam("reproduce table2 fig17 table3 -o r")
        .exits(0);
    assert!(ended.stderr.contains("1 of 3 items"), "{}", ended.account());
    assert_eq!(written("r/table2.csv"), before);
    assert!(workspace.text("r/fig17.svg").contains("<svg"));
    assert!(workspace.text("r/reproduction.md").contains("## table3"));
    // What was finished before is in the page from its files.
    let page = workspace.text("r/reproduction.html");
    assert!(
        ["table2", "fig17", "table3"]
            .iter()
            .all(|i| page.contains(&format!("data-name=\"{i}\"")))
    );
    let ended = workspace
        .phicam("reproduce table2 -o r --seed 2 --replace")
        .exits(0);
    assert!(
        !ended.stderr.contains("finished already"),
        "{}",
        ended.account()
    );
    assert!(
        workspace
            .text("r/table2.csv")
            .starts_with("line,row,printed")
    );
}

/// The items that trace their photographs: verdicts with their reasons, figures and pictures, kept
/// when asked for again.
#[test]
#[ignore = "slow"]
fn traced_items_become_files_and_are_kept() {
    let workspace = Workspace::new();
    let ended = workspace
        .phicam("reproduce dual moving-view -o r --seeds 2")
        .exits(0);
    assert!(
        ended
            .stdout
            .contains("dual         reproduced (7 of 7 checks hold)")
            && ended
                .stdout
                .contains("moving-view  not reproducible (3 of 5"),
        "{}",
        ended.account()
    );
    for name in [
        "dual.csv",
        "dual.svg",
        "dual-images.png",
        "dual-images-2.png",
        "moving-view.csv",
        "moving-view.svg",
        "moving-view-images.png",
    ] {
        assert!(!workspace.read(&format!("r/{name}")).is_empty());
    }
    let page = workspace.text("r/reproduction.md");
    assert!(page.contains("none given"), "{page}");
    let ended = workspace
        .phicam("reproduce moving-view dual -o r --seeds 2")
        .exits(0);
    assert!(ended.stderr.contains("2 of 2 items"), "{}", ended.account());
    let other = workspace
        .phicam("reproduce dual -o s --seeds 2 --threads 1")
        .exits(0);
    assert!(!other.stdout.contains("moving-view"), "{}", other.account());
    for name in ["dual.csv", "dual.json", "dual-images.png"] {
        let [a, b] = ["r", "s"].map(|dir| workspace.read(&format!("{dir}/{name}")));
        assert_eq!(a, b, "threads: {name}");
    }
}

#[test]
#[ignore = "slow"]
fn threads_do_not_change_a_byte() {
    let workspace = Workspace::new();
    let _ = workspace
        .phicam("reproduce fig22 fig15 -o a --seeds 2 --threads 1")
        .exits(0);
    let _ = workspace
        .phicam("reproduce fig22 fig15 -o b --seeds 2 --threads 3")
        .exits(0);
    let found = workspace.contents("a");
    assert_same(&found, &workspace.contents("b"), "threads");
    // The smallest eigenvalue is one over the largest, and its column says so.
    let eigenvalues = found.iter().find(|(name, _)| name.ends_with("fig15.csv"));
    let text = String::from_utf8_lossy(eigenvalues.unwrap().1);
    assert!(text.contains(",smallest_eigenvalue_over_largest,"));
}

#[test]
fn strangers_are_told_the_list() {
    let workspace = Workspace::new();
    workspace.refuses(
        "reproduce table2 fig99 -o r",
        &["fig99", "table1 (fig11)", "precision", "moving-view"],
    );
    workspace.refuses("reproduce --most-elements 65 -o r", &["--most-elements"]);
}

/// A file of a finished item that has changed since is told, and the item computed again: a number
/// of its own record too, which no form of the file betrays.
#[test]
fn changed_items_are_told_and_computed_again() {
    let workspace = Workspace::new();
    let line = "reproduce table2 -o r --most-elements 8";
    let _ = workspace.phicam(line).exits(0);
    let whole = workspace.contents("r");
    for name in ["table2.json", "table2.csv", "table2.svg", "table2.png"] {
        let mut changed = whole[name].clone();
        // A digit of a number in text, whatever is there in a picture.
        let half = changed.len() / 2;
        let at = half
            + changed[half..]
                .iter()
                .position(|b| (b'1'..=b'8').contains(b))
                .unwrap();
        changed[at] ^= 1;
        workspace.write(&format!("r/{name}"), changed);
        let ended = workspace.phicam(line).exits(0);
        let words = format!("{name} is not what was written; table2 is computed again");
        assert!(ended.stderr.contains(&words), "{}", ended.account());
        assert_same(&whole, &workspace.contents("r"), name);
    }
    let ended = workspace.phicam(line).exits(0);
    assert!(ended.stderr.contains("1 of 1 items"), "{}", ended.account());
}
