//! `--json`: standard output is one JSON text, and it says what is in the files.

use serde_json::{Value, json};

use crate::workspace::Workspace;

fn said(workspace: &Workspace, line: &str, code: i32) -> Value {
    let ended = workspace.phicam(line).exits(code);
    serde_json::from_str(&ended.stdout).unwrap_or_else(|e| panic!("{e}: {}", ended.account()))
}

#[test]
fn what_is_stacked_modelled_and_checked() {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render tiny.toml -o done --samples 32")
        .exits(0);
    let stacked = said(&workspace, "stack done -o stacked --json", 0);
    assert_eq!([&stacked["pixels"], &stacked["spots"]], [6, 8]);
    assert_eq!(
        [&stacked["scene"], &stacked["written"]],
        [&json!("bench"), &json!(true)]
    );
    assert!(workspace.path(stacked["phi"].as_str().unwrap()).is_file());
    // Φcam with more digits is there.
    let again = said(&workspace, "stack done --json", 0);
    assert_eq!(again["written"], false);

    let model = said(&workspace, "model tiny.toml -o done --json", 0);
    for name in ["g12", "g23", "phi"] {
        let (rows, columns) = workspace.matrix(&format!("done/model/{name}.npy")).shape();
        assert_eq!(model[name], json!([rows, columns]), "{name}");
    }
    assert_eq!(model["last_refinement"], Value::Null);
    let line = "model tiny.toml -o done --json --integration quadrature";
    let change = said(&workspace, line, 0)["last_refinement"].as_f64();
    assert!(change.is_some_and(|c| c > 0.0 && c < 1e-6), "{change:?}");

    let scene = said(&workspace, "scene check tiny.toml --json", 0);
    assert_eq!(
        scene["surfaces"],
        json!({ "relay": ["wall"], "hidden": ["object"], "occluder": [] })
    );
    assert_eq!(scene["pixels"], json!([3, 2]));
    let few = "48 photographed values (pixels × spots) for 64 elements: fewer than what is to be recovered";
    assert_eq!(scene["suspicious"], json!([few]));
    assert_eq!(
        [&scene["scene"], &scene["ok"]],
        [&json!("tiny.toml"), &json!(true)]
    );
    let list = said(&workspace, "scene list --json", 0);
    let words = workspace.phicam("scene list").exits(0).stdout;
    assert_eq!(list.as_array().unwrap().len(), words.lines().count());
    assert_eq!(list[0]["name"], "bench");
}

#[test]
fn a_wrong_scene_has_its_verdict() {
    let workspace = Workspace::new();
    workspace.write("bad.toml", "name = 3\n");
    for name in ["bad.toml", "there_is_none.toml"] {
        let ended = workspace
            .phicam(&format!("scene check {name} --json"))
            .exits(2);
        let verdict: Value = serde_json::from_str(&ended.stdout).unwrap();
        let error = verdict["error"].as_str().unwrap();
        assert_eq!(
            verdict,
            json!({ "scene": name, "ok": false, "error": error })
        );
        // Standard error says the same.
        assert!(error.contains(name) && error.contains("cure: "), "{error}");
        assert_eq!(ended.stderr.trim_end(), format!("error: {error}"));
    }
}

#[test]
fn what_is_planned_computed_missing_merged_and_removed() {
    let workspace = Workspace::with_scenes();
    let line = "plan tiny.toml -o job --estimator shared --samples 64 --shards 4 --json";
    let blocks = said(&workspace, line, 0)["blocks"].as_u64().unwrap();
    let shard = said(&workspace, "shard job --index 1 --json", 0);
    assert_eq!(shard["blocks"], json!([blocks / 4, blocks / 2]));
    let files = shard["computed"].as_array().unwrap();
    assert_eq!(files.len(), 1);
    assert!(workspace.path(files[0].as_str().unwrap()).is_file());
    let again = said(&workspace, "shard job --index 1 --json", 0);
    assert_eq!(again["computed"], json!([]));

    let status = said(&workspace, "status job --json", 3);
    assert_eq!(status["missing"], json!([0, 2, 3]));
    assert_eq!(
        [&status["shards"], &status["complete"]],
        [&json!(4), &json!(false)]
    );
    for index in [0, 2, 3] {
        let _ = workspace
            .phicam(&format!("shard job --index {index}"))
            .exits(0);
    }
    let status = said(&workspace, "status job --json", 0);
    assert_eq!(
        [&status["missing"], &status["complete"]],
        [&json!([]), &json!(true)]
    );
    assert_eq!(
        said(&workspace, "merge job -o out --json", 0),
        workspace.json("out/run.json")
    );

    let would = said(&workspace, "clean job --shards --dry-run --json", 0);
    let there = said(&workspace, "clean job --shards --json", 0);
    assert_eq!(
        [&would["removed"], &there["removed"]],
        [&json!(false), &json!(true)]
    );
    assert_eq!(
        [&would["files"], &would["bytes"]],
        [&there["files"], &there["bytes"]]
    );
    assert_eq!(there["files"].as_array().unwrap().len(), 4);
    assert!(!workspace.path(files[0].as_str().unwrap()).exists());
}
