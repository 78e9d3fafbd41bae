//! `phicam study experiment`: the failed laboratory experiment, re-enacted.

use super::findings::{Findings, traced};
use crate::cli::args::ExperimentArgs;
use crate::cli::failure::Failure;
use crate::cli::output::Talk;
use crate::cli::trust;
use crate::cli::{Outcome, progress, settings};
use crate::num::stream::Sampling;
use crate::report;
use crate::scene::Scene;
use crate::store::ensure_writable;
use crate::study::{self, ExperimentPlan};

pub(super) fn execute(args: &ExperimentArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = trust::load(&args.scene)?;
    let plan = plan(args, &scene)?;
    let pool = settings::pool(args.threads)?;
    ensure_writable(&args.output)?;
    talk.warn(&scene);
    let paths = args.samples.saturating_mul(scene.camera.pixels() as u64);
    let bar = progress::steps(talk, "reading photographs");
    let steps = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let work = (&*format!("tracing {}", scene.name), paths);
    let found = traced(talk, &pool, work, |control| {
        study::experiment(&scene, &plan, control, &steps)
    })?;
    bar.finish_and_clear();
    Findings::new("experiment", &found, report::experiment_table(&found))?
        .with("experiment.csv", report::experiment_csv(&found))
        .with("experiment.svg", report::experiment_svg(&found))
        .deliver(&args.output, args.json)?;
    Ok(Outcome::Done)
}

fn plan(args: &ExperimentArgs, scene: &Scene) -> Result<ExperimentPlan, Failure> {
    settings::budget("--samples", args.samples, Sampling::Sobol)?;
    settings::falloff(args.falloff)?;
    let (sensor, sensor_name) = settings::studied_sensor(args.sensor.as_deref(), scene)?;
    let plan = ExperimentPlan {
        sensor,
        sensor_name,
        samples: args.samples,
        seed: args.seed,
        seeds: args.seeds,
        frames: args.frames,
        glares: args.glares.clone(),
        exposures: args.exposures.clone(),
        falloff: args.falloff,
    };
    plan.check()?;
    Ok(plan)
}
