//! Checked settings from raw arguments.

use rayon::ThreadPool;

use super::args::{EstimatorName, IntegrationName, KernelName, PathArgs, SamplerName, TestArgs};
use super::failure::Failure;
use super::output::Talk;
use crate::model::Kernel;
use crate::num::stream::Sampling;
use crate::scene::{Scene, SensorModel};
use crate::sensor::Sensor;
use crate::study::{Errors, Integration, Test};
use crate::transport::{Budget, Estimator, Plan, obstacle};

/// The plan that the arguments describe; a rounded number of samples is said.
pub(super) fn plan(args: &PathArgs, talk: Talk) -> Result<Plan, Failure> {
    let (estimator, sampling) = (estimator(args.estimator), sampling(args.sampler));
    let budget = budget("--samples", args.samples, sampling)?;
    if budget.samples() != args.samples {
        talk.say(format!(
            "{} samples rounded up to {}: {} blocks of {}",
            args.samples,
            budget.samples(),
            budget.blocks,
            budget.size
        ));
    }
    Ok(Plan {
        estimator,
        sampling,
        seed: args.seed,
        budget,
    })
}

/// The plan that a file describes: its samples are already whole blocks.
pub(super) fn named(
    estimator: &str,
    sampler: &str,
    seed: u64,
    samples: u64,
) -> Result<Plan, Failure> {
    let estimator = Estimator::ALL
        .into_iter()
        .find(|e| e.name() == estimator)
        .ok_or_else(|| unknown("estimator"))?;
    let sampling = [Sampling::Pcg, Sampling::Sobol]
        .into_iter()
        .find(|s| s.name() == sampler)
        .ok_or_else(|| unknown("sampler"))?;
    let budget = Budget::new(samples, sampling)
        .filter(|b| b.samples() == samples)
        .ok_or_else(|| unknown("division into blocks"))?;
    Ok(Plan {
        estimator,
        sampling,
        seed,
        budget,
    })
}

/// What a file names and this version does not know.
pub(super) fn unknown(what: &str) -> Failure {
    let cause = format!("the settings name a {what} that this version does not know");
    Failure::new(cause, "use the version of phicam that wrote them")
}

/// Refuses an estimator that does not suit the scene.
pub(super) fn suited(scene: &Scene, plan: &Plan) -> Result<(), Failure> {
    let Some(surface) = obstacle(scene, plan) else {
        return Ok(());
    };
    let cause = format!(
        "--estimator {} needs Lambertian surfaces between the walls, and `{surface}` is none",
        plan.estimator.name()
    );
    Err(Failure::new(cause, "use --estimator shared"))
}

/// `samples` in blocks; `flag` names it where that cannot be.
pub(super) fn budget(flag: &str, samples: u64, sampling: Sampling) -> Result<Budget, Failure> {
    Budget::new(samples, sampling).ok_or_else(|| {
        let cause = format!("{flag} {samples} is not a number of paths that can be traced");
        Failure::usage(cause, "use at least 1 and at most 2³²")
    })
}

pub(super) fn estimator(name: EstimatorName) -> Estimator {
    match name {
        EstimatorName::Independent => Estimator::Independent,
        EstimatorName::Shared => Estimator::Shared,
        EstimatorName::Factored => Estimator::Factored,
    }
}

pub(super) fn sampling(name: SamplerName) -> Sampling {
    match name {
        SamplerName::Pcg => Sampling::Pcg,
        SamplerName::Sobol => Sampling::Sobol,
    }
}

/// A significance level strictly between 0 and 1.
pub(super) fn significance(level: f64) -> Result<f64, Failure> {
    if level > 0.0 && level < 1.0 {
        return Ok(level);
    }
    let cause = format!("--significance {level} is not a probability");
    Err(Failure::new(
        cause,
        "use a number between 0 and 1, e.g. 0.001",
    ))
}

/// The threads to work with.
pub(super) fn pool(threads: Option<usize>) -> Result<ThreadPool, Failure> {
    if threads.is_some_and(|n| !(1..=4096).contains(&n)) {
        return Err(Failure::usage(
            "--threads is out of range",
            "use 1 to 4096, or leave it out",
        ));
    }
    Ok(rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .build()?)
}

pub(super) fn kernel(name: KernelName) -> Kernel {
    match name {
        KernelName::Physical => Kernel::Physical,
        KernelName::Published => Kernel::Published,
    }
}

pub(super) fn integration(name: IntegrationName) -> Integration {
    match name {
        IntegrationName::Centres => Integration::Centres,
        IntegrationName::Quadrature => Integration::Quadrature,
    }
}

pub(super) fn sensor_model(name: &str) -> Result<SensorModel, Failure> {
    let found = SensorModel::ALL.into_iter().find(|m| m.name() == name);
    found.ok_or_else(|| {
        let names: Vec<&str> = SensorModel::ALL.iter().map(|m| m.name()).collect();
        let cure = format!("use one of {}", names.join(", "));
        Failure::new(format!("there is no built-in sensor `{name}`"), cure)
    })
}

/// The sensor of a study, and its name: the built-in one asked for, or that of the scene, or the CCD.
pub(super) fn studied_sensor(
    name: Option<&str>,
    scene: &Scene,
) -> Result<(Sensor, String), Failure> {
    Ok(match (name, &scene.sensor) {
        (Some(name), _) => (Sensor::builtin(sensor_model(name)?), name.to_owned()),
        (None, Some(own)) => (Sensor::from_settings(own)?, format!("of {}", scene.name)),
        (None, None) => (
            Sensor::builtin(SensorModel::Ccd),
            SensorModel::Ccd.name().to_owned(),
        ),
    })
}

/// Refuses a `--falloff` that is no distance.
pub(super) fn falloff(given: f64) -> Result<(), Failure> {
    match given > 0.0 && given.is_finite() {
        true => Ok(()),
        false => Err(Failure::new(
            format!("--falloff {given} is no distance"),
            "use a length above 0 in the scene's unit",
        )),
    }
}

/// Paths a block from which on its mean is taken as normally distributed.
const ENOUGH_PATHS: u32 = 4;

/// The test for a run traced by `plan`.
pub(super) fn test(args: &TestArgs, plan: &Plan, talk: Talk) -> Result<Test, Failure> {
    if plan.budget.size < ENOUGH_PATHS {
        talk.say(format!(
            "warning: {} paths a block are few for normal block means: the verdict's significance is only approximate",
            plan.budget.size
        ));
    }
    Ok(Test {
        significance: significance(args.significance)?,
        replicates: plan.budget.blocks,
        errors: Errors::of(plan.estimator),
    })
}
