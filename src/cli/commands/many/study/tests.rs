use std::collections::BTreeMap;
use std::fs;
use std::sync::atomic::AtomicBool;

use super::*;
use crate::transport::Control;

const CONSOLE: Console<'static> = Console {
    quiet: true,
    also_read: &[],
    define: &[],
};

fn words(line: &str) -> Vec<String> {
    line.split_whitespace().map(str::to_owned).collect()
}

/// All files but the tasks that a rerun goes on from.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entry = |e: std::io::Result<fs::DirEntry>| {
        let e = e.unwrap();
        let name = e.file_name().into_string().unwrap();
        (name, fs::read(e.path()).unwrap())
    };
    let all = fs::read_dir(folder).unwrap().map(entry);
    all.filter(|(name, _)| !name.ends_with(".phs")).collect()
}

/// A built-in scene of four by four pixels as a file.
fn small(folder: &Path, name: &str) -> String {
    let text = Scene::load(name).unwrap().text;
    let at = text.find("pixels = [").unwrap();
    let end = at + text[at..].find(']').unwrap() + 1;
    let path = folder.join(format!("{name}.toml"));
    fs::write(&path, text.replacen(&text[at..end], "pixels = [4, 4]", 1)).unwrap();
    path.to_string_lossy().into_owned()
}

/// Other values of keys behind the command are those of its scene, as before the dashes; what names
/// no scene has none.
#[test]
fn a_planned_command_has_its_own_values() {
    let line = words("study spots bench -D camera.pixels=[6,6] -D laser.spots.per_side=4");
    let study = Study::new(&line, None, false, CONSOLE).unwrap();
    let scene = study.scene().unwrap();
    let size = [scene.camera.columns, scene.camera.rows];
    assert_eq!((size, scene.laser.spots.len()), ([6, 6], 16));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, &scene.text).unwrap();
    let path = path.to_string_lossy();
    let again = Study::new(&line, Some(&path), false, CONSOLE).unwrap();
    assert_eq!(again.scene().unwrap().hash, scene.hash);
    let none = words("reproduce table2 -D camera.pixels=[6,6]");
    assert!(Study::new(&none, None, false, CONSOLE).is_err());
}

/// Runs `line` as it is, and in tasks of two processes, the second half first.
fn same(line: &str) {
    let folder = tempfile::tempdir().unwrap();
    let direct = folder.path().join("direct");
    let merged = folder.path().join("merged");
    let line = ["bench", "satin", "experiment"]
        .into_iter()
        .filter(|name| line.contains(&format!("{{{name}}}")))
        .fold(line.to_owned(), |line, name| {
            line.replace(&format!("{{{name}}}"), &small(folder.path(), name))
        });
    let own = format!("phicam {line} -o {}", direct.display());
    match Args::try_parse_from(words(&own)).unwrap().command {
        Command::Study(args) => study::execute(&args, CONSOLE).map(|_| ()).unwrap(),
        Command::Reproduce(args) => reproduce::execute(&args, CONSOLE).map(|_| ()).unwrap(),
        _ => panic!("{line}"),
    }
    let planned = || Study::new(&words(&line), None, false, CONSOLE).unwrap();
    let stop = AtomicBool::new(false);
    let control = Control {
        progress: &|_| (),
        stop: &stop,
    };
    let process = |range: Range<usize>| planned().tasks.run(range, control).unwrap();
    let all = planned().tasks;
    let half = all.count() / 2;
    let second = process(half..all.count());
    let parts = [process(0..half), second].concat();
    all.deliver(&parts, &merged).unwrap();
    assert!(files(&direct) == files(&merged), "{line}");

    let mut forged = parts.clone();
    forged[0].push(0);
    assert!(all.deliver(&forged, &merged).is_err(), "{line}");
    let beyond = half..all.count() + 1;
    assert!(all.run(beyond, control).is_err(), "{line}");
    stop.store(true, std::sync::atomic::Ordering::Relaxed);
    assert!(
        matches!(all.run(0..all.count(), control), Err(Failure::Stopped(_))),
        "{line}"
    );
}

#[test]
#[ignore = "slow"]
fn studies_of_recoveries_leave_the_same_files() {
    same("study coverage {bench} --elements 2 --seeds 11 --method pinv,joint");
    same(
        "study noise {bench} --boards 2 --elements 2,4 --seeds 3 --noise 1e-6,1e-2 --method pinv,joint --render-samples 16",
    );
    same(
        "study indicator {bench} --spots 8,40 --half-widths 4 --elements 4 --boards 2 --seeds 3 --every 5 --method pinv",
    );
    same(
        "study experiment {experiment} --samples 32 --seeds 2 --glares 1 --exposures 0.1 --frames 2",
    );
}

#[test]
#[ignore = "slow"]
fn studies_of_traced_light_leave_the_same_files() {
    same("study power {bench} --samples 32 --seeds 3 --estimator shared,factored");
    same("study convergence {bench} --samples 32,64");
    same("study budget {bench} --samples 256 --run-samples 32");
    same("study tolerance {bench}");
    same("study brdf {satin} --samples 64 --noise 0.01 --seeds 2 --method pinv,joint");
}

#[test]
fn published_items_leave_the_same_files() {
    same("reproduce table2 fig13 --most-elements 8");
}

#[test]
fn other_commands_are_refused() {
    let Err(Failure::Error(said)) = Study::new(&words("model bench"), None, false, CONSOLE) else {
        panic!("divided")
    };
    assert!(said.contains("cannot be cut into tasks"), "{said}");
}
