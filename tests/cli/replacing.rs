//! Own work is never replaced without being asked.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::time::{Duration, Instant, SystemTime};

use crate::workspace::{Workspace, assert_same};

const QUICK: &str = "render tiny.toml -o done --samples 32";

#[test]
fn the_same_render_goes_on_where_it_stopped() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam(&format!("{QUICK} --spots 0..3")).exits(0);
    let place = |spot: usize| {
        let path = workspace.path(&format!("done/frames/spot-{spot:04}.exr"));
        fs::metadata(path).map(|m| m.ino()).unwrap()
    };
    let before: Vec<u64> = (0..3).map(place).collect();
    // A range that reaches into what is finished traces the rest of it.
    let _ = workspace.phicam(&format!("{QUICK} --spots 1..5")).exits(0);
    assert_eq!(workspace.json("done/run.json")["finished"], 5);
    let ended = workspace.phicam(QUICK).exits(0);
    let words = "going on after 5 of 8 finished spots";
    assert!(ended.stderr.contains(words), "{}", ended.account());
    assert_eq!(before, (0..3).map(place).collect::<Vec<u64>>());
    let _ = workspace
        .phicam("render tiny.toml -o whole --samples 32")
        .exits(0);
    let [done, whole] = ["done", "whole"].map(|f| workspace.rendered(f));
    assert_same(&done, &whole, "in three steps and in one");
    // And once more: nothing is traced, nothing is written.
    let all = workspace.contents("done");
    let _ = workspace.phicam(QUICK).exits(0);
    assert_same(&all, &workspace.contents("done"), "once more");
}

#[test]
fn other_settings_are_refused_unless_they_are_to_replace() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam("run tiny.toml -o done --samples 32");
    let words = [
        "done holds a run with other settings",
        "seed 1",
        "--replace",
    ];
    for line in [
        "render tiny.toml -o done --samples 32 --seed 2",
        "--quiet render tiny.toml -o done --samples 64",
        "run tiny.toml -o done --samples 32 --estimator shared",
        "--quiet run tiny.toml -o done --samples 32 --seed 2",
        "render tiny.toml -o done --samples 32 --seed 2 --spots 0..2",
    ] {
        workspace.refuses(line, &words);
    }
    let words = ["done holds a run of another scene", "--replace"];
    workspace.refuses("run small.toml -o done --samples 32", &words);

    let fresh = "--samples 64 --seed 2";
    let _ = workspace
        .phicam(&format!("render tiny.toml -o done --replace {fresh}"))
        .exits(0);
    let _ = workspace
        .phicam(&format!("render tiny.toml -o fresh {fresh}"))
        .exits(0);
    let [done, fresh] = ["done", "fresh"].map(|f| workspace.rendered(f));
    assert_same(
        &done,
        &fresh,
        "replaced and fresh: nothing of the old run is left",
    );
}

/// The old run stays whole, and readable, until the new one is; which then goes on.
#[test]
fn a_killed_replacement_leaves_the_old_run_and_goes_on() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam(QUICK).exits(0);
    let old = workspace.contents("done");
    let mut samples = 1u64 << 17;
    let line = loop {
        let line = format!("render tiny.toml --seed 2 --samples {samples}");
        let mut child = workspace.begins(&format!("{line} -o done --replace"));
        let kept = workspace.path("done/.replacement/partial/spots-0000-0008.phs");
        let begun = Instant::now();
        while !kept.exists() && begun.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().expect("it can be killed");
        if !child.wait().expect("it ends").success() {
            break line;
        }
        samples *= 4;
        let _ = workspace.phicam(&format!("{QUICK} --replace")).exits(0);
    };
    let beside = |name: &String| name.starts_with(".replacement") || name.ends_with(".lock");
    let mut there = workspace.contents("done");
    there.retain(|name, _| !beside(name));
    let (mut before, mut now) = (old, there);
    assert!(before.remove("run.json").is_some() && now.remove("run.json").is_some());
    assert_same(&before, &now, "the old run");
    let validated = workspace.phicam("validate done");
    assert!(validated.code < 2, "{}", validated.account());
    // The old settings are still those of the folder.
    let _ = workspace.phicam(QUICK).exits(0);
    let ended = workspace
        .phicam(&format!("{line} -o done --replace"))
        .exits(0);
    assert!(
        ended.stderr.contains("going on after"),
        "{}",
        ended.account()
    );
    let _ = workspace.phicam(&format!("{line} -o fresh")).exits(0);
    let [done, fresh] = ["done", "fresh"].map(|f| workspace.rendered(f));
    assert_same(&done, &fresh, "replaced in two steps and fresh");
}

/// A process may end at any moment while it puts the new run in the place of the old one.
#[test]
fn a_replacement_that_ended_midway_is_finished_by_the_next_writer() {
    let workspace = Workspace::with_scenes();
    let fresh = "render tiny.toml --samples 64 --seed 2";
    let _ = workspace.phicam(&format!("{fresh} -o fresh")).exits(0);
    let whole = workspace.rendered("fresh");
    let copy = |to: &str| {
        let _ = fs::create_dir_all(workspace.path(to));
        for (name, bytes) in workspace.contents("fresh") {
            let path = workspace.path(to).join(&name);
            if name.ends_with('/') {
                fs::create_dir_all(path).unwrap();
            } else {
                fs::write(path, bytes).unwrap();
            }
        }
    };
    // The old run half removed, its record first.
    let _ = workspace.phicam(QUICK).exits(0);
    copy("done/.replacement");
    for name in ["run.json", "frames/spot-0000.exr", "frames/spot-0005.exr"] {
        fs::remove_file(workspace.path("done").join(name)).unwrap();
    }
    let ended = workspace.phicam(&format!("{fresh} -o done")).exits(0);
    assert!(ended.stdout.contains("8 of 8 spots"), "{}", ended.account());
    assert_same(&whole, &workspace.rendered("done"), "after removing");
    // The new run half moved, its record not yet.
    copy("moved/.incoming");
    for name in ["frames", "files"] {
        let _ = fs::create_dir_all(workspace.path("moved").join(name));
    }
    for name in [
        "frames/spot-0000.exr",
        "frames/spot-0003.exr",
        "scene.toml",
        "phi.npy",
    ] {
        let (from, to) = (workspace.path("moved/.incoming"), workspace.path("moved"));
        fs::rename(from.join(name), to.join(name)).unwrap();
    }
    fs::remove_dir(workspace.path("moved/files")).unwrap();
    let _ = workspace.phicam(&format!("{fresh} -o moved")).exits(0);
    assert_same(&whole, &workspace.rendered("moved"), "after moving");
}

#[test]
fn a_run_is_not_traced_twice_and_its_results_come_again() {
    let workspace = Workspace::with_scenes();
    let line = "run small.toml -o done --samples 256";
    let first = workspace.phicam(line);
    let place = || {
        let path = workspace.path("done/frames/spot-0000.exr");
        fs::metadata(path).map(|m| m.ino()).unwrap()
    };
    let (before, frame) = (workspace.contents("done"), place());
    fs::remove_file(workspace.path("done/report.html")).unwrap();
    fs::remove_dir_all(workspace.path("done/recovered")).unwrap();
    let _ = workspace.phicam(line).exits(first.code);
    assert_eq!(frame, place());
    let mut after = workspace.contents("done");
    let mut before = before;
    for times in ["run.json", "summary.json", "report.html"] {
        assert!(after.remove(times).is_some() && before.remove(times).is_some());
    }
    assert_same(&before, &after, "after a stop");
}

/// Deviations from a model stay until there is another model beside them.
#[test]
fn the_deviations_of_a_run_outlive_a_model_that_is_not_written() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam("run small.toml -o done --samples 64");
    let before = workspace.contents("done/model");
    assert!(before.contains_key("z.npy"));
    let line = "model small.toml -o done";
    let ended = workspace.phicam_after("ulimit -f 16", line).exits(2);
    assert!(ended.stderr.contains("g12.npy"), "{}", ended.account());
    assert_same(&before, &workspace.contents("done/model"), line);
    let ended = workspace.phicam(line).exits(0);
    let words = "in the place of the model that summary.json and report.html tell of";
    assert!(ended.stderr.contains(words), "{}", ended.account());
    assert!(!workspace.path("done/model/z.npy").exists());
}

/// What a recovery has left stays until the same of a new one is whole.
#[test]
fn the_files_of_a_recovery_outlive_one_that_is_not_written() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam(QUICK).exits(0);
    let line = "recover done --method joint -o mine";
    let _ = workspace.phicam(line);
    let before = workspace.contents("mine");
    assert!(
        before.contains_key("picard-joint.csv"),
        "{:?}",
        before.keys()
    );
    // A folder where the first file is to be, or one of the last: none of another picture's takes
    // the place of its own.
    for name in ["picard.svg", "joint.choice.json", "overview.png"] {
        let obstacle = workspace.path("mine").join(name);
        fs::remove_file(&obstacle).unwrap();
        fs::create_dir(&obstacle).unwrap();
        let other = "recover done --method joint -o mine --frame-constant";
        let ended = workspace.phicam(other).exits(2);
        assert!(ended.stderr.contains(name), "{}", ended.account());
        fs::remove_dir(&obstacle).unwrap();
        workspace.write(&format!("mine/{name}"), &before[name]);
        assert_same(&before, &workspace.contents("mine"), name);
    }
}

/// What a process that was killed had written goes with the next result.
#[test]
fn what_a_killed_recovery_had_written_is_removed_by_the_next() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam(QUICK).exits(0);
    let left = workspace.path("mine/.phicam-elsewhere0-1-Xy.part");
    fs::create_dir_all(&left).unwrap();
    fs::write(left.join("joint.npy"), "half").unwrap();
    let folder = fs::File::open(&left).unwrap();
    folder
        .set_modified(SystemTime::now() - Duration::from_secs(7200))
        .unwrap();
    let _ = workspace
        .phicam("recover done --method joint -o mine")
        .exits(0);
    assert!(!left.exists());
    assert!(workspace.path("mine/joint.npy").exists());
}

#[test]
fn files_are_not_overwritten_without_force() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam(QUICK).exits(0);
    for (line, file) in [
        ("scene export bench -o mine", "mine"),
        ("scene export bench --mitsuba -o mine", "mine"),
        ("scene show bench -o mine", "mine"),
        ("scene view bench --samples 1 --size 16,16 -o mine", "mine"),
        ("target card -o mine", "mine"),
        ("target sphere --faces 20 -o mine", "mine"),
        ("target usaf", "usaf.png"),
        ("view done/frames/spot-0000.exr -o mine", "mine"),
        ("view done/phi.npy", "done/phi.npy.png"),
    ] {
        workspace.write(file, "years of work");
        workspace.refuses(line, &[file, "is there already", "--force"]);
        let _ = workspace.phicam(&format!("{line} --force")).exits(0);
        assert_ne!(workspace.read(file), b"years of work", "{line}");
        fs::remove_file(workspace.path(file)).unwrap();
        let _ = workspace.phicam(line).exits(0);
        assert!(workspace.path(file).exists(), "{line}");
    }
}

#[test]
fn what_is_recovered_from_other_photographs_has_its_own_folder() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam("run small.toml -o done --samples 256");
    let before = workspace.contents("done/recovered");
    let page = workspace.read("done/report.html");
    let _ = workspace
        .phicam("expose done --sensor machine-vision --exposure 1")
        .exits(0);
    let mut folders = Vec::new();
    for seed in [1, 2] {
        let _ = workspace
            .phicam(&format!(
                "expose done --sensor machine-vision --exposure 1 --seed {seed} --replace"
            ))
            .exits(0);
        let line = "recover done --phi done/exposed/phi.npy --stderr done/exposed/phi.stderr.npy --method tikhonov --keep-clipped";
        let ended = workspace.phicam(line);
        assert!(ended.code < 2, "{}", ended.account());
        let names = fs::read_dir(workspace.path("done")).unwrap();
        let names = names.map(|e| e.unwrap().file_name().into_string().unwrap());
        let own: Vec<String> = names
            .filter(|n| n.starts_with("recovered-exposed-"))
            .collect();
        assert_eq!(own.len(), seed, "{own:?}");
        folders = own;
    }
    for folder in folders {
        assert!(
            workspace
                .path("done")
                .join(folder)
                .join("tikhonov.npy")
                .exists()
        );
    }
    assert_same(
        &before,
        &workspace.contents("done/recovered"),
        "the run's own",
    );
    assert_eq!(page, workspace.read("done/report.html"));
    let _ = workspace
        .phicam("recover done --method tikhonov -o elsewhere")
        .exits(0);
    assert!(workspace.path("elsewhere/tikhonov.npy").exists());
    assert_same(
        &before,
        &workspace.contents("done/recovered"),
        "the run's own",
    );
}

#[test]
fn studies_and_published_items_of_other_settings_stay() {
    let workspace = Workspace::with_scenes();
    let line = "reproduce table2 -o published --most-elements 8";
    let _ = workspace.phicam(line).exits(0);
    workspace.refuses(
        "reproduce table2 -o published --most-elements 9",
        &["table2", "other settings", "--replace"],
    );
    let _ = workspace
        .phicam("reproduce table2 -o published --most-elements 9 --replace")
        .exits(0);
}
