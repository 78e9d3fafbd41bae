//! Folders that cannot be written to, or that hold something else than they should.

use phicam::matrix::{Matrix, npy};

use crate::workspace::Workspace;

const QUICK: &str = "render tiny.toml -o done --samples 32";

fn with_run() -> Workspace {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam(QUICK).exits(0);
    workspace
}

/// Both readers of a run refuse `done` as it is.
fn readers_refuse(workspace: &Workspace, words: &[&str]) {
    for command in ["validate done", "recover done", "--quiet recover done"] {
        workspace.refuses(command, words);
    }
}

#[test]
fn a_file_in_the_way_of_the_output() {
    let workspace = Workspace::with_scenes();
    workspace.write("taken", "something else");
    for command in ["run", "render", "model"] {
        for output in ["taken", "taken/below", "taken/far/below"] {
            let line = format!("{command} tiny.toml -o {output}");
            workspace.refuses(&line, &["taken is a file, not a folder", "choose another"]);
        }
    }
    workspace.refuses("scene export bench -o taken/x.toml", &["taken", "folder"]);
    workspace.refuses("scene show bench -o nowhere/x.svg", &["nowhere", "create"]);
}

#[test]
fn a_file_in_the_way_of_a_folder_inside_the_output() {
    let workspace = Workspace::with_scenes();
    std::fs::create_dir(workspace.path("out")).unwrap();
    for inside in ["frames", "partial", "model", "recovered"] {
        let file = format!("out/{inside}");
        workspace.write(&file, "something else");
        let words = [file.as_str(), "is a file, not a folder"];
        workspace.refuses("run tiny.toml -o out", &words);
        std::fs::remove_file(workspace.path(&file)).unwrap();
    }
    for inside in ["report.html", "summary.json", "phi.npy"] {
        let folder = format!("out/{inside}");
        std::fs::create_dir(workspace.path(&folder)).unwrap();
        workspace.refuses("run tiny.toml -o out", &[inside]);
        std::fs::remove_dir(workspace.path(&folder)).unwrap();
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_system_that_takes_nothing() {
    let workspace = Workspace::with_scenes();
    for command in ["run", "render", "model"] {
        let line = format!("{command} tiny.toml -o /proc/phicam/out");
        workspace.refuses(&line, &["cannot write /proc/phicam", "choose another"]);
    }
}

#[test]
fn the_folder_of_another_scene() {
    let workspace = with_run();
    let words = ["done", "another scene", "choose another folder", "cure: "];
    for command in ["run", "render", "model"] {
        workspace.refuses(&format!("{command} small.toml -o done"), &words);
    }
    workspace.refuses("run furnace -o done", &words);
    workspace.refuses("render small.toml -o done --resume", &words);
    // A folder of matrices only knows its scene, too.
    let _ = workspace.phicam("model tiny.toml -o matrices").exits(0);
    for command in ["run", "render", "model"] {
        let line = format!("{command} small.toml -o matrices");
        workspace.refuses(&line, &["matrices", "another scene"]);
    }
    let _ = workspace
        .phicam("render tiny.toml -o matrices --samples 32")
        .exits(0);
}

#[test]
fn a_folder_of_unknown_origin() {
    let workspace = with_run();
    std::fs::remove_file(workspace.path("done/run.json")).unwrap();
    let words = ["done", "run.json", "choose another folder"];
    workspace.refuses(QUICK, &words);
    workspace.write("done/run.json", "{ \"version\": ");
    workspace.refuses(QUICK, &["run.json", "damaged"]);
    std::fs::create_dir(workspace.path("foreign")).unwrap();
    workspace.write("foreign/scene.toml", "film = \"a comedy\"\n");
    workspace.refuses(
        "render tiny.toml -o foreign",
        &["foreign", "scene.toml", "choose another folder"],
    );
}

#[test]
fn another_seed_does_not_go_on_with_a_run() {
    let workspace = with_run();
    let words = ["other settings", "seed 1", "another folder"];
    workspace.refuses(&format!("{QUICK} --seed 2 --resume"), &words);
    workspace.refuses(&format!("{QUICK} --seed 2 --spots 0..2"), &words);
    workspace.refuses(&format!("{QUICK} --sampler pcg --resume"), &words);
}

#[test]
fn no_run_at_all() {
    let workspace = Workspace::new();
    std::fs::create_dir(workspace.path("done")).unwrap();
    readers_refuse(&workspace, &["not the folder of a run", "phicam render"]);
    workspace.refuses("validate nowhere", &["nowhere", "not the folder of a run"]);
    workspace.write("file", "x");
    workspace.refuses("recover file", &["file", "not the folder of a run"]);
}

#[test]
fn an_unfinished_run() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam(&format!("{QUICK} --spots 0..3")).exits(0);
    readers_refuse(&workspace, &["3 of 8 spots", "the same command"]);
}

#[test]
fn an_edited_scene() {
    let workspace = with_run();
    let scene = workspace.text("done/scene.toml");
    workspace.write("done/scene.toml", scene.replace("0.8", "0.7"));
    let words = ["scene.toml", "not the scene", "restore"];
    readers_refuse(&workspace, &words);
    // A comment changes nothing that was rendered.
    workspace.write("done/scene.toml", scene + "\n# a remark\n");
    let _ = workspace.phicam("recover done --method joint").exits(0);
}

#[test]
fn a_nan_in_the_matrix() {
    for file in ["done/phi.npy", "done/phi.stderr.npy"] {
        let workspace = with_run();
        let mut phi = workspace.matrix(file);
        phi[(4, 7)] = f64::NAN;
        npy::write(&workspace.path(file), &phi).unwrap();
        readers_refuse(&workspace, &[file, "NaN", "4", "7"]);
    }
}

#[test]
fn a_negative_standard_error() {
    let workspace = with_run();
    let file = "done/phi.stderr.npy";
    let mut stderr = workspace.matrix(file);
    stderr[(4, 7)] *= -1.0;
    npy::write(&workspace.path(file), &stderr).unwrap();
    readers_refuse(&workspace, &[file, "negative", "pixel 4, spot 7"]);
}

#[test]
fn a_matrix_of_another_shape() {
    for file in ["done/phi.npy", "done/phi.stderr.npy"] {
        let workspace = with_run();
        let phi = workspace.matrix(file);
        for wrong in [
            phi.transpose(),
            phi.columns(0, 7).into(),
            Matrix::zeros(1, 1),
        ] {
            npy::write(&workspace.path(file), &wrong).unwrap();
            let found = format!("{} × {}", wrong.nrows(), wrong.ncols());
            readers_refuse(&workspace, &[&found, "6 ", "8 "]);
        }
        workspace.write(file, "no matrix");
        readers_refuse(&workspace, &[file]);
        std::fs::remove_file(workspace.path(file)).unwrap();
        readers_refuse(&workspace, &[file]);
    }
}
