//! Ctrl-C in the middle of a render, and going on afterwards.
#![cfg(unix)]

use std::process::Command;
use std::time::{Duration, Instant};

use crate::workspace::{Workspace, assert_same};

/// Starts a render of the tiny scene into `cut`, sends `signal` as soon as its first blocks are on
/// disk, and returns the exit code and standard error.
fn interrupted(workspace: &Workspace, samples: u64, signal: &str) -> (Option<i32>, String) {
    let child = workspace.begins(&format!("render tiny.toml -o cut --samples {samples}"));
    let kept = workspace.path("cut/partial/spots-0000-0008.phs");
    let start = Instant::now();
    while !kept.exists() && start.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(1));
    }
    // A process that has ended is not reaped before `wait_with_output`, so its id is nobody else's.
    let signal = format!("kill -{signal} {}", child.id());
    let sent = Command::new("sh").args(["-c", &signal]).status();
    assert!(sent.expect("a shell").success());
    let output = child.wait_with_output().expect("it ends");
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), words)
}

#[test]
fn ctrl_c_keeps_what_is_finished_and_resume_gives_the_same_bytes() {
    let mut samples = 1 << 15;
    let (workspace, words) = loop {
        let workspace = Workspace::with_scenes();
        let (code, words) = interrupted(&workspace, samples, "INT");
        match code {
            // The machine was quicker than the signal: a longer render.
            Some(0) if samples < 1 << 22 => samples *= 4,
            Some(130) => break (workspace, words),
            other => panic!("exit code {other:?} after SIGINT: {words}"),
        }
    };
    assert!(!words.contains("panicked"), "{words}");
    for word in [
        "stopped",
        "0 of 8 spots and",
        "of 32 blocks",
        "kept in cut",
        "the same command",
    ] {
        assert!(words.contains(word), "no `{word}` in {words}");
    }
    assert_eq!(workspace.json("cut/run.json")["finished"], 0);
    assert!(!workspace.path("cut/phi.npy").exists());
    workspace.refuses("validate cut", &["of 8 spots", "the same command"]);
    workspace.refuses("stack cut", &["holds no frames", "phicam render"]);

    let settings = format!("--samples {samples} --json");
    let line = format!("render tiny.toml -o cut {settings}");
    let _ = workspace.phicam(&line).exits(0);
    let line = format!("render tiny.toml -o whole {settings}");
    let _ = workspace.phicam(&line).exits(0);
    let [mut cut, mut whole] = ["cut", "whole"].map(|dir| workspace.contents(dir));
    // What the run is called differs only in its times.
    assert!(cut.remove("run.json").is_some() && whole.remove("run.json").is_some());
    assert_same(&cut, &whole, "resumed and straight");
}

#[test]
fn a_killed_render_is_resumed_too() {
    let mut samples = 1 << 15;
    let workspace = loop {
        let workspace = Workspace::with_scenes();
        match interrupted(&workspace, samples, "KILL") {
            (Some(0), _) if samples < 1 << 22 => samples *= 4,
            (None, _) => break workspace,
            (code, words) => panic!("exit code {code:?} after SIGKILL: {words}"),
        }
    };
    let line = format!("render tiny.toml --samples {samples} -o");
    let _ = workspace.phicam(&format!("{line} cut --resume")).exits(0);
    let _ = workspace.phicam(&format!("{line} whole")).exits(0);
    let [mut cut, mut whole] = ["cut", "whole"].map(|dir| workspace.contents(dir));
    assert!(cut.remove("run.json").is_some() && whole.remove("run.json").is_some());
    assert_same(&cut, &whole, "resumed and straight");
}

#[test]
fn what_a_killed_process_was_writing_is_cleared_away() {
    let workspace = Workspace::with_scenes();
    let line = "render tiny.toml -o done --samples 32";
    let _ = workspace.phicam(&format!("{line} --spots 0..3")).exits(0);
    // The number of a process that has ended and was waited for is free.
    let mut child = Command::new("true").spawn().expect("a process");
    let dead = child.id();
    child.wait().expect("it ends");
    let machine = phicam::store::machine();
    for folder in ["", "frames/", "partial/"] {
        let name = format!("done/{folder}.phicam-{machine}-{dead}-Xy12.part");
        workspace.write(&name, "half a file");
    }
    let _ = workspace.phicam(&format!("{line} --resume")).exits(0);
    let names = workspace.contents("done");
    assert!(
        !names.keys().any(|n| n.contains("part")),
        "{:?}",
        names.keys()
    );
}

#[test]
fn nothing_is_traced_again_when_all_is_there() {
    let workspace = Workspace::with_scenes();
    let line = "render tiny.toml -o done --samples 32";
    let _ = workspace.phicam(line).exits(0);
    let whole = workspace.contents("done");
    let ended = workspace.phicam(&format!("{line} --resume")).exits(0);
    assert!(ended.stdout.contains("8 of 8 spots"), "{}", ended.account());
    // The record has the times, so that not even it was written again.
    assert_same(&whole, &workspace.contents("done"), "resumed");
    // A frame that is gone, or not whole, is made again.
    let frame = "done/frames/spot-0003.exr";
    workspace.write(frame, &workspace.read(frame)[..200]);
    let _ = workspace.phicam(&format!("{line} --resume")).exits(0);
    assert_eq!(workspace.read(frame), whole["frames/spot-0003.exr"]);
}

#[test]
fn resume_traces_only_what_is_missing() {
    let workspace = Workspace::with_scenes();
    let line = "render tiny.toml -o cut --samples 32";
    let _ = workspace.phicam(&format!("{line} --spots 0..3")).exits(0);
    let modified = |spot: usize| {
        let path = workspace.path(&format!("cut/frames/spot-{spot:04}.exr"));
        std::fs::metadata(path).and_then(|m| m.modified()).unwrap()
    };
    let before: Vec<_> = (0..3).map(modified).collect();
    std::thread::sleep(Duration::from_millis(20));
    let _ = workspace.phicam(&format!("{line} --resume")).exits(0);
    let after: Vec<_> = (0..3).map(modified).collect();
    assert_eq!(before, after);
    assert!(!workspace.path("cut/partial").exists());
}
