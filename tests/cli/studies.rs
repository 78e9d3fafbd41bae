//! `phicam study`: files, tables, refusals.

use crate::small_scene::{SMALL, altered};
use crate::workspace::{Ended, Workspace};

/// The terminal says these words, wherever its lines are broken.
fn says(ended: &Ended, words: &[&str]) {
    let said = ended
        .stdout
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    for word in words {
        assert!(said.contains(word), "no `{word}`: {}", ended.account());
    }
}

/// The page in `folder` is whole in itself and says these words.
fn told(workspace: &Workspace, folder: &str, words: &[&str]) {
    let page = workspace.text(&format!("{folder}/report.html"));
    for word in words {
        assert!(page.contains(word), "no `{word}` in the page of {folder}");
    }
    assert!(!page.contains("src=\"http") && page.len() < 10_000_000);
    assert!(page.contains("class=\"verdict"));
}

#[test]
fn a_budget_is_a_table_a_figure_and_json() {
    let workspace = Workspace::with_scenes();
    let ended = workspace
        .phicam("study budget tiny.toml -o b --samples 512 --run-samples 64")
        .exits(0);
    says(
        &ended,
        &[
            "element area",
            "5 bounces",
            "Monte Carlo itself",
            "the parts add up",
        ],
    );
    let json = workspace.json("b/budget.json");
    assert_eq!(json["closure"]["closes"], true, "{json}");
    let terms = json["terms"].as_array().unwrap().len();
    // A header and a line a term.
    assert_eq!(workspace.text("b/budget.csv").lines().count(), terms + 1);
    told(
        &workspace,
        "b",
        &[
            "phicam study budget tiny.toml --samples 512 --run-samples 64 --seed 1",
            "the parts add up to",
            "data-name=\"budget\"",
            "download=\"budget.csv\"",
            "pixels = [3, 2]",
        ],
    );
    let figure = workspace.text("b/budget.svg");
    assert!(figure.contains("<svg") && !figure.contains("NaN") && figure.contains("5 bounces"));
}

#[test]
#[ignore = "slow"]
fn tolerance_is_a_table_a_figure_and_json() {
    let workspace = Workspace::with_scenes();
    let ended = workspace.phicam("study tolerance small.toml -o t").exits(0);
    says(&ended, &["hinge angle", "wall bent", "the pattern is lost"]);
    let json = workspace.json("t/tolerance.json");
    assert_eq!(json["parameters"].as_array().unwrap().len(), 15);
    assert!(workspace.text("t/tolerance.svg").contains("hinge angle"));
    told(
        &workspace,
        "t",
        &["tolerance small.toml --noise 0.01 --mtf 0.9<", "<metadata>"],
    );
    assert!(workspace.text("t/tolerance.csv").lines().count() > 60);
    workspace.refuses(
        "study tolerance small.toml -o u --noise 0",
        &["--noise", "cure"],
    );
}

#[test]
fn power_is_a_table_and_json() {
    let workspace = Workspace::with_scenes();
    let line = "study power tiny.toml -o p --seeds 4 --samples 32,64 --json";
    let json: serde_json::Value =
        serde_json::from_str(&workspace.phicam(line).exits(0).stdout).unwrap();
    // Three estimators at two numbers of samples.
    assert_eq!(json["rows"].as_array().unwrap().len(), 6);
    assert_eq!(json, workspace.json("p/power.json"));
    told(&workspace, "p", &["smallest scale error", "--seeds 4"]);
    workspace.refuses(
        "study power tiny.toml -o q --significance 1.5",
        &["--significance", "cure"],
    );
    workspace.refuses("study power tiny.toml -o q --seeds 0", &["--seeds"]);
}

#[test]
fn absurd_numbers_of_paths_are_refused() {
    let workspace = Workspace::with_scenes();
    let most = u64::MAX;
    for line in [
        format!("study budget tiny.toml -o q --samples {most} --run-samples {most}"),
        format!("study power tiny.toml -o q --samples {most},{most}"),
        format!("study convergence tiny.toml -o q --samples {most},{most}"),
    ] {
        workspace.refuses(&line, &["2³²"]);
    }
}

#[test]
fn convergence_is_a_table_a_figure_and_json() {
    let workspace = Workspace::with_scenes();
    let line = "study convergence small.toml -o c --samples 64,256,1024 --json";
    let json: serde_json::Value =
        serde_json::from_str(&workspace.phicam(line).exits(0).stdout).unwrap();
    assert_eq!(json, workspace.json("c/convergence.json"));
    let slope = |i: usize| json["curves"][i]["slope"].as_f64().unwrap();
    // Independent PCG over 1536 entries: each error is known to 1.8 %, the slope over ln 16 to
    // 0.01.
    assert!((slope(0) + 0.5).abs() < 0.05, "{json}");
    assert!(slope(1) < -0.75, "{json}");
    assert!(workspace.text("c/convergence.svg").contains("slope"));
    told(&workspace, "c", &["--samples 64,256,1024", "<metadata>"]);
    let one = workspace
        .phicam("study convergence small.toml -o d --samples 64")
        .exits(2);
    assert!(one.stderr.contains("two different"), "{}", one.account());
    // What was refused is not in the way of what is right.
    let line = "study convergence small.toml -o d --samples 64,128";
    let _ = workspace.phicam(line).exits(0);
}

#[test]
fn nothing_hidden_is_nothing_to_study() {
    let workspace = Workspace::new();
    for study in ["budget", "tolerance", "power", "convergence"] {
        let ended = workspace
            .phicam(&format!("study {study} furnace -o f"))
            .exits(2);
        assert!(ended.stderr.contains("hidden"), "{}", ended.account());
    }
}

/// A rejected model leaves its map: an EXR whose z is the table's, and a picture.
#[test]
fn a_disagreement_is_mapped() {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render small.toml -o done --samples 256")
        .exits(0);
    let _ = workspace.phicam("validate done").exits(0);
    assert!(!workspace.path("done/validation").exists());
    let line = "validate done --kernel published --json";
    let json: serde_json::Value =
        serde_json::from_str(&workspace.phicam(line).exits(1).stdout).unwrap();
    let map = phicam::film::exr::read(&workspace.path("done/validation/p.exr")).unwrap();
    assert_eq!(
        (map.columns, map.rows),
        (24, 64),
        "spots along, pixels down"
    );
    let worst = &json["worst"][0];
    let at = |key: &str| usize::try_from(worst[key].as_u64().unwrap()).unwrap();
    let z = map.channel("z").unwrap()[at("spot") + at("pixel") * 24];
    assert_eq!(z, worst["z"].as_f64().unwrap() as f32);
    let p = map.channel("p").unwrap();
    assert!(p.iter().all(|p| (0.0..=1.0).contains(p)));
    assert!(
        workspace
            .read("done/validation/p.png")
            .starts_with(b"\x89PNG")
    );
}

#[test]
#[ignore = "slow"]
fn the_experiment_is_told_in_words_tables_and_a_figure() {
    let workspace = Workspace::with_scenes();
    let line = "study experiment small.toml -o e --glares 1 --exposures 1 --seeds 2 --samples 64 --frames 2";
    let ended = workspace.phicam(line).exits(0);
    says(
        &ended,
        &[
            "the published analysis finds",
            "joint, glare pattern",
            "Normalized modulation by exposure",
        ],
    );
    let json = workspace.json("e/experiment.json");
    // Two spreads of the glare.
    assert_eq!(json["by_glare"].as_array().unwrap().len(), 2);
    let readings = json["by_glare"][0]["readings"].as_array().unwrap().len();
    // A header, then a line for every reading of 4 settings.
    let lines = workspace.text("e/experiment.csv").lines().count();
    assert_eq!(lines, 1 + 4 * readings);
    told(
        &workspace,
        "e",
        &["the published analysis finds", "--glares 1"],
    );
    let figure = workspace.text("e/experiment.svg");
    assert!(figure.contains("glare over signal") && !figure.contains("NaN"));
    let again = workspace
        .phicam(&format!("{line} --threads 1 --json"))
        .exits(0);
    let again: serde_json::Value = serde_json::from_str(&again.stdout).unwrap();
    assert_eq!(again, json, "threads change nothing");
    for (wrong, words) in [
        ("--glares 1,0", ["--glares", "grow"]),
        ("--glares -1", ["--glares", "0 or more"]),
        ("--exposures 0", ["--exposures", "above 0"]),
        ("--falloff 0", ["--falloff", "above 0"]),
        ("--sensor eye", ["eye", "machine-vision"]),
        ("--samples 0", ["--samples", "at least 1"]),
    ] {
        workspace.refuses(&format!("study experiment small.toml -o f {wrong}"), &words);
    }
}

#[test]
fn coverage_is_a_table_and_json() {
    let workspace = Workspace::with_scenes();
    let line = "study coverage small.toml -o c --elements 4 --seeds 20 --method pinv,tsvd,joint-tv";
    let ended = workspace.phicam(line).exits(0);
    for word in ["each alone", "joint-tv has no bands"] {
        assert!(ended.stdout.contains(word), "{word}: {}", ended.account());
    }
    let json = workspace.json("c/coverage.json");
    assert_eq!(json["rows"].as_array().unwrap().len(), 3);
    assert!(json["rows"][0]["covered"].as_f64().unwrap() > 0.8);
    assert!(json["rows"][1]["covered"].is_null());
    let why = json["rows"][1]["reason"].as_str().unwrap();
    assert!(why.contains("tsvd has no bands: regularisation"), "{why}");
    told(
        &workspace,
        "c",
        &["cover the true reflectance", "joint-tv has no bands"],
    );
    for (wrong, word) in [
        ("--noise 0", "--noise"),
        ("--confidence 1", "--confidence"),
        ("--elements 0", "--elements"),
        ("--method best", "joint-two-valued"),
    ] {
        workspace.refuses(&format!("study coverage small.toml -o d {wrong}"), &[word]);
    }
}

/// On satin the wall's own BRDF agrees and the others are rejected; a bench without gloss has
/// nothing to tell.
#[test]
#[ignore = "slow"]
fn brdf_is_a_table_json_csv_and_a_figure() {
    let workspace = Workspace::with_scenes();
    let satin = ("{ lambertian = 0.8 }", "{ coated = 0.8, roughness = 0.3 }");
    workspace.write("satin.toml", altered(SMALL.iter().chain([&satin])));
    let line = "study brdf satin.toml -o b --samples 4096 --seeds 3 --noise 0.01 --method joint";
    let ended = workspace.phicam(line).exits(0);
    says(
        &ended,
        &[
            "the traced light agrees with the model that has the wall's true BRDF",
            "the test rejects Lambertian (off by",
            "Lambertian, best scale (off by",
            "roughness × 2 (off by",
            "1 of 1 recoveries that succeed on a Lambertian wall do as well within 10 %",
        ],
    );
    let json = workspace.json("b/brdf.json");
    let assumptions = json["assumptions"].as_array().unwrap().len();
    assert_eq!(json["ratios"][0]["reaches"], true);
    // A header, then a line for each assumption and for the Lambertian case: one method, one level.
    let lines = workspace.text("b/brdf.csv").lines().count();
    assert_eq!(lines, 1 + assumptions + 1);
    told(
        &workspace,
        "b",
        &["agrees with the model that has", "<metadata>"],
    );
    let figure = workspace.text("b/brdf.svg");
    assert!(figure.contains("own BRDF (agrees)") && !figure.contains("NaN"));
    let again = workspace
        .phicam(&format!("{line} --threads 1 --json"))
        .exits(0);
    let again: serde_json::Value = serde_json::from_str(&again.stdout).unwrap();
    assert_eq!(again, json, "threads change nothing");
    workspace.refuses("study brdf small.toml -o c", &["Lambertian", "satin"]);
    for (wrong, word) in [
        ("--noise 0", "--noise"),
        ("--significance 2", "--significance"),
        ("--samples 0", "at least 1"),
        ("--method best", "joint-two-valued"),
    ] {
        workspace.refuses(&format!("study brdf satin.toml -o d {wrong}"), &[word]);
    }
}

/// A layout of 6 spots on the tiny scene: less risk than the scene's own 8, a scene file that has
/// its spots and a wall that holds them; refusals before anything is computed, and where nothing
/// fits.
#[test]
fn a_layout_is_tables_a_drawing_and_a_scene() {
    let workspace = Workspace::with_scenes();
    let line = "study layout tiny.toml -o l --count 6 --candidates 8 --elements 2 --level 1e-3 \
                --boards 2 --draws 2 --wall 1 --refine 1 --hinge 0.1";
    let ended = workspace.phicam(line).exits(0);
    says(&ended, &["optimised", "whole wall in view", "no layout of"]);
    let json = workspace.json("l/layout.json");
    let optimum = &json["optimum"];
    assert!(optimum["bound"].as_f64() <= optimum["on_grid"].as_f64());
    assert_eq!(optimum["layout"].as_array().unwrap().len(), 6);
    assert_eq!(workspace.text("l/places.csv").lines().count(), 7);
    let candidates = optimum["candidates"].as_array().unwrap().len();
    let weighted = workspace.text("l/candidates.csv");
    assert_eq!(weighted.lines().count(), candidates + 1);
    assert!(workspace.text("l/layout.svg").contains("candidate"));
    told(
        &workspace,
        "l",
        &["download=\"layout.toml\"", "on the grid"],
    );
    let _ = workspace.phicam("scene check l/layout.toml").exits(0);
    let scene = workspace.text("l/layout.toml");
    assert!(scene.contains("list") && scene.contains("13.5"), "{scene}");
    for (option, words) in [
        ("--level 0", ["--level", "cure"]),
        ("--length 0", ["--length", "cure"]),
        ("--margin -1", ["--margin", "cure"]),
        ("--count 60 --candidates 4", ["--candidates", "--count"]),
        ("--apart 9", ["--apart", "--margin"]),
    ] {
        let rest = "--elements 2 --boards 2 --draws 1";
        let line = format!("study layout tiny.toml -o m {option} {rest}");
        workspace.refuses(&line, &words);
    }
}

/// Of a surface that is one element, seen under a relative noise ε, N = pixels × spots entries
/// leave 1/(1 + N/ε²) of a variance of ¼: each tells Φ = A/2 to ε A/2. So power changes the light in
/// proportion and nothing else, and pixels count as many as they are; texts and refusals.
#[test]
fn a_sweep_follows_the_law_of_one_element() {
    let workspace = Workspace::with_scenes();
    let line = "study sweep tiny.toml --elements 1 --noise 0.5";
    let steps = |folder: &str, key: &str, values: &str, said: &str| -> Vec<serde_json::Value> {
        let line = format!("{line} --key {key} --values {values} -o {folder}");
        let ended = workspace.phicam(&line).exits(0);
        says(&ended, &[key, said]);
        workspace.json(&format!("{folder}/sweep.json"))["steps"]
            .as_array()
            .unwrap()
            .clone()
    };
    let left = |step: &serde_json::Value| step["risk"].as_f64().unwrap();
    let power = steps("p", "laser.power", "5mW,0.01", "makes no difference");
    for step in &power {
        let law = 1.0 / (1.0 + 48.0 / 0.25);
        assert!((left(step) - law).abs() < 1e-9 * law, "{step} and {law}");
        assert_eq!(step["directions"], serde_json::json!([1, 1, 1, 1]));
    }
    let light = |k: usize| power[k]["brightest"].as_f64().unwrap();
    assert!((light(1) / light(0) - 2.0).abs() < 1e-12);
    assert_eq!(workspace.text("p/sweep.csv").lines().count(), 3);
    told(&workspace, "p", &["laser.power of bench", "<metadata>"]);
    // The same camera with 5 and with 9 columns of pixels, 2 rows and 8 spots.
    let pixels = steps("c", "camera.pixels.0", "5,9", "least of the prior variance");
    for (step, columns) in pixels.iter().zip([5.0, 9.0]) {
        let law = 1.0 / (1.0 + 16.0 * columns / 0.25);
        assert!((left(step) - law).abs() < 1e-9 * law, "{step} and {law}");
    }
    for (wrong, words) in [
        ("--values 1", ["no sweep", "cure"]),
        ("--values 1,2 --noise 0", ["--noise", "cure"]),
        (
            "--key camera.pixel --values 1,2",
            ["camera.pixel", "pixels"],
        ),
        ("--values 3,300", ["half_width=300", "wall"]),
    ] {
        workspace.refuses(&format!("study sweep tiny.toml -o d {wrong}"), &words);
    }
}

/// A finished study stays until --replace says otherwise: other settings, another scene and another
/// study are refused, the same command is not.
#[test]
fn a_finished_study_is_replaced_by_no_other() {
    let workspace = Workspace::with_scenes();
    let line = "study sweep tiny.toml --elements 1 --key laser.power --values 1,2 -o s";
    let _ = workspace.phicam(line).exits(0);
    let found = workspace.text("s/sweep.json");
    for (other, word) in [
        (format!("{line} --noise 0.02"), "--noise"),
        (line.replace("tiny", "small"), "scene"),
        ("study spots tiny.toml -o s".to_owned(), "study is sweep"),
    ] {
        workspace.refuses(&other, &["another study", word, "--replace", "cure"]);
        assert_eq!(workspace.text("s/sweep.json"), found, "{other}");
    }
    let _ = workspace.phicam(line).exits(0);
    assert_eq!(workspace.text("s/sweep.json"), found);
    let other = format!("{line} --noise 0.02");
    let _ = workspace.phicam(&format!("{other} --replace")).exits(0);
    assert_ne!(workspace.text("s/sweep.json"), found);
    let _ = workspace.phicam(&other).exits(0);
    workspace.refuses(line, &["another study", "--noise"]);
}
