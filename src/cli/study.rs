//! `phicam study`: experiments around a scene.

use std::path::Path;

use super::args::{BudgetArgs, ConvergenceArgs, PowerArgs, StudyArgs, StudyCommand, ToleranceArgs};
use super::failure::Failure;
use super::interrupt::stop_flag;
use super::output::{self, Talk};
use super::{Outcome, progress, settings, study_indicator, study_noise};
use crate::report;
use crate::scene::Scene;
use crate::store::{ensure_writable, write_whole};
use crate::study::{self, BudgetPlan, PowerPlan, error_budget};
use crate::transport::{Control, Estimator};

pub(super) fn execute(args: &StudyArgs, talk: Talk) -> Result<Outcome, Failure> {
    match &args.command {
        StudyCommand::Budget(a) => budget(a, talk),
        StudyCommand::Power(a) => power(a, talk),
        StudyCommand::Tolerance(a) => tolerance(a, talk),
        StudyCommand::Convergence(a) => convergence(a, talk),
        StudyCommand::Noise(a) => study_noise::execute(a, talk),
        StudyCommand::Indicator(a) => study_indicator::execute(a, talk),
    }
}

fn budget(args: &BudgetArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = Scene::load(&args.scene)?;
    let pool = settings::pool(args.threads)?;
    ensure_writable(&args.output)?;
    talk.warn(&scene);
    let plan = BudgetPlan {
        seed: args.seed,
        ensemble_samples: args.samples,
        run_samples: args.run_samples,
    };
    let pixels = scene.camera.pixels() as u64;
    let total = pixels * (args.samples + args.run_samples * scene.laser.spots.len() as u64);
    let bar = progress::paths(talk, &format!("budget of {}", scene.name), total);
    let tick = |paths| bar.inc(paths);
    let control = Control {
        progress: &tick,
        stop: stop_flag(),
    };
    let found = pool.install(|| error_budget(&scene, plan, control))?;
    bar.finish_and_clear();
    let Some(found) = found else {
        return Err(Failure::Stopped(
            "nothing was written; run it again".to_owned(),
        ));
    };
    let json = output::json(&found)?;
    write(&args.output.join("budget.json"), &json)?;
    write(&args.output.join("budget.csv"), &report::budget_csv(&found))?;
    write(&args.output.join("budget.svg"), &report::budget_svg(&found))?;
    let text = if args.json {
        json
    } else {
        report::budget_table(&found)
    };
    output::print(&text)?;
    Ok(if found.closure.closes {
        Outcome::Done
    } else {
        Outcome::Disagreed
    })
}

fn power(args: &PowerArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = Scene::load(&args.scene)?;
    let pool = settings::pool(args.threads)?;
    let plan = PowerPlan {
        estimators: match args.estimator.as_slice() {
            [] => vec![Estimator::Independent, Estimator::Shared],
            names => names.iter().map(|n| settings::estimator(*n)).collect(),
        },
        sampling: settings::sampling(args.sampler),
        samples: args.samples.clone(),
        seeds: args.seeds,
        first_seed: args.seed,
        significance: settings::significance(args.significance)?,
    };
    ensure_writable(&args.output)?;
    talk.warn(&scene);
    let spots = scene.laser.spots.len() as u64;
    let per_seed = |e: &Estimator| if *e == Estimator::Shared { 1 } else { spots };
    let kinds: u64 = plan.estimators.iter().map(per_seed).sum();
    let paths: u64 =
        plan.samples.iter().sum::<u64>() * plan.seeds * kinds * scene.camera.pixels() as u64;
    let bar = progress::paths(talk, &format!("power on {}", scene.name), paths);
    let tick = |paths| bar.inc(paths);
    let control = Control {
        progress: &tick,
        stop: stop_flag(),
    };
    let found = pool.install(|| study::power(&scene, &plan, control))?;
    bar.finish_and_clear();
    let Some(found) = found else {
        return Err(Failure::Stopped(
            "nothing was written; run it again".to_owned(),
        ));
    };
    let json = output::json(&found)?;
    write(&args.output.join("power.json"), &json)?;
    output::print(&if args.json {
        json
    } else {
        report::power_table(&found)
    })?;
    Ok(Outcome::Done)
}

fn tolerance(args: &ToleranceArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = Scene::load(&args.scene)?;
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
    let json = output::json(&found)?;
    write(&args.output.join("tolerance.json"), &json)?;
    write(
        &args.output.join("tolerance.csv"),
        &report::tolerance_csv(&found),
    )?;
    write(
        &args.output.join("tolerance.svg"),
        &report::tolerance_svg(&found),
    )?;
    output::print(&if args.json {
        json
    } else {
        report::tolerance_table(&found)
    })?;
    Ok(Outcome::Done)
}

fn convergence(args: &ConvergenceArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = Scene::load(&args.scene)?;
    let pool = settings::pool(args.threads)?;
    ensure_writable(&args.output)?;
    let spots = scene.laser.spots.len() as u64;
    let each = args.samples.iter().fold(0u64, |a, b| a.saturating_add(*b));
    // Both samplers, under both estimators.
    let paths = each.saturating_mul(2 * scene.camera.pixels() as u64 * (spots + 1));
    let bar = progress::paths(talk, &format!("convergence on {}", scene.name), paths);
    let tick = |paths| bar.inc(paths);
    let control = Control {
        progress: &tick,
        stop: stop_flag(),
    };
    let found = pool.install(|| study::convergence(&scene, &args.samples, args.seed, control))?;
    bar.finish_and_clear();
    let Some(found) = found else {
        return Err(Failure::Stopped(
            "nothing was written; run it again".to_owned(),
        ));
    };
    let json = output::json(&found)?;
    write(&args.output.join("convergence.json"), &json)?;
    write(
        &args.output.join("convergence.svg"),
        &report::convergence_svg(&found),
    )?;
    output::print(&if args.json {
        json
    } else {
        report::convergence_table(&found)
    })?;
    Ok(Outcome::Done)
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    Ok(write_whole(path, |w| w.write_all(text.as_bytes()))?)
}
