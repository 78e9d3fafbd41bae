//! `phicam expose`: files, settings, refusals.

use phicam::film;

use crate::small_scene::{SMALL, TINY, altered};
use crate::workspace::{Workspace, assert_same};

/// A finished run of the tiny scene in `done`.
fn with_run() -> Workspace {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render tiny.toml -o done --samples 32")
        .exits(0);
    workspace
}

/// The run's scene with a sensor table, which leaves the run valid.
fn set_sensor(workspace: &Workspace, table: &str) {
    let text = altered(&TINY);
    workspace.write("done/scene.toml", format!("{text}\n[sensor]\n{table}\n"));
}

#[test]
fn an_exposure_leaves_its_files() {
    let workspace = with_run();
    let line = "expose done --sensor ccd --exposure 0.004 --frames 3 --dark-frames 2";
    let ended = workspace.phicam(line).exits(0);
    for word in ["electrons", "signal/noise", "saturated", "0 of 48"] {
        assert!(
            ended.stdout.contains(word),
            "no `{word}` in {}",
            ended.account()
        );
    }
    let names: Vec<String> = workspace.contents("done/exposed").into_keys().collect();
    let mut expected = vec!["counts/".to_owned()];
    for spot in 0..8 {
        expected.extend(["exr", "png"].map(|e| format!("counts/spot-{spot:04}.{e}")));
    }
    expected.extend(
        [
            "exposure.json",
            "phi.npy",
            "phi.stderr.npy",
            "saturated.npy",
        ]
        .map(str::to_owned),
    );
    assert_eq!(names, expected);
    let [clean, exposed, stderr, saturated] = [
        "phi",
        "exposed/phi",
        "exposed/phi.stderr",
        "exposed/saturated",
    ]
    .map(|name| workspace.matrix(&format!("done/{name}.npy")));
    assert_eq!(exposed.shape(), (6, 8));
    assert_eq!(saturated.max(), 0.0);
    for i in 0..clean.len() {
        let z = (exposed[i] - clean[i]) / stderr[i];
        assert!(stderr[i] > 0.0 && z.abs() < 6.0, "entry {i}: z = {z}");
    }
    let account = workspace.json("done/exposed/exposure.json");
    assert_eq!(account["sensor"]["read_noise"], 12.6);
    assert_eq!(account["times"], serde_json::json!([0.004]));
    assert_eq!(account["result"]["saturated"], 0);
    // The mean of three frames of whole counts, in EXR.
    let frame = film::exr::read(&workspace.path("done/exposed/counts/spot-0003.exr")).unwrap();
    assert_eq!((frame.columns, frame.rows), (3, 2));
    let counts = frame.channel("counts").unwrap();
    assert!(
        counts
            .iter()
            .all(|c| *c > 100.0 && (c * 3.0 - (c * 3.0).round()).abs() < 1e-2)
    );
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_does_not() {
    let workspace = with_run();
    for (out, seed) in [("a", 3), ("b", 3), ("c", 4)] {
        let line = format!("expose done -o {out} --sensor dslr --brackets 1,0.1 --seed {seed}");
        let _ = workspace.phicam(&line).exits(0);
    }
    assert_same(
        &workspace.contents("a"),
        &workspace.contents("b"),
        "seed 3 twice",
    );
    assert_ne!(workspace.read("a/phi.npy"), workspace.read("c/phi.npy"));
    let frame = film::exr::read(&workspace.path("a/counts/spot-0000.exr")).unwrap();
    assert!(frame.channel("counts.0").is_some() && frame.channel("counts.1").is_some());
}

#[test]
fn the_ideal_sensor_gives_the_clean_flux_back() {
    let workspace = with_run();
    let _ = workspace.phicam("expose done --sensor ideal").exits(0);
    let [clean, exposed] =
        ["phi", "exposed/phi"].map(|n| workspace.matrix(&format!("done/{n}.npy")));
    for (x, y) in exposed.iter().zip(&clean) {
        assert!((x - y).abs() <= 1e-14 * y.abs(), "{x} {y}");
    }
    // The render's own error is all there is, or beside the published percent error: its variance
    // is known to 2/(blocks − 1), and σ² = V + Var V/V.
    let render = workspace.matrix("done/phi.stderr.npy");
    let blocks = workspace.json("done/run.json")["blocks"].as_f64().unwrap();
    for (noise, rest) in [(0.0, ""), (0.01, " --noise 0.01")] {
        let _ = workspace
            .phicam(&format!("expose done --sensor ideal --replace{rest}"))
            .exits(0);
        let [noisy, stderr] =
            ["phi", "phi.stderr"].map(|n| workspace.matrix(&format!("done/exposed/{n}.npy")));
        for i in 0..clean.len() {
            let own = render[i] * render[i];
            let variance = (noise * clean[i]).powi(2) + own;
            let stated = (variance + 2.0 * own * own / ((blocks - 1.0) * variance)).sqrt();
            assert!((stderr[i] / stated - 1.0).abs() < 1e-12);
            assert!((noisy[i] - clean[i]).abs() <= (6.0 * noise + 1e-14) * clean[i]);
            assert!(noise == 0.0 || noisy[i] != clean[i]);
        }
    }
}

/// From counts unless the oracle is asked for; both state nearly the same, and the files say which.
#[test]
fn the_deviation_comes_from_counts_or_from_the_oracle() {
    let workspace = with_run();
    let stated = |by: &str| {
        let line = format!("expose done --sensor ccd --exposure 0.004 --replace{by}");
        let _ = workspace.phicam(&line).exits(0);
        let account = workspace.json("done/exposed/exposure.json");
        let [phi, stderr] =
            ["phi", "phi.stderr"].map(|n| workspace.matrix(&format!("done/exposed/{n}.npy")));
        (account, phi, stderr)
    };
    let (counts, phi, stderr) = stated("");
    assert_eq!(counts["stderr"], "counts");
    let slope = counts["photon_transfer"]["slope"].as_f64().unwrap();
    assert!((slope * 1.413 - 1.0).abs() < 0.01, "{slope}");
    let (oracle, same, law) = stated(" --stderr oracle");
    assert_eq!(oracle["stderr"], "oracle");
    assert!(oracle["photon_transfer"].is_null());
    assert_eq!(phi, same);
    for (s, l) in stderr.iter().zip(&law) {
        assert!(s != l && (s / l - 1.0).abs() < 0.2, "{s} {l}");
    }
    workspace.refuses(
        "expose done --sensor ccd --stderr truth",
        &["truth", "oracle"],
    );
}

#[test]
fn the_table_of_the_scene_is_used_and_the_command_line_goes_before_it() {
    let workspace = with_run();
    set_sensor(
        &workspace,
        "model = \"ccd\"\nread_noise = 2.5\nexposure = 0.5\nglare = { fraction = 1e-3, spread = { falloff = 2.0 } }",
    );
    let account = |line: &str| -> serde_json::Value {
        let ended = workspace.phicam(line).exits(0);
        serde_json::from_str(&ended.stdout).unwrap()
    };
    let own = account("expose done --json");
    assert_eq!(own["sensor"]["read_noise"], 2.5);
    assert_eq!(own["sensor"]["gain"], 1.413);
    assert_eq!(own["times"], serde_json::json!([0.5]));
    let ratio = own["glare_to_signal"].as_f64().unwrap();
    assert!(ratio > 0.1, "{ratio}");
    let other =
        account("expose done --replace --json --brackets 0.1,2 --glare 2e-3 --ambient 1e-15");
    assert_eq!(other["times"], serde_json::json!([2.0, 0.1]));
    assert!((other["glare_to_signal"].as_f64().unwrap() / ratio - 2.0).abs() < 1e-12);
    assert_eq!(other["ambient"], 1e-15);
    // Its figures are no part of the render; a sensor that replaces them leaves none to be changed.
    let other = account("expose done --replace --json -D sensor.read_noise=4 -D sensor.offset=7");
    let figures =
        ["read_noise", "offset", "gain"].map(|key| other["sensor"][key].as_f64().unwrap());
    assert_eq!(figures, [4.0, 7.0, 1.413]);
    assert_eq!(other["scene_hash"], own["scene_hash"]);
    workspace.refuses(
        "expose done -D sensor.gain=2 --sensor ccd",
        &["-D sensor.gain", "-D sensor.model='\"ccd\"'"],
    );
    workspace.refuses(
        "expose done -D camera.pixels=[2,2]",
        &["-D camera.pixels changes a scene", "-D sensor.KEY=VALUE"],
    );
    // Another sensor keeps the exposure, and none of the figures.
    let other = account("expose done --replace --json --sensor machine-vision");
    assert_eq!(other["sensor"]["read_noise"], 3.1);
    assert_eq!(other["times"], serde_json::json!([0.5]));
}

#[test]
fn what_was_exposed_can_be_recovered_from() {
    let workspace = Workspace::new();
    workspace.write("small.toml", altered(&SMALL));
    let _ = workspace.phicam("render small.toml -o done").exits(0);
    let _ = workspace
        .phicam("expose done --sensor ccd --exposure 0.02 --frames 4000 --dark-frames 100")
        .exits(0);
    let line = "recover done --phi done/exposed/phi.npy --stderr done/exposed/phi.stderr.npy --method joint --json";
    let ended = workspace.phicam(line).exits(0);
    let found: serde_json::Value = serde_json::from_str(&ended.stdout).unwrap();
    assert!(found[0]["mtf_raw"].is_number(), "{found}");
}

#[test]
fn saturation_is_marked_counted_and_refused_if_asked() {
    let workspace = with_run();
    let line = "expose done --sensor machine-vision --exposure 1000";
    workspace.refuses(
        &format!("{line} --strict"),
        &["48 of 48 entries are saturated", "--brackets"],
    );
    let ended = workspace.phicam(line).exits(0);
    assert!(
        ended.stderr.contains("48 of 48 entries are saturated"),
        "{}",
        ended.account()
    );
    assert_eq!(workspace.matrix("done/exposed/saturated.npy").sum(), 48.0);
    let account = workspace.json("done/exposed/exposure.json");
    assert_eq!(account["result"]["saturated"], 48);
    assert!(account["result"]["snr_mean"].is_null());
    // A shorter time in a series holds them.
    let _ = workspace
        .phicam("expose done --sensor machine-vision --brackets 1000,0.001 --strict --replace")
        .exits(0);
    assert_eq!(workspace.matrix("done/exposed/saturated.npy").sum(), 0.0);
}

/// A saturated entry is wrong by more than its standard error says.
#[test]
fn clipped_photographs_are_not_recovered_from_in_silence() {
    let workspace = with_run();
    let _ = workspace
        .phicam("expose done --sensor machine-vision --exposure 1000")
        .exits(0);
    let line = "recover done --phi done/exposed/phi.npy --stderr done/exposed/phi.stderr.npy --elements 2 --method pinv";
    let words = [
        "48 of 48 entries",
        "saturated.npy",
        "--brackets",
        "--keep-clipped",
    ];
    workspace.refuses(line, &words);
    let files = "--phi done/exposed/phi.npy --stderr done/exposed/phi.stderr.npy";
    for other in ["validate done", "calibrate done --free hinge.angle"] {
        workspace.refuses(
            &format!("{other} {files}"),
            &["48 of 48 entries", "saturated.npy", "--left-out"],
        );
    }
    let _ = workspace.phicam(&format!("{line} --keep-clipped")).exits(0);
    workspace.refuses("recover done --keep-clipped", &["--phi"]);
    let _ = workspace
        .phicam("expose done --sensor machine-vision --exposure 0.001 --replace")
        .exits(0);
    let _ = workspace.phicam(line).exits(0);
}

/// What dark frames leave or bring in is said where it matters.
#[test]
fn light_that_stays_and_noise_that_is_shared_are_said() {
    let workspace = Workspace::with_scenes();
    // So many that the sensor's noise is more than that of the render.
    let _ = workspace
        .phicam("render tiny.toml -o done --samples 16384")
        .exits(0);
    for (rest, words) in [
        ("--ambient 1e-12", "stay in every entry"),
        ("--dark-frames 1", "all spots of a pixel share"),
    ] {
        let line = format!("expose done --sensor ccd --exposure 0.001 --replace {rest}");
        let ended = workspace.phicam(&line).exits(0);
        assert!(ended.stderr.contains(words), "{}", ended.account());
    }
    // Read noise, dark current and rounding of one frame, electrons², over those of each entry: of
    // the dark frame, of its own with the light's, and of the render.
    let electrons = 0.79 * 1e-3 * 632.8e-9 / (6.626_070_15e-34 * 299_792_458.0);
    let dark = 12.6 * 12.6 + 0.080 * 1e-3 + 1.413 * 1.413 / 12.0;
    let [clean, own] = ["phi", "phi.stderr"].map(|name| {
        let matrix = workspace.matrix(&format!("done/{name}.npy"));
        matrix * electrons
    });
    let share = clean.zip_map(&own, |light, own| dark / (light + 2.0 * dark + own * own));
    let share = share.mean();
    let account = workspace.json("done/exposed/exposure.json");
    let found = account["result"]["common"].as_f64().unwrap();
    assert!((found / share - 1.0).abs() < 1e-9, "{found} {share}");
    let quiet = workspace
        .phicam("expose done --sensor ccd --exposure 0.001 --dark-frames 2000 --replace")
        .exits(0);
    assert!(!quiet.stderr.contains("warning"), "{}", quiet.account());
    // Of dark frames that are full the counts say nothing, and no part is more than the whole.
    let full = "expose done --sensor ccd --exposure 0.001 --dark-frames 1 --ambient 1e-6 --replace";
    let full = workspace.phicam(full).exits(0);
    assert!(full.stderr.contains("48 of 48 entries are saturated"));
    assert!(
        !full.stderr.contains("of the variance"),
        "{}",
        full.account()
    );
    let account = workspace.json("done/exposed/exposure.json");
    for part in ["common", "render"] {
        assert_eq!(account["result"][part], 0.0, "{part}");
    }
}

#[test]
fn figures_beyond_all_measure_are_refused() {
    let workspace = with_run();
    for (table, words) in [
        ("gain = 1e-308", ["inf W", "gain"]),
        ("read_noise = 1e200", ["standard deviation", "read_noise"]),
        ("offset = 1e308", ["offset", "65535"]),
        (
            "glare = { fraction = 1, spread = { falloff = 1e-300 } }",
            ["falloff", "length"],
        ),
    ] {
        set_sensor(&workspace, table);
        workspace.refuses("expose done", &words);
    }
    set_sensor(&workspace, "model = \"ccd\"");
    let many = vec!["1"; 17].join(",");
    workspace.refuses(
        &format!("expose done --sensor ccd --brackets {many}"),
        &["17 exposure times", "1 to 16"],
    );
    workspace.refuses(
        "expose done --sensor ccd --exposure 1e308",
        &["1e308 s", "electrons", "shorter"],
    );
}

#[test]
fn bad_settings_are_refused_before_anything_is_written() {
    let workspace = with_run();
    for (rest, words) in [
        ("", ["no [sensor] table", "--sensor"]),
        ("--sensor nikon", ["`nikon`", "machine-vision"]),
        ("--sensor ccd --exposure 0", ["exposure = 0", "positive"]),
        ("--sensor ccd --exposure -1", ["exposure = -1", "positive"]),
        ("--sensor ccd --frames 0", ["frames = 0", "1 to"]),
        ("--sensor ccd --brackets 1,0", ["exposure = 0", "positive"]),
        (
            "--sensor ccd --brackets 1 --exposure 1",
            ["--brackets", "--exposure"],
        ),
        ("--sensor ccd --noise 1", ["relative_noise = 1", "below 1"]),
        ("--sensor ccd --glare 1.5", ["--glare 1.5", "0 to 1"]),
        ("--sensor ccd --ambient -1", ["ambient = -1", "0 or more"]),
        ("--sensor ccd -o done", ["folder of a run", "-o"]),
    ] {
        workspace.refuses(&format!("expose done {rest}"), &words);
    }
    workspace.refuses("expose nowhere --sensor ccd", &["nowhere", "phicam render"]);
    workspace.write("done/exposed", "mine");
    workspace.refuses("expose done --sensor ccd", &["exposed", "not a folder"]);
}

#[test]
fn a_flux_that_no_camera_can_see_is_refused() {
    let workspace = with_run();
    workspace.disown("done");
    let clean = workspace.matrix("done/phi.npy");
    let path = workspace.path("done/phi.npy");
    phicam::matrix::npy::write(&path, &(&clean * 0.0)).unwrap();
    workspace.refuses(
        "expose done --sensor ccd",
        &["dark in every pixel", "render"],
    );
    let mut negative = clean;
    negative[(2, 5)] = -1e-15;
    phicam::matrix::npy::write(&path, &negative).unwrap();
    workspace.refuses(
        "expose done --sensor ccd",
        &["pixel 2", "spot 5", "-1e-15 W"],
    );
}

#[test]
fn the_built_in_sensors_are_listed() {
    let workspace = Workspace::new();
    let ended = workspace.phicam("expose --list").exits(0);
    for word in [
        "ideal",
        "ccd",
        "dslr",
        "machine-vision",
        "65600 e-",
        "16 bits",
    ] {
        assert!(ended.stdout.contains(word), "{}", ended.account());
    }
    workspace.refuses("expose", &["<DIR>"]);
}

/// A new render of the scene makes photographs of the old one worthless.
#[test]
fn rendering_again_removes_the_photographs() {
    let workspace = with_run();
    let _ = workspace.phicam("expose done --sensor ccd").exits(0);
    let _ = workspace
        .phicam("render tiny.toml -o done --samples 32 --seed 9 --replace")
        .exits(0);
    assert!(workspace.contents("done/exposed").is_empty());
}
