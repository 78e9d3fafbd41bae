//! `phicam study`: experiments around a scene.

mod brdf;
mod coverage;
mod experiment;
mod findings;
mod indicator;
mod job;
mod noise;

use std::path::Path;
use std::sync::OnceLock;

use super::Outcome;
use super::args::{BudgetArgs, ConvergenceArgs, PowerArgs, StudyArgs, StudyCommand, ToleranceArgs};
use super::failure::Failure;
use super::output::Talk;
use super::record::version;
use super::settings;
use super::tasks::Cut;
use super::trust;
use crate::num::stream::Sampling;
use crate::report::{self, Asked};
use crate::scene::Scene;
use crate::study::{
    BudgetPlan, BudgetTasks, ConvergenceTasks, Division, PowerPlan, PowerTasks, ToleranceTasks,
};
use crate::transport::{Estimator, Plan};
use findings::Findings;
use job::{Count, Job};

pub(in crate::cli) fn execute(args: &StudyArgs, talk: Talk) -> Result<Outcome, Failure> {
    match &args.command {
        StudyCommand::Budget(a) => start(talk, args, |s, asked| budget(a, s, asked)),
        StudyCommand::Power(a) => start(talk, args, |s, asked| power(a, s, asked)),
        StudyCommand::Tolerance(a) => start(talk, args, |s, asked| tolerance(a, s, asked)),
        StudyCommand::Convergence(a) => start(talk, args, |s, asked| convergence(a, s, asked)),
        StudyCommand::Noise(a) => noise::execute(a, args, talk),
        StudyCommand::Indicator(a) => start(talk, args, |s, asked| indicator::job(a, s, asked)),
        StudyCommand::Brdf(a) => start(talk, args, |s, asked| brdf::job(a, s, asked)),
        StudyCommand::Coverage(a) => start(talk, args, |s, asked| coverage::job(a, s, asked)),
        StudyCommand::Experiment(a) => start(talk, args, |s, asked| experiment::job(a, s, asked)),
    }
}

fn start<D: Division>(
    talk: Talk,
    args: &StudyArgs,
    job: impl FnOnce(&Scene, Asked) -> Result<Job<D>, Failure>,
) -> Result<Outcome, Failure> {
    let scene = trust::load(args.command.scene())?;
    job(&scene, asked(args, &scene))?.execute(&scene, talk)
}

/// What the page of a study says of how it was asked for.
fn asked(args: &StudyArgs, scene: &Scene) -> Asked {
    let given = args.command.scene();
    let file = Path::new(given).file_name();
    Asked {
        study: args.name.clone(),
        scene: scene.clone(),
        file: file.map_or(given.to_owned(), |f| f.to_string_lossy().into_owned()),
        options: args.options.clone(),
        version: version().to_owned(),
    }
}

/// The tasks of a study of `scene`, or where there is none of the scene that the arguments name.
pub(in crate::cli) fn cut(args: &StudyArgs, scene: Option<Scene>) -> Result<Box<dyn Cut>, Failure> {
    let scene = &match scene {
        Some(scene) => scene,
        None => trust::load(args.command.scene())?,
    };
    let asked = asked(args, scene);
    Ok(match &args.command {
        StudyCommand::Budget(a) => Box::new(budget(a, scene, asked)?),
        StudyCommand::Power(a) => Box::new(power(a, scene, asked)?),
        StudyCommand::Tolerance(a) => Box::new(tolerance(a, scene, asked)?),
        StudyCommand::Convergence(a) => Box::new(convergence(a, scene, asked)?),
        StudyCommand::Noise(a) => Box::new(noise::job(a, scene, asked)?),
        StudyCommand::Indicator(a) => Box::new(indicator::job(a, scene, asked)?),
        StudyCommand::Brdf(a) => Box::new(brdf::job(a, scene, asked)?),
        StudyCommand::Coverage(a) => Box::new(coverage::job(a, scene, asked)?),
        StudyCommand::Experiment(a) => Box::new(experiment::job(a, scene, asked)?),
    })
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

fn budget(args: &BudgetArgs, scene: &Scene, asked: Asked) -> Result<Job<BudgetTasks>, Failure> {
    let total = paths(
        scene,
        sum("--samples", &[args.samples])?,
        sum("--run-samples", &[args.run_samples])?,
    );
    let plan = BudgetPlan {
        seed: args.seed,
        ensemble_samples: args.samples,
        run_samples: args.run_samples,
    };
    Ok(Job {
        division: BudgetTasks::new(scene, plan),
        ground: OnceLock::new(),
        asked,
        what: format!("budget of {}", scene.name),
        count: Count::Paths(total),
        threads: args.threads,
        output: args.output.clone(),
        json: args.json,
        findings: |found| {
            let findings = Findings::new(
                "budget",
                found,
                report::budget_table(found),
                report::budget_account(found),
            )?
            .with("budget.csv", report::budget_csv(found))
            .with("budget.svg", report::budget_svg(found));
            Ok(match found.closure.closes {
                true => (findings, Outcome::Done),
                false => (findings, Outcome::Disagreed),
            })
        },
    })
}

fn power(args: &PowerArgs, scene: &Scene, asked: Asked) -> Result<Job<PowerTasks>, Failure> {
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
        settings::suited(scene, &one)?;
    }
    let each = sum("--samples", &plan.samples)?.saturating_mul(plan.seeds);
    let alone = plan
        .estimators
        .iter()
        .filter(|e| !e.serves_all_spots())
        .count() as u64;
    let together = plan.estimators.len() as u64 - alone;
    let total = paths(
        scene,
        each.saturating_mul(together),
        each.saturating_mul(alone),
    );
    Ok(Job {
        division: PowerTasks::new(scene, plan),
        ground: OnceLock::new(),
        asked,
        what: format!("power on {}", scene.name),
        count: Count::Paths(total),
        threads: args.threads,
        output: args.output.clone(),
        json: args.json,
        findings: |found| {
            let findings = Findings::new(
                "power",
                found,
                report::power_table(found),
                report::power_account(found),
            )?;
            Ok((findings, Outcome::Done))
        },
    })
}

fn tolerance(
    args: &ToleranceArgs,
    scene: &Scene,
    asked: Asked,
) -> Result<Job<ToleranceTasks>, Failure> {
    if !(args.noise > 0.0 && args.noise < 1.0) {
        let cause = format!("--noise {} is not a relative noise", args.noise);
        return Err(Failure::new(
            cause,
            "use a number between 0 and 1, e.g. 0.01",
        ));
    }
    Ok(Job {
        division: ToleranceTasks::new(scene, args.noise),
        ground: OnceLock::new(),
        asked,
        what: format!("tolerance of {}", scene.name),
        count: Count::Tasks,
        threads: None,
        output: args.output.clone(),
        json: args.json,
        findings: |found| {
            let findings = Findings::new(
                "tolerance",
                found,
                report::tolerance_table(found),
                report::tolerance_account(found),
            )?
            .with("tolerance.csv", report::tolerance_csv(found))
            .with("tolerance.svg", report::tolerance_svg(found));
            Ok((findings, Outcome::Done))
        },
    })
}

fn convergence(
    args: &ConvergenceArgs,
    scene: &Scene,
    asked: Asked,
) -> Result<Job<ConvergenceTasks>, Failure> {
    // Both samplers, under both estimators.
    let each = sum("--samples", &args.samples)?.saturating_mul(2);
    Ok(Job {
        division: ConvergenceTasks::new(scene, &args.samples, args.seed),
        ground: OnceLock::new(),
        asked,
        what: format!("convergence on {}", scene.name),
        count: Count::Paths(paths(scene, each, each)),
        threads: args.threads,
        output: args.output.clone(),
        json: args.json,
        findings: |found| {
            let findings = Findings::new(
                "convergence",
                found,
                report::convergence_table(found),
                report::convergence_account(found),
            )?
            .with("convergence.svg", report::convergence_svg(found));
            Ok((findings, Outcome::Done))
        },
    })
}
