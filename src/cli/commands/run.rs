//! `phicam run`: the main job from end to end.

use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Instant;

use super::render::{self, Rendered};
use super::{model, recover_options, recovered, validate};
use crate::cli::args::RunArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::interrupt::stop_flag;
use crate::cli::load_run::read_matrix;
use crate::cli::output;
use crate::cli::progress;
use crate::cli::run_folder::{
    Claim, MODEL, PHI, RECOVERED, REPORT, STDERR, SUMMARY, TAILS, is_of_model, is_of_recovered,
};
use crate::cli::{Outcome, settings};
use crate::film::{self, Stack};
use crate::folder::frame_max;
use crate::jobs::need;
use crate::lab::finding::Describe;
use crate::lab::{
    self, Against, Certainty, GalleryPlan, GalleryTasks, Measured, Noise, RunGallery, RunResults,
    Work,
};
use crate::matrix::Matrix;
use crate::metrics::relative_frobenius;
use crate::model::{Effort, MatrixModel};
use crate::recovery::{Method, Nuisance, Options};
use crate::report;
use crate::scene::Scene;

pub(in crate::cli) fn execute(args: &RunArgs, console: Console) -> Result<Outcome, Failure> {
    let scene = console.load_scene(&args.scene)?;
    let mut clock = Clock::start();
    let plan = settings::plan(&args.trace.paths, args.trace.threads, &scene, console)?;
    let test = settings::test(&args.test, &plan, console)?;
    need::run(&scene, &plan)?;
    let claim = Claim {
        what: "phicam run",
        spots: None,
        replace: args.replace,
    };
    let Rendered {
        mut record,
        traced,
        folder,
    } = render::into_folder(&scene, &plan, &args.trace, &claim, &args.output, console)?;
    let [flux, stderr, tails] = match traced {
        Some(traced) => [traced.flux, traced.stderr, traced.tails],
        None => finished_matrices(&args.output, &scene)?,
    };
    clock.lap("render")?;

    console.say("stacking the frames");
    let stacked = film::stack_within(&args.output, frame_max(&scene))?;
    refuse_unfaithful_frames(&args.output, &stacked, &flux)?;
    clock.lap("stack")?;

    let total: f64 = stacked.phi.sum();
    let share = |m: &Matrix| if total > 0.0 { m.sum() / total } else { 0.0 };
    let bounces = (1..)
        .zip(&stacked.bounces)
        .map(|(n, (_, m))| (n, share(m)))
        .collect();
    let mut results = RunResults {
        version: record.version.clone(),
        plan,
        phi: flux,
        stderr,
        tails,
        bounces,
        model: None,
        z: None,
        agreement: None,
        recovered: Vec::new(),
        picards: Vec::new(),
        gallery: None,
        times: Vec::new(),
        scene,
    };
    if results.scene.hidden().next().is_some() {
        compare_and_recover(&mut results, args, test, &mut clock, console)?;
    }

    console.say("writing the report");
    results.times = clock.laps;
    let path = |name| args.output.join(name);
    let summary = report::summary_json(&results);
    output::write(&path(SUMMARY), &summary)?;
    let page = report::run_html(&results);
    output::write(&path(REPORT), page)?;
    record.vouch(&args.output, [SUMMARY, REPORT])?;
    record.vouch_all(&args.output, MODEL, is_of_model)?;
    record.vouch_all(&args.output, RECOVERED, is_of_recovered)?;
    record.write(&args.output)?;
    drop(folder);
    let text = if args.json {
        summary
    } else {
        format!(
            "{}\n{}\n  everything is in {}, the report in report.html\n",
            report::finding_text(&results.answer().describe()),
            report::finding_text(&results.describe()),
            args.output.display()
        )
    };
    output::print(&text)?;
    Ok(results
        .agreement
        .as_ref()
        .map_or(Outcome::Done, validate::outcome))
}

/// Φcam, its standard error and how far that is to be trusted, of a run that an earlier process has
/// finished.
fn finished_matrices(dir: &Path, scene: &Scene) -> Result<[Matrix; 3], Failure> {
    let read = |name| read_matrix(&dir.join(name), scene);
    Ok([read(PHI)?, read(STDERR)?, read(TAILS)?])
}

/// Model, verdict and recoveries.
fn compare_and_recover(
    results: &mut RunResults,
    args: &RunArgs,
    test: lab::Test,
    clock: &mut Clock,
    console: Console,
) -> Result<(), Failure> {
    let kernel = args.test.kernel;
    console.say("computing the model and comparing");
    let occlusion = args.occlusion.occlusion();
    let integration = args.test.integration;
    let by = (integration, Effort::FINEST);
    let matrices = lab::inverted(&results.scene, kernel, None, occlusion, by)?;
    let measured = Measured::new(&results.phi, &results.stderr, Some(&results.tails));
    let against = Against {
        kernel,
        integration,
        occlusion,
    };
    let scene = &results.scene;
    let what = format!("model of {}", scene.name);
    let found = progress::clocked(console, &what, || {
        lab::validate(scene, measured, against, test)
    })?;
    model::write(&args.output, &matrices, Some(&found.model), Some(&found.z))?;
    results.model = Some(found.model);
    results.z = Some(found.z);
    results.agreement = Some(found.agreement);
    clock.lap("model and validate")?;

    if results.phi.iter().all(|&x| x == 0.0) {
        console.say("no light reached the camera: there is nothing to recover");
        return Ok(());
    }
    console.say("recovering the object");
    let noise = Noise::StandardError(&results.stderr, Certainty::of(&results.plan));
    let options = Options {
        uncertainty: recover_options::uncertainty(&matrices, console),
        ..Options::default()
    };
    let methods = Method::tried(matrices.albedo.len());
    let what = format!("recover {}", results.scene.name);
    let (attempts, picards) = recovered::recovering(console, &what, &methods, |control| {
        lab::recover_with_picards(
            &matrices,
            &results.phi,
            noise,
            Nuisance::default(),
            &methods,
            &options,
            control,
        )
    });
    results.recovered = recovered::collect(attempts, &[], console)?;
    lab::by_trust(&mut results.recovered);
    results.picards = picards?;
    recovered::write(
        &args.output.join(RECOVERED),
        Some(&results.scene),
        &results.recovered,
        &results.picards,
    )?;
    clock.lap("recover")?;

    results.gallery = gallery(results, &matrices, console);
    clock.lap("gallery")?;
    Ok(())
}

/// The object over regularisation and noise; none where there is nothing to show, and where it was
/// stopped.
fn gallery(results: &RunResults, matrices: &MatrixModel, console: Console) -> Option<RunGallery> {
    let tasks = GalleryTasks::new(
        &results.scene,
        matrices,
        (&results.phi, &results.stderr),
        &results.recovered,
        GalleryPlan::of_run(results.plan.seed),
    )?;
    let what = "recovering over regularisation and noise";
    let work = Work::Tasks(tasks.count());
    progress::run(console, what, work, |control| tasks.gallery(control))
}

/// Below 1.2e-38 numbers of f32 lose their digits; a frame whose brightest pixel is fainter than
/// this has such in it.
const FAINTEST: f64 = 1e-30;

/// The frames must hold Φcam to f32 rounding: what is read back is compared with what was traced.
fn refuse_unfaithful_frames(dir: &Path, stacked: &Stack, flux: &Matrix) -> Result<(), Failure> {
    // Rounding to f32 is off by at most 2⁻²⁴ of each entry, so also of the norm.
    let off = relative_frobenius(&stacked.phi, flux).unwrap_or(0.0);
    if off <= f64::from(f32::EPSILON) {
        return Ok(());
    }
    let most = flux.amax();
    if most < FAINTEST {
        let cause =
            format!("a flux of at most {most:.1e} W is too faint for the f32 of the frames");
        return Err(Failure::new(cause, "raise the laser's power in the scene"));
    }
    let cause = format!(
        "the frames in {} differ from what was traced by {off:.1e}",
        dir.display()
    );
    Err(Failure::new(cause, "check the disk, and run again"))
}

/// Wall time of each stage.
struct Clock {
    last: Instant,
    laps: Vec<(String, f64)>,
}

impl Clock {
    fn start() -> Self {
        Self {
            last: Instant::now(),
            laps: Vec::new(),
        }
    }

    /// Ends a stage; the place where Ctrl-C is obeyed after the tracing.
    fn lap(&mut self, stage: &str) -> Result<(), Failure> {
        self.laps
            .push((stage.to_owned(), self.last.elapsed().as_secs_f64()));
        self.last = Instant::now();
        if stop_flag().load(Ordering::Relaxed) {
            let kept = "frames and phi.npy are finished; `phicam validate` and `phicam recover` go on from there";
            return Err(Failure::Stopped(kept.to_owned()));
        }
        Ok(())
    }
}
