//! Checked settings from raw arguments.

use crate::cli::args::{PathArgs, TestArgs};
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::interrupt;
use crate::cli::process::pool;
use crate::lab::{self, Certainty, Errors, LabError, Test};
use crate::scene::Scene;
use crate::transport::{Budget, Estimator, Plan, unsupported_surface};

/// Refuses a given value that is not `allowed`; `range` says in words what is.
pub(super) fn within(
    name: &str,
    given: Option<f64>,
    allowed: impl Fn(f64) -> bool,
    range: &str,
) -> Result<(), Failure> {
    match given {
        Some(value) if !allowed(value) => Err(Failure::new(
            format!("--{name} {value} has no meaning"),
            format!("use a number that is {range}"),
        )),
        _ => Ok(()),
    }
}

/// The plan that the arguments describe for the scene; says what was chosen where they leave both
/// estimator and samples open, on so many threads.
pub(super) fn plan(
    args: &PathArgs,
    threads: Option<usize>,
    scene: &Scene,
    console: Console,
) -> Result<Plan, Failure> {
    if args.estimator.is_none() && args.samples.is_none() {
        let chosen = || aimed(args, scene, console);
        return pool(threads)?.install(chosen);
    }
    let estimator = args.estimator.unwrap_or(Estimator::Independent);
    let samples = args.samples.unwrap_or(lab::SAMPLES);
    let plan = Plan::new(estimator, args.sampler, args.seed, samples);
    plan.map_err(|_| {
        let cause = format!("--samples {samples} is not a number of paths that can be traced");
        Failure::usage(cause, "use at least 1 and at most 2³²")
    })
}

fn aimed(args: &PathArgs, scene: &Scene, console: Console) -> Result<Plan, Failure> {
    let found = lab::aimed(scene, args.sampler, args.seed, interrupt::control());
    let (plan, foretold) = found.map_err(|error| match error {
        LabError::Stopped(stopped) => stopped.into(),
        error => Failure::new(error.to_string(), "give --estimator and --samples"),
    })?;
    if let Some(error) = foretold {
        let Plan {
            estimator, budget, ..
        } = plan;
        console.say(format!(
            "a pilot chose --estimator {estimator} --samples {}: it foretells an overall standard error of {:.2} %{}",
            budget.samples(),
            100.0 * error,
            without_errors(scene, &plan)
        ));
    }
    Ok(plan)
}

/// That a recovery from this render has no standard errors, and what gives them, where it is so.
fn without_errors(scene: &Scene, plan: &Plan) -> String {
    let which = Errors::of(plan.estimator).shared();
    let which = which.filter(|_| scene.hidden().next().is_some());
    which.map_or(String::new(), |which| {
        format!(
            ", but {which}, so that what is recovered from it has no standard errors: --estimator independent gives \
             them, at more time for the same noise"
        )
    })
}

/// Says so where `plan` has more samples than were asked for.
pub(super) fn remark_rounding(args: &PathArgs, plan: &Plan, console: Console) {
    let Budget { blocks, size } = plan.budget;
    let samples = plan.budget.samples();
    if let Some(asked) = args.samples.filter(|asked| *asked != samples) {
        console.say(format!(
            "{asked} samples rounded up to {samples}: {blocks} blocks of {size}"
        ));
    }
}

/// Refuses an estimator that does not suit the scene.
pub(super) fn suited(scene: &Scene, plan: &Plan) -> Result<(), Failure> {
    let Some(surface) = unsupported_surface(scene, plan) else {
        return Ok(());
    };
    let cause = format!(
        "--estimator {} needs Lambertian surfaces between the walls where light meets more than three, and `{surface}` is none",
        plan.estimator.name()
    );
    Err(Failure::new(
        cause,
        "use --estimator shared, or max_bounces = 3 in the scene",
    ))
}

/// Paths a block from which on its mean is taken as normally distributed.
const ENOUGH_PATHS: u32 = 4;

/// The test for a run traced by `plan`.
pub(super) fn test(args: &TestArgs, plan: &Plan, console: Console) -> Result<Test, Failure> {
    let significance = significance(args)?;
    if plan.budget.size < ENOUGH_PATHS {
        console.say(format!(
            "warning: {} paths a block are few for normal block means: the verdict's significance is only approximate",
            plan.budget.size
        ));
    }
    Ok(Test {
        significance,
        known: Certainty::of(plan),
    })
}

/// The test for a matrix of unknown origin. Unless it is said from how many replicates its standard
/// errors come they are taken as known, of normal errors.
pub(super) fn test_of_matrix(
    args: &TestArgs,
    errors: Errors,
    replicates: Option<u32>,
) -> Result<Test, Failure> {
    Ok(Test {
        significance: significance(args)?,
        known: Certainty::new(errors, replicates),
    })
}

fn significance(args: &TestArgs) -> Result<f64, Failure> {
    let significance = args.significance;
    if significance > 0.0 && significance < 1.0 {
        return Ok(significance);
    }
    let cause = format!("--significance {significance} is not a probability");
    let cure = "use a number between 0 and 1, e.g. 0.001";
    Err(Failure::new(cause, cure))
}
