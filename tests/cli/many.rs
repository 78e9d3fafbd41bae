//! One render divided among processes: the same bytes however it is cut, and nothing that is not a
//! part of it accepted.

use std::fs;
use std::path::PathBuf;

use phicam::transport::NUMERICS;

use crate::small_scene::{SMALL, TINY, altered};
use crate::workspace::{Contents, Ended, Workspace, assert_same};

const PATHS: &str = "--samples 64 --seed 5";

/// A workspace with the tiny scene planned into `job` in `shards` shards.
fn planned(options: &str) -> Workspace {
    let workspace = Workspace::new();
    workspace.write("tiny.toml", altered(&TINY));
    let _ = workspace
        .phicam(&format!("plan tiny.toml -o job {PATHS} {options}"))
        .exits(0);
    workspace
}

fn compute(workspace: &Workspace, indices: impl IntoIterator<Item = usize>) {
    for k in indices {
        let _ = workspace
            .phicam(&format!("shard job --index {k} --threads {}", 1 + k % 2))
            .exits(0);
    }
}

/// The files of the result, without the record, whose times differ, and without what says of which
/// plan it is.
fn result(workspace: &Workspace, folder: &str) -> Contents {
    let mut contents = workspace.contents(folder);
    assert!(contents.remove("run.json").is_some());
    contents.remove("merged.json");
    contents
}

fn shards(workspace: &Workspace) -> Vec<PathBuf> {
    let entries = fs::read_dir(workspace.path("job/shards")).expect("a folder of shards");
    let mut paths: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
    paths.retain(|p| p.extension().is_some_and(|e| e == "phs"));
    paths.sort_by_key(|p| from(p));
    paths
}

/// The first block in the name PLAN-FROM-TO.phs.
fn from(path: &std::path::Path) -> u64 {
    let name = path
        .file_stem()
        .expect("a name")
        .to_string_lossy()
        .into_owned();
    let from = name.split('-').nth(1).expect("a first block");
    from.parse().expect("a number")
}

/// Merging is refused with `code` and every one of `words`, and nothing is written.
fn merge_refused(workspace: &Workspace, code: i32, words: &[&str]) {
    refused(workspace, "merge job -o merged", code, words);
    assert!(!workspace.path("merged").exists());
}

fn refused(workspace: &Workspace, line: &str, code: i32, words: &[&str]) {
    let before = workspace.contents("");
    let ended: Ended = workspace.phicam(line).exits(code);
    assert!(
        !ended.stderr.contains("error: error"),
        "{}",
        ended.account()
    );
    for word in words {
        assert!(
            ended.stderr.contains(word),
            "no `{word}` in {}",
            ended.account()
        );
    }
    assert_same(&before, &workspace.contents(""), line);
}

#[test]
#[ignore = "slow"]
fn any_splitting_gives_the_bytes_of_one_process() {
    for estimator in ["independent", "shared", "factored"] {
        let straight = planned("");
        let line = format!("render tiny.toml -o whole {PATHS} --estimator {estimator}");
        let _ = straight.phicam(&format!("{line} --threads 2")).exits(0);
        let whole = result(&straight, "whole");
        for shards in [1, 2, 7, 32] {
            let workspace = planned(&format!("--shards {shards} --estimator {estimator}"));
            compute(&workspace, (0..shards).rev());
            let _ = workspace.phicam("status job").exits(0);
            let _ = workspace.phicam("merge job -o merged").exits(0);
            assert_same(
                &whole,
                &result(&workspace, "merged"),
                &format!("{estimator}, {shards}"),
            );
        }
        // Two splittings: the second takes over where the first has stopped.
        let workspace = planned(&format!("--shards 7 --estimator {estimator}"));
        compute(&workspace, [1, 4, 5]);
        let line = format!("plan tiny.toml -o job {PATHS} --estimator {estimator} --shards 3");
        let _ = workspace.phicam(&line).exits(0);
        compute(&workspace, 0..3);
        let _ = workspace.phicam("merge job -o merged").exits(0);
        assert_same(
            &whole,
            &result(&workspace, "merged"),
            &format!("{estimator}, two splittings"),
        );
    }
}

#[test]
fn what_is_there_is_not_computed_again_and_what_is_missing_is_named() {
    let workspace = planned("--shards 8");
    let status = workspace.phicam("status job").exits(3);
    assert_eq!(status.stdout, "0-7\n");
    compute(&workspace, [0, 2, 6, 7]);
    let status = workspace.phicam("status job").exits(3);
    assert_eq!(status.stdout, "1,3-5\n");
    merge_refused(&workspace, 66, &["4 of 8 shards", "1,3-5", "phicam shard"]);
    let before = workspace.contents("job");
    let again = workspace.phicam("shard job --index 2").exits(0);
    assert!(again.stderr.contains("is there"), "{}", again.account());
    assert_same(&before, &workspace.contents("job"), "again");
    compute(&workspace, [1, 3, 4, 5]);
    let status = workspace.phicam("status job").exits(0);
    assert_eq!(status.stdout, "");
    let _ = workspace.phicam("merge job -o merged").exits(0);
    // A second merge finds everything there; the shards stay.
    let whole = workspace.contents("");
    let _ = workspace.phicam("merge job -o merged").exits(0);
    assert_same(&whole, &workspace.contents(""), "merged twice");
}

#[test]
#[ignore = "slow"]
fn spoilt_and_foreign_shards_are_refused_each_by_its_own_words() {
    let workspace = planned("--shards 4");
    compute(&workspace, 0..4);
    let second = shards(&workspace)[1].clone();
    let whole = fs::read(&second).expect("a shard");
    let spoil = |bytes: &[u8], word: &str| {
        fs::write(&second, bytes).expect("written");
        // It counts as missing, and is computed again to the same payload.
        merge_refused(
            &workspace,
            66,
            &[word, &second.file_name().unwrap().to_string_lossy()],
        );
        assert_eq!(workspace.phicam("status job").exits(3).stdout, "1\n");
        let _ = workspace.phicam("shard job --index 1").exits(0);
        let _ = workspace.phicam("status job").exits(0);
    };
    spoil(&[], "is empty");
    spoil(&whole[..whole.len() - 7], "is cut off");
    spoil(&whole[..11], "is cut off");
    let mut flipped = whole.clone();
    flipped[whole.len() - 100] ^= 1;
    spoil(&flipped, "is damaged");
    spoil(&[&whole[..], b"x"].concat(), "more than its header says");

    // Somebody else's: of another seed, another scene, and no shard at all. Neither is it replaced.
    let other = planned("--shards 4");
    let line = "plan tiny.toml -o other --samples 64 --seed 6 --shards 4";
    let _ = other.phicam(line).exits(0);
    let _ = other.phicam("shard other --index 1").exits(0);
    let names = other.contents("other/shards");
    let foreign = names.values().next().expect("a shard");
    fs::write(&second, foreign).expect("written");
    let words = [
        "belongs to another plan",
        "its seed is 6, that of this plan is 5",
    ];
    let lines = ["status job", "slurm job --dry-run", "shard job --index 1"];
    merge_refused(&workspace, 65, &words);
    for line in lines {
        refused(&workspace, line, 65, &words);
    }
    fs::write(&second, b"A picture of something else").expect("written");
    merge_refused(&workspace, 65, &["is no shard of phicam"]);
    for line in lines {
        refused(&workspace, line, 65, &["is no shard of phicam"]);
    }
}

/// A shard written by the library, with what it says of itself changed, and its closing digest
/// right.
#[test]
fn a_shard_of_other_numerics_is_refused_by_that_name() {
    let workspace = planned("--shards 2");
    compute(&workspace, 0..2);
    let path = shards(&workspace)[0].clone();
    let plan = workspace.json("job/plan.json");
    let mut identity = plan["identity"].clone();
    let last = identity
        .as_array_mut()
        .and_then(|i| i.last_mut())
        .expect("a pair");
    assert_eq!(last[0], "numerics");
    last[1] = "0".into();
    let renewed: phicam::jobs::Identity = serde_json::from_value(identity).expect("an identity");
    let provenance = phicam::jobs::Provenance {
        version: "0.0.0".to_owned(),
        threads: 1,
        seconds: 1.0,
    };
    phicam::jobs::write(&path, &renewed, &[(0..16, vec![0; 10])], provenance).expect("written");
    merge_refused(&workspace, 65, &["version 0 of the numerics", "do not mix"]);
}

#[test]
fn overlapping_shards_are_refused_and_equal_ones_are_not() {
    let workspace = planned("--shards 2");
    compute(&workspace, 0..2);
    let name = |p: &PathBuf| p.file_name().unwrap().to_string_lossy().into_owned();
    // The same blocks computed elsewhere: other times, same payload.
    let elsewhere = planned("--shards 2");
    compute(&elsewhere, [1]);
    let copy = shards(&elsewhere)[0].clone();
    let renamed = workspace.path("job/shards/copy.phs");
    fs::copy(&copy, &renamed).expect("copied");
    let _ = workspace.phicam("merge job -o merged").exits(0);
    fs::remove_dir_all(workspace.path("merged")).expect("removed");
    fs::remove_file(renamed).expect("removed");
    // Some of the same blocks, and others.
    let other = planned("--shards 3");
    compute(&other, [1]);
    let middle = shards(&other)[0].clone();
    fs::copy(&middle, workspace.path("job/shards").join(name(&middle))).expect("copied");
    merge_refused(&workspace, 65, &["overlap", "count twice", &name(&middle)]);
}

#[test]
fn a_plan_or_scene_that_was_edited_is_refused() {
    let workspace = planned("--shards 2");
    compute(&workspace, 0..2);
    let scene = workspace.text("job/scene.toml");
    let edited = scene.replace("pixels = [3, 2]", "pixels = [2, 3]");
    workspace.write("job/scene.toml", edited);
    for line in ["merge job -o merged", "shard job --index 0", "status job"] {
        refused(&workspace, line, 65, &["edited after planning", "digest"]);
    }
    workspace.write("job/scene.toml", scene);
    let plan = workspace.text("job/plan.json");
    let seed = plan.replace("\"seed\": 5", "\"seed\": 6");
    assert_ne!(plan, seed);
    workspace.write("job/plan.json", seed);
    merge_refused(
        &workspace,
        65,
        &["edited after planning", "seed: 5 planned, 6 found"],
    );
    let both = plan
        .replace("\"seed\": 5", "\"seed\": 6")
        .replace("\"seed\",\n      \"5\"", "\"seed\",\n      \"6\"");
    workspace.write("job/plan.json", both);
    merge_refused(&workspace, 65, &["was edited", "plan_id"]);
    let of = |version: u32| format!("\"numerics\",\n      \"{version}\"");
    let numerics = plan.replace(&of(NUMERICS), &of(NUMERICS + 7));
    assert_ne!(plan, numerics);
    workspace.write("job/plan.json", numerics);
    merge_refused(&workspace, 65, &["was edited", "plan_id"]);
    for broken in ["", "{", "[]", "{\"layout\": 1}"] {
        workspace.write("job/plan.json", broken);
        merge_refused(&workspace, 65, &["plan.json is damaged"]);
    }
    workspace.write("job/plan.json", &plan);
    let more = plan.replace("\"shards\": 2", "\"shards\": 0");
    workspace.write("job/plan.json", more);
    merge_refused(&workspace, 65, &["was edited: 0 shards"]);
    workspace.write("job/plan.json", plan);
    let _ = workspace.phicam("merge job -o merged").exits(0);
}

#[test]
fn wrong_usage_has_its_own_code() {
    let workspace = planned("--shards 2");
    for (line, word) in [
        ("shard job --index 2", "beyond the 2 shards"),
        ("shard job --index two", "--index"),
        ("shard job", "cure: give --index"),
        ("shard job 1", "cure: write it behind its option: --index 1"),
        ("shard nowhere --index 0", "not the folder of a plan"),
        ("status nowhere", "not the folder of a plan"),
        ("merge job", "--output"),
        ("plan tiny.toml -o other --shards 0", "--shards 0"),
        ("plan tiny.toml -o other --samples 0", "--samples 0"),
        ("--also-read . shard job --bad", "--bad"),
        ("plan tiny.toml -o other --shards 100000", "--shards 100000"),
        ("plan tiny.toml -o other --no-such-flag", "--no-such-flag"),
    ] {
        refused(&workspace, line, 64, &[word]);
    }
    let line = format!("plan tiny.toml -o job {PATHS} --seed 7");
    refused(
        &workspace,
        &line.replace("--seed 5 ", ""),
        65,
        &["holds another plan", "seed"],
    );
    // Other commands keep theirs.
    assert_eq!(workspace.phicam("render --no-such-flag").code, 2);
    assert_eq!(workspace.phicam("merge --help").code, 0);
}

#[test]
fn only_clean_removes_and_only_what_is_ours() {
    let workspace = planned("--shards 2");
    compute(&workspace, 0..2);
    let names: Vec<String> = shards(&workspace)
        .iter()
        .map(|p| p.file_name().unwrap().to_string_lossy().into_owned())
        .collect();
    let checkpoint = names[0].replace(".phs", ".checkpoint");
    let unfinished = checkpoint.replace("-0-", "-1-");
    for name in [&checkpoint, &unfinished, &"notes.txt".to_owned()] {
        workspace.write(&format!("job/shards/{name}"), "x");
    }
    let before = workspace.contents("");
    let dry = workspace.phicam("clean job --dry-run").exits(0);
    assert!(dry.stdout.contains(&checkpoint), "{}", dry.account());
    assert_same(&before, &workspace.contents(""), "dry run");
    let _ = workspace.phicam("clean job").exits(0);
    let missing = workspace.path("job/shards").join(&names[1]);
    let second = fs::read(&missing).expect("a shard");
    let left = |name: &str| workspace.path("job/shards").join(name).exists();
    assert!(!left(&checkpoint) && left("notes.txt") && names.iter().all(|n| left(n)));
    // What is finished of a shard that is not is needed.
    fs::remove_file(&missing).expect("removed");
    let begun = names[1].replace(".phs", ".checkpoint");
    workspace.write(&format!("job/shards/{begun}"), "x");
    let _ = workspace.phicam("clean job").exits(0);
    assert!(left(&begun) && left(&names[0]));
    fs::write(&missing, second).expect("written");
    let _ = workspace.phicam("merge job -o merged").exits(0);
    let _ = workspace.phicam("clean job --shards").exits(0);
    assert!(left("notes.txt") && !names.iter().any(|n| left(n)));
    assert!(workspace.path("job/plan.json").exists());
}

/// A plan that was killed before its last file is planned again; a folder with another scene is not
/// touched.
#[test]
fn a_plan_that_was_not_finished_is_planned_again() {
    let workspace = planned("--shards 2");
    fs::remove_file(workspace.path("job/plan.json")).expect("removed");
    let line = format!("plan tiny.toml -o job {PATHS} --shards 2");
    let _ = workspace.phicam(&line).exits(0);
    fs::remove_file(workspace.path("job/plan.json")).expect("removed");
    workspace.write("job/scene.toml", "a scene of somebody else");
    refused(&workspace, &line, 65, &["not of a plan", "another folder"]);
}

/// What a study takes from the scene beside its light is part of the plan, too.
#[test]
fn a_study_of_another_sensor_is_another_plan() {
    let workspace = Workspace::new();
    let scene = altered(&TINY) + "\n[sensor]\nmodel = \"ccd\"\n";
    workspace.write("tiny.toml", &scene);
    let study = "study noise tiny.toml --axis exposure --seeds 2 --noise 0.001 --method pinv";
    let line = format!("plan -o job --shards 2 -- {study}");
    let _ = workspace.phicam(&line).exits(0);
    let _ = workspace.phicam("shard job --index 0").exits(0);
    workspace.write("job/scene.toml", scene.replace("ccd", "dslr"));
    refused(
        &workspace,
        "shard job --index 1",
        65,
        &["edited after planning", "text"],
    );
    workspace.write("tiny.toml", scene.replace("ccd", "dslr"));
    refused(&workspace, &line, 65, &["holds another plan"]);
}

/// The packed copy carries what the scene names; the originals are not needed any more.
#[test]
fn a_plan_carries_the_files_of_its_scene() {
    let workspace = Workspace::new();
    let _ = workspace.phicam("target ramp -o ramp.png").exits(0);
    let board = "lambertian = { checkerboard = [2, 2], dark = 0.0, light = 1.0 }";
    let picture = "lambertian = { image = \"ramp.png\", transfer = \"linear\" }";
    let pictured = altered(TINY.iter().chain([&(board, picture)]));
    workspace.write("pictured.toml", pictured);
    let _ = workspace
        .phicam("plan pictured.toml -o job --samples 32 --shards 2")
        .exits(0);
    let _ = workspace
        .phicam("render pictured.toml -o whole --samples 32")
        .exits(0);
    fs::remove_file(workspace.path("ramp.png")).expect("removed");
    compute(&workspace, 0..2);
    let _ = workspace.phicam("merge job -o merged").exits(0);
    assert_same(
        &result(&workspace, "whole"),
        &result(&workspace, "merged"),
        "packed",
    );
}

/// A study in shards leaves the files of the study in one process; so do the published items.
#[test]
#[ignore = "slow"]
fn studies_are_divided_too() {
    let workspace = Workspace::new();
    workspace.write("tiny.toml", altered(&SMALL));
    for (n, command) in [
        "study noise tiny.toml --seeds 3 --noise 0.1,0.01 --method pinv,joint",
        "study power tiny.toml --seeds 6 --samples 32,64",
        "reproduce fig15 dual fig22",
    ]
    .into_iter()
    .enumerate()
    {
        let job = format!("job-{n}");
        let line = format!("plan -o {job} --shards 3 -- {command}");
        let _ = workspace.phicam(&line).exits(0);
        for k in [2, 0, 1] {
            let _ = workspace
                .phicam(&format!("shard {job} --index {k}"))
                .exits(0);
        }
        let merged = workspace.phicam(&format!("merge {job} -o merged-{n}"));
        let straight = workspace.phicam(&format!("{command} -o straight-{n}"));
        assert_eq!(
            (merged.code, &merged.stdout),
            (straight.code, &straight.stdout)
        );
        let mut contents = workspace.contents(&format!("merged-{n}"));
        assert!(contents.remove("merged.json").is_some());
        let mut whole = workspace.contents(&format!("straight-{n}"));
        // What a rerun of the one command goes on from; the other's is in its shards.
        assert_eq!(
            whole.remove("noise.phs").is_some(),
            command.contains("noise")
        );
        assert_same(&contents, &whole, command);
    }
    for (line, word) in [
        (
            "plan -o other -- study noise tiny.toml -o out",
            "-o is no part",
        ),
        (
            "plan -o other -- study noise tiny.toml --threads 2",
            "--threads is no part",
        ),
        ("plan -o other", "a plan is of a scene"),
        (
            "plan tiny.toml -o other -- study noise tiny.toml",
            "a plan is of a scene",
        ),
        ("plan -o other -- study nonsense", "nonsense"),
        (
            "plan -o other --samples 4 -- study noise tiny.toml",
            "--samples",
        ),
    ] {
        refused(&workspace, line, 64, &[word]);
    }
    refused(
        &workspace,
        "plan -o other -- run tiny.toml",
        65,
        &["cannot be cut"],
    );
}
