//! `phicam validate`: what it accepts and what it rejects.

use std::sync::OnceLock;

use crate::workspace::Workspace;

/// A finished run of the small scene in `done`; nobody writes to it.
fn run() -> &'static Workspace {
    static RUN: OnceLock<Workspace> = OnceLock::new();
    RUN.get_or_init(|| {
        let workspace = Workspace::with_scenes();
        let _ = workspace
            .phicam("render small.toml -o done --samples 1024")
            .exits(0);
        let other = workspace
            .text("small.toml")
            .replace("lambertian = 0.8", "lambertian = 0.79");
        workspace.write("grey.toml", other);
        workspace
    })
}

fn verdict(settings: &str, code: i32) -> serde_json::Value {
    let ended = run()
        .phicam(&format!("validate done --json {settings}"))
        .exits(code);
    let value: serde_json::Value =
        serde_json::from_str(&ended.stdout).unwrap_or_else(|e| panic!("{e}: {}", ended.account()));
    assert_eq!(value["agrees"], code == 0, "{}", ended.account());
    value
}

fn number(value: &serde_json::Value, key: &str) -> f64 {
    let found = value[key].as_f64();
    found.unwrap_or_else(|| panic!("no number {key} in {value}"))
}

#[test]
fn light_agrees_with_the_physical_model() {
    for settings in [
        "",
        "--kernel physical",
        "--integration quadrature",
        "--against small.toml",
    ] {
        let value = verdict(settings, 0);
        assert_eq!(value["kernel"], "physical");
        let all = number(&value, "entries") + number(&value, "left_out");
        assert!((all - 64.0 * 24.0).abs() < 0.5, "{value}");
        assert!(number(&value, "largest_z") <= number(&value, "z_limit"));
        assert!(number(&value, "chi2_per_dof") < 1.2, "{value}");
        assert!((number(&value, "best_scale") - 1.0).abs() < 0.01, "{value}");
        for key in [
            "significance",
            "dof",
            "chi2_p",
            "largest_p",
            "relative_difference",
            "relative_noise",
            "relative_discretisation",
        ] {
            assert!(number(&value, key).is_finite(), "{key}");
        }
        assert!(value["worst"][0]["z"].is_number());
    }
    // By quadrature the difference is noise alone: the χ² of 1536 entries per degree of freedom
    // scatters by √(2/1536) = 0.036, so five of that.
    let value = verdict("--integration quadrature", 0);
    assert!(
        (number(&value, "chi2_per_dof") - 1.0).abs() < 0.18,
        "{value}"
    );
    // The bound is what the last refinement changed: below the 1e-10 at which refinement stops.
    assert!(number(&value, "relative_discretisation") < 1e-10, "{value}");
}

#[test]
fn it_disagrees_with_the_published_kernel() {
    for integration in ["centres", "quadrature"] {
        let value = verdict(
            &format!("--kernel published --integration {integration}"),
            1,
        );
        assert_eq!(value["kernel"], "published");
        // The two kernels differ by tens of per cent, before and after a single scale (18 % at
        // half-width 6).
        assert!(number(&value, "relative_difference") > 0.1, "{value}");
        assert!(number(&value, "largest_z") > number(&value, "z_limit"));
    }
    let ended = run().phicam("validate done --kernel published").exits(1);
    for word in [
        "DISAGREE",
        "published",
        "worst entries",
        "most likely",
        "95 times in 100",
    ] {
        assert!(
            ended.stdout.contains(word),
            "no `{word}` in {}",
            ended.account()
        );
    }
}

#[test]
fn it_disagrees_where_the_spots_were_moved_in_the_model() {
    for shift in ["0.05,0", "-0.05,0", "0,0.05"] {
        let _ = verdict(&format!("--shift-spots {shift}"), 1);
    }
    let _ = verdict("--shift-spots 0,0", 0);
}

#[test]
fn it_disagrees_with_a_wall_of_another_albedo() {
    let value = verdict("--against grey.toml --integration quadrature", 1);
    // Light meets the wall twice: (0.80/0.79)².
    let scale = number(&value, "best_scale");
    assert!((scale - (0.80f64 / 0.79).powi(2)).abs() < 2e-3, "{scale}");
}

#[test]
fn the_level_decides() {
    let value = verdict("--significance 0.01", 0);
    assert_eq!(number(&value, "significance"), 0.01);
    let strict = number(&value, "z_limit");
    assert!(strict < number(&verdict("--significance 1e-9", 0), "z_limit"));
}

#[test]
#[ignore = "slow"]
fn every_plan_is_judged_by_its_own_errors() {
    let workspace = Workspace::with_scenes();
    for estimator in ["independent", "shared"] {
        for sampler in ["pcg", "sobol"] {
            let dir = format!("{estimator}-{sampler}");
            let plan = format!("--estimator {estimator} --sampler {sampler} --samples 4096");
            let _ = workspace
                .phicam(&format!("render small.toml -o {dir} {plan}"))
                .exits(0);
            let line = format!("validate {dir} --integration quadrature");
            let _ = workspace.phicam(&line).exits(0);
            let _ = workspace
                .phicam(&format!("{line} --kernel published"))
                .exits(1);
        }
    }
}

#[test]
fn frames_alone_are_enough() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam("render small.toml -o done").exits(0);
    for file in ["done/phi.npy", "done/phi.stderr.npy"] {
        std::fs::remove_file(workspace.path(file)).unwrap();
    }
    let _ = workspace.phicam("stack done").exits(0);
    let _ = workspace.phicam("validate done").exits(0);
    let _ = workspace
        .phicam("validate done --kernel published")
        .exits(1);
}

/// Any matrix against any scene; one of another shape is refused.
#[test]
fn a_matrix_of_ones_own_is_judged() {
    let done = "--phi done/phi.npy --stderr done/phi.stderr.npy --replicates 32";
    for line in [
        format!("validate done {done}"),
        format!("validate --against small.toml {done}"),
        format!("validate --against small.toml {done} --errors all"),
    ] {
        let _ = run().phicam(&line).exits(0);
    }
    let _ = run()
        .phicam(&format!("validate --against grey.toml {done}"))
        .exits(1);
    // Other tests write into the run's folder meanwhile, so its bytes are not compared.
    let line = format!("validate --against tiny.toml {done}");
    let ended = run().phicam(&line).exits(2);
    for word in ["64 × 24", "6 pixels", "8 spots"] {
        assert!(ended.stderr.contains(word), "{}", ended.account());
    }
    for line in [
        format!("validate {done}"),
        "validate done --phi done/phi.npy".to_owned(),
        "validate".to_owned(),
        "validate done --errors all".to_owned(),
    ] {
        let _ = run().phicam(&line).exits(2);
    }
}

/// A render of fewer than 100 entries may have missed a rare path at all of them: `render` says so,
/// and the verdict on it. Nobody knows that of a matrix that is given.
#[test]
fn what_few_entries_may_have_missed_is_said_again() {
    let w = Workspace::with_scenes();
    let flat = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let missed = "may all have missed";
    let ended = w.phicam("render tiny.toml -o few --samples 1024").exits(0);
    assert!(flat(&ended.stdout).contains(missed), "{}", ended.account());
    let ended = w.phicam("validate few").exits(0);
    assert!(flat(&ended.stdout).contains(missed), "{}", ended.account());
    let given = "--phi few/phi.npy --stderr few/phi.stderr.npy --replicates 32";
    for (workspace, line) in [
        (&w, format!("validate --against tiny.toml {given}")),
        (run(), "validate done".to_owned()),
    ] {
        let ended = workspace.phicam(&line).exits(0);
        assert!(!flat(&ended.stdout).contains(missed), "{}", ended.account());
    }
}

/// Photographs in counts, each frame with light of its own from elsewhere, agree with the scene that
/// they are of, and with no other; a factor of all light is not seen, and told so.
#[test]
fn counts_beside_other_light_are_judged() {
    let read = |name: &str| phicam::matrix::npy::read(&run().path(name)).unwrap();
    let (phi, stderr) = (read("done/phi.npy"), read("done/phi.stderr.npy"));
    let mean = phi.mean();
    let elsewhere = |l: usize| mean * (5.0 + (l as f64).sin());
    let (rows, spots) = phi.shape();
    let counts = |p: usize, l: usize| 2e15 * (phi[(p, l)] + elsewhere(l));
    let write = |name: &str, matrix| {
        phicam::matrix::npy::write(&run().path(name), &matrix).unwrap();
    };
    write(
        "counts.npy",
        phicam::matrix::Matrix::from_fn(rows, spots, counts),
    );
    write("counts.stderr.npy", stderr * 2e15);
    let given = "--phi counts.npy --stderr counts.stderr.npy --replicates 32";
    let judged = |against: &str, code: i32| {
        let beside = format!("{given} --free-scale --frame-polynomial 0 --against {against}");
        let ended = run()
            .phicam(&format!("validate --json {beside}"))
            .exits(code);
        let value: serde_json::Value = serde_json::from_str(&ended.stdout).unwrap();
        assert_eq!(value["agrees"], code == 0, "{}", ended.account());
        value
    };
    let value = judged("small.toml", 0);
    let (scale, error) = (
        number(&value, "best_scale"),
        number(&value, "best_scale_stderr"),
    );
    assert!(
        (scale - 2e15).abs() < 4.0 * error && error < 0.01 * scale,
        "{value}"
    );
    assert_eq!(value["fitted"], 25, "{value}");
    assert!(number(&value, "other_light") > 0.5, "{value}");
    // A darker wall is one factor of all light.
    let darker = number(&judged("grey.toml", 0), "best_scale");
    assert!(
        (darker / scale - (0.80f64 / 0.79).powi(2)).abs() < 2e-3,
        "{darker}"
    );
    let moved = run()
        .text("small.toml")
        .replace("11.350951966438567", "11.2");
    run().write("moved.toml", moved);
    let _ = judged("moved.toml", 1);
    // What is not fitted is not there.
    for without in ["", "--free-scale", "--frame-polynomial 0"] {
        let line = format!("validate {given} {without} --against small.toml");
        let _ = run().phicam(&line).exits(1);
    }
    let line = format!("validate {given} --free-scale --frame-polynomial 0 --against small.toml");
    let ended = run().phicam(&line).exits(0);
    for word in [
        "of a free scale",
        "a factor of all light",
        "what has its form",
    ] {
        assert!(
            ended.stdout.contains(word),
            "no `{word}` in {}",
            ended.account()
        );
    }
}

/// A laser that drifts by 3 % and an image in all frames: told of them the verdict agrees, says which
/// factors it found, and that they are larger where less was stated; told of one alone it does not.
#[test]
fn a_drifting_laser_is_told_of() {
    let read = |name: &str| phicam::matrix::npy::read(&run().path(name)).unwrap();
    let (phi, stderr) = (read("done/phi.npy"), read("done/phi.stderr.npy"));
    let (rows, spots) = phi.shape();
    let factor = |l: usize| 1.0 + 0.03 * (2.3 * l as f64).sin();
    let image = |p: usize| phi.mean() * (2.0 + (p as f64).cos());
    let write = |name: &str, of: &dyn Fn(usize, usize) -> f64| {
        let matrix = phicam::matrix::Matrix::from_fn(rows, spots, of);
        phicam::matrix::npy::write(&run().path(name), &matrix).unwrap();
    };
    write("drift.npy", &|p, l| factor(l) * phi[(p, l)] + image(p));
    write("drift.stderr.npy", &|p, l| stderr[(p, l)]);
    let judged = |beside: &str, code: i32| {
        let given =
            "--phi drift.npy --stderr drift.stderr.npy --replicates 32 --against small.toml";
        run()
            .phicam(&format!("validate --json {given} {beside}"))
            .exits(code)
    };
    let ended = judged("--background --frame-gain 0.03", 0);
    let value: serde_json::Value = serde_json::from_str(&ended.stdout).unwrap();
    let frames = &value["gains"]["frames"];
    for l in 0..spots {
        let [size, error] = ["size", "standard_error"].map(|key| frames[key][l].as_f64().unwrap());
        // Beside an image a factor that all frames share is seen by the spots' differences alone.
        assert!(
            (1.0 + size - factor(l)).abs() <= 3.0 * error && error <= 0.03,
            "{value}"
        );
    }
    assert!(frames["p"].as_f64().unwrap() > 1e-3, "{value}");
    for alone in ["", "--background", "--frame-gain 0.03"] {
        let _ = judged(alone, 1);
    }
    let given = "--phi drift.npy --stderr drift.stderr.npy --replicates 32 --against small.toml";
    let words = |sigma: &str, code: i32| {
        let line = format!("validate {given} --background --frame-gain {sigma}");
        run().phicam(&line).exits(code).stdout
    };
    assert!(!words("0.03", 0).contains("LARGER"), "{}", words("0.03", 0));
    assert!(
        words("0.003", 1).contains("LARGER than stated"),
        "{}",
        words("0.003", 1)
    );
    for (bad, cause) in [
        ("--frame-gain 0", "--frame-gain 0"),
        ("--scale-error 2", "--scale-error 2"),
        (
            "--frame-patterns drift.npy --glare-pattern no.npy",
            "no.npy",
        ),
        (
            "--frame-polynomial 8 --background",
            "could be all of the model's light",
        ),
    ] {
        let ended = run().phicam(&format!("validate {given} {bad}")).exits(2);
        assert!(ended.stderr.contains(cause), "{}", ended.account());
    }
}

/// Entries that are wrong refute a right model, unless they do not count: then they need not even be
/// numbers.
#[test]
fn what_is_left_out_does_not_count() {
    let workspace = Workspace::with_scenes();
    let line = "model small.toml -o done --integration quadrature";
    let _ = workspace.phicam(line).exits(0);
    let model = workspace.matrix("done/model/phi.npy");
    let flags = model.map_with_location(|p, l, _| f64::from(u8::from(p % 7 == l % 5)));
    let files = [
        ("phi.npy", model.zip_map(&flags, |x, flag| x * (1.0 + flag))),
        ("stderr.npy", model.map(|x| 0.01 * x)),
        ("flags.npy", flags),
    ];
    for (name, matrix) in &files {
        phicam::matrix::npy::write(&workspace.path(name), matrix).unwrap();
    }
    let line = "validate --phi phi.npy --stderr stderr.npy --against small.toml --json";
    let _ = workspace.phicam(line).exits(1);
    let ended = workspace.phicam(&format!("{line} --left-out flags.npy"));
    let found: serde_json::Value = serde_json::from_str(&ended.exits(0).stdout).unwrap();
    let counted = files[2].1.iter().filter(|x| **x == 0.0).count();
    assert_eq!(found["entries"], counted, "{found}");
    let untested = found["score"]["untested"].to_string();
    assert!(untested.contains("taken for points"), "{untested}");
    for (name, matrix) in &files[..2] {
        let holes = matrix.zip_map(
            &files[2].1,
            |x, flag| if flag == 0.0 { x } else { f64::NAN },
        );
        phicam::matrix::npy::write(&workspace.path(name), &holes).unwrap();
    }
    workspace.refuses(line, &["phi.npy has the value NaN", "--left-out"]);
    let ended = workspace.phicam(&format!("{line} --left-out flags.npy"));
    let again: serde_json::Value = serde_json::from_str(&ended.exits(0).stdout).unwrap();
    assert_eq!(again, found);
}

/// Zero light from both, and entries that are all flagged, are no evidence.
#[test]
fn nothing_is_no_evidence() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam("render tiny.toml -o done").exits(0);
    workspace.disown("done");
    let flags = npy(6, 8, 1.0);
    std::fs::write(workspace.path("done/phi.tails.npy"), flags).unwrap();
    let ended = workspace.phicam("validate done").exits(4);
    assert!(ended.stdout.contains("no evidence"), "{}", ended.account());
    assert!(!ended.stdout.contains("agree"), "{}", ended.account());
    std::fs::write(workspace.path("done/phi.tails.npy"), npy(6, 7, 0.0)).unwrap();
    workspace.refuses("validate done", &["phi.tails.npy", "6 × 7"]);
}

/// A matrix of f64 in one value, as NumPy writes it (format 1.0, C order).
fn npy(rows: usize, columns: usize, value: f64) -> Vec<u8> {
    let dictionary =
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows}, {columns}), }}");
    let header = format!("{dictionary:<117}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend((0..rows * columns).flat_map(|_| value.to_le_bytes()));
    bytes
}

/// A plank takes light away that the published model has: the scene's own knows it unasked.
#[test]
#[ignore = "slow"]
fn what_stands_in_the_way_is_known_to_the_model() {
    let workspace = Workspace::with_scenes();
    let plank = "\n[[surface]]\nname = \"plank\"\nrole = \"occluder\"\nmaterial = { lambertian = 0.0 }\n\
                 rectangle = { corner = [3.2, 7.0, 3.0], u = [1.8, 0, 0], v = [0, 1.6, 0] }\n";
    workspace.write("plank.toml", workspace.text("small.toml") + plank);
    let _ = workspace
        .phicam("render plank.toml -o done --samples 4096")
        .exits(0);
    let _ = workspace.phicam("validate done --no-occlusion").exits(1);
    let ended = workspace.phicam("validate done").exits(0);
    assert!(ended.stdout.contains("occlusion by"), "{}", ended.account());
    let _ = workspace
        .phicam("validate done --kernel published")
        .exits(1);
}
