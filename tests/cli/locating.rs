//! `phicam locate`: where the hidden surface is.

use phicam::matrix::{Matrix, npy};

use crate::workspace::Workspace;

/// What was told, on one line.
fn told(ended: &crate::workspace::Ended) -> String {
    ended
        .stdout
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}

/// The small bench, rendered.
fn rendered() -> Workspace {
    let w = Workspace::with_scenes();
    let _ = w
        .phicam("render small.toml -o run --samples 256 -q")
        .exits(0);
    w
}

#[test]
fn a_rendered_surface_is_where_the_scene_has_it() {
    let w = rendered();
    let line = "locate run --elements 4x4 --steps 5 --orders 999 --range -0.6,0.6";
    let ended = w.phicam(line).exits(0);
    for words in [
        "S2 along its normal",
        "by leaving out one of 24 frames",
        "belong to their spots",
    ] {
        assert!(told(&ended).contains(words), "{}", ended.account());
    }
    let found = w.json("run/located/locate.json");
    let number = |key: &str| found[key].as_f64().unwrap();
    let error = number("by_curvature").max(number("by_frames"));
    assert!(
        number("size").abs() < 4.0 * error && error < 0.2,
        "{found:#}"
    );
    assert_eq!(found["order"]["as_likely"], 0);
    for file in ["locate.csv", "locate.svg", "report.html"] {
        assert!(w.path(&format!("run/located/{file}")).exists(), "{file}");
    }
    // The same numbers whatever the threads.
    let again = w
        .phicam(&format!("{line} --threads 1 --json -o other"))
        .exits(0);
    let other: serde_json::Value = serde_json::from_str(&again.stdout).unwrap();
    assert_eq!(found, other);
    // From files of their own, beside a scene of any folder, they are at the same place.
    std::fs::create_dir(w.path("beside")).unwrap();
    w.write("beside/scene.toml", w.text("run/scene.toml"));
    let files = "--phi run/phi.npy --stderr run/phi.stderr.npy --replicates 32 --left-out run/phi.tails.npy";
    let _ = w
        .phicam(&line.replace("run", &format!("beside {files}")))
        .exits(0);
    let other = w.json("beside/located/locate.json");
    let off = other["size"].as_f64().unwrap() - number("size");
    assert!(off.abs() < 0.3 * error, "{off} {error}");
}

/// Photographs whose order was changed are not believed; exit code 1.
#[test]
fn shuffled_photographs_are_rejected() {
    let w = rendered();
    let phi = w.matrix("run/phi.npy");
    let count = phi.ncols();
    let shuffle = |m: Matrix| Matrix::from_fn(m.nrows(), count, |p, l| m[(p, (7 * l + 5) % count)]);
    for file in ["run/phi.npy", "run/phi.stderr.npy"] {
        let mixed = shuffle(w.matrix(file));
        npy::write(&w.path(file), &mixed).unwrap();
    }
    w.disown("run");
    let ended = w
        .phicam("locate run --elements 4x4 --steps 3 --range -0.3,0.3")
        .exits(1);
    let words = "Nothing says that the photographs belong to their spots";
    assert!(told(&ended).contains(words), "{}", ended.account());
}

/// Photographs with a light of 5 % that the model lacks: the noise that is stated refutes what is
/// found, as it does for `calibrate`, and the cure is named and works.
#[test]
fn light_left_over_is_not_found_to_fit() {
    let w = rendered();
    let phi = w.matrix("run/phi.npy");
    npy::write(&w.path("run/phi.npy"), &phi.add_scalar(0.05 * phi.mean())).unwrap();
    w.disown("run");
    let line = "locate run --elements 4x4 --steps 5 --orders 0 --range -0.6,0.6";
    let ended = w.phicam(line).exits(1);
    for words in ["NOWHERE", "--background", "--frame-polynomial"] {
        assert!(told(&ended).contains(words), "{}", ended.account());
    }
    let calibrate = "calibrate run --free hidden.normal --elements 4x4 --starts 1";
    let _ = w.phicam(calibrate).exits(1);
    for cure in ["--background", "--frame-polynomial 0"] {
        let _ = w.phicam(&format!("{line} {cure}")).exits(0);
    }
}

#[test]
fn what_cannot_be_looked_for_is_refused() {
    let w = Workspace::with_scenes();
    w.refuses("locate nowhere", &["nowhere"]);
    let _ = w.phicam("render tiny.toml -o run --samples 16 -q").exits(0);
    w.refuses("locate run --what depth", &["normal", "angle"]);
    w.refuses("locate run --steps 2", &["3..=1000"]);
    w.refuses("locate run --range 1,0", &["LOW,HIGH"]);
    w.refuses(
        "locate run --background --frame-polynomial 0",
        &["--background", "--frame-polynomial"],
    );
}
