//! `phicam study`: experiments around a scene.

mod brdf;
mod coverage;
mod experiment;
mod findings;
mod indicator;
mod noise;

use super::args::{BudgetArgs, ConvergenceArgs, PowerArgs, StudyArgs, StudyCommand, ToleranceArgs};
use super::failure::Failure;
use super::output::Talk;
use super::trust;
use super::{Outcome, progress, settings};
use crate::num::stream::Sampling;
use crate::report;
use crate::scene::Scene;
use crate::store::ensure_writable;
use crate::study::{self, BudgetPlan, PowerPlan, error_budget};
use crate::transport::{Estimator, Plan};
use findings::{Findings, traced};

pub(in crate::cli) fn execute(args: &StudyArgs, talk: Talk) -> Result<Outcome, Failure> {
    match &args.command {
        StudyCommand::Budget(a) => budget(a, talk),
        StudyCommand::Power(a) => power(a, talk),
        StudyCommand::Tolerance(a) => tolerance(a, talk),
        StudyCommand::Convergence(a) => convergence(a, talk),
        StudyCommand::Noise(a) => noise::execute(a, talk),
        StudyCommand::Indicator(a) => indicator::execute(a, talk),
        StudyCommand::Brdf(a) => brdf::execute(a, talk),
        StudyCommand::Coverage(a) => coverage::execute(a, talk),
        StudyCommand::Experiment(a) => experiment::execute(a, talk),
    }
}

/// Paths that `scene` needs: `shared` of them per pixel and `independent` ones per pixel and spot. A number too large to count
/// is as good as any other for a progress bar; the study itself refuses it.
fn paths(scene: &Scene, shared: u64, independent: u64) -> u64 {
    independent
        .saturating_mul(scene.laser.spots.len() as u64)
        .saturating_add(shared)
        .saturating_mul(scene.camera.pixels() as u64)
}

/// The sum of numbers of paths, each of which can be traced.
fn sum(flag: &str, samples: &[u64]) -> Result<u64, Failure> {
    let mut all = 0u64;
    for &n in samples {
        settings::budget(flag, n, Sampling::Sobol)?;
        all = all.saturating_add(n);
    }
    Ok(all)
}

fn budget(args: &BudgetArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = trust::load(&args.scene)?;
    let pool = settings::pool(args.threads)?;
    let total = paths(
        &scene,
        sum("--samples", &[args.samples])?,
        sum("--run-samples", &[args.run_samples])?,
    );
    ensure_writable(&args.output)?;
    talk.warn(&scene);
    let plan = BudgetPlan {
        seed: args.seed,
        ensemble_samples: args.samples,
        run_samples: args.run_samples,
    };
    let work = (&*format!("budget of {}", scene.name), total);
    let found = traced(talk, &pool, work, |control| {
        error_budget(&scene, plan, control)
    })?;
    Findings::new("budget", &found, report::budget_table(&found))?
        .with("budget.csv", report::budget_csv(&found))
        .with("budget.svg", report::budget_svg(&found))
        .deliver(&args.output, args.json)?;
    Ok(if found.closure.closes {
        Outcome::Done
    } else {
        Outcome::Disagreed
    })
}

fn power(args: &PowerArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = trust::load(&args.scene)?;
    let pool = settings::pool(args.threads)?;
    let plan = PowerPlan {
        estimators: match args.estimator.as_slice() {
            [] => Estimator::ALL.to_vec(),
            names => names.iter().map(|n| settings::estimator(*n)).collect(),
        },
        sampling: settings::sampling(args.sampler),
        samples: args.samples.clone(),
        seeds: args.seeds,
        first_seed: args.seed,
        significance: settings::significance(args.significance)?,
    };
    for &estimator in &plan.estimators {
        let budget = settings::budget("--samples", 1, plan.sampling)?;
        let one = Plan {
            estimator,
            sampling: plan.sampling,
            seed: 0,
            budget,
        };
        settings::suited(&scene, &one)?;
    }
    let each = sum("--samples", &plan.samples)?.saturating_mul(plan.seeds);
    ensure_writable(&args.output)?;
    talk.warn(&scene);
    let alone = plan
        .estimators
        .iter()
        .filter(|e| !e.serves_all_spots())
        .count() as u64;
    let together = plan.estimators.len() as u64 - alone;
    let total = paths(
        &scene,
        each.saturating_mul(together),
        each.saturating_mul(alone),
    );
    let work = (&*format!("power on {}", scene.name), total);
    let found = traced(talk, &pool, work, |control| {
        study::power(&scene, &plan, control)
    })?;
    Findings::new("power", &found, report::power_table(&found))?
        .deliver(&args.output, args.json)?;
    Ok(Outcome::Done)
}

fn tolerance(args: &ToleranceArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = trust::load(&args.scene)?;
    if !(args.noise > 0.0 && args.noise < 1.0) {
        let cause = format!("--noise {} is not a relative noise", args.noise);
        return Err(Failure::new(
            cause,
            "use a number between 0 and 1, e.g. 0.01",
        ));
    }
    ensure_writable(&args.output)?;
    talk.warn(&scene);
    let bar = progress::steps(talk, &format!("tolerance of {}", scene.name));
    let found = study::tolerance(&scene, args.noise, &|done, all| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    })?;
    bar.finish_and_clear();
    Findings::new("tolerance", &found, report::tolerance_table(&found))?
        .with("tolerance.csv", report::tolerance_csv(&found))
        .with("tolerance.svg", report::tolerance_svg(&found))
        .deliver(&args.output, args.json)?;
    Ok(Outcome::Done)
}

fn convergence(args: &ConvergenceArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = trust::load(&args.scene)?;
    let pool = settings::pool(args.threads)?;
    // Both samplers, under both estimators.
    let each = sum("--samples", &args.samples)?.saturating_mul(2);
    ensure_writable(&args.output)?;
    let work = (
        &*format!("convergence on {}", scene.name),
        paths(&scene, each, each),
    );
    let found = traced(talk, &pool, work, |control| {
        study::convergence(&scene, &args.samples, args.seed, control)
    })?;
    Findings::new("convergence", &found, report::convergence_table(&found))?
        .with("convergence.svg", report::convergence_svg(&found))
        .deliver(&args.output, args.json)?;
    Ok(Outcome::Done)
}
