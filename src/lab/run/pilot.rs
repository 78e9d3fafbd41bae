//! What a few samples foretell of a render, before the hours are spent.

use std::ops::ControlFlow;

use crate::lab::error::LabError;
use crate::scene::Scene;
use crate::transport::{Control, Plan, Tally, trace};

/// Samples of the first look, and of the second, which is asked before a bad word is said.
const FIRST: u64 = 64;
const SECOND: u64 = 1024;
/// Pixels a side and spots that are looked at, at most.
const SIDE: usize = 8;
const SPOTS: usize = 8;
/// The look takes at most one part in this of the render's paths.
const SHARE: f64 = 32.0;
/// Overall standard error, relative, that is worth a word.
const COARSE: f64 = 0.1;

/// What the samples foretell, if that is worth a word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Foretold {
    /// None of them met light, and none can: no way leads from any of the spots to the camera.
    Dark,
    /// None of so many, of each of the pixels and spots looked at, met light.
    Unlit(u64),
    /// ‖σ‖/‖Φ‖ that the render will end with, about.
    Coarse(f64),
}

impl std::fmt::Display for Foretold {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Dark => f.write_str(
                "no light reaches the camera: nothing that the laser lights is seen, directly or over the surfaces there are",
            ),
            Self::Unlit(samples) => write!(
                f,
                "{samples} samples of each of some pixels and spots met no light: little of it, or none, reaches the camera"
            ),
            Self::Coarse(error) => write!(
                f,
                "the first samples foretell an overall standard error of about {:.0} %: more --samples, or another --estimator, would lower it",
                100.0 * error
            ),
        }
    }
}

/// Traces at most 8 × 8 pixels that cover the view and 8 of the spots with 64 samples; where these
/// foretell more than 10 % of error, by ‖σ‖/‖Φ‖ ∝ 1/√N, with 1024 of them, for nets fall faster
/// than that. Nothing is traced where the render itself takes less than 32 times as many paths. The
/// bits of the render do not depend on it.
///
/// # Errors
/// [`LabError`] for a plan that cannot be traced, or a stop.
pub fn foretold(
    scene: &Scene,
    plan: &Plan,
    control: Control<'_>,
) -> Result<Option<Foretold>, LabError> {
    let samples = plan.budget.samples();
    let thinned = thinned(scene, SIDE, SPOTS);
    let paths = |scene: &Scene| {
        let sets = if plan.estimator.serves_all_spots() {
            1
        } else {
            scene.laser.spots.len()
        };
        scene.camera.pixels() as f64 * sets as f64
    };
    let mut answer = None;
    for asked in [FIRST, SECOND.min(samples)] {
        let known = answer.is_some() && asked <= FIRST;
        if known || paths(scene) * (samples as f64) < SHARE * paths(&thinned) * asked as f64 {
            break;
        }
        let plan = Plan::new(plan.estimator, plan.sampling, plan.seed, asked)?;
        let tally = look(&thinned, &plan, control)?;
        let lit = tally.relative_error();
        answer = match lit {
            Some(error) => {
                let end = error * (asked as f64 / samples as f64).sqrt();
                (end > COARSE).then_some(Foretold::Coarse(end))
            }
            None => {
                let spots = 0..thinned.laser.spots.len();
                let traced = tally.traced(&thinned, spots);
                let possible = traced.is_none_or(|t| t.stderr.iter().any(|e| *e > 0.0));
                Some(if possible {
                    Foretold::Unlit(asked)
                } else {
                    Foretold::Dark
                })
            }
        };
        if answer.is_none() || answer == Some(Foretold::Dark) {
            break;
        }
    }
    Ok(answer)
}

/// Whether no light reaches the camera, or 64 samples of each pixel and spot looked at met none.
///
/// # Errors
/// [`LabError`] for a plan that cannot be traced, or a stop.
pub fn darkness(
    scene: &Scene,
    plan: &Plan,
    control: Control<'_>,
) -> Result<Option<Foretold>, LabError> {
    let endless = Plan::new(plan.estimator, plan.sampling, plan.seed, 1 << 32)?;
    let found = foretold(scene, &endless, control)?;
    Ok(found.filter(|found| !matches!(found, Foretold::Coarse(_))))
}

/// The tally of a render that tells nobody of its progress.
pub(super) fn look(scene: &Scene, plan: &Plan, control: Control<'_>) -> Result<Tally, LabError> {
    let spots = 0..scene.laser.spots.len();
    let tally = Tally::new(scene, plan, spots.len(), 0);
    let silent = Control {
        progress: &|_| (),
        stop: control.stop,
    };
    let go_on = &mut |_: &Tally| ControlFlow::Continue(u32::MAX);
    let end = plan.budget.blocks;
    Ok(trace(scene, plan, spots, tally, end, silent, go_on)?)
}

/// The same view in at most so many pixels a `side`, and as many of the `spots`, evenly chosen.
pub(super) fn thinned(scene: &Scene, side: usize, spots: usize) -> Scene {
    let mut few = scene.clone();
    few.camera.columns = few.camera.columns.min(side);
    few.camera.rows = few.camera.rows.min(side);
    few.known.clear();
    let all = &scene.laser.spots;
    let count = all.len().min(spots);
    let places = (0..count).map(|i| (2 * i + 1) * all.len() / (2 * count));
    few.laser.spots = places.map(|i| all[i]).collect();
    few
}
