//! `phicam render`: frames and Φcam.

use std::ops::Range;
use std::path::Path;
use std::time::Instant;

use super::args::{RenderArgs, TraceArgs};
use super::batches::Batches;
use super::console::Console;
use super::failure::Failure;
use super::interrupt::SignalGuard;
use super::load_run::read_matrix;
use super::output;
use super::process::pool;
use super::record::Record;
use super::run_folder::{PHI, Resume, RunFolder, STDERR, TAILS};
use super::{Outcome, need, settings, suspicious};
use crate::film;
use crate::lab::describe_render;
use crate::matrix::Matrix;
use crate::report;
use crate::scene::Scene;
use crate::transport::{Plan, Traced, block_size};

pub(super) fn execute(args: &RenderArgs, console: Console) -> Result<Outcome, Failure> {
    let scene = console.load_scene(&args.scene)?;
    let total = scene.laser.spots.len();
    let spots = args.spots.clone().unwrap_or(0..total);
    if spots.end > total {
        let cause = format!(
            "--spots {}..{} asks for more than the {total} spots there are",
            spots.start, spots.end
        );
        return Err(Failure::new(
            cause,
            format!("use a range within 0..{total}"),
        ));
    }
    let resume = match (args.resume, spots.len() < total) {
        (true, _) => Resume::Finished,
        (false, true) => Resume::OtherSpots,
        (false, false) => Resume::Nothing,
    };
    let plan = settings::plan(&args.trace.paths)?;
    let complete = match resume {
        Resume::Nothing => None,
        _ => complete(&scene, &plan, &args.output)?,
    };
    let (record, traced) = match complete {
        Some(record) => {
            // What the earlier process was killed over.
            RunFolder::at(&args.output).tidy()?;
            (record, None)
        }
        None => {
            let rendered = into_folder(
                &scene,
                &plan,
                &args.trace,
                spots,
                resume,
                &args.output,
                console,
            )?;
            (rendered.record, rendered.phi)
        }
    };
    let place = args.output.display();
    let Record {
        finished,
        spots,
        seconds,
        plan,
        ..
    } = &record;
    output::print(&match traced {
        _ if args.json => output::json(&record)?,
        Some(traced) => {
            let found = describe_render(&scene, plan, &traced, *seconds);
            let table = report::finding_text(&found);
            format!(
                "{table}\n  {place}: {finished} of {spots} spots, frames, phi.npy, phi.stderr.npy and phi.tails.npy\n"
            )
        }
        None => {
            let what = if finished == spots {
                "frames, phi.npy, phi.stderr.npy and phi.tails.npy"
            } else {
                "frames; phi.npy follows when every spot is there"
            };
            let bars = record.error_bars();
            format!(
                "{place}: {finished} of {spots} spots in {seconds:.1} s ({plan}): {what}\n{bars}"
            )
        }
    })?;
    Ok(Outcome::Done)
}

/// The record of the run in `path` if this very run is there whole, so that nothing is left to do.
pub(super) fn complete(scene: &Scene, plan: &Plan, path: &Path) -> Result<Option<Record>, Failure> {
    let asked = Record::new(scene, plan, 0, 0, 0.0);
    let record = Record::read(path)?
        .filter(|earlier| earlier.same_settings(&asked) && earlier.finished == earlier.spots);
    let whole = || {
        [PHI, STDERR, TAILS]
            .iter()
            .all(|name| read_matrix(&path.join(name), scene).is_ok())
            && film::stack(path).is_ok()
    };
    Ok(record.filter(|_| whole()))
}

/// What a render left.
#[derive(Debug)]
pub(super) struct Rendered {
    pub record: Record,
    /// Every column of Φcam, if all spots are finished.
    pub phi: Option<Traced>,
}

/// Renders `spots` into the run folder `path`, every finished spot safe on disk.
pub(super) fn into_folder(
    scene: &Scene,
    plan: &Plan,
    args: &TraceArgs,
    spots: Range<usize>,
    resume: Resume,
    path: &Path,
    console: Console,
) -> Result<Rendered, Failure> {
    settings::remark_rounding(&args.paths, plan, console);
    settings::suited(scene, plan)?;
    let pool = pool(args.threads)?;
    let threads = pool.current_num_threads();
    let mut record = Record::new(scene, plan, 0, threads, 0.0);
    if resume == Resume::Finished
        && let Some(earlier) = Record::read(path)?
    {
        record.seconds = earlier.seconds;
    }
    need::render(scene, plan)?;
    let folder = RunFolder::open(path, scene, &record, resume, console)?;
    console.warn(scene);
    pool.install(|| suspicious::warn(scene, plan, console))?;
    let total = scene.laser.spots.len();
    let there = |s: usize| match resume {
        Resume::Finished => true,
        Resume::OtherSpots => !spots.contains(&s),
        Resume::Nothing => false,
    };
    let mut kept: Vec<Option<Matrix>> = (0..total)
        .map(|s| there(s).then(|| folder.kept(s, scene, &record)).flatten())
        .collect();
    let todo: Vec<usize> = spots.filter(|s| kept[*s].is_none()).collect();
    let points = block_size(scene, plan) as u64;
    if points > u64::from(plan.budget.size) {
        console.say(format!(
            "a block takes {points} points in place of {}, so that every texture cell has its share",
            plan.budget.size
        ));
    }
    let start = Instant::now();
    let batches = Batches {
        scene,
        plan,
        folder: &folder,
        record: &record,
        pool: &pool,
        resume: resume == Resume::Finished,
    };
    let guard = SignalGuard::new();
    let stopped = batches.trace(&todo, &mut kept, console);
    drop(guard);
    record.seconds += start.elapsed().as_secs_f64();
    record.finished = kept.iter().flatten().count();
    let phi = match stopped {
        Ok(None) => gather(scene, kept),
        _ => None,
    };
    if let Some(traced) = &phi {
        let matrices = [&traced.flux, &traced.stderr, &traced.tails];
        folder.finish(&mut record, matrices)?;
    } else {
        note(&record, path)?;
    }
    let Some(blocks) = stopped? else {
        return Ok(Rendered { record, phi });
    };
    let blocks = match blocks {
        0 => String::new(),
        n => format!(" and {n} of {} blocks of the next", plan.budget.blocks),
    };
    Err(Failure::Stopped(format!(
        "{} of {total} spots{blocks} are finished and kept in {}; go on with `phicam render --resume` and the same settings",
        record.finished,
        path.display()
    )))
}

/// Writes how far a run has come, unless another process has finished it meanwhile.
fn note(record: &Record, path: &Path) -> Result<(), Failure> {
    let whole = |there: &Record| there.same_settings(record) && there.finished == there.spots;
    if Record::read(path)?.is_some_and(|there| whole(&there)) {
        Ok(())
    } else {
        record.write(path)
    }
}

/// All columns from what was kept of each spot, if every spot is there.
fn gather(scene: &Scene, kept: Vec<Option<Matrix>>) -> Option<Traced> {
    let orders = scene.max_bounces as usize;
    let kept: Vec<Matrix> = kept.into_iter().collect::<Option<_>>()?;
    let pick =
        |n: usize| Matrix::from_columns(&kept.iter().map(|m| m.column(n)).collect::<Vec<_>>());
    let bounces: Vec<Matrix> = (0..orders).map(pick).collect();
    // The same order of additions as in the tracer, so that the bits are the same.
    let flux = Matrix::from_fn(kept[0].nrows(), kept.len(), |p, l| {
        bounces.iter().map(|b| b[(p, l)]).sum()
    });
    let mut traced = Traced {
        flux,
        stderr: pick(orders),
        tails: pick(orders + 1),
        bounces,
    };
    traced.flag_neighbours();
    Some(traced)
}
