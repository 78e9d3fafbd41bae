//! Memory is counted before it is taken, and Ctrl-C is answered in the midst of a step.
#![cfg(target_os = "linux")]

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::small_scene::{TINY, altered};
use crate::workspace::Workspace;

/// KiB of address space.
const ONE_GIB: u64 = 1 << 20;

/// One spot of the bench, and what is replaced.
fn one_spot(pixels: &str) -> String {
    altered(&[
        ("pixels = [16, 16]", pixels),
        (
            "layout = \"square\"",
            "layout = \"list\"\npoints = [[2.0, 3.0]]",
        ),
        ("centre = [5.0, 4.373476808130942]", ""),
        ("half_width = 3.0", ""),
        ("per_side = 30", ""),
        (
            "stagger = [-1.0, 1.0, 0.0]         # offsets cycled along each side",
            "",
        ),
    ])
}

/// Frames beyond 1 GiB are refused by whoever would show, trace or study them, whatever the
/// machine, and at once; a moment ago `scene check` looked at 67 million pixels.
#[test]
fn frames_that_no_file_holds_are_refused_at_once() {
    let workspace = Workspace::new();
    workspace.write("huge.toml", one_spot("pixels = [8192, 8192]"));
    let start = Instant::now();
    for line in [
        "scene check huge.toml",
        "scene show huge.toml",
        "render huge.toml -o out",
        "run huge.toml -o out",
        "study budget huge.toml -o out",
        "study tolerance huge.toml -o out",
        "study convergence huge.toml -o out",
        "study power huge.toml -o out",
        "study noise huge.toml -o out",
        "study coverage huge.toml -o out",
        "study spots huge.toml -o out",
    ] {
        workspace.refuses(
            line,
            &["67108864 pixels", "1.25 GiB", "at most 53687091 pixels"],
        );
    }
    // A scheduler is told that the data are refused.
    let planned = workspace.phicam("plan huge.toml -o out").exits(65);
    assert!(
        planned.stderr.contains("67108864 pixels"),
        "{}",
        planned.account()
    );
    assert!(
        start.elapsed() < Duration::from_secs(10),
        "{:?}",
        start.elapsed()
    );
}

/// With 1 GiB of address space every command says what it needs, what there is, and what would fit;
/// none begins.
#[test]
fn what_does_not_fit_is_refused_before_it_is_taken() {
    let workspace = Workspace::new();
    workspace.write("large.toml", one_spot("pixels = [4096, 4096]"));
    let words = [
        "16777216 pixels",
        "GiB may be taken (the limit of its address space)",
        "pixels would fit",
    ];
    for line in [
        "render large.toml -o out",
        "render large.toml -o out --estimator shared",
        "render large.toml -o out --estimator factored",
        "run large.toml -o out",
        "model large.toml -o out",
        "study budget large.toml -o out",
        "study convergence large.toml -o out",
    ] {
        workspace.refuses_within(ONE_GIB, line, &words);
    }
}

/// So do meshes that the program makes itself, pictures while they are decoded or drawn, and scenes
/// that become the text of a program.
#[test]
fn meshes_and_pictures_are_refused_before_they_are_taken() {
    let workspace = Workspace::new();
    let words = ["100000000 triangles", "GiB may be taken", "--faces"];
    for name in ["mesh", "sphere", "rectangle"] {
        let line = format!("target {name} --faces 100000000 -o x.ply");
        workspace.refuses_within(ONE_GIB, &line, &words);
    }
    let _ = workspace
        .phicam("target letters --linear --size 4096,4096 -o large.png")
        .exits(0);
    let board = "lambertian = { checkerboard = [2, 2], dark = 0.0, light = 1.0 }";
    let painted = |texture: &str| {
        let texture = format!("lambertian = {{ {texture} }}");
        altered(TINY.iter().chain([&(board, texture.as_str())]))
    };
    let words = ["4096 × 4096 pixels", "GiB may be taken", "scale it down"];
    workspace.write(
        "image.toml",
        painted("image = \"large.png\", transfer = \"linear\""),
    );
    workspace.refuses_within(ONE_GIB, "scene check image.toml", &words);
    let target = "target = \"letters\", size = [4096, 4096]";
    workspace.write("target.toml", painted(target));
    workspace.refuses_within(ONE_GIB / 8 * 3, "scene check target.toml", &words);
    let line = "scene export target.toml --mitsuba -o x.py";
    workspace.refuses_within(ONE_GIB, line, &["as text", "GiB may be taken"]);
}

/// Meshes are counted before they are made, read or cut along the edges of a texture, which takes
/// twenty times what the file has.
#[test]
fn meshes_of_scenes_are_refused_before_they_are_taken() {
    let workspace = Workspace::new();
    let _ = workspace
        .phicam("target sphere --faces 3000000 -o sphere.ply")
        .exits(0);
    let scene = |mesh: &str, albedo: &str| {
        altered(&TINY)
            + &format!(
                "\n[[surface]]\nname = \"body\"\nrole = \"occluder\"\nmesh = {{ {mesh}, scale = 0.1, translate = [1, 1, 1] }}\nmaterial = {{ lambertian = {albedo} }}\n"
            )
    };
    let words = ["triangles", "GiB may be taken", "use fewer triangles"];
    for mesh in [
        "file = \"sphere.ply\"",
        "generate = \"sphere\", faces = 3000000",
    ] {
        workspace.write("body.toml", scene(mesh, "0.5"));
        for line in [
            "scene check body.toml",
            "render body.toml -o out",
            "model body.toml -o out",
            "study budget body.toml -o out",
        ] {
            workspace.refuses_within(ONE_GIB, line, &words);
        }
    }
    let board = "{ checkerboard = [1000, 1000], dark = 0.0, light = 1.0 }";
    workspace.write(
        "cut.toml",
        scene("generate = \"sphere\", faces = 2000", board),
    );
    let words = [
        "surface `body`, cut along",
        "GiB may be taken",
        "a coarser texture",
    ];
    workspace.refuses_within(ONE_GIB / 2, "scene check cut.toml", &words);
}

/// What would fit, does: the number of pixels that the refusal names is rendered in the same
/// memory.
#[test]
fn what_is_said_to_fit_fits() {
    let workspace = Workspace::new();
    let scene = |pixels: u64| {
        altered(&[
            TINY[1],
            ("pixels = [16, 16]", &format!("pixels = [{pixels}, 1]")),
        ])
    };
    workspace.write("large.toml", scene(1 << 22));
    let line = "render large.toml -o out --samples 1 --estimator shared";
    let refused = workspace.phicam_within(ONE_GIB, line).exits(2);
    let fits = refused.stderr.split("at most ").nth(1);
    let fits = fits.and_then(|rest| rest.split(' ').next()?.parse::<u64>().ok());
    let fits = fits.unwrap_or_else(|| panic!("{}", refused.account()));
    // Time is a few seconds for a tenth of it; the whole is tried by hand.
    workspace.write("less.toml", scene(fits / 10));
    let line = line.replace("large.toml", "less.toml");
    let _ = workspace.phicam_within(ONE_GIB, &line).exits(0);
}

/// More threads than have room are an error; where nobody asked for a number there are fewer.
#[test]
fn threads_without_room_are_refused() {
    let workspace = Workspace::with_scenes();
    let words = ["64 threads cannot be started", "room for", "--threads"];
    workspace.refuses_within(ONE_GIB, "render tiny.toml -o out --threads 64", &words);
    let _ = workspace
        .phicam_within(ONE_GIB / 2, "scene check tiny.toml")
        .exits(0);
}

/// How many processes want to run for each that can, at least 1: so much longer all of them take.
fn busy() -> f64 {
    let load = std::fs::read_to_string("/proc/loadavg").unwrap();
    let load: f64 = load.split(' ').next().unwrap().parse().unwrap();
    (load / std::thread::available_parallelism().unwrap().get() as f64).max(1.0)
}

/// Ctrl-C in the midst of a million pixels ends the process within two seconds, with the code of
/// Ctrl-C, under each estimator.
#[test]
fn ctrl_c_is_answered_while_a_scene_is_prepared() {
    let workspace = Workspace::new();
    workspace.write("wide.toml", one_spot("pixels = [1024, 1024]"));
    for estimator in ["independent", "shared", "factored"] {
        let child = Command::new(env!("CARGO_BIN_EXE_phicam"))
            .args([
                "render",
                "wide.toml",
                "-o",
                estimator,
                "--estimator",
                estimator,
            ])
            .args(["--samples", "100000"])
            .current_dir(workspace.path(""))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let begun = workspace.path(&format!("{estimator}/partial"));
        let start = Instant::now();
        while !begun.exists() && start.elapsed() < Duration::from_secs(100) {
            std::thread::sleep(Duration::from_millis(5));
        }
        let sent = Instant::now();
        let signal = format!("kill -INT {}", child.id());
        assert!(
            Command::new("sh")
                .args(["-c", &signal])
                .status()
                .unwrap()
                .success()
        );
        let output = child.wait_with_output().unwrap();
        let words = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(130), "{estimator}: {words}");
        assert!(words.contains("stopped"), "{estimator}: {words}");
        let (answer, most) = (sent.elapsed(), Duration::from_secs(2).mul_f64(busy()));
        assert!(answer < most, "{estimator}: {answer:?} of {most:?}");
    }
}
