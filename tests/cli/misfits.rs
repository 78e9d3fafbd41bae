//! What `phicam recover` says of photographs that are not of its scene.

use phicam::matrix::{Matrix, npy};
use phicam::recovery::Method;

use crate::workspace::Workspace;

/// Frames upside down, spots in another order, counts given as W, spots half an inch from where
/// they were: every method that can work at all says that nothing it could recover fits, and ends
/// with exit code 1; the right photographs fit by `joint`.
#[test]
fn every_method_tells_by_its_exit_code_what_does_not_fit() {
    let w = Workspace::with_scenes();
    let _ = w
        .phicam("render small.toml -o run --samples 4096 -q")
        .exits(0);
    let _ = w
        .phicam("expose run --sensor ideal --noise 0.001 -q")
        .exits(0);
    let both = ["phi", "phi.stderr"].map(|name| w.matrix(&format!("run/exposed/{name}.npy")));
    // 8 × 8 pixels.
    let upside_down =
        |m: &Matrix| Matrix::from_fn(m.nrows(), m.ncols(), |p, l| m[((7 - p / 8) * 8 + p % 8, l)]);
    let permuted = |m: &Matrix| {
        let n = m.ncols();
        Matrix::from_fn(m.nrows(), n, |p, l| m[(p, (l + 1) % n)])
    };
    let counts = |m: &Matrix| m * 1e15;
    let scene = w.text("small.toml");
    let elsewhere = scene.replace("centre = [5.0, 4.37", "centre = [5.5, 4.37");
    assert_ne!(scene, elsewhere);
    for (folder, text) in [("here", &scene), ("elsewhere", &elsewhere)] {
        std::fs::create_dir(w.path(folder)).unwrap();
        w.write(&format!("{folder}/scene.toml"), text);
    }
    let faults = [
        ("upside-down", "here", both.each_ref().map(upside_down)),
        ("permuted", "here", both.each_ref().map(permuted)),
        ("counts", "here", both.each_ref().map(counts)),
        ("elsewhere", "elsewhere", both.clone()),
        ("right", "here", both.clone()),
    ];
    for (fault, folder, matrices) in faults {
        for (name, matrix) in ["phi", "stderr"].into_iter().zip(&matrices) {
            npy::write(&w.path(&format!("{fault}.{name}.npy")), matrix).unwrap();
        }
        let recover = |method: &str| {
            w.phicam(&format!(
                "recover {folder} --phi {fault}.phi.npy --stderr {fault}.stderr.npy --method {method} --elements 4x4 -o {fault}-{method}"
            ))
        };
        if fault == "right" {
            let _ = recover("joint").exits(0);
            continue;
        }
        let mut told = 0;
        for method in Method::ALL {
            let ended = recover(&method.to_string());
            if ended.code == 2 {
                // Methods that have no solution here, or whose least regularisation leaves too much.
                let is_refused = ["does not describe", "does not exist", "rank"]
                    .iter()
                    .any(|words| ended.stderr.contains(words));
                assert!(is_refused, "{fault}, {method}: {}", ended.account());
                continue;
            }
            let is_told = ended.stdout.contains("NO") && ended.code == 1;
            assert!(is_told, "{fault}, {method}: {}", ended.account());
            told += 1;
        }
        assert!(told >= 7, "{fault}: {told} methods");
    }
}
