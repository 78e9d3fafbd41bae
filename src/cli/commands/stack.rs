//! `phicam stack`: Φcam from the frames alone.

use std::path::Path;

use serde_json::json;

use crate::cli::Outcome;
use crate::cli::args::StackArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::run_folder::{PHI, RunFolder, SCENE, STDERR};
use crate::film;
use crate::folder::{Record, frame_max};
use crate::jobs::need;
use crate::matrix::npy::NpyError;
use crate::matrix::{Matrix, npy};
use crate::scene::COPIES;

pub(in crate::cli) fn execute(args: &StackArgs, console: Console) -> Result<Outcome, Failure> {
    let record = Record::read(&args.dir)?;
    if let Some(record) = &record {
        record.check_lengths(&args.dir, COPIES)?;
    }
    // Of frames without a scene only the frames themselves say how large they are.
    let stack = match console
        .of_folders()
        .load_any_scene(&args.dir.join(SCENE).to_string_lossy())
    {
        Ok(scene) => {
            need::photographs(&scene, f64::from(scene.max_bounces) + 3.0)?;
            film::stack_within(&args.dir, frame_max(&scene))?
        }
        Err(_) => film::stack(&args.dir)?,
    };
    if let Some(record) = &record {
        record.check_all(&args.dir, SCENE)?;
    }
    let dir = args.output.as_ref().unwrap_or(&args.dir);
    let _lock = RunFolder::lock(dir, "phicam stack")?;
    let path = dir.join(PHI);
    let there = path.exists();
    let precision = if there {
        refuse_other(&path, &stack.phi)?;
        "left as it is: the frames agree with it, and it holds more digits than they do"
    } else {
        npy::write(&dir.join(STDERR), &stack.stderr)?;
        npy::write(&path, &stack.phi)?;
        if let Some(mut record) = record.filter(|_| args.output.is_none()) {
            record.vouch(dir, [PHI, STDERR])?;
            record.write(dir)?;
        }
        "to the f32 precision of the frames"
    };
    let (pixels, spots) = stack.phi.shape();
    let scene = &stack.run.scene_name;
    let text = if args.json {
        output::json(&json!({
            "phi": path.to_string_lossy(),
            "pixels": pixels,
            "spots": spots,
            "scene": scene,
            "written": !there,
        }))?
    } else {
        let place = path.display();
        format!("{place}: {pixels} pixels × {spots} spots of scene `{scene}`, {precision}\n")
    };
    output::print(&text)?;
    Ok(Outcome::Done)
}

/// Refuses to go on where the Φcam in `path` does not round to `stacked`: it is not overwritten.
fn refuse_other(path: &Path, stacked: &Matrix) -> Result<(), Failure> {
    let cure = "give another folder with -o, or remove it";
    let failure = |e: NpyError| Failure::new(e.to_string(), cure);
    let rounds = npy::shape(path).map_err(failure)? == stacked.shape()
        && npy::read(path)
            .map_err(failure)?
            .iter()
            .zip(stacked.iter())
            .all(|(a, b)| f64::from(*a as f32) == *b);
    if !rounds {
        let cause = format!(
            "{} is there already and is not what the frames hold",
            path.display()
        );
        return Err(Failure::new(cause, cure));
    }
    Ok(())
}
