//! `phicam stack`: Φcam from the frames alone.

use crate::workspace::Workspace;

/// f32 has 24 significant bits: rounding to nearest is off by at most 2⁻²⁴ < 6e-8 of the value.
const F32_ROUNDING: f64 = 6e-8;

fn assert_rounded(workspace: &Workspace, stacked: &str, traced: &str) {
    let (stacked, traced) = (workspace.matrix(stacked), workspace.matrix(traced));
    assert_eq!(stacked.shape(), traced.shape());
    assert!(traced.iter().any(|x| *x > 0.0));
    for (s, t) in stacked.iter().zip(&traced) {
        assert!((s - t).abs() <= F32_ROUNDING * t.abs(), "{s:e} for {t:e}");
    }
    assert_ne!(stacked, traced, "f64 cannot have come out of f32");
}

#[test]
fn it_gives_what_was_traced_rounded_to_f32() {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render small.toml -o done --samples 64")
        .exits(0);
    let before = workspace.contents("done");
    let ended = workspace.phicam("stack done -o stacked").exits(0);
    for word in ["64 pixels × 24 spots", "`bench`", "f32"] {
        assert!(
            ended.stdout.contains(word),
            "no `{word}` in {}",
            ended.account()
        );
    }
    assert_eq!(workspace.contents("done"), before);
    for file in ["phi.npy", "phi.stderr.npy"] {
        assert_rounded(
            &workspace,
            &format!("stacked/{file}"),
            &format!("done/{file}"),
        );
    }
}

#[test]
fn it_needs_nothing_but_the_frames() {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render tiny.toml -o done --samples 64")
        .exits(0);
    std::fs::rename(workspace.path("done/frames"), workspace.path("carried")).unwrap();
    let _ = workspace.phicam("stack carried -o out").exits(0);
    assert_rounded(&workspace, "out/phi.npy", "done/phi.npy");
}

#[test]
fn it_writes_into_the_run_unless_told_otherwise() {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render tiny.toml -o done --samples 64")
        .exits(0);
    std::fs::rename(workspace.path("done/phi.npy"), workspace.path("traced.npy")).unwrap();
    let _ = workspace.phicam("stack done").exits(0);
    assert_rounded(&workspace, "done/phi.npy", "traced.npy");
}

#[test]
fn an_output_that_cannot_be_written_is_refused() {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render tiny.toml -o done --samples 32")
        .exits(0);
    workspace.write("taken", "x");
    workspace.refuses("stack done -o taken", &["taken is a file, not a folder"]);
}
