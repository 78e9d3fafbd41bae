//! `phicam render`: frames and Φcam.

use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;

use super::batches::Batches;
use crate::cli::args::{RenderArgs, TraceArgs};
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::interrupt::SignalGuard;
use crate::cli::load_run::read_matrix;
use crate::cli::output;
use crate::cli::partial::Kept;
use crate::cli::process::pool;
use crate::cli::run_folder::{Claim, PHI, RunFolder, STDERR, TAILS};
use crate::cli::{Outcome, settings, suspicious};
use crate::film;
use crate::folder::{Record, columns, frame_max};
use crate::jobs::need;
use crate::lab::describe_render;
use crate::matrix::Matrix;
use crate::report;
use crate::scene::Scene;
use crate::transport::{Plan, Traced, block_size};

pub(in crate::cli) fn execute(args: &RenderArgs, console: Console) -> Result<Outcome, Failure> {
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
    let plan = settings::plan(&args.trace.paths, args.trace.threads, &scene, console)?;
    let claim = Claim {
        what: "phicam render",
        spots: (spots.len() < total).then_some(spots),
        replace: args.replace,
    };
    let Rendered { record, traced, .. } =
        into_folder(&scene, &plan, &args.trace, &claim, &args.output, console)?;
    let place = args.output.display();
    let Record {
        finished,
        spots,
        seconds,
        origin,
        ..
    } = &record;
    output::print(&match traced {
        _ if args.json => record.json()?,
        Some(traced) => {
            let found = describe_render(&scene, &plan, &traced, *seconds);
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
                "{place}: {finished} of {spots} spots in {seconds:.1} s ({origin}): {what}\n{bars}"
            )
        }
    })?;
    Ok(Outcome::Done)
}

/// The record of the run in `path` if this very run is there whole, so that nothing is left to do.
pub(super) fn complete(scene: &Scene, plan: &Plan, path: &Path) -> Result<Option<Record>, Failure> {
    let asked = Record::new(scene, plan, 0, 0, 0.0);
    let record = Record::read(path)?
        .filter(|earlier| earlier.same_settings(&asked) && earlier.is_complete());
    let whole = |record: &Record| {
        let frames = || film::stack_within(path, frame_max(scene)).is_ok();
        let matrix = |name: &&str| read_matrix(&path.join(name), scene).is_ok();
        let rendered = |name: &&str| name.starts_with("frames/");
        let mut names = record.files.keys().map(String::as_str).filter(rendered);
        [PHI, STDERR, TAILS].iter().all(matrix)
            && names.all(|name| record.check(path, name).is_ok())
            && frames()
    };
    Ok(record.filter(whole))
}

/// What a render left.
#[derive(Debug)]
pub(super) struct Rendered {
    pub record: Record,
    /// Every column of Φcam, if they were finished by this process.
    pub traced: Option<Traced>,
    /// The folder, which nobody else may write meanwhile.
    pub folder: RunFolder,
}

/// Renders what `claim` says into the run folder `path`, every finished spot safe on disk. What an
/// earlier process has finished of the same is not traced again.
pub(super) fn into_folder(
    scene: &Scene,
    plan: &Plan,
    args: &TraceArgs,
    claim: &Claim,
    path: &Path,
    console: Console,
) -> Result<Rendered, Failure> {
    settings::remark_rounding(&args.paths, plan, console);
    settings::suited(scene, plan)?;
    let pool = pool(args.threads)?;
    let threads = pool.current_num_threads();
    let mut record = Record::new(scene, plan, 0, threads, 0.0);
    need::render(scene, plan)?;
    let mut folder = RunFolder::open(path, scene, &record, claim, console)?;
    if let Some(record) = complete(scene, plan, &folder.path)? {
        // What the earlier process was ended over.
        folder.tidy()?;
        folder.settle()?;
        return Ok(Rendered {
            record,
            traced: None,
            folder,
        });
    }
    console.warn(scene);
    pool.install(|| suspicious::warn(scene, plan, console))?;
    if Record::read(&folder.path)?.is_some_and(|there| there.is_complete()) {
        let place = folder.path.display();
        console.say(format!(
            "warning: {place} does not hold what was written there: it is traced again"
        ));
    }
    let total = scene.laser.spots.len();
    let mut kept: Vec<Option<Matrix>> = vec![None; total];
    let begun = take_finished(&folder, scene, plan, &mut kept);
    let spots = claim.spots.clone().unwrap_or(0..total);
    let todo: Vec<usize> = spots.filter(|s| kept[*s].is_none()).collect();
    let there = kept.iter().flatten().count();
    if there > 0 {
        console.say(format!("going on after {there} of {total} finished spots"));
    }
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
    };
    let guard = SignalGuard::new();
    let stopped = batches.trace(&todo, &begun, &mut kept, console);
    drop(guard);
    let seconds = start.elapsed().as_secs_f64();
    let traced = folder.alone(|| {
        let there = Record::read(&folder.path)?.filter(|there| there.same_settings(&record));
        if let Some(there) = there {
            record.seconds = there.seconds;
            if there.is_complete() && !folder.partial().is_there() {
                // Another process wrote the last spots, and saw these.
                record = there;
                return Ok(None);
            }
        }
        record.seconds += seconds;
        if kept.contains(&None) {
            take_finished(&folder, scene, plan, &mut kept);
        }
        record.finished = kept.iter().flatten().count();
        if !matches!(stopped, Ok(None)) || record.finished < total {
            record.write(&folder.path)?;
            return Ok(None);
        }
        let mut others: Vec<bool> = vec![true; total];
        todo.iter().for_each(|s| others[*s] = false);
        pool.install(|| write_missing_frames(&folder, scene, &record, &kept, &others))?;
        let Some(traced) = gather(scene, std::mem::take(&mut kept)) else {
            return Ok(None);
        };
        let matrices = [&traced.flux, &traced.stderr, &traced.tails];
        folder
            .finish(scene, &mut record, matrices)
            .map(|()| Some(traced))
    })?;
    let Some(blocks) = stopped? else {
        if record.is_complete() {
            folder.settle()?;
        }
        return Ok(Rendered {
            record,
            traced,
            folder,
        });
    };
    let blocks = match blocks {
        0 => String::new(),
        n => format!(" and {n} of {} blocks of the next", plan.budget.blocks),
    };
    Err(Failure::Stopped(format!(
        "{} of {total} spots{blocks} are finished and kept in {}; go on with the same command",
        record.finished,
        path.display()
    )))
}

/// Takes into `kept` the spots that are finished in the folder; returns what is only begun.
fn take_finished(
    folder: &RunFolder,
    scene: &Scene,
    plan: &Plan,
    kept: &mut [Option<Matrix>],
) -> Vec<Kept> {
    let mut begun = Vec::new();
    for file in folder.partial().kept(scene, plan) {
        if !kept[file.spots.clone()].contains(&None) {
            continue;
        }
        let Some(traced) = file.traced(scene, plan) else {
            begun.push(file);
            continue;
        };
        for (spot, column) in file.spots.clone().zip(columns(&traced)) {
            kept[spot].get_or_insert(column);
        }
    }
    begun
}

/// Writes the frames of `others` that are not what was kept of their spots: an earlier process was
/// ended, or the power was cut, before they were safe.
fn write_missing_frames(
    folder: &RunFolder,
    scene: &Scene,
    record: &Record,
    kept: &[Option<Matrix>],
    others: &[bool],
) -> Result<(), Failure> {
    kept.par_iter().enumerate().try_for_each(|(spot, kept)| {
        let missing = |kept: &&Matrix| others[spot] && !folder.has_frame(scene, record, spot, kept);
        match kept.as_ref().filter(missing) {
            Some(kept) => folder.write_frame(scene, record, spot, kept),
            None => Ok(()),
        }
    })
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
