//! How much noise does each recovery bear?
//!
//! The object is a checkerboard of albedo 0 and 1, Φcam that of the matrix model (elements, pixels and spots at their centres), and the recovery
//! inverts this very model: what is lost is lost to noise, and to what the method does even without it. Each draw of the noise is recovered by
//! every method.
//!
//! A method that is linear and unbiased keeps its mean raw MTF however loud the noise: what grows is the spread. And a ratio whose denominator W + B comes near 0
//! has no mean. Both are why the normalized MTF, which lies between −1 and 1, and the root mean square error stand beside it; see [`Lost::Unknown`].
//!
//! Where the bound of Cramér and Rao, √(tr CRB/r), is to stand beside the root mean square error, [`Point`] is the place: it is a function of the
//! model and of the level's standard errors alone.

mod axis;
mod curve;
mod ledger;
mod render;
mod trial;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use serde::Serialize;

use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel, ModelError};
use crate::recovery::Method;
use crate::scene::Scene;

pub use axis::NoiseAxis;
pub(super) use curve::MOST_SPREAD;
pub use curve::{Lost, Point, Spread};
pub use ledger::{LedgerError, read_ledger, write_ledger};
pub use render::{RenderNoise, render_noise};
pub use trial::{Measures, Trial};

/// What is studied.
#[derive(Clone, Debug, PartialEq)]
pub struct NoisePlan {
    /// Checks a side of the objects.
    pub boards: Vec<usize>,
    /// Elements a side of the recoveries; those that a board does not divide are left out with it.
    pub elements: Vec<usize>,
    /// The methods.
    pub methods: Vec<Method>,
    /// Kernel of the data and of the inversion.
    pub kernel: Kernel,
    /// What is varied.
    pub axis: NoiseAxis,
    /// Its levels, from quiet to loud.
    pub levels: Vec<f64>,
    /// Draws of the noise.
    pub seeds: u64,
    /// Seed of the first.
    pub first_seed: u64,
}

impl NoisePlan {
    /// What trials have to share to belong to one study, in words: program, scene, kernel and axis.
    pub fn study(&self, scene: &Scene) -> String {
        format!(
            "phicam {} study noise of scene {} ({}), {} kernel, {} axis",
            env!("CARGO_PKG_VERSION"),
            scene.name.replace(['\n', '\r'], " "),
            scene.hash,
            self.kernel.name(),
            self.axis.name()
        )
    }

    /// Objects with the elements that they are recovered at.
    fn objects(&self) -> Vec<[usize; 2]> {
        let pairs = self
            .boards
            .iter()
            .flat_map(|b| self.elements.iter().map(|e| [*b, *e]));
        pairs.filter(|[b, e]| e % b == 0).collect()
    }

    /// Recoveries of the whole study.
    pub fn trials(&self) -> usize {
        self.objects().len() * self.levels.len() * self.seeds as usize * self.methods.len()
    }
}

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
    /// What a level is.
    pub axis_title: String,
    /// Draws of the noise.
    pub seeds: u64,
    /// Seed of the first.
    pub first_seed: u64,
    /// One for each object, elements and method.
    pub curves: Vec<NoiseCurve>,
    /// Where the noise of renders lies on the axis of relative noise, if it was measured.
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
}

/// Standard error above which a mean MTF is not held against a limit: a mean that strays has not fallen.
const MOST_STDERR: f64 = 0.1;
/// Draws worked off between two calls of `keep`.
const CHUNK: usize = 32;

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
    let objects = plan.objects();
    if objects.is_empty() {
        return Err(NoiseError::NoObject);
    }
    let mut known: Vec<Trial> = known.to_vec();
    known.sort_by(Trial::order);
    for &[board, elements] in &objects {
        let model = MatrixModel::new(
            &scene.with_checkerboard(board),
            plan.kernel,
            Some([elements; 2]),
        )?;
        let exact = model.phi();
        let draws: Vec<(f64, u64)> = plan
            .levels
            .iter()
            .flat_map(|level| (0..plan.seeds).map(|k| (*level, plan.first_seed.wrapping_add(k))))
            .collect();
        for chunk in draws.chunks(CHUNK) {
            let bench = Bench {
                plan,
                board,
                elements,
                model: &model,
                exact: &exact,
            };
            let found: Vec<Option<Vec<Trial>>> = chunk
                .par_iter()
                .map(|draw| (!stop.load(Ordering::Relaxed)).then(|| bench.draw(*draw, &known)))
                .collect();
            let whole = found.iter().all(Option::is_some);
            let found: Vec<Trial> = found.into_iter().flatten().flatten().collect();
            let go_on = keep(&found);
            known.extend(found);
            known.sort_by(Trial::order);
            if !whole || go_on.is_break() {
                return Ok(None);
            }
        }
    }
    let curves = objects
        .iter()
        .flat_map(|o| plan.methods.iter().map(|m| curve(plan, *o, *m, &known)))
        .collect();
    Ok(Some(NoiseStudy {
        scene: scene.name.clone(),
        scene_hash: scene.hash.clone(),
        kernel: plan.kernel.name().to_owned(),
        axis: plan.axis.name().to_owned(),
        axis_title: plan.axis.title().to_owned(),
        seeds: plan.seeds,
        first_seed: plan.first_seed,
        curves,
        render_noise: Vec::new(),
    }))
}

/// One object, ready to be photographed.
struct Bench<'a> {
    plan: &'a NoisePlan,
    board: usize,
    elements: usize,
    model: &'a MatrixModel,
    exact: &'a Matrix,
}

impl Bench<'_> {
    /// The trials of one draw that are not known yet.
    fn draw(&self, (level, seed): (f64, u64), known: &[Trial]) -> Vec<Trial> {
        let trial = |method| Trial {
            board: self.board,
            elements: self.elements,
            method,
            level,
            seed,
            outcome: Err(String::new()),
        };
        let mut open: Vec<Trial> = self.plan.methods.iter().map(|m| trial(*m)).collect();
        open.retain(|t| known.binary_search_by(|k| k.order(t)).is_err());
        if open.is_empty() {
            return open;
        }
        let photographs = self.plan.axis.photograph(self.exact, level, seed);
        for trial in &mut open {
            trial.outcome = trial::measure(self.model, &photographs, trial.method);
        }
        open
    }
}

fn curve(
    plan: &NoisePlan,
    [board, elements]: [usize; 2],
    method: Method,
    trials: &[Trial],
) -> NoiseCurve {
    let seeds = 0..plan.seeds;
    let asked = |t: &&Trial| {
        (t.board, t.elements, t.method) == (board, elements, method)
            && seeds.contains(&t.seed.wrapping_sub(plan.first_seed))
    };
    let own: Vec<&Trial> = trials.iter().filter(asked).collect();
    let point = |level: &f64| {
        let here: Vec<&Trial> = own
            .iter()
            .copied()
            .filter(|t| t.level.total_cmp(level).is_eq())
            .collect();
        Point::of(*level, &here)
    };
    let points: Vec<Point> = plan.levels.iter().map(point).collect();
    let lost = |f: &dyn Fn(&Point) -> Option<Spread>| {
        let known = |s: &Spread| s.stderr.is_none_or(|e| e <= MOST_STDERR);
        let mean = |p: &Point| {
            let spread = f(p).filter(|s| s.draws == p.draws);
            spread.filter(known).map(|s| s.mean)
        };
        let curve: Vec<_> = points.iter().map(|p| (p.level, mean(p))).collect();
        LIMITS.map(|limit| curve::lost(&curve, limit))
    };
    let narrow = |p: &Point| p.denominator_spread.is_none_or(|s| s <= MOST_SPREAD);
    let lost_raw = lost(&|p| p.mtf_raw.filter(|_| narrow(p)));
    let lost_normalized = lost(&|p| p.mtf_normalized);
    NoiseCurve {
        board,
        elements,
        method: method.name().to_owned(),
        points,
        lost_raw,
        lost_normalized,
    }
}

#[cfg(test)]
mod tests;
