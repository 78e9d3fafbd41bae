//! Checked settings from raw arguments.

use super::args::{PathArgs, TestArgs};
use super::console::Console;
use super::failure::Failure;
use crate::lab::{Errors, Test};
use crate::scene::Scene;
use crate::transport::{Budget, Plan, unsupported_surface};

/// The plan that the arguments describe.
pub(super) fn plan(args: &PathArgs) -> Result<Plan, Failure> {
    let plan = Plan::new(args.estimator, args.sampler, args.seed, args.samples);
    plan.map_err(|_| {
        let cause = format!(
            "--samples {} is not a number of paths that can be traced",
            args.samples
        );
        Failure::usage(cause, "use at least 1 and at most 2³²")
    })
}

/// Says so where `plan` has more samples than were asked for.
pub(super) fn remark_rounding(args: &PathArgs, plan: &Plan, console: Console) {
    let Budget { blocks, size } = plan.budget;
    let samples = plan.budget.samples();
    if samples != args.samples {
        console.say(format!(
            "{} samples rounded up to {samples}: {blocks} blocks of {size}",
            args.samples
        ));
    }
}

/// Refuses an estimator that does not suit the scene.
pub(super) fn suited(scene: &Scene, plan: &Plan) -> Result<(), Failure> {
    let Some(surface) = unsupported_surface(scene, plan) else {
        return Ok(());
    };
    let cause = format!(
        "--estimator {} needs Lambertian surfaces between the walls, and `{surface}` is none",
        plan.estimator.name()
    );
    Err(Failure::new(cause, "use --estimator shared"))
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
        replicates: plan.budget.blocks,
        errors: Errors::of(plan.estimator),
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
        replicates: replicates.unwrap_or(u32::MAX),
        errors,
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
