//! How much noise does each recovery bear?
//!
//! The object is a checkerboard of albedo 0 and 1, Φcam that of the matrix model (elements, pixels and spots at their centres), and the recovery
//! inverts this very model: what is lost is lost to noise, and to what the method does even without it. Each draw of the noise is recovered by
//! every method.
//!
//! A method that is linear and unbiased keeps its mean raw MTF however loud the noise: what grows is the spread. And a ratio whose denominator W + B comes near 0
//! has no mean. Both are why the normalized MTF, which lies between −1 and 1, and the root mean square error stand beside it; see [`Lost::Unknown`].
//!
//! Beside the error stands the bound of Cramér and Rao, √(tr CRB/r): what no unbiased recovery undercuts. Methods that are told more than the photographs
//! (bounds, two values) do; what bound holds for them is not known, so the ratio of the error to this one is all that is given.

mod axis;
mod best;
mod bound;
mod curve;
mod ledger;
mod plan;
mod render;
mod stage;
mod tasks;
mod trial;

use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

use serde::Serialize;

use crate::model::ModelError;
use crate::recovery::Method;
use crate::scene::Scene;
use crate::transport::Control;

pub use axis::{NamedSensor, NoiseAxis, Spacing};
pub use best::Best;
pub(super) use curve::MOST_SPREAD;
pub use curve::{Held, Lost, Point, Reach, Spread};
pub use ledger::{LedgerError, read_ledger, write_ledger};
pub use plan::NoisePlan;
pub use render::RenderNoise;
pub(super) use stage::relative;
pub use tasks::{NoiseFinding, NoiseTasks};
pub(super) use trial::measures;
pub use trial::{Measures, Trial};

/// One method on one object.
#[derive(Clone, Debug, Serialize)]
pub struct NoiseCurve {
    /// Checks a side of the object.
    pub board: usize,
    /// Elements a side of the recovery.
    pub elements: usize,
    /// The method.
    pub method: String,
    /// From quiet to loud.
    pub points: Vec<Point>,
    /// Where the mean raw MTF falls to each of [`LIMITS`].
    pub lost_raw: [Lost; 2],
    /// The same of the normalized MTF.
    pub lost_normalized: [Lost; 2],
    /// Up to which level the mean raw MTF stays at or above the first of [`LIMITS`], m, and not above 2 − m, where dark would come out below 0; none
    /// where it is not there at the quietest.
    pub held: Option<Held>,
}

/// The modulations whose loss is told.
pub const LIMITS: [f64; 2] = [0.9, 0.5];

/// The study of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct NoiseStudy {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Kernel of data and inversion.
    pub kernel: String,
    /// What was varied.
    pub axis: String,
    /// What a level is, with its unit.
    pub axis_title: String,
    /// The header of a level in comma-separated values.
    pub axis_column: String,
    /// How levels are spaced.
    pub axis_spacing: Spacing,
    /// What was done to the photographs, and what the recovery was told, in words.
    pub axis_words: String,
    /// The sensor, on axes that have one.
    pub sensor: Option<String>,
    /// Draws of the noise.
    pub seeds: u64,
    /// Seed of the first.
    pub first_seed: u64,
    /// One for each object, elements and method.
    pub curves: Vec<NoiseCurve>,
    /// The best method for each object and elements.
    pub best: Vec<Best>,
    /// Where the noise of renders lies on the axis, if it was measured.
    pub render_noise: Vec<RenderNoise>,
}

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
pub enum NoiseError {
    /// The scene has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// No board divides any number of elements.
    #[error(
        "no number of elements is a multiple of a number of checks, so there is no object to study (use e.g. 2 checks and 8 elements)"
    )]
    NoObject,
    /// No light.
    #[error("no light from the object reaches the camera (see `phicam scene check`)")]
    Dark,
    /// No glare to be had.
    #[error(
        "no light enters the lens straight from any spot, so there is no glare to study (let the camera face the wall where the spots are)"
    )]
    NoGlare,
    /// Nothing but saturated pixels.
    #[error(
        "an exposure of {exposure:e} s saturates the brightest pixel; use exposures below {most:.3e} s"
    )]
    Saturated {
        /// The exposure, s.
        exposure: f64,
        /// What fills the brightest pixel, s.
        most: f64,
    },
}

/// Standard error above which a mean MTF is not held against a limit: a mean that strays has not fallen.
const MOST_STDERR: f64 = 0.1;

/// Recovers every object from every draw of the noise at every level. Trials among `known` are not repeated; `keep` is handed the others as they
/// are finished, and may break the study off, as `stop` may. `Ok(None)` if that happened.
///
/// # Errors
/// [`NoiseError`].
pub fn noise(
    scene: &Scene,
    plan: &NoisePlan,
    known: &[Trial],
    stop: &AtomicBool,
    keep: &mut dyn FnMut(&[Trial]) -> ControlFlow<()>,
) -> Result<Option<NoiseStudy>, NoiseError> {
    let tasks = NoiseTasks::new(scene, plan.clone(), Vec::new());
    let control = Control {
        progress: &|_| (),
        stop,
    };
    let found = tasks.go_on(known, control, keep)?;
    Ok(found.map(|f| f.study))
}

/// `bounds` are those of Cramér and Rao at the plan's levels.
fn curve(
    plan: &NoisePlan,
    [board, elements]: [usize; 2],
    method: Method,
    (trials, bounds): (&[Trial], &[Option<f64>]),
) -> NoiseCurve {
    let seeds = 0..plan.seeds;
    let asked = |t: &&Trial| {
        (t.board, t.elements, t.method) == (board, elements, method)
            && seeds.contains(&t.seed.wrapping_sub(plan.first_seed))
    };
    let own: Vec<&Trial> = trials.iter().filter(asked).collect();
    let point = |(level, bound): (&f64, &Option<f64>)| {
        let here: Vec<&Trial> = own
            .iter()
            .copied()
            .filter(|t| t.level.total_cmp(level).is_eq())
            .collect();
        Point::of(*level, &here, *bound)
    };
    let points: Vec<Point> = plan.levels.iter().zip(bounds).map(point).collect();
    let means = |f: &dyn Fn(&Point) -> Option<Spread>| -> Vec<(f64, Option<f64>)> {
        let known = |s: &Spread| s.stderr.is_none_or(|e| e <= MOST_STDERR);
        let mean = |p: &Point| {
            let spread = f(p).filter(|s| s.draws == p.draws);
            spread.filter(known).map(|s| s.mean)
        };
        points.iter().map(|p| (p.level, mean(p))).collect()
    };
    let narrow = |p: &Point| p.denominator_spread.is_none_or(|s| s <= MOST_SPREAD);
    let raw = means(&|p| p.mtf_raw.filter(|_| narrow(p)));
    let normalized = means(&|p| p.mtf_normalized);
    let spacing = plan.axis.spacing();
    let lost = |curve: &[_]| LIMITS.map(|limit| curve::lost(curve, limit, spacing));
    let (lost_raw, lost_normalized) = (lost(&raw), lost(&normalized));
    NoiseCurve {
        board,
        elements,
        method: method.name().to_owned(),
        points,
        lost_raw,
        lost_normalized,
        held: curve::held(&raw, LIMITS[0], spacing),
    }
}

#[cfg(test)]
mod tests;
