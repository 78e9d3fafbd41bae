//! `phicam validate`: traced against modelled.

use std::path::{Path, PathBuf};

use super::beside::{Beside, PhotographSize, certainty};
use super::mask::{read_mask, refuse_clipped};
use crate::cli::args::ValidateArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::load_run::{read_left_out, read_photographs, read_run_or_scene, read_stderr};
use crate::cli::output;
use crate::cli::progress::clocked;
use crate::cli::run_folder::{PHI, STDERR, VALIDATION};
use crate::cli::{Outcome, settings};
use crate::film::{self, Channel, Frame};
use crate::folder::Record;
use crate::jobs::need;
use crate::lab::finding::Describe;
use crate::lab::{Against, Agreement, Measured, Test, validate};
use crate::matrix::Matrix;
use crate::num::statistics::normal_two_sided;
use crate::report::{self, Panel, Scale};
use crate::scene::Scene;
use crate::store::{ensure_writable, flush};

pub(in crate::cli) fn execute(args: &ValidateArgs, console: Console) -> Result<Outcome, Failure> {
    let given = given(args, console)?;
    let mut scene = given.scene;
    if let Some(by) = args.shift_spots {
        scene = scene.with_shifted_spots(by).map_err(|e| {
            let cause = format!("--shift-spots {},{}: {}", by[0], by[1], e.cause);
            Failure::new(cause, "give a shift that leaves every spot on the wall")
        })?;
    }
    need::verdict(&scene)?;
    let size = PhotographSize::of_scene(&scene);
    let own = given.run.as_ref();
    let gains = own.map(|(_, record)| args.beside.of_photographs(&record.origin, console));
    let nuisance = gains.as_ref().unwrap_or(&args.beside);
    let beside = Beside::read(nuisance, given.left_out, &size)?;
    let measured = Measured {
        phi: &given.phi,
        stderr: &given.stderr,
        beside: beside.nuisance(nuisance),
    };
    let against = Against {
        kernel: args.test.kernel,
        integration: args.test.integration,
        occlusion: args.occlusion.occlusion(),
    };
    let what = format!("model of {}", scene.name);
    let found = clocked(console, &what, || {
        validate(&scene, measured, against, given.test)
    })?;
    output::result(args.json, &found.agreement, || {
        report::finding_text(&found.agreement.describe())
    })?;
    if let (Some((dir, record)), Outcome::Disagreed) = (&given.run, outcome(&found.agreement)) {
        write_map(dir, &scene, record, &found.z)?;
        console.say(format!(
            "the probability of each entry is mapped in {}, pixels upwards and spots to the right",
            dir.join(VALIDATION).join("p.exr").display()
        ));
    }
    Ok(outcome(&found.agreement))
}

/// What is to be tested.
struct Given {
    /// The scene of --against, or that of the run.
    scene: Scene,
    phi: Matrix,
    stderr: Matrix,
    left_out: Option<Matrix>,
    test: Test,
    /// The run whose matrix it is.
    run: Option<(PathBuf, Record)>,
}

/// Reads the matrix of a run, or that of --phi.
fn given(args: &ValidateArgs, console: Console) -> Result<Given, Failure> {
    let run = match &args.dir {
        None => None,
        Some(dir) => {
            let (scene, record) = read_run_or_scene(dir, args.phi.as_deref(), console)?;
            Some((dir, scene, record))
        }
    };
    let other = args.against.as_deref();
    let other = other.map(|s| console.load_scene(s)).transpose()?;
    match (&args.phi, &args.stderr, run) {
        (Some(phi), Some(stderr), run) => {
            let own = run.map(|(_, scene, _)| scene);
            let scene = other.or(own).ok_or_else(|| {
                let cause = "nothing says of which scene the matrix is";
                Failure::usage(cause, "give the folder of a run, or --against SCENE")
            })?;
            if args.left_out.is_none() {
                refuse_clipped(phi, &scene, "")?;
            }
            let left_out = left_out(args, None, &scene)?;
            Ok(Given {
                phi: read_photographs(phi, left_out.as_ref(), &scene)?,
                stderr: read_stderr(stderr, left_out.as_ref(), &scene)?,
                left_out,
                test: settings::test_of_matrix(&args.test, args.errors, args.replicates)?,
                run: None,
                scene,
            })
        }
        (_, _, Some((dir, scene, Some(record)))) => {
            let noise = known_noise(dir, &record)?;
            if !args.beside.free_scale {
                refuse_unscaled(dir, &record)?;
            }
            let left_out = left_out(args, read_left_out(dir, &scene)?, &scene)?;
            Ok(Given {
                phi: read_photographs(&dir.join(PHI), left_out.as_ref(), &scene)?,
                stderr: read_stderr(&noise, left_out.as_ref(), &scene)?,
                left_out,
                test: match record.origin.plan() {
                    Some(plan) => settings::test(&args.test, plan, console)?,
                    None => {
                        let known = certainty(&record.origin, args.beside.background);
                        Test {
                            known,
                            ..settings::test_of_matrix(&args.test, known.errors, None)?
                        }
                    }
                },
                scene: match other {
                    Some(other) => other,
                    None => scene.known()?,
                },
                run: Some((dir.clone(), record)),
            })
        }
        _ => {
            let cure = "give the folder of a run, or --phi FILE --stderr FILE --against SCENE";
            Err(Failure::usage("there is nothing to validate", cure))
        }
    }
}

/// Refuses photographs whose size is not that of light.
fn refuse_unscaled(dir: &Path, record: &Record) -> Result<(), Failure> {
    match record.origin.unscaled() {
        None => Ok(()),
        Some(unit) => Err(Failure::new(
            format!(
                "the photographs of {} are in {unit}, and the model is in W",
                dir.display()
            ),
            "say --free-scale, or import them with `watts`, what one of these is in W",
        )),
    }
}

/// Entries that do not count: those whose standard error is not to be trusted, and those of
/// --left-out.
fn left_out(
    args: &ValidateArgs,
    tails: Option<Matrix>,
    scene: &Scene,
) -> Result<Option<Matrix>, Failure> {
    let Some(file) = &args.left_out else {
        return Ok(tails);
    };
    let own = read_mask(file, &PhotographSize::of_scene(scene))?;
    let both = |tails: Matrix| tails.zip_map(&own, |a, b| a.abs() + b.abs());
    Ok(Some(tails.map_or_else(|| own.clone(), both)))
}

/// The file of a run's standard errors; photographs of unknown noise have none.
fn known_noise(dir: &Path, record: &Record) -> Result<PathBuf, Failure> {
    let path = dir.join(STDERR);
    if record.is_imported() && !path.exists() {
        let cause = format!(
            "nothing is known of the noise of the photographs in {}",
            dir.display()
        );
        let cure =
            "import several photographs of each spot (`repeats`), or give `noise` in the list";
        return Err(Failure::new(cause, cure));
    }
    Ok(path)
}

/// Exit code of a verdict.
pub(super) fn outcome(agreement: &Agreement) -> Outcome {
    if !agreement.evidence {
        Outcome::NoEvidence
    } else if agreement.agrees {
        Outcome::Done
    } else {
        Outcome::Disagreed
    }
}

/// Writes validation/p.exr (channels `p`, two-sided probability of each entry, and `z`; a row of
/// pixels per matrix row, spots along it) and validation/p.png (−log10 p).
fn write_map(dir: &Path, scene: &Scene, record: &Record, z: &Matrix) -> Result<(), Failure> {
    let folder = dir.join(VALIDATION);
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
        meta: record.meta(scene, 0),
    };
    film::exr::write(&folder.join("p.exr"), &frame)?;
    flush(&folder)?;
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
