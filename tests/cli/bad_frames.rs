//! Frames that do not make a matrix.

use phicam::film::{self, Frame};

use crate::workspace::Workspace;

const FIRST: &str = "done/frames/spot-0000.exr";
const THIRD: &str = "done/frames/spot-0002.exr";

/// A finished run without its matrices, so that `stack` would have to write them.
fn with_frames() -> Workspace {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render tiny.toml -o done --samples 32")
        .exits(0);
    for file in ["done/phi.npy", "done/phi.stderr.npy"] {
        std::fs::remove_file(workspace.path(file)).unwrap();
    }
    workspace
}

fn stack_refuses(workspace: &Workspace, words: &[&str]) {
    workspace.refuses("stack done", words);
    workspace.refuses("stack done -o elsewhere", words);
}

/// The frame of spot 2 changed by `change` and written back.
fn with_changed_frame(change: impl FnOnce(&mut Frame)) -> Workspace {
    let workspace = with_frames();
    let path = workspace.path(THIRD);
    let mut frame = film::exr::read(&path).unwrap();
    change(&mut frame);
    film::exr::write(&path, &frame).unwrap();
    workspace
}

#[test]
fn cut_short_anywhere() {
    let workspace = with_frames();
    let whole = workspace.read(THIRD);
    for length in [0, 1, 100, whole.len() / 2, whole.len() - 1] {
        workspace.write(THIRD, &whole[..length]);
        stack_refuses(&workspace, &["spot-0002.exr"]);
    }
    workspace.write(THIRD, "this is no picture");
    stack_refuses(&workspace, &["spot-0002.exr"]);
}

#[test]
fn a_value_that_no_rendering_gives() {
    for (value, name) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf")] {
        for channel in ["flux", "flux.stderr"] {
            let workspace = with_changed_frame(|frame| {
                let found = frame.channels.iter_mut().find(|c| c.name == channel);
                found.unwrap().values[4] = value;
            });
            let words = ["spot-0002.exr", name, channel, "column 1, row 1", "again"];
            stack_refuses(&workspace, &words);
        }
    }
}

#[test]
fn one_missing() {
    let workspace = with_frames();
    std::fs::remove_file(workspace.path(THIRD)).unwrap();
    stack_refuses(&workspace, &["1 of 8 spots", ": 2;", "phicam render"]);
    std::fs::remove_file(workspace.path("done/frames/spot-0007.exr")).unwrap();
    stack_refuses(&workspace, &["2 of 8 spots", ": 2, 7;"]);
}

#[test]
fn none_at_all() {
    let workspace = Workspace::new();
    std::fs::create_dir_all(workspace.path("done/frames")).unwrap();
    stack_refuses(&workspace, &["no frames", "phicam render"]);
    workspace.refuses("stack nowhere", &["nowhere", "give the output folder"]);
}

#[test]
fn of_two_seeds() {
    let workspace = with_frames();
    let _ = workspace
        .phicam("render tiny.toml -o other --samples 32 --seed 2")
        .exits(0);
    let other = workspace.read("other/frames/spot-0002.exr");
    workspace.write(THIRD, other);
    stack_refuses(
        &workspace,
        &["spot-0002.exr", "seed", "1", "2", "one run only"],
    );
}

#[test]
fn of_two_scenes() {
    let workspace = with_frames();
    let grey = workspace.text("tiny.toml").replace("0.8", "0.7");
    workspace.write("grey.toml", grey);
    let _ = workspace
        .phicam("render grey.toml -o other --samples 32")
        .exits(0);
    workspace.write(THIRD, workspace.read("other/frames/spot-0002.exr"));
    stack_refuses(&workspace, &["spot-0002.exr", "scene", "one run only"]);
}

#[test]
fn of_two_sizes() {
    let workspace = with_changed_frame(|frame| {
        std::mem::swap(&mut frame.columns, &mut frame.rows);
    });
    stack_refuses(&workspace, &["spot-0002.exr", "2 × 3", "3 × 2"]);
}

#[test]
fn under_the_name_of_another_spot() {
    let workspace = with_frames();
    let (first, third) = (workspace.read(FIRST), workspace.read(THIRD));
    workspace.write(FIRST, third);
    workspace.write(THIRD, first);
    stack_refuses(&workspace, &["spot-0000.exr", "holds the frame of spot 2"]);
}
