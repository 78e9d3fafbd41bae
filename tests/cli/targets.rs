//! `phicam target`: list, write.

use crate::workspace::Workspace;

const NAMES: [&str; 6] = ["card", "letters", "siemens", "edge", "usaf", "ramp"];

#[test]
fn targets_are_listed_and_written() {
    let workspace = Workspace::new();
    let ended = workspace.phicam("target").exits(0);
    let first = ended
        .stdout
        .lines()
        .filter_map(|l| l.split_whitespace().next());
    assert_eq!(first.collect::<Vec<_>>(), NAMES, "{}", ended.account());
    for name in NAMES {
        let ended = workspace
            .phicam(&format!("target {name} --size 47,31"))
            .exits(0);
        assert!(ended.stderr.contains("47 × 31"), "{}", ended.account());
        let bytes = workspace.read(&format!("{name}.png"));
        // Signature, then the chunk IHDR: width, height, 16 bits, grey.
        assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
        assert_eq!(&bytes[16..26], [0, 0, 0, 47, 0, 0, 0, 31, 16, 0]);
    }
    for (option, file) in [("--linear", "linear"), ("", "srgb")] {
        let line = format!("target ramp {option} -o {file}.png");
        let ended = workspace.phicam(&line).exits(0);
        let stated = format!("transfer = \"{file}\"");
        assert!(ended.stderr.contains(&stated), "{}", ended.account());
    }
    assert_ne!(workspace.read("linear.png"), workspace.read("srgb.png"));
}

#[test]
fn what_is_no_target_is_refused() {
    let workspace = Workspace::new();
    workspace.refuses("target joker", &["no target `joker`", "card"]);
    workspace.refuses("target card --size 0,4", &["W,H"]);
    workspace.refuses("target --linear", &["NAME"]);
}
