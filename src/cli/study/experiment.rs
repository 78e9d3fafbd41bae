//! `phicam study experiment`: the failed laboratory experiment, re-enacted.

use std::sync::OnceLock;

use super::findings::Findings;
use super::job::{Count, Job};
use crate::cli::args::ExperimentArgs;
use crate::cli::failure::Failure;
use crate::cli::{Outcome, settings};
use crate::num::stream::Sampling;
use crate::report::{self, Asked};
use crate::scene::Scene;
use crate::study::{ExperimentPlan, ExperimentTasks};

pub(super) fn job(
    args: &ExperimentArgs,
    scene: &Scene,
    asked: Asked,
) -> Result<Job<ExperimentTasks>, Failure> {
    Ok(Job {
        division: ExperimentTasks::new(scene, plan(args, scene)?),
        ground: OnceLock::new(),
        asked,
        what: format!("photographs of {}", scene.name),
        count: Count::Tasks,
        threads: args.threads,
        output: args.output.clone(),
        json: args.json,
        findings: |found| {
            let findings = Findings::new(
                "experiment",
                found,
                report::experiment_table(found),
                report::experiment_account(found),
            )?
            .with("experiment.csv", report::experiment_csv(found))
            .with("experiment.svg", report::experiment_svg(found));
            Ok((findings, Outcome::Done))
        },
    })
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
