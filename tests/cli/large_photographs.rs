//! `phicam recover` where Φcam does not fit the memory it may take.

use std::fs::File;
use std::io::Write;
use std::process::Command;

use crate::small_scene::altered;
use crate::workspace::Workspace;

/// Enough for ten pixels at a time of the small scene with 4 × 4 elements, and not for all.
const LITTLE: &str = "--elements 4 --memory 0.0625559";

fn with_run() -> Workspace {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam("render small.toml -o done").exits(0);
    workspace
}

#[test]
#[ignore = "slow"]
fn by_rows_it_is_what_it_is_at_once() {
    let workspace = with_run();
    for (method, more, code) in [
        ("pinv", "", 1),
        ("rdivide", "--tolerance 1e-6", 1),
        ("tikhonov", "--damping 1e-3", 1),
        ("tsvd", "--rank 6 --noise 0.01 --bands 0.9", 0),
    ] {
        let line = format!("recover done --method {method} {more}");
        // Sixteen elements are too coarse to explain the photographs, but under noise of 1 %; by
        // rows that is not judged.
        let _ = workspace
            .phicam(&format!("{line} --elements 4 --integration centres"))
            .exits(code);
        let names = [
            format!("done/recovered/{method}.npy"),
            format!("done/recovered/{method}.stderr.npy"),
        ];
        let known = names.each_ref().map(|name| workspace.matrix(name));
        let ended = workspace.phicam(&format!("{line} {LITTLE}")).exits(0);
        assert!(
            ended.stderr.contains("read by 10 pixels at a time"),
            "{}",
            ended.account()
        );
        for (name, known) in names.iter().zip(known) {
            let off = (workspace.matrix(name) - &known).amax() / known.amax();
            assert!(off < 1e-9, "{name}: {off:e}");
        }
    }
}

#[test]
fn what_cannot_be_had_by_rows_is_refused() {
    let workspace = with_run();
    for (line, words) in [
        ("--method joint", ["all photographs at once", "joint"]),
        (
            "--method tsvd",
            ["all photographs at once", "give the rank"],
        ),
    ] {
        // A joint method takes more; so much more that less than this is enough to refuse it.
        workspace.refuses(&format!("recover done {line} {LITTLE}"), &words);
    }
    workspace.refuses(
        "recover done --method pinv --memory 0.01",
        &["the model alone needs", "--memory"],
    );
}

/// 256 MiB of photographs, black but for the first pixel's, by a program that may not have so much:
/// the address space is bounded by the system.
#[cfg(target_os = "linux")]
#[test]
#[ignore = "slow"]
fn the_memory_stated_is_held() {
    let workspace = Workspace::new();
    let scene = altered(&[
        ("pixels = [16, 16]", "pixels = [128, 128]"),
        ("per_side = 30", "per_side = 512"),
    ]);
    std::fs::create_dir(workspace.path("big")).unwrap();
    workspace.write("big/scene.toml", scene);
    let (pixels, spots) = (128 * 128, 4 * 512);
    let dict =
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({pixels}, {spots}), }}");
    let mut file = File::create(workspace.path("phi.npy")).unwrap();
    file.write_all(b"\x93NUMPY\x01\x00\x76\x00").unwrap();
    file.write_all(format!("{dict:<117}\n").as_bytes()).unwrap();
    file.write_all(&vec![1e-12f64.to_le_bytes(); spots].concat())
        .unwrap();
    file.set_len(128 + 8 * (pixels * spots) as u64).unwrap();
    let ended = |kib: u32, memory: &str| {
        let line = "recover big --phi phi.npy --method pinv --elements 4";
        Command::new("sh")
            .arg("-c")
            .arg(format!("ulimit -v {kib}; exec \"$0\" {line} {memory}"))
            .arg(assert_cmd::cargo::cargo_bin!("phicam"))
            .current_dir(workspace.path(""))
            .output()
            .unwrap()
    };
    let held = ended(500_000, "--memory 0.2");
    let said = String::from_utf8_lossy(&held.stderr);
    assert!(held.status.success(), "{said}");
    assert!(said.contains("memory: up to 0."), "{said}");
    // The limit is one: with all of it at once the same program does not get through.
    assert!(!ended(500_000, "--memory 8").status.success());
}
