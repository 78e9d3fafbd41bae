//! Estimator and samples of a render that is told neither: what brings ‖σ‖/‖Φ‖ to 1 %.

use super::pilot::{look, thinned};
use crate::lab::error::LabError;
use crate::num::stream::Sampling;
use crate::scene::{Role, Scene, Surface};
use crate::transport::{Control, Estimator, Plan, unsupported_surface};

/// The relative standard error that a render should reach.
pub(super) const AIM: f64 = 0.01;
/// Samples of a render unless it is told how many, or a pilot asks for more.
pub const SAMPLES: u64 = 512;
/// Samples of the first pilot by `shared`, whose paths serve one pixel each.
const FEW: u64 = 64;
/// A pilot has at least one sample in so many of the render's.
const STEP: u64 = 8;
/// For the error of a pilot's own error.
const MARGIN: f64 = 1.1;
/// Pairs of a point with a pixel or a spot (`factored`), and of a path with a spot (`shared`), that
/// a render may cost: some minutes on two cores.
const MOST_PAIRS: u64 = 1 << 26;
const MOST_PATHS: u64 = 1 << 28;
/// Pixels a side and entries that a pilot looks at, at most.
const MOST_SIDE: usize = 128;
const MOST_ENTRIES: usize = 1 << 21;

/// The plan of a render that is told neither estimator nor samples, and what a pilot foretells of
/// its ‖σ‖/‖Φ‖.
///
/// `independent` with 512 samples, without a pilot, where hidden surfaces alone reflect between the
/// walls: every entry then has points of its own on them. Where other surfaces reflect too, the
/// light may come from anywhere, and points that serve all entries find it at a fraction of the
/// cost: `factored`, or `shared` where that cannot be or would not reach 1 %. Pilots of all pixels
/// and spots (of more than 2²¹ entries, of some), each with 8 times the samples of the one before
/// at most, foretell by σ ∝ 1/√N how many samples that takes: a power of two, from 512 to what
/// takes some minutes. Pilots have random numbers of their own: the render is unbiased, whatever
/// they find.
///
/// # Errors
/// [`LabError`] for a plan that cannot be traced, or a stop.
pub fn aimed(
    scene: &Scene,
    sampling: Sampling,
    seed: u64,
    control: Control<'_>,
) -> Result<(Plan, Option<f64>), LabError> {
    let usual = Plan::new(Estimator::Independent, sampling, seed, SAMPLES)?;
    let others = |s: &Surface| s.role == Role::Occluder && !s.is_black();
    if scene.max_bounces < 3 || scene.shining().is_some() || !scene.surfaces.iter().any(others) {
        return Ok((usual, None));
    }
    let [columns, rows] = [scene.camera.columns, scene.camera.rows].map(|n| n.min(MOST_SIDE));
    let looked_at = thinned(scene, MOST_SIDE, (MOST_ENTRIES / (columns * rows)).max(1));
    let mut best: Option<(Plan, f64)> = None;
    for estimator in [Estimator::Factored, Estimator::Shared] {
        let least = Plan { estimator, ..usual };
        if unsupported_surface(scene, &least).is_some() {
            continue;
        }
        let most = most(scene, estimator);
        let Some((plan, error)) = reaching(&looked_at, &least, most, control)? else {
            return Ok((usual, None));
        };
        if best.is_none_or(|(_, least)| error < least) {
            best = Some((plan, error));
        }
        if error <= AIM {
            break;
        }
    }
    Ok(best.map_or((usual, None), |(plan, error)| (plan, Some(error))))
}

/// The plan with as many samples as pilots ask for, `most` at most, and the error that it then
/// has; `None` where they meet no light.
fn reaching(
    scene: &Scene,
    least: &Plan,
    most: u64,
    control: Control<'_>,
) -> Result<Option<(Plan, f64)>, LabError> {
    let of = |samples, seed| Plan::new(least.estimator, least.sampling, seed, samples);
    let mut asked = match least.estimator {
        Estimator::Factored => SAMPLES,
        _ => FEW,
    };
    loop {
        let tally = look(scene, &of(asked, !least.seed)?, control)?;
        let Some(error) = tally.relative_error() else {
            return Ok(None);
        };
        let wished = asked as f64 * (MARGIN * error / AIM).powi(2);
        let needed = (wished.min(most as f64) as u64).next_power_of_two();
        let needed = needed.clamp(SAMPLES, most);
        if needed <= STEP * asked {
            let end = error * (asked as f64 / needed as f64).sqrt();
            return Ok(Some((of(needed, least.seed)?, end)));
        }
        asked = needed / STEP;
    }
}

/// Samples that take some minutes: a power of two, 512 or more.
fn most(scene: &Scene, estimator: Estimator) -> u64 {
    let [pixels, spots] = [scene.camera.pixels(), scene.laser.spots.len()].map(|n| n as u64);
    let samples = match estimator {
        Estimator::Factored => MOST_PAIRS / (pixels + spots).max(1),
        _ => MOST_PATHS / (pixels * spots).max(1),
    };
    // The power of two that is not above it.
    1 << samples.max(SAMPLES).ilog2()
}

#[cfg(test)]
#[path = "aim_tests.rs"]
mod tests;
