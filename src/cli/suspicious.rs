//! What only tracing shows to be suspicious, said before the hours are spent.

use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::interrupt::control;
use crate::lab::{Foretold, LabError, darkness, foretold};
use crate::scene::Scene;
use crate::transport::{Estimator, Plan, Sampling};

/// Says what the first samples of a render foretell.
pub(super) fn warn(scene: &Scene, plan: &Plan, console: Console) -> Result<(), Failure> {
    if let Some(found) = known(foretold(scene, plan, control()))? {
        console.say(format!("warning: {found}"));
    }
    Ok(())
}

/// Whether light reaches the camera, as far as samples and geometry say.
pub(super) fn dark(scene: &Scene) -> Result<Option<Foretold>, Failure> {
    let plan = Plan::new(Estimator::Shared, Sampling::Sobol, 1, 64)?;
    known(darkness(scene, &plan, control()))
}

/// What cannot be traced is for the render itself to refuse.
fn known(found: Result<Option<Foretold>, LabError>) -> Result<Option<Foretold>, Failure> {
    match found {
        Err(LabError::Stopped(stopped)) => Err(stopped.into()),
        found => Ok(found.unwrap_or(None)),
    }
}
