//! Settings without sense: refused before anything is written.

use crate::workspace::Workspace;

/// Every line is refused with its words, in a workspace with `tiny.toml` and a finished run of it
/// in `done`.
fn refuses_each(lines: &[(&str, &[&str])]) {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render tiny.toml -o done --samples 32")
        .exits(0);
    for (line, words) in lines {
        workspace.refuses(line, words);
    }
}

#[test]
fn of_tracing() {
    refuses_each(&[
        (
            "render tiny.toml -o out --samples 0",
            &["--samples 0", "at least 1"],
        ),
        (
            "run tiny.toml -o out --samples 0",
            &["--samples 0", "at least 1"],
        ),
        (
            "run tiny.toml -o out --samples 9999999999999",
            &["--samples 9999999999999", "at most"],
        ),
        ("run tiny.toml -o out --samples -5", &["--samples", "-5"]),
        (
            "render tiny.toml -o out --spots 0..9",
            &["--spots 0..9", "8 spots", "0..8"],
        ),
        (
            "render tiny.toml -o out --spots 7..9",
            &["--spots 7..9", "8 spots"],
        ),
        (
            "render tiny.toml -o out --spots 5..2",
            &["5..2", "--spots", "A < B"],
        ),
        (
            "render tiny.toml -o out --spots 3..3",
            &["3..3", "--spots", "A < B"],
        ),
        (
            "render tiny.toml -o out --threads 0",
            &["--threads", "1 to 4096"],
        ),
        (
            "run tiny.toml -o out --threads 0",
            &["--threads", "1 to 4096"],
        ),
        (
            "run tiny.toml -o out --estimator fastest",
            &["fastest", "independent", "shared"],
        ),
        (
            "render tiny.toml -o out --resume --samples 0",
            &["--samples 0"],
        ),
    ]);
}

#[test]
fn of_the_test() {
    for line in ["run tiny.toml -o out", "validate done"] {
        for level in ["2", "0", "1", "-1", "nan", "inf"] {
            let line = format!("{line} --significance {level}");
            refuses_each(&[(&line, &["--significance", "between 0 and 1"])]);
        }
    }
    refuses_each(&[
        (
            "validate done --kernel true",
            &["true", "physical, published"],
        ),
        ("validate done --shift-spots 1", &["--shift-spots", "DX,DY"]),
        (
            "validate done --shift-spots 50,0",
            &["spot 0 at", "falls off"],
        ),
        (
            "validate done --against nowhere.toml",
            &["nowhere.toml", "cure: "],
        ),
        (
            "validate done --against furnace",
            &["6 × 8", "16 pixels and 3 spots"],
        ),
    ]);
}

#[test]
fn of_recovery() {
    refuses_each(&[
        (
            "recover done --method best",
            &[
                "\"best\"",
                "rdivide-min-norm, tsvd, tikhonov, tikhonov-gradient, joint-unbounded, joint",
            ],
        ),
        (
            "recover done --method pinv,best",
            &["\"best\"", "choose one of"],
        ),
        (
            "recover done --noise -1",
            &["--noise -1", "positive", "cure: "],
        ),
        ("recover done --noise 0", &["--noise 0", "positive"]),
        ("recover done --noise nan", &["--noise NaN", "positive"]),
        ("recover done --rank 0", &["--rank 0", "at least 1"]),
        ("recover done --damping -0.5", &["--damping -0.5", "cure: "]),
        ("recover done --damping nan", &["--damping NaN", "cure: "]),
        ("recover done --memory 0", &["--memory 0", "positive: GiB"]),
        (
            "recover done --tolerance -1",
            &["--tolerance -1", "below 1"],
        ),
        ("recover done --tolerance 1", &["--tolerance 1", "below 1"]),
        (
            "recover done --tolerance nan",
            &["--tolerance NaN", "below 1"],
        ),
        (
            "recover done --method tsvd --rank 100",
            &["rank 100", "choose 1 to"],
        ),
        ("recover done --elements 0", &["--elements", "1 to 1024"]),
        (
            "recover done --noise 0.1 --stderr done/phi.stderr.npy",
            &["--noise", "--stderr"],
        ),
    ]);
}

/// Settings that would change nothing beside others are refused: nobody takes them for heard.
#[test]
fn that_change_nothing() {
    refuses_each(&[
        (
            "locate done --orders 0 --seed 2",
            &["--seed would change nothing", "--orders 0"],
        ),
        (
            "calibrate done --free hidden.yaw --starts 1 --spread 2",
            &["--spread would change nothing", "--starts 1"],
        ),
        (
            "study occluder tiny.toml --samples 0 --sensor ccd",
            &["--sensor would change nothing", "--samples 0"],
        ),
        (
            "study occluder tiny.toml --kinds plate --cells 4",
            &["--cells would change nothing", "random mask"],
        ),
        (
            "study occluder tiny.toml --kinds none --size 2",
            &["--size would change nothing", "no occluder"],
        ),
        (
            "study layout tiny.toml --prior white --length 2",
            &["--length would change nothing", "--prior smooth"],
        ),
    ]);
}

#[test]
fn of_the_command_itself() {
    refuses_each(&[
        ("study weather", &["study", "Usage: phicam"]),
        ("render tiny.toml", &["--output", "Usage: phicam render"]),
        ("scene draw bench", &["draw", "scene"]),
        (
            "render tiny.toml -o out --sample 9",
            &["--sample", "--samples"],
        ),
    ]);
    let workspace = Workspace::new();
    let ended = workspace.phicam("").exits(2);
    assert!(
        ended.stderr.contains("Usage: phicam"),
        "{}",
        ended.account()
    );
}
