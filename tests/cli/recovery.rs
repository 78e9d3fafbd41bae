//! `phicam recover`: methods, settings and files.

use phicam::matrix::npy;
use phicam::recovery::Method;

use crate::workspace::{Ended, Workspace};

fn with_run() -> Workspace {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam("render small.toml -o done").exits(0);
    let _ = workspace.phicam("model small.toml -o done").exits(0);
    workspace
}

/// The results of `recover … --json`.
fn objects(ended: Ended) -> Vec<serde_json::Value> {
    let ended = ended.exits(0);
    serde_json::from_str(&ended.stdout).unwrap_or_else(|e| panic!("{e}: {}", ended.account()))
}

#[test]
fn a_method_writes_its_matrix_and_its_picture() {
    let workspace = with_run();
    let ended = workspace.phicam("recover done --method joint").exits(0);
    for word in ["joint", "MTF raw", "object, 8 × 8 elements"] {
        assert!(
            ended.stdout.contains(word),
            "no `{word}` in {}",
            ended.account()
        );
    }
    let names: Vec<String> = workspace.contents("done/recovered").into_keys().collect();
    let written = [
        "determined.npy",
        "determined.png",
        "joint.choice.json",
        "joint.npy",
        "joint.ply",
        "joint.png",
        "joint.texture.png",
        "overview.png",
        "picard-joint.csv",
        "picard-joint.svg",
        "picard.csv",
        "picard.svg",
        "truth.npy",
        "truth.png",
    ];
    assert_eq!(names, written);
    let joint = workspace.matrix("done/recovered/joint.npy");
    assert_eq!(joint.shape(), (8, 8));
    assert!(joint.iter().all(|x| (0.0..=1.0).contains(x)), "{joint}");
    // Cell (0, 0) of the 2 × 2 board is dark, its neighbours are light: element (iu, iv) is row iv,
    // column iu.
    let truth = workspace.matrix("done/recovered/truth.npy");
    for iv in 0..8 {
        for iu in 0..8 {
            let light = (iu < 4) != (iv < 4);
            assert_eq!(truth[(iv, iu)], f64::from(u8::from(light)), "({iu}, {iv})");
        }
    }
}

#[test]
fn rows_of_the_file_are_rows_of_elements() {
    let workspace = with_run();
    let found = objects(workspace.phicam("recover done --method joint --elements 6x4 --json"));
    assert_eq!(found[0]["elements"], serde_json::json!([6, 4]));
    let joint = workspace.matrix("done/recovered/joint.npy");
    assert_eq!(joint.shape(), (4, 6), "(nv, nu)");
    for (i, x) in found[0]["reflectance"]
        .as_array()
        .unwrap()
        .iter()
        .enumerate()
    {
        assert_eq!(x.as_f64().unwrap(), joint[(i / 6, i % 6)], "element {i}");
    }
}

#[test]
fn fewer_elements() {
    let workspace = with_run();
    let line = "recover done --method joint --elements 4x4";
    let _ = workspace.phicam(line).exits(0);
    // Elements taken at their centres are off by more than the error of the render here: exit code
    // 1.
    let ended = workspace
        .phicam(&format!("{line} --integration centres"))
        .exits(1);
    let words = ["DOES NOT FIT", "more --elements"];
    assert!(
        words.iter().all(|w| ended.stdout.contains(w)),
        "{}",
        ended.account()
    );
    assert_eq!(workspace.matrix("done/recovered/joint.npy").shape(), (4, 4));
    assert_eq!(workspace.matrix("done/recovered/truth.npy").shape(), (4, 4));
}

#[test]
fn the_model_s_own_matrix_gives_the_truth_back() {
    let workspace = with_run();
    let line = "recover done --method joint --phi done/model/phi.npy --integration centres --json";
    let found = objects(workspace.phicam(line));
    let raw = found[0]["mtf_raw"].as_f64().unwrap();
    assert!(raw > 0.99, "{raw}");
    assert!(found[0]["rmse"].as_f64().unwrap() < 1e-3, "{}", found[0]);
}

/// Light integrated over elements, footprints and spots by another quadrature than that of the
/// operator: what is left of it comes back as an error of the reflectance, from centres a larger
/// one.
#[test]
fn integrated_light_is_inverted_by_integrated_elements() {
    let workspace = with_run();
    let _ = workspace
        .phicam("model small.toml -o exact --integration quadrature")
        .exits(0);
    let rmse = |more: &str| {
        let line = format!("recover exact --phi exact/model/phi.npy --method joint --json{more}");
        let found = objects(workspace.phicam(&line));
        found[0]["rmse"].as_f64().unwrap()
    };
    let (own, centres) = (rmse(""), rmse(" --integration centres"));
    assert!(own < 2e-3 && own < 0.1 * centres, "{own} {centres}");
}

#[test]
#[ignore = "slow"]
fn a_parameter_can_be_given() {
    let workspace = with_run();
    let line = "recover done --method tsvd --rank 5 --phi done/model/phi.npy -o own --json";
    let found = objects(workspace.phicam(line));
    assert!(
        found[0]["parameter"].as_str().unwrap().contains('5'),
        "{}",
        found[0]
    );
    let line =
        "recover done --method tikhonov --damping 0.01 --phi done/model/phi.npy -o own --json";
    let found = objects(workspace.phicam(line));
    let parameter = found[0]["parameter"].as_str().unwrap();
    assert!(
        parameter.contains("0.01") || parameter.contains("1.00e-2"),
        "{parameter}"
    );
    let names = workspace.contents("own");
    for name in ["tsvd.npy", "tsvd.png", "tikhonov.npy", "tikhonov.png"] {
        assert!(names.contains_key(name), "no {name}");
    }
    // Another parameter, another result.
    let of = |rank: usize| {
        let _ = workspace
            .phicam(&format!("recover done --method tsvd --rank {rank}"))
            .exits(0);
        workspace.matrix("done/recovered/tsvd.npy")
    };
    assert_ne!(of(2), of(6));
}

#[test]
#[ignore = "slow"]
fn without_a_noise_model_a_method_says_what_it_needs() {
    let workspace = with_run();
    for method in ["tsvd", "tikhonov"] {
        let line = format!("recover done --method {method} --phi done/model/phi.npy");
        workspace.refuses(&line, &[method, "noise", "standard error", "give"]);
        let _ = workspace.phicam(&format!("{line} --noise 0.001")).exits(0);
        let _ = workspace
            .phicam(&format!("{line} --stderr done/phi.stderr.npy"))
            .exits(0);
    }
}

#[test]
fn if_no_method_can_work_each_says_why() {
    let workspace = with_run();
    let line = "recover done --method tsvd,tikhonov --phi done/model/phi.npy";
    let words = ["tsvd: tsvd needs", "tikhonov: tikhonov needs", "cure: "];
    workspace.refuses(line, &words);
    workspace.refuses(&format!("--quiet {line}"), &words);
    // One that can work is enough; the other is a remark.
    let line = line.replace("tikhonov", "joint");
    let ended = workspace.phicam(&line).exits(0);
    assert!(ended.stderr.contains("tsvd needs"), "{}", ended.account());
}

#[test]
#[ignore = "slow"]
fn the_usual_methods_unless_some_are_named() {
    let workspace = with_run();
    let names = |found: &[serde_json::Value]| -> Vec<String> {
        found
            .iter()
            .map(|f| f["method"].as_str().unwrap().to_owned())
            .collect()
    };
    let all = objects(workspace.phicam("recover done --json"));
    let mut tried = names(&all);
    tried.sort();
    assert_eq!(
        tried,
        [
            "joint",
            "joint-gp",
            "joint-two-valued",
            "joint-unbounded",
            "pinv",
            "tikhonov",
            "tsvd"
        ]
    );
    // What explains the photographs comes first, then what knows how likely it makes them.
    let fits = |f: &serde_json::Value| f["fit"]["fits"].as_bool().unwrap();
    let refuted = all.iter().position(|f| !fits(f)).unwrap_or(all.len());
    assert!(!all[refuted..].iter().any(fits), "{:?}", names(&all));
    let evidence = |f: &serde_json::Value| f["log_evidence"].as_f64().unwrap_or(f64::MIN);
    let first = &all[..refuted];
    assert!(first.len() > 1 && first.is_sorted_by(|a, b| evidence(a) >= evidence(b)));
    let two = objects(workspace.phicam("recover done --method joint,pinv --json"));
    assert_eq!(names(&two), ["joint", "pinv"]);
}

#[test]
fn other_light_is_estimated_with_the_object() {
    let workspace = with_run();
    let model = workspace.matrix("done/model/phi.npy");
    // A constant of each frame a hundred times the light, and a factor.
    let spoilt =
        model.map_with_location(|_, l, x| 2.5 * x + 100.0 * model.amax() * (1.0 + l as f64));
    npy::write(&workspace.path("spoilt.npy"), &spoilt).unwrap();
    let line = "recover done --phi spoilt.npy --frame-constant --free-scale --method joint --integration centres --json";
    let found = objects(workspace.phicam(line));
    assert!(found[0]["mtf_raw"].as_f64().unwrap() > 0.99, "{}", found[0]);
    let words = found[0]["parameter"].as_str().unwrap();
    assert!(
        words.contains("scale 2.500") && words.contains("frame constant"),
        "{words}"
    );
    // Methods that cannot are remarks beside one that can, and refused alone.
    let line = "recover done --phi spoilt.npy --frame-constant --noise 0.01";
    let ended = workspace.phicam(line).exits(0);
    assert!(
        ended
            .stderr
            .contains("pinv takes every entry as light of the surface"),
        "{}",
        ended.account()
    );
    workspace.refuses(
        &format!("{line} --method pinv"),
        &["--frame-constant", "joint", "cure: "],
    );
    workspace.refuses("recover done --tv 0.1", &["--tv", "joint-tv"]);
    workspace.refuses(
        "recover done --levels 0,1 --method joint",
        &["--levels", "joint-two-valued"],
    );
    workspace.refuses(
        "recover done --method joint-two-valued --levels 1,0",
        &["DARK < LIGHT"],
    );
    workspace.refuses(
        "recover done --weighting none --method pinv",
        &["--weighting means nothing"],
    );
    workspace.refuses(
        "recover done --method joint --glare-pattern no.npy",
        &["no.npy"],
    );
    workspace.refuses(
        "recover done --method joint --bands 95",
        &["--bands 95", "0.95"],
    );
    workspace.refuses(
        "recover done --method joint-tv --bands 0.95",
        &["--bands means nothing", "or nnls or joint-gp"],
    );
}

/// A method without bands is recovered beside one that has them, and it is said why it has none.
#[test]
fn a_method_without_bands_is_kept_beside_one_that_has_them() {
    let workspace = with_run();
    let line = "recover done --method joint-tv,joint --elements 2x2 --noise 0.2 --bands 0.9";
    let told = workspace.phicam(line).exits(0).stdout;
    let told: Vec<&str> = told.split_whitespace().collect();
    let words = "joint-tv: it has no bands: what its assumption adds";
    assert!(told.join(" ").contains(words), "{told:?}");
    let found = objects(workspace.phicam(&format!("{line} --json")));
    let bands: Vec<(&str, bool)> = found
        .iter()
        .map(|o| (o["method"].as_str().unwrap(), o["bands"].is_object()))
        .collect();
    assert_eq!(bands, [("joint-tv", false), ("joint", true)]);
}

/// A method that was asked for by name and gave nothing is told, whatever remarks are wanted; one
/// of the usual methods is a remark. A free scale costs a picture its bands alone.
#[test]
fn what_gave_nothing_though_it_was_asked_for_is_told() {
    let workspace = with_run();
    let line = "-q recover done --method left-inverse,joint --elements 2x2 --noise 0.2";
    let ended = workspace.phicam(line).exits(0);
    let words = "warning: left-inverse: left-inverse does not exist";
    assert!(ended.stderr.contains(words), "{}", ended.account());
    let usual = "-q recover done --elements 2x2 --noise 0.2";
    let ended = workspace.phicam(usual).exits(0);
    assert_eq!(ended.stderr, "", "{}", ended.account());
    let line = "-q recover done --method joint-unbounded,joint --elements 2x2 --noise 0.2 --free-scale --bands 0.9 --json";
    let ended = workspace.phicam(line);
    assert_eq!(ended.stderr, "", "{}", ended.account());
    let found = objects(ended);
    assert_eq!(found[1]["method"], "joint");
    assert!(found[1]["bands"].is_null() && found[1].to_string().contains("has no bands with a"));
    assert!(!workspace.path("done/recovered/joint.lower.npy").exists());
}

#[test]
fn bands_are_files_of_their_own() {
    let workspace = with_run();
    let line =
        "recover done --method joint-unbounded,joint --elements 2x2 --noise 0.2 --bands 0.9 --json";
    let found = objects(workspace.phicam(line));
    for (object, kind) in found.iter().zip(["gaussian", "simultaneous"]) {
        assert_eq!(object["bands"]["kind"], kind);
        let name = object["method"].as_str().unwrap();
        let of = |end: &str| workspace.matrix(&format!("done/recovered/{name}{end}.npy"));
        let (lower, upper) = (of(".lower"), of(".upper"));
        assert_eq!(lower.shape(), (2, 2));
        let middle = of("");
        for at in 0..4 {
            assert!(lower[at] <= middle[at] && middle[at] <= upper[at], "{name}");
        }
    }
}

#[test]
fn every_method_can_be_asked_for() {
    let workspace = with_run();
    let line = "recover done --method nnls,joint-tv,joint-two-valued --phi done/model/phi.npy --integration centres --noise 0.001 -o own";
    let _ = workspace.phicam(line).exits(0);
    let names = workspace.contents("own");
    for name in ["nnls.npy", "joint-tv.npy", "joint-two-valued.npy"] {
        assert!(names.contains_key(name), "no {name}");
    }
}

#[test]
#[ignore = "slow"]
fn every_method_can_be_named() {
    let workspace = with_run();
    for method in Method::ALL {
        // 24 spots: 36 elements for the inverse from the left, 4 for all others.
        let elements = match method {
            Method::LeftInverse => "6 --tolerance 1e-17",
            Method::Tsvd | Method::Tikhonov | Method::TikhonovGradient => "2 --rule gcv",
            _ => "2",
        };
        let line =
            format!("recover done --method {method} --elements {elements} --noise 0.2 --json");
        let found = objects(workspace.phicam(&line));
        assert_eq!(found[0]["method"], method.name());
        assert!(found[0]["effective_rank"].as_f64().unwrap() > 0.5);
    }
}

#[test]
#[ignore = "slow"]
fn a_linear_method_writes_its_uncertainty() {
    let workspace = with_run();
    let line = "recover done --method pinv,tikhonov-gradient,joint-unbounded,joint --elements 4x2 --damping 0.01 --noise 0.2";
    let found = objects(workspace.phicam(&format!("{line} --json")));
    for (object, method) in found
        .iter()
        .zip(["pinv", "tikhonov-gradient", "joint-unbounded"])
    {
        let read = |what: &str| workspace.matrix(&format!("done/recovered/{method}.{what}.npy"));
        let (stderr, covariance) = (read("stderr"), read("covariance"));
        assert_eq!((stderr.shape(), covariance.shape()), ((2, 4), (8, 8)));
        for i in 0..8 {
            let said = object["standard_error"][i].as_f64().unwrap();
            assert_eq!(said, stderr[(i / 4, i % 4)]);
            assert!((covariance[(i, i)].sqrt() / said - 1.0).abs() < 1e-9);
        }
        let resolution = read("resolution");
        let rank = object["effective_rank"].as_f64().unwrap();
        assert!((resolution.trace() - rank).abs() < 1e-6 && rank < 8.0 + 1e-9);
    }
    let names = workspace.contents("done/recovered");
    assert!(
        !names
            .keys()
            .any(|n| n.starts_with("joint.") && n.contains("stderr"))
    );
    assert!(found[3]["standard_error"].is_null());
    // Without a noise model only the resolution is known: what the earlier call said is gone.
    let _ = workspace
        .phicam(
            "recover done --method pinv --phi done/model/phi.npy --elements 4x2 -o done/recovered",
        )
        .exits(0);
    let names = workspace.contents("done/recovered");
    assert!(!names.contains_key("pinv.stderr.npy") && !names.contains_key("pinv.covariance.npy"));
    assert!(names.contains_key("pinv.resolution.npy"));
}

#[test]
fn picard_data_are_written() {
    let workspace = with_run();
    let _ = workspace.phicam("recover done --method pinv").exits(0);
    let table = workspace.text("done/recovered/picard.csv");
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("direction,sigma,coefficient_W,noise_W"));
    // 24 spots, 64 elements: 24 directions, singular values falling.
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|x| x.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 24);
    assert!(rows.windows(2).all(|w| w[1][1] <= w[0][1]));
    // The traced signal rises above its noise in the first direction, and nothing does in the last.
    assert!(rows[0][2] > 100.0 * rows[0][3] && rows[23][2] < 2.0 * rows[23][3]);
    let figure = workspace.text("done/recovered/picard.svg");
    assert!(figure.contains("noise in direction i") && figure.ends_with("</svg>\n"));
}

#[test]
#[ignore = "slow"]
fn rules_without_a_noise_model() {
    let workspace = with_run();
    for (rule, words) in [
        ("gcv", "generalised cross-validation"),
        ("l-curve", "corner of the L-curve"),
    ] {
        for method in ["tsvd", "tikhonov", "tikhonov-gradient"] {
            let line =
                format!("recover done --method {method} --rule {rule} --phi done/phi.npy --json");
            let found = objects(workspace.phicam(&line));
            let parameter = found[0]["parameter"].as_str().unwrap();
            assert!(parameter.contains(words), "{method}: {parameter}");
        }
    }
    workspace.refuses("recover done --rule best", &["best", "gcv", "l-curve"]);
}

#[test]
fn a_foreign_matrix_of_another_shape_is_refused() {
    let workspace = with_run();
    let _ = workspace
        .phicam("render tiny.toml -o other --samples 32")
        .exits(0);
    for line in [
        "recover done --phi other/phi.npy",
        "-q recover done --phi other/phi.npy",
        "recover done --method joint --phi other/phi.npy",
        "recover done --stderr other/phi.npy",
    ] {
        workspace.refuses(line, &["other/phi.npy", "6 × 8", "64", "24"]);
    }
    workspace.refuses("recover done --phi nowhere.npy", &["nowhere.npy"]);
    workspace.refuses("recover done --phi small.toml", &["small.toml"]);
}

#[test]
#[ignore = "slow"]
fn what_the_run_has_left_is_not_touched() {
    let workspace = with_run();
    let mut before = workspace.contents("done");
    let _ = workspace.phicam("recover done").exits(0);
    let mut after = workspace.contents("done");
    // The record vouches for the pictures that are there now.
    let rest = |name: &String| !name.starts_with("recovered") && name != "run.json";
    before.retain(|name, _| rest(name));
    after.retain(|name, _| rest(name));
    crate::workspace::assert_same(&before, &after, "recover");
}

/// What an earlier recovery left and this one does not know is gone; Picard data and biases are
/// there.
#[test]
#[ignore = "slow"]
fn files_of_an_earlier_recovery_do_not_stay_beside_those_of_a_later() {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render tiny.toml -o done --samples 32")
        .exits(0);
    let line = "recover done --elements 2 --method pinv,joint-unbounded,joint";
    let _ = workspace.phicam(&format!("{line} --bands 0.9")).exits(0);
    let names = |w: &Workspace| w.contents("done/recovered");
    let found = names(&workspace);
    for name in [
        "pinv.lower.npy",
        "joint.upper.npy",
        "pinv.bias.npy",
        "joint-unbounded.bias.npy",
        "picard-joint.csv",
        "picard-joint.svg",
    ] {
        assert!(found.contains_key(name), "no {name}");
    }
    assert!(!found.contains_key("joint.bias.npy"));
    let bias = workspace.matrix("done/recovered/joint-unbounded.bias.npy");
    assert!(bias.shape() == (2, 2) && bias.amax() < 1e-6, "{bias}");
    let _ = workspace.phicam(line).exits(0);
    let left = names(&workspace);
    assert!(
        left.keys()
            .all(|n| !n.contains("lower") && !n.contains("upper"))
    );
    let _ = workspace
        .phicam("recover done --elements 2 --method pinv")
        .exits(0);
    assert!(!names(&workspace).contains_key("picard-joint.csv"));
}

/// The parameter in the JSON has all its digits: given again it makes the same picture to the last
/// bit. What was estimated beside it is there in the JSON and in files.
#[test]
fn a_run_can_be_repeated_at_its_own_choice() {
    let workspace = with_run();
    let line = "recover done --phi done/model/phi.npy --integration centres --noise 1e-3 -o own --json --method";
    for method in ["tsvd", "tikhonov", "joint-tv"] {
        let mut found = objects(workspace.phicam(&format!("{line} {method}")));
        let (first, repeat) = (found.remove(0), |v: &serde_json::Value| {
            v["choice"]["repeat"].as_str().unwrap().to_owned()
        });
        let again = format!("{line} {method} {}", repeat(&first));
        let second = objects(workspace.phicam(&again)).remove(0);
        assert_eq!(first["reflectance"], second["reflectance"], "{again}");
        assert_eq!(first["choice"]["value"], second["choice"]["value"]);
        assert_eq!(second["choice"]["rule"], "given");
        let names = workspace.contents("own");
        let kept = &names[&format!("{method}.choice.json")];
        let kept: serde_json::Value = serde_json::from_slice(kept).unwrap();
        assert_eq!(kept["choice"], second["choice"]);
    }
    let line = format!("{line} joint");
    let beside = objects(workspace.phicam(&format!(
        "{line} --frame-constant --background --free-scale"
    )));
    let estimated = &beside[0]["estimated"];
    assert!(estimated["scale"].as_f64().unwrap() > 0.0);
    assert!(beside[0]["solver"]["gap"].as_f64().unwrap() >= 0.0);
    for (name, whole) in [("frame_constant", (1, 24)), ("background", (64, 1))] {
        let written = workspace.matrix(&format!("own/joint.{name}.npy"));
        assert_eq!(written.shape(), whole, "{name}");
        let told = estimated[name].as_array().unwrap().iter();
        let told: Vec<f64> = told.map(|x| x.as_f64().unwrap()).collect();
        assert_eq!(told, written.as_slice(), "{name}");
    }
    let _ = workspace.phicam(&line).exits(0);
    assert!(
        !workspace
            .contents("own")
            .contains_key("joint.background.npy")
    );
}

/// Frames of a laser whose power drifts: their gains come with the picture, in numbers, in a file
/// and in words; gains that are larger than was said are warned of. Deviations without meaning, a
/// scale both free and known roughly, and methods that take no gains are refused.
#[test]
fn gains_of_frames_are_estimated_with_the_object() {
    let workspace = with_run();
    let model = workspace.matrix("done/model/phi.npy");
    let gain = |l: usize| 0.1 * (2.399 * l as f64).sin();
    let drifting = model.map_with_location(|_, l, x| (1.0 + gain(l)) * x);
    npy::write(&workspace.path("drifting.npy"), &drifting).unwrap();
    let line = "recover done --phi drifting.npy --noise 0.001 --integration centres --json -o own";
    let found = objects(workspace.phicam(&format!(
        "{line} --method joint-unbounded,joint-gp --frame-gain 0.1 --scale-error 0.05"
    )));
    for object in &found {
        let gains = &object["estimated"]["gains"];
        let numbers = |of: &serde_json::Value| -> Vec<f64> {
            of.as_array()
                .unwrap()
                .iter()
                .map(|x| x.as_f64().unwrap())
                .collect()
        };
        let sizes = numbers(&gains["frames"]["size"]);
        let mean = sizes.iter().sum::<f64>() / sizes.len() as f64;
        let off = sizes
            .iter()
            .enumerate()
            .map(|(l, x)| (x - mean - gain(l)).abs());
        assert!(off.fold(0.0, f64::max) < 0.02, "{object}");
        assert_eq!(gains["settled"], true);
        assert!(gains["widened"].as_f64().unwrap() > 1.0, "{gains}");
        let method = object["method"].as_str().unwrap();
        let file = workspace.matrix(&format!("own/{method}.frame_gain.npy"));
        assert_eq!(file.row(0).iter().copied().collect::<Vec<_>>(), sizes);
        let errors = numbers(&gains["frames"]["standard_error"]);
        assert_eq!(file.row(1).iter().copied().collect::<Vec<_>>(), errors);
        let words = object["parameter"].as_str().unwrap();
        assert!(
            words.contains("gain of a frame off 1")
                && words.contains("times those of known factors"),
            "{words}"
        );
        let warned = object["warnings"].to_string();
        assert!(!warned.contains("--frame-gain"), "{warned}");
    }
    let small = format!("{line} --method joint-unbounded --frame-gain 0.01");
    let warned = objects(workspace.phicam(&small))[0]["warnings"].to_string();
    assert!(warned.contains("larger than was said"), "{warned}");
    for (given, words) in [
        ("--frame-gain 0", ["--frame-gain 0", "above 0"]),
        ("--frame-gain -0.1", ["--frame-gain -0.1", "above 0"]),
        ("--frame-gain nan", ["--frame-gain NaN", "above 0"]),
        ("--scale-error 1.5", ["--scale-error 1.5", "at most 1"]),
        ("--scale-error inf", ["--scale-error inf", "at most 1"]),
        (
            "--scale-error 0.1 --free-scale",
            ["--scale-error", "--free-scale"],
        ),
        ("--frame-gain 0.1 --method pinv", ["--frame-gain", "joint"]),
    ] {
        workspace.refuses(&format!("recover done {given}"), &words);
    }
}

/// An object of which nothing is known is recovered, and nothing is told of a truth; its light is
/// not made up either.
#[test]
fn an_unknown_albedo_has_no_truth_and_no_scores() {
    let workspace = with_run();
    let text = workspace.text("small.toml");
    let board = "{ checkerboard = [2, 2], dark = 0.0, light = 1.0 }";
    let unknown = text.replace(board, "\"unknown\"");
    workspace.write("unknown.toml", &unknown);
    for line in ["render unknown.toml -o r", "run unknown.toml -o r"] {
        workspace.refuses(line, &["unknown.toml:", "`object`", "give it a number"]);
    }
    let wall = unknown.replace("lambertian = 0.8", "lambertian = \"unknown\"");
    workspace.write("wall.toml", wall);
    workspace.refuses("model wall.toml -o r", &["only `lambertian` of a hidden"]);
    let modelled = workspace.phicam("model unknown.toml -o bench").exits(0);
    assert!(
        modelled.stdout.contains("no phi.npy"),
        "{}",
        modelled.account()
    );
    assert!(!workspace.contents("bench/model").contains_key("phi.npy"));
    let line = "recover bench --phi done/model/phi.npy --integration centres --noise 1e-3 --method joint-unbounded,joint";
    let told = workspace
        .phicam(&format!("{line} --elements 4"))
        .exits(0)
        .stdout;
    for word in ["RMSE", "MTF", "correlation", "truth"] {
        assert!(!told.contains(word), "{word} in {told}");
    }
    let found = objects(workspace.phicam(&format!("{line} --elements 4 --json")));
    for object in &found {
        for key in ["truth", "rmse", "mtf_raw", "mtf_normalized", "correlation"] {
            assert!(object[key].is_null(), "{key}: {object}");
        }
        assert!(object.get("bias").is_none(), "{object}");
    }
    let names = workspace.contents("bench/recovered");
    assert!(names.contains_key("joint.npy") && names.contains_key("overview.png"));
    assert!(
        names
            .keys()
            .all(|n| !n.starts_with("truth") && !n.contains("bias"))
    );
    // The same photographs with the board known: the same picture, and its scores.
    let line = "recover done --phi done/model/phi.npy --integration centres --noise 1e-3 --method joint --elements 4 --json";
    let known = objects(workspace.phicam(line));
    assert_eq!(known[0]["reflectance"], found[1]["reflectance"]);
    assert!(known[0]["rmse"].is_f64());
}

/// The run's own photographs are its own under their name, too: the same pictures, errors and fit.
#[test]
fn photographs_of_the_run_are_its_own_by_name() {
    let workspace = with_run();
    let of = |more: &str| {
        let line = format!("recover done --method joint,pinv --json {more}");
        objects(workspace.phicam(&line))
    };
    let own = of("");
    assert_eq!(of("--phi done/phi.npy"), own);
    assert_eq!(of("--phi done/phi.npy --stderr done/phi.stderr.npy"), own);
    let copy = workspace.read("done/phi.stderr.npy");
    workspace.write("copy.npy", &copy);
    // Of other errors it is not known from how many blocks they are.
    assert_ne!(of("--phi done/phi.npy --stderr copy.npy"), own);
}

/// Of photographs whose entries share their errors a picture and no error of it, with the reason;
/// of those with errors of their own both.
#[test]
fn shared_errors_give_no_errors_of_the_picture() {
    let workspace = Workspace::with_scenes();
    for (estimator, words) in [
        ("independent", None),
        ("shared", Some("all spots of a pixel share theirs")),
        ("factored", Some("all entries share theirs")),
    ] {
        let line = format!("render small.toml -o {estimator} --estimator {estimator}");
        let _ = workspace.phicam(&line).exits(0);
        let line =
            format!("recover {estimator} --method joint-gp,joint-two-valued --elements 4 --json");
        for object in objects(workspace.phicam(&line)) {
            let method = &object["method"];
            for key in ["standard_error", "log_evidence"] {
                let is_there = !object[key].is_null();
                assert_eq!(is_there, words.is_none(), "{estimator} {method} {key}");
            }
            let told = object["warnings"].to_string();
            assert_eq!(told.contains("hang together"), words.is_some(), "{told}");
            assert!(words.is_none_or(|words| told.contains(words)), "{told}");
        }
    }
}
