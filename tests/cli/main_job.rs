//! `phicam run` from end to end.

use crate::workspace::{Workspace, assert_same};

/// Names that the design promises for a run with a hidden object, frames aside.
const FILES: [&str; 25] = [
    "scene.toml",
    "run.json",
    "phi.npy",
    "phi.stderr.npy",
    "phi.tails.npy",
    "model/g12.npy",
    "model/g23.npy",
    "model/phi.npy",
    "recovered/pinv.npy",
    "recovered/pinv.png",
    "recovered/pinv.stderr.npy",
    "recovered/pinv.covariance.npy",
    "recovered/pinv.resolution.npy",
    "recovered/tsvd.npy",
    "recovered/tsvd.png",
    "recovered/tikhonov.npy",
    "recovered/tikhonov.png",
    "recovered/joint.npy",
    "recovered/joint.png",
    "recovered/picard.csv",
    "recovered/picard.svg",
    "recovered/truth.npy",
    "recovered/truth.png",
    "summary.json",
    "report.html",
];

const PNG: [u8; 8] = [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n'];

/// The page loads nothing from anywhere: its markup has no address but those that name an XML
/// vocabulary, no foreign source, no script but inside. (That its scripts ask for nothing, a
/// browser tells in `tests/browser`.)
fn assert_self_contained(page: &str) {
    let inside: String = page
        .split("<script")
        .map(|part| {
            part.split_once("</script>")
                .map_or(part, |(_, after)| after)
        })
        .collect();
    let markup = inside.split("<details class=\"licences\">").next().unwrap();
    let without_vocabularies: String = markup
        .split("xmlns")
        .enumerate()
        .map(
            |(i, part)| match (i, part.split_once("\"http://www.w3.org/")) {
                (1.., Some((_, rest))) => rest,
                _ => part,
            },
        )
        .collect();
    for address in ["http://", "https://", "src=\"//", "url(//", "@import"] {
        assert!(!without_vocabularies.contains(address), "{address}");
    }
    assert!(!page.contains("<script src"));
    for link in without_vocabularies.split("href=\"").skip(1) {
        let here = link.starts_with("data:") || link.starts_with('#');
        assert!(here, "{link:.40}");
    }
    for source in without_vocabularies.split("src=\"").skip(1) {
        assert!(
            source.starts_with("data:"),
            "{}",
            &source[..40.min(source.len())]
        );
    }
}

#[test]
#[ignore = "slow"]
fn it_leaves_every_file_and_agrees_and_recovers() {
    let workspace = Workspace::with_scenes();
    let ended = workspace.phicam("run small.toml").exits(0);
    assert!(
        ended.stdout.contains("traced and physical model agree"),
        "{}",
        ended.account()
    );
    for word in [
        "joint",
        "MTF raw",
        "χ²",
        "report.html",
        "64 pixels × 24 spots",
    ] {
        assert!(
            ended.stdout.contains(word),
            "no `{word}` in {}",
            ended.account()
        );
    }

    let files = workspace.contents("out");
    for name in FILES {
        let bytes = files.get(name).unwrap_or_else(|| panic!("no {name}"));
        assert!(!bytes.is_empty(), "{name} is empty");
        assert!(!name.ends_with(".png") || bytes.starts_with(&PNG), "{name}");
    }
    for spot in 0..24 {
        let name = format!("frames/spot-{spot:04}.exr");
        assert!(files.contains_key(&name), "no {name}");
    }
    assert!(
        files
            .keys()
            .all(|n| !n.contains("partial") && !n.ends_with(".part")),
        "left over: {:?}",
        files.keys()
    );
    assert_eq!(files["scene.toml"], workspace.read("small.toml"));
    for (name, shape) in [
        ("phi", (64, 24)),
        ("phi.stderr", (64, 24)),
        ("phi.tails", (64, 24)),
        ("model/g12", (64, 24)),
        ("model/g23", (64, 64)),
        ("model/phi", (64, 24)),
        ("recovered/joint", (8, 8)),
    ] {
        let matrix = workspace.matrix(&format!("out/{name}.npy"));
        assert_eq!(matrix.shape(), shape, "{name}");
    }

    let summary = workspace.json("out/summary.json");
    assert_eq!(summary["agreement"]["agrees"], true, "{}", ended.account());
    assert_eq!(summary["agreement"]["kernel"], "physical");
    let recovered = summary["recovered"].as_array().expect("a list");
    let joint = recovered
        .iter()
        .find(|r| r["method"] == "joint")
        .expect("joint");
    assert!(joint["mtf"]["raw"].as_f64().unwrap() >= 0.9, "{joint}");

    let page = workspace.text("out/report.html");
    assert!(page.contains("<svg") && page.contains("data:image/png"));
    assert_self_contained(&page);
}

#[test]
#[ignore = "slow"]
fn json_on_standard_output_is_the_summary() {
    let workspace = Workspace::with_scenes();
    let ended = workspace.phicam("run small.toml -o there --json").exits(0);
    let value: serde_json::Value =
        serde_json::from_str(&ended.stdout).unwrap_or_else(|e| panic!("{e}: {}", ended.account()));
    assert_eq!(value, workspace.json("there/summary.json"));
    let record = workspace
        .phicam("render small.toml -o there --json")
        .exits(0);
    let record: serde_json::Value = serde_json::from_str(&record.stdout).expect("JSON");
    assert_eq!(record["finished"], 24);
    assert_eq!(record, workspace.json("there/run.json"));
}

#[test]
#[ignore = "slow"]
fn quiet_says_nothing_on_standard_error() {
    let workspace = Workspace::with_scenes();
    for line in [
        "--quiet run small.toml --samples 500",
        "run small.toml -q --samples 500",
        "-q render furnace -o furnace --samples 33",
        "-q scene show furnace",
    ] {
        let ended = workspace.phicam(line).exits(0);
        assert_eq!(ended.stderr, "", "{}", ended.account());
        assert_ne!(ended.stdout, "", "{}", ended.account());
    }
    let talking = workspace.phicam("run small.toml --samples 500").exits(0);
    assert!(
        talking.stderr.contains("rounded up to 512"),
        "{}",
        talking.account()
    );
}

#[test]
fn a_scene_that_hides_nothing_has_frames_but_no_model() {
    let workspace = Workspace::new();
    let ended = workspace.phicam("run furnace -o out --samples 64").exits(0);
    assert!(
        ended.stderr.contains("no surface is hidden"),
        "{}",
        ended.account()
    );
    let files = workspace.contents("out");
    for name in [
        "frames/spot-0002.exr",
        "phi.npy",
        "summary.json",
        "report.html",
    ] {
        assert!(files.contains_key(name), "no {name}");
    }
    assert!(
        !files
            .keys()
            .any(|n| n.starts_with("model") || n.starts_with("recovered"))
    );
    let summary = workspace.json("out/summary.json");
    assert!(summary["agreement"].is_null() && summary["recovered"] == serde_json::json!([]));
    assert_eq!(workspace.matrix("out/phi.npy").shape(), (16, 3));
    assert_self_contained(&workspace.text("out/report.html"));
    workspace.refuses("validate out", &["hidden"]);
    workspace.refuses("recover out", &["hidden"]);
}

#[test]
#[ignore = "slow"]
fn a_wrong_model_ends_with_exit_code_one_and_all_files() {
    let workspace = Workspace::with_scenes();
    let ended = workspace
        .phicam("run small.toml --kernel published")
        .exits(1);
    assert!(
        ended.stdout.contains("published model DISAGREE"),
        "{}",
        ended.account()
    );
    let files = workspace.contents("out");
    for name in FILES {
        assert!(files.contains_key(name), "no {name}");
    }
    assert_eq!(
        workspace.json("out/summary.json")["agreement"]["agrees"],
        false
    );
}

#[test]
#[ignore = "slow"]
fn a_render_with_another_seed_leaves_no_result_of_the_earlier_run() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam("run small.toml --samples 64").exits(0);
    workspace.write("out/notes.txt", "mine");
    workspace.write("out/recovered/notes.txt", "mine");
    let line = "render small.toml -o out --samples 64 --seed 2 --replace";
    let _ = workspace.phicam(line).exits(0);
    let mut names: Vec<String> = workspace.contents("out").into_keys().collect();
    names.retain(|n| !n.starts_with("frames/spot-"));
    // What is not the program's own stays.
    let left = [
        "frames/",
        "notes.txt",
        "phi.npy",
        "phi.stderr.npy",
        "phi.tails.npy",
        "recovered/",
        "recovered/notes.txt",
        "run.json",
        "scene.toml",
    ];
    assert_eq!(names, left);
}

#[test]
fn a_black_object_is_found_black_and_no_error() {
    let workspace = Workspace::with_scenes();
    let black = workspace
        .text("tiny.toml")
        .replace("light = 1.0", "light = 0.0");
    workspace.write("black.toml", black);
    // Dark in both is no evidence.
    let ended = workspace.phicam("run black.toml --samples 64").exits(4);
    assert!(
        ended.stderr.contains("nothing to recover"),
        "{}",
        ended.account()
    );
    let summary = workspace.json("out/summary.json");
    assert_eq!(summary["recovered"], serde_json::json!([]));
}

#[test]
fn light_beyond_the_range_of_a_frame_is_no_infinity() {
    let workspace = Workspace::with_scenes();
    let bright = workspace.text("tiny.toml").replace("5.0e-3", "1.0e60");
    workspace.write("bright.toml", bright);
    let ended = workspace
        .phicam("render bright.toml -o out --samples 32")
        .exits(2);
    for word in ["f32", "W", "lower the laser's power"] {
        assert!(ended.stderr.contains(word), "{}", ended.account());
    }
    assert!(!workspace.contents("out").keys().any(|n| n.ends_with("exr")));
}

#[test]
fn light_too_faint_for_a_frame_is_not_blamed_on_the_disk() {
    let workspace = Workspace::with_scenes();
    let faint = workspace.text("tiny.toml").replace("5.0e-3", "1.0e-35");
    workspace.write("faint.toml", faint);
    let ended = workspace
        .phicam("run faint.toml -o out --samples 32")
        .exits(2);
    for word in ["too faint", "f32", "raise the laser's power"] {
        assert!(ended.stderr.contains(word), "{}", ended.account());
    }
}

#[test]
#[ignore = "slow"]
fn another_seed_replaces_the_run_wholly() {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("run small.toml -o twice --samples 64")
        .exits(0);
    let again = workspace
        .phicam("run small.toml -o twice --samples 64 --seed 2 --replace")
        .exits(0);
    assert!(
        again.stderr.contains("stays until this one is whole"),
        "{}",
        again.account()
    );
    let _ = workspace
        .phicam("run small.toml -o once --samples 64 --seed 2")
        .exits(0);
    let [mut twice, mut once] = ["twice", "once"].map(|dir| workspace.contents(dir));
    for timed in ["run.json", "summary.json", "report.html"] {
        assert!(twice.remove(timed).is_some() && once.remove(timed).is_some());
    }
    assert_same(&twice, &once, "a run over a run");
}
