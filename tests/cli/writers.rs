//! One writer a folder: never two processes, never mixed frames.
#![cfg(unix)]

use std::process::Child;
use std::time::{Duration, Instant};

use crate::small_scene::{TINY, altered};
use crate::workspace::{Contents, Workspace, assert_same};

/// Exit code and standard error.
fn ended(child: Child) -> (Option<i32>, String) {
    let output = child.wait_with_output().expect("it ends");
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!words.contains("panicked"), "{words}");
    (output.status.code(), words)
}

/// What a render leaves, but for times; no lock and no half file.
fn rendered(workspace: &Workspace, folder: &str) -> Contents {
    let contents = workspace.rendered(folder);
    assert!(
        !contents.keys().any(|name| name.contains(".phicam")),
        "{:?}",
        contents.keys()
    );
    contents
}

/// A render that takes a while, at work in `busy`.
fn at_work(workspace: &Workspace) -> Child {
    let child = workspace.begins("render tiny.toml -o busy --samples 16777216");
    let begun = Instant::now();
    while !workspace.path("busy/partial/spots-0000-0008.phs").exists() {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "nothing was begun"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

#[test]
fn who_comes_second_is_refused_and_a_killed_writer_is_no_obstacle() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam("run tiny.toml -o done --samples 64");
    let mut first = at_work(&workspace);
    let number = format!("process {}", first.id());
    for line in [
        "render tiny.toml -o busy --samples 16777216",
        "render tiny.toml -o busy --samples 64",
        "render tiny.toml -o busy --samples 16777216 --spots 0..2",
        "render tiny.toml -o busy --samples 64 --replace",
        "run tiny.toml -o busy --samples 16777216",
        "model tiny.toml -o busy",
        "recover done -o busy",
        "stack done -o busy",
        "study spots tiny.toml -o busy",
        "reproduce table2 -o busy",
    ] {
        let second = workspace.phicam(line).exits(2);
        for word in ["busy is being written", "phicam render", &number, "wait"] {
            let account = second.account();
            assert!(second.stderr.contains(word), "no `{word}` in {account}");
        }
    }
    first.kill().expect("it can be killed");
    let _ = first.wait();
    let left = |name: &String| name.ends_with(".lock");
    assert!(workspace.contents("busy").keys().any(left));
    // Nobody holds its lock any more.
    let _ = workspace
        .phicam("render tiny.toml -o busy --samples 64 --replace")
        .exits(0);
    assert!(!workspace.contents("busy").keys().any(left));
}

#[test]
fn disjoint_spots_are_rendered_side_by_side_and_the_last_puts_them_together() {
    let workspace = Workspace::with_scenes();
    let line = "render tiny.toml --samples 4096";
    let _ = workspace.phicam(&format!("{line} -o whole")).exits(0);
    let whole = rendered(&workspace, "whole");
    for round in 0..4 {
        let out = format!("parts-{round}");
        let parts = ["0..3", "3..4", "4..8"]
            .map(|spots| workspace.begins(&format!("{line} -o {out} --spots {spots}")));
        for part in parts {
            let (code, words) = ended(part);
            assert_eq!(code, Some(0), "{words}");
        }
        assert_same(&whole, &rendered(&workspace, &out), &out);
        assert_eq!(workspace.json(&format!("{out}/run.json"))["finished"], 8);
    }
}

/// Pairs at once, with the same settings and with others: the folder is that of one of them.
#[test]
fn pairs_never_mix_their_frames() {
    let workspace = Workspace::new();
    workspace.write("tiny.toml", altered(&TINY));
    let line = |seed: u64| format!("render tiny.toml --samples 512 --seed {seed}");
    for seed in [1, 2] {
        let alone = format!("{} -o alone-{seed}", line(seed));
        let _ = workspace.phicam(&alone).exits(0);
    }
    let wholes = [1, 2].map(|seed| rendered(&workspace, &format!("alone-{seed}")));
    for pair in 0..20 {
        let seeds = [1, 1 + pair % 2];
        let out = format!("pair-{pair}");
        let both = seeds.map(|seed| workspace.begins(&format!("{} -o {out}", line(seed))));
        let codes = both.map(|child| {
            let (code, words) = ended(child);
            let told = words.contains("is being written") || words.contains("other settings");
            assert!(
                code == Some(0) || code == Some(2) && told,
                "{code:?}: {words}"
            );
            code
        });
        assert!(codes.contains(&Some(0)), "{codes:?}");
        let found = rendered(&workspace, &out);
        let won = seeds
            .iter()
            .zip(codes)
            .find(|(_, code)| *code == Some(0))
            .map_or(0, |(seed, _)| *seed as usize);
        assert_same(&wholes[won - 1], &found, &format!("{out}, seeds {seeds:?}"));
    }
}
