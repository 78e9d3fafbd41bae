//! `phicam calibrate`: the geometry, from the photographs.

use crate::workspace::Workspace;

/// Words on one line.
fn told(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The light of the small bench.
fn rendered() -> Workspace {
    let w = Workspace::with_scenes();
    let _ = w
        .phicam("render small.toml -o run --samples 1024 -q")
        .exits(0);
    w
}

/// Of a rendered scene nothing is off by more than its errors; the written scene is one, and is
/// what the numbers say.
#[test]
fn a_rendered_scene_is_as_it_is_written() {
    let w = rendered();
    let line = "calibrate run --free hinge.angle=0.5,hidden.normal --elements 4x4 --starts 2";
    let ended = w.phicam(line).exits(0);
    let words = told(&ended.stdout);
    for expected in ["hinge.angle", "hidden.normal", "starts", "known to"] {
        assert!(words.contains(expected), "{}", ended.account());
    }
    let found = w.json("run/calibrated/calibration.json");
    for own in found["found"].as_array().unwrap() {
        let number = |key: &str| own[key].as_f64().unwrap();
        assert!(number("value").abs() < 4.0 * number("stderr"), "{own:#}");
    }
    for file in [
        "calibration.csv",
        "identifiability.csv",
        "profiles.svg",
        "report.html",
        "joint-gp.covariance.npy",
    ] {
        assert!(w.path(&format!("run/calibrated/{file}")).exists(), "{file}");
    }
    let _ = w.phicam("scene check run/calibrated/scene.toml").exits(0);
    // The picture is that of the account, and its errors are those of its covariance.
    let [picture, stderr, covariance] = ["npy", "stderr.npy", "covariance.npy"]
        .map(|what| w.matrix(&format!("run/calibrated/joint-gp.{what}")));
    assert_eq!((picture.shape(), covariance.shape()), ((4, 4), (16, 16)));
    for k in 0..16 {
        let at = (k / 4, k % 4);
        let number = |key: &str| found["grids"][0][key][k].as_f64().unwrap();
        for (own, want) in [
            (picture[at], number("values")),
            (stderr[at], number("stderr")),
        ] {
            assert!(
                (own - want).abs() < 1e-12 * want.abs(),
                "{k}: {own} for {want}"
            );
        }
        let variance = covariance[(k, k)];
        assert!(
            (variance - stderr[at] * stderr[at]).abs() < 1e-9 * variance,
            "{k}: {variance}"
        );
        assert!(
            stderr[at] * 1.000001 > found["stderr_given"][k].as_f64().unwrap(),
            "{k}"
        );
    }
    // Another picture by this geometry has not its errors, which is said.
    let recovered = "recover run/calibrated --phi run/phi.npy --noise 0.05 --method joint --elements 4x4 -o there";
    let ended = w.phicam(recovered).exits(0);
    let words = told(&ended.stderr);
    let is_told =
        words.contains("was estimated from photographs") && words.contains("joint-gp.stderr.npy");
    assert!(is_told, "{}", ended.account());
    let own = w.phicam("recover run --method joint -o own").exits(0);
    assert!(
        !own.stderr.contains("estimated from photographs"),
        "{}",
        own.account()
    );
    // A calibrated scene that is no longer what was found is used, and told.
    let recover = "recover run/calibrated --phi run/phi.npy --noise 0.05 --method joint --elements 4x4 -o there";
    let is_told = || w.phicam(recover).exits(0).stderr.contains("was changed");
    assert!(!is_told());
    let own = w.text("run/calibrated/scene.toml");
    let other = own.replacen("power = 0.005", "power = 0.006", 1);
    assert_ne!(own, other, "{own}");
    w.write("run/calibrated/scene.toml", other);
    assert!(is_told());
    w.write("run/calibrated/scene.toml", own);
    // A scene that is wrong by 0.3 in. is put right, also where the errors are not stated.
    let text = w.text("run/scene.toml");
    let there = phicam::scene::Scene::from_toml("small", &text).unwrap();
    let normal = phicam::scene::Parameter::named(&there, "hidden.normal").unwrap();
    let wrong = there
        .displaced_file(&normal, &[0.3])
        .unwrap()
        .toml()
        .unwrap();
    std::fs::create_dir(w.path("wrong")).unwrap();
    w.write("wrong/scene.toml", wrong);
    let beside =
        "calibrate wrong --phi run/phi.npy --free hidden.normal --elements 4x4 --starts 1 --json";
    let _ = w.phicam(beside).exits(0);
    let back = w.json("wrong/calibrated/calibration.json");
    let number = |key: &str| back["found"][0][key].as_f64().unwrap();
    let off = number("value") + 0.3;
    assert!(
        off.abs() < 4.0 * number("stderr") && number("stderr") < 0.1,
        "{back:#}"
    );
    // The same numbers whatever the threads.
    let again = w
        .phicam(&format!("{line} --threads 1 --json -o other"))
        .exits(0);
    let other: serde_json::Value = serde_json::from_str(&again.stdout).unwrap();
    assert_eq!(found, other);
}

/// What the scene says of its measurements is what is free, and what it does not know is refused.
#[test]
fn uncertainties_stand_in_the_scene() {
    let w = rendered();
    w.refuses("calibrate run", &["--free", "[uncertainty]"]);
    for line in [
        "calibrate run --free hinge.angle -o run",
        "locate run -o run",
        "study noise run/scene.toml -o run --replace",
    ] {
        w.refuses(line, &["the folder of a run", "choose another"]);
    }
    w.refuses(
        "calibrate run --free hinge.angel",
        &["hinge.angel", "hinge.angle"],
    );
    w.refuses("calibrate run --free hidden.u", &["own plane"]);
    w.refuses("calibrate run --free hinge.angle=-1", &["NAME=SIGMA"]);
    w.refuses(
        "calibrate run --free hinge.angle=0.5,hinge.angle=0.001 --elements 2x2",
        &["hinge.angle is free twice", "once"],
    );
    w.refuses(
        "calibrate run --free hinge.angle=1e-300 --elements 2x2",
        &["hinge.angle", "from 1e-12 to 1e12"],
    );
    w.refuses(
        "calibrate run --free laser.x --elements 2x2",
        &["do not tell", "laser.x"],
    );
    w.refuses("calibrate nowhere --free hinge.angle", &["nowhere"]);
    let scene = w.text("run/scene.toml");
    let stated = format!("{scene}\n[uncertainty]\n\"hinge.angle\" = 0.5\n");
    w.write("run/scene.toml", &stated);
    let ended = w
        .phicam("calibrate run --elements 4x4 --starts 1 -q")
        .exits(0);
    assert!(
        told(&ended.stdout).contains("hinge.angle"),
        "{}",
        ended.account()
    );
    let wrong = stated.replace("= 0.5", "= 0");
    w.write("wrong.toml", &wrong);
    w.refuses(
        "scene check wrong.toml",
        &["hinge.angle", "standard deviation"],
    );
}

/// Errors that neighbours share are refused where the noise is stated; where it is not, which errors
/// are likelier is said, and the command that recovers takes the same.
#[test]
fn errors_that_neighbours_share_are_asked_for() {
    let w = rendered();
    let line = "--free hinge.angle --error-field --elements 2x2 --starts 1";
    w.refuses(
        &format!("calibrate run {line}"),
        &["noise of the photographs is stated", "--error-field"],
    );
    let ended = w
        .phicam(&format!("calibrate run --phi run/phi.npy {line} -o shared"))
        .exits(0);
    let words = told(&ended.stdout);
    for expected in ["errors that neighbouring pixels share", "likelier"] {
        assert!(words.contains(expected), "{}", ended.account());
    }
    assert!(
        told(&ended.stderr).contains("--method joint-gp --error-field"),
        "{}",
        ended.account()
    );
    let found = w.json("shared/calibration.json");
    assert!(found["field"]["range"].as_f64().unwrap() > 0.0);
    assert!(found["log_likelier"].as_f64().unwrap() > -0.5);
    assert!(found["p"].is_null());
}

/// Errors that come from few replicates refute less than errors that are known.
#[test]
fn errors_of_few_replicates_refute_less() {
    let w = rendered();
    // Not the run's own, of which it is known.
    for file in ["phi.npy", "phi.stderr.npy"] {
        std::fs::copy(w.path(&format!("run/{file}")), w.path(file)).unwrap();
    }
    let own = "--phi phi.npy --stderr phi.stderr.npy";
    let fit = |more: &str| {
        let line =
            format!("recover run {own}{more} --elements 4x4 --method joint --json -o there -q");
        let ended = w.phicam(&line);
        let found: serde_json::Value = serde_json::from_str(&ended.stdout).unwrap();
        found[0]["fit"]["chi2_per_dof"]
            .as_f64()
            .unwrap_or_else(|| panic!("{found:#}"))
    };
    // z of Student's t of 3 degrees of freedom is less than t.
    assert!(fit(" --replicates 4") < 0.8 * fit(""));
    w.refuses("recover run --replicates 4", &["--stderr"]);
    w.refuses(
        &format!("recover run {own} --replicates 1"),
        &["--replicates"],
    );
    // Errors that are stated too small refute it, those of few replicates less.
    let stated = phicam::matrix::npy::read(&w.path("phi.stderr.npy")).unwrap();
    phicam::matrix::npy::write(&w.path("small.npy"), &(stated * 0.8)).unwrap();
    let own = "--phi phi.npy --stderr small.npy";
    let line = format!(
        "calibrate run {own} --replicates 8 --free hinge.angle --elements 4x4 --starts 1 --json -o c -q"
    );
    let few: serde_json::Value = serde_json::from_str(&w.phicam(&line).stdout).unwrap();
    let all = w.phicam(&line.replace(" --replicates 8", ""));
    let all: serde_json::Value = serde_json::from_str(&all.stdout).unwrap();
    let p = |found: &serde_json::Value| found["p"].as_f64().unwrap();
    let [few, all] = [p(&few), p(&all)];
    assert!(all < 1e-3 && few > 10.0 * all, "{few} {all}");
}
