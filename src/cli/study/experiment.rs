//! `phicam study experiment`: the failed laboratory experiment, re-enacted.

use super::findings::{Findings, traced};
use crate::cli::args::ExperimentArgs;
use crate::cli::expose;
use crate::cli::failure::Failure;
use crate::cli::output::Talk;
use crate::cli::{Outcome, progress, settings};
use crate::num::stream::Sampling;
use crate::report;
use crate::scene::{Scene, SensorModel};
use crate::sensor::Sensor;
use crate::store::ensure_writable;
use crate::study::{self, ExperimentPlan};

pub(super) fn execute(args: &ExperimentArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = Scene::load(&args.scene)?;
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
    if !(args.falloff > 0.0 && args.falloff.is_finite()) {
        let cause = format!("--falloff {} is no distance", args.falloff);
        return Err(Failure::new(
            cause,
            "use a length above 0 in the scene's unit",
        ));
    }
    for (name, list, least) in [
        ("--glares", &args.glares, 0.0),
        ("--exposures", &args.exposures, f64::MIN_POSITIVE),
    ] {
        let grows = list.windows(2).all(|w| w[0] < w[1]);
        let bad = list.iter().find(|x| !(**x >= least && x.is_finite()));
        if let Some(bad) = bad {
            return Err(Failure::new(
                format!("{name} {bad} has no meaning"),
                "use finite numbers: exposures above 0, glares of 0 or more",
            ));
        }
        if !grows {
            let cause = format!("{name} does not grow");
            return Err(Failure::new(
                cause,
                "list its values in growing order, each once",
            ));
        }
    }
    let (sensor, sensor_name) = match (&args.sensor, &scene.sensor) {
        (Some(name), _) => (Sensor::builtin(expose::model(name)?), name.clone()),
        (None, Some(own)) => (Sensor::from_settings(own)?, format!("of {}", scene.name)),
        (None, None) => (
            Sensor::builtin(SensorModel::Ccd),
            SensorModel::Ccd.name().to_owned(),
        ),
    };
    Ok(ExperimentPlan {
        sensor,
        sensor_name,
        samples: args.samples,
        seed: args.seed,
        seeds: args.seeds,
        frames: args.frames,
        glares: args.glares.clone(),
        exposures: args.exposures.clone(),
        falloff: args.falloff,
    })
}
