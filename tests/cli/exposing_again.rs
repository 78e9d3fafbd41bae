//! `phicam expose` where photographs are: they stay until what takes their place is whole.
#![cfg(unix)]

use std::fs;

use crate::workspace::{Workspace, assert_same};

const SEED_1: &str = "expose done --sensor ccd --exposure 0.01";
const SEED_2: &str = "expose done --sensor ccd --exposure 0.01 --seed 2";

/// A finished run of the small scene in `done`, photographed by the line `expose`.
fn photographed(expose: &str) -> Workspace {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render small.toml -o done --samples 32")
        .exits(0);
    let _ = workspace.phicam(expose).exits(0);
    workspace
}

#[test]
fn other_settings_are_refused_unless_they_are_to_replace() {
    let workspace = photographed(SEED_1);
    let first = workspace.contents("done/exposed");
    let _ = workspace.phicam(SEED_1).exits(0);
    assert_same(&first, &workspace.contents("done/exposed"), "once more");
    let words = ["done/exposed holds photographs with other", "--replace"];
    for rest in ["--seed 2", "--frames 2", "--glare 1e-4", "--stderr oracle"] {
        workspace.refuses(&format!("{SEED_1} {rest}"), &words);
    }
    let _ = workspace.phicam(&format!("{SEED_1} -o seen")).exits(0);
    let words = ["seen", "(exposure.json: seed)", "--replace"];
    workspace.refuses(&format!("{SEED_2} -o seen"), &words);
    let _ = workspace.phicam(&format!("{SEED_2} -o fresh")).exits(0);
    let _ = workspace.phicam(&format!("{SEED_2} --replace")).exits(0);
    let [done, fresh] = ["done/exposed", "fresh"].map(|f| workspace.contents(f));
    assert_same(&done, &fresh, "replaced and fresh");
    // Nobody knows what these are.
    fs::remove_file(workspace.path("seen/exposure.json")).unwrap();
    let words = ["seen holds photographs, but no exposure.json", "--replace"];
    workspace.refuses(&format!("{SEED_1} -o seen"), &words);
}

/// A file that grows too large ends the process in the midst of its writing.
#[test]
fn what_cannot_be_written_whole_replaces_nothing() {
    let workspace = photographed(SEED_1);
    let first = workspace.contents("done/exposed");
    for line in [SEED_1, &format!("{SEED_2} --replace")] {
        let ended = workspace.phicam_after("ulimit -f 16", line).exits(2);
        assert!(ended.stderr.contains("ulimit -f"), "{}", ended.account());
        let mut there = workspace.contents("done/exposed");
        there.retain(|name, _| !name.starts_with(".exposed-new/"));
        assert_same(&first, &there, line);
    }
    let _ = workspace.phicam(SEED_1).exits(0);
    assert_same(&first, &workspace.contents("done/exposed"), "and then");
}

/// A process may end at any moment while it puts new photographs in the place of old ones.
#[test]
fn a_replacement_that_ended_midway_is_finished_by_the_next_writer() {
    let workspace = photographed(SEED_1);
    let _ = workspace.phicam(&format!("{SEED_1} -o seen")).exits(0);
    for (folder, output) in [("done/exposed", ""), ("seen", "-o seen")] {
        let _ = workspace.phicam(&format!("{SEED_2} -o fresh")).exits(0);
        let fresh = workspace.contents("fresh");
        let finished = |what: &str| {
            let line = format!("{SEED_1} --seed 3 {output}");
            let ended = workspace.phicam(&line).exits(2);
            let told = ended.stderr.contains("other settings");
            assert!(told, "{}", ended.account());
            assert_same(&fresh, &workspace.contents(folder), what);
            // And the run vouches for its own.
            let line = format!("view {folder}/phi.npy -o seen.png --force");
            let _ = workspace.phicam(&line).exits(0);
        };
        let place = |name: &str| workspace.path(folder).join(name);
        // The old photographs half removed, the account first.
        fs::rename(workspace.path("fresh"), place(".exposed-new")).unwrap();
        for name in ["exposure.json", "counts/spot-0003.exr"] {
            fs::remove_file(place(name)).unwrap();
        }
        finished("after removing");
        // The new ones half moved, the account not yet.
        fs::create_dir_all(place(".exposed-incoming/counts")).unwrap();
        for name in ["exposure.json", "phi.npy", "counts/spot-0000.exr"] {
            fs::rename(place(name), place(".exposed-incoming").join(name)).unwrap();
        }
        finished("after moving");
    }
}
