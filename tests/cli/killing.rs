//! A render killed at any moment: no visible file is ever half a file or another one, and going on
//! ends with the same bytes.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::small_scene::{TINY, altered};
use crate::workspace::{Contents, Workspace, assert_same};

/// Estimators, and the samples to begin with.
const PLANS: [(&str, u64); 3] = [
    ("shared", 65536),
    ("independent", 8192),
    ("factored", 262_144),
];
/// A render is to take so long that moments of it can be met, and a checkpoint is due in it.
const LONG: Duration = Duration::from_millis(800);
/// Moments, over all plans.
const KILLS: usize = 51;

fn is_temporary(name: &str) -> bool {
    name.contains(".phicam") && (name.ends_with(".part") || name.ends_with(".lock"))
}

/// What can be seen in a folder whose render was killed: of the final files the final bytes, of the
/// others whole ones.
fn look(workspace: &Workspace, folder: &str, whole: &Contents) -> u64 {
    let mut blocks = 0;
    for (name, bytes) in workspace.contents(folder) {
        if is_temporary(&name) || name == "run.json" || name.ends_with('/') {
            continue;
        }
        if name.starts_with("partial/") {
            blocks += blocks_of(&bytes, &name);
            continue;
        }
        assert_eq!(
            Some(&bytes),
            whole.get(&name),
            "{name} is not what it ends as"
        );
    }
    blocks
}

/// The blocks in a file of finished blocks, by its header; its closing digest is that of its bytes.
fn blocks_of(bytes: &[u8], name: &str) -> u64 {
    use sha2::{Digest, Sha256};
    let (body, digest) = bytes.split_at(bytes.len().saturating_sub(32));
    assert_eq!(Sha256::digest(body)[..], *digest, "{name}");
    let header = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let header: serde_json::Value = serde_json::from_slice(&bytes[16..16 + header]).expect("JSON");
    header["to"].as_u64().expect("a last block")
}

#[test]
#[ignore = "slow"]
fn killed_at_fifty_moments_it_ends_with_the_same_bytes() {
    let mut random = 0x9e37_79b9_7f4a_7c15u64;
    let mut killed: BTreeMap<&str, usize> = BTreeMap::new();
    let mut resumed = 0;
    for (plan, mut samples) in PLANS {
        let workspace = Workspace::new();
        let bounces = ("max_bounces = 3", "max_bounces = 4");
        workspace.write("tiny.toml", altered(TINY.iter().chain([&bounces])));
        let (line, takes) = loop {
            let line =
                format!("render tiny.toml --estimator {plan} --samples {samples} --threads 2");
            let begun = Instant::now();
            let _ = workspace
                .phicam(&format!("{line} -o whole --replace"))
                .exits(0);
            if begun.elapsed() >= LONG {
                break (line, begun.elapsed());
            }
            samples *= 2;
        };
        let mut whole = workspace.contents("whole");
        whole.remove("run.json");
        let mut renders = 0;
        while killed.get(plan).copied().unwrap_or(0) < KILLS / PLANS.len() {
            renders += 1;
            assert!(renders < 100, "{plan}: it ends before it can be killed");
            let cut = format!("cut-{renders}");
            let mut blocks = 0;
            loop {
                let mut child = workspace.begins(&format!("{line} -o {cut} --resume"));
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                let share = (random >> 11) as f64 / (1u64 << 53) as f64;
                std::thread::sleep(takes.mul_f64(share).max(Duration::from_millis(1)));
                child.kill().expect("it can be killed");
                if child.wait().expect("it ends").success() {
                    break;
                }
                *killed.entry(plan).or_default() += 1;
                let there = look(&workspace, &cut, &whole);
                // What was finished is never forgotten, unless all has taken its place.
                let kept = there >= blocks || there == 0;
                assert!(kept, "{plan}: {blocks} blocks were there, now {there}");
                resumed += u64::from(there > 0);
                blocks = there;
            }
            let mut found = workspace.contents(&cut);
            found.remove("run.json");
            assert_same(&whole, &found, plan);
        }
    }
    assert!(killed.values().sum::<usize>() >= 50, "{killed:?}");
    assert!(
        resumed > 5,
        "blocks were there at {resumed} of the moments only"
    );
}

/// Spots so short that all their blocks are traced at one go: SIGTERM ends a render between two of
/// them, and kill -9 leaves a shard what it had.
#[test]
fn short_spots_are_kept_one_by_one() {
    let workspace = Workspace::new();
    let spots = ("per_side = 30", "per_side = 300");
    workspace.write("many.toml", altered([&TINY[0], &spots]));
    let wait = |what: &dyn Fn() -> bool| {
        let begun = Instant::now();
        while !what() && begun.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(5));
        }
        assert!(what(), "nothing was finished within a minute");
    };
    let mut child = workspace.begins("render many.toml -o cut --samples 512");
    wait(&|| workspace.path("cut/frames/spot-0003.exr").exists());
    let sent = Command::new("kill")
        .args(["-TERM", &child.id().to_string()])
        .status();
    assert!(sent.expect("a signal").success());
    assert_eq!(child.wait().expect("it ends").code(), Some(75));
    assert!(!workspace.path("cut/phi.npy").exists());

    let _ = workspace
        .phicam("plan many.toml -o job --samples 65536 --shards 1")
        .exits(0);
    let mut child = workspace.begins("shard job --index 0");
    let unfinished = || {
        let names = workspace.contents("job/shards");
        names.keys().any(|n| n.ends_with(".checkpoint"))
    };
    wait(&unfinished);
    child.kill().expect("it can be killed");
    assert!(!child.wait().expect("it ends").success());
    let mut child = workspace.begins("shard job --index 0");
    std::thread::sleep(Duration::from_millis(200));
    child.kill().expect("it can be killed");
    let _ = child.wait();
    assert!(unfinished());
}

/// SIGTERM is the scheduler's warning: the block at work is finished and kept, and the exit code
/// says that going on is worth it.
#[test]
#[ignore = "slow"]
fn a_warned_shard_keeps_its_blocks_and_goes_on() {
    let workspace = Workspace::new();
    workspace.write("tiny.toml", altered(&TINY));
    let paths = "--estimator shared --samples 2097152";
    let _ = workspace
        .phicam(&format!("plan tiny.toml -o job {paths} --shards 1"))
        .exits(0);
    let mut child = workspace.begins("shard job --index 0 --threads 1");
    let unfinished = |workspace: &Workspace| {
        let names = workspace.contents("job/shards");
        names
            .iter()
            .find(|(n, _)| n.ends_with(".checkpoint"))
            .map(|(n, bytes)| blocks_of(bytes, n))
    };
    let begun = Instant::now();
    while unfinished(&workspace).is_none() && begun.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let before = unfinished(&workspace).expect("a block within a minute");
    let sent = Command::new("kill")
        .args(["-TERM", &child.id().to_string()])
        .status();
    assert!(sent.expect("a signal").success());
    assert_eq!(child.wait().expect("it ends").code(), Some(75));
    let after = unfinished(&workspace).expect("the finished blocks");
    assert!(
        (before..32).contains(&after),
        "{before} blocks, then {after}"
    );
    let ended = workspace.phicam("shard job --index 0").exits(0);
    let words = format!("going on at block {after} of 0..32");
    assert!(ended.stderr.contains(&words), "{}", ended.account());
    let _ = workspace.phicam("merge job -o merged").exits(0);
    let line = format!("render tiny.toml -o whole {paths}");
    let _ = workspace.phicam(&line).exits(0);
    let [mut merged, mut whole] = ["merged", "whole"].map(|f| workspace.contents(f));
    assert!(merged.remove("run.json").is_some() && whole.remove("run.json").is_some());
    assert!(merged.remove("merged.json").is_some());
    assert_same(&merged, &whole, "warned and straight");
}
