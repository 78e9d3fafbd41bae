//! `phicam validate`: traced against modelled.

use std::path::Path;

use super::args::ValidateArgs;
use super::console::Console;
use super::failure::Failure;
use super::load_run::{read_matrix, read_run, read_stderr};
use super::output;
use super::record::Record;
use super::run_folder::{self, PHI, STDERR};
use super::{Outcome, settings};
use crate::film::{self, Channel, Frame};
use crate::lab::finding::Describe;
use crate::lab::{Agreement, validate};
use crate::matrix::Matrix;
use crate::num::statistics::normal_two_sided;
use crate::report::{self, Panel, Scale};
use crate::scene::Scene;
use crate::store::ensure_writable;

pub(super) fn execute(args: &ValidateArgs, console: Console) -> Result<Outcome, Failure> {
    let (own, record) = read_run(&args.dir, console)?;
    let phi = read_matrix(&args.dir.join(PHI), &own)?;
    let stderr = read_stderr(&args.dir.join(STDERR), &own)?;
    let mut scene = match &args.against {
        Some(other) => console.load_scene(other)?,
        None => own,
    };
    if let Some(by) = args.shift_spots {
        scene = scene.with_shifted_spots(by)?;
    }
    let test = settings::test(&args.test, &record.plan, console)?;
    let kernel = args.test.kernel;
    let integration = args.test.integration;
    let found = validate(&scene, &phi, &stderr, kernel, integration, test)?;
    if !found.agreement.agrees {
        write_map(&args.dir, &scene, &record, &found.z)?;
        console.say(format!(
            "the probability of each entry is mapped in {}, pixels upwards and spots to the right",
            args.dir.join(MAP).join("p.exr").display()
        ));
    }
    output::result(args.json, &found.agreement, || {
        report::finding_text(&found.agreement.describe())
    })?;
    Ok(outcome(&found.agreement))
}

/// Exit code of a verdict.
pub(super) fn outcome(agreement: &Agreement) -> Outcome {
    if agreement.agrees {
        Outcome::Done
    } else {
        Outcome::Disagreed
    }
}

/// Folder of the map.
const MAP: &str = "validation";

/// Writes validation/p.exr (channels `p`, two-sided probability of each entry, and `z`; a row of
/// pixels per matrix row, spots along it) and validation/p.png (−log10 p).
fn write_map(dir: &Path, scene: &Scene, record: &Record, z: &Matrix) -> Result<(), Failure> {
    let folder = dir.join(MAP);
    ensure_writable(&folder)?;
    let (rows, columns) = z.shape();
    // By rows: column + row·columns, as a frame has it.
    let map =
        |f: &dyn Fn(f64) -> f64| -> Vec<f64> { z.transpose().iter().map(|z| f(*z)).collect() };
    let channel = |name: &str, values: Vec<f64>| Channel {
        name: name.to_owned(),
        values: values.into_iter().map(|x| x as f32).collect(),
    };
    let frame = Frame {
        columns,
        rows,
        channels: vec![
            channel("p", map(&normal_two_sided)),
            channel("z", map(&|z| z)),
        ],
        meta: run_folder::meta(scene, record, 0),
    };
    film::exr::write(&folder.join("p.exr"), &frame)?;
    let smallest = f64::MIN_POSITIVE;
    let surprise = map(&|z| -libm::log10(normal_two_sided(z).max(smallest)));
    let scale = Scale::sequential(&surprise);
    let panel = Panel {
        title: "probability of each entry if the model is right".to_owned(),
        size: [columns, rows],
        values: surprise,
        axes: ["spot", "pixel"].map(str::to_owned),
        scale_bar: None,
    };
    let png = report::colour_png(&scene.name, &[panel], &scale, "−log10 p")?;
    output::write(&folder.join("p.png"), &png)
}
