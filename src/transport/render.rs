//! The estimators of Φcam.

use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::beam::Beams;
use super::factored::Factored;
use super::own::OwnPoints;
use super::pixel::PixelTracer;
use super::setting::Setting;
use super::tally::{Moments, Tally};
use crate::matrix::Matrix;
use crate::num::stream::{LARGEST_NET, Sampling};
use crate::num::tree::Tree;
use crate::scene::{Scene, Surface};

/// What paths have in common. All are unbiased.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimator {
    /// Every (pixel, spot) entry has its own paths: errors are independent.
    Independent,
    /// The paths of a pixel serve all spots, one connection per spot and vertex: errors along a row of Φcam are
    /// correlated.
    Shared,
    /// The points between first and last wall serve all pixels and all spots: Φ̂ is a matrix product, and the errors of all entries are
    /// correlated.
    Factored,
}

impl Estimator {
    /// Every estimator.
    pub const ALL: [Self; 3] = [Self::Independent, Self::Shared, Self::Factored];

    /// Whether one path, or point, serves every spot.
    pub fn serves_all_spots(self) -> bool {
        self != Self::Independent
    }

    /// The name used on the command line and in the files of a run.
    pub fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Shared => "shared",
            Self::Factored => "factored",
        }
    }
}

/// How many paths, in how many independent blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Blocks: replicates with random numbers of their own, from whose spread the standard error comes.
    pub blocks: u32,
    /// Paths in each block.
    pub size: u32,
}

/// Blocks that the samples are divided into, unless that makes a block too large.
const REPLICATES: u64 = 32;

impl Budget {
    /// At least `samples` paths, rounded up to whole blocks: 32 of them; with Sobol' points a block is a power of two
    /// (a net), at most 2¹⁶, and more blocks follow beyond that. `None` for no samples or more than 2³².
    pub fn new(samples: u64, sampling: Sampling) -> Option<Self> {
        if samples == 0 || samples > 1 << 32 {
            return None;
        }
        let size = samples.div_ceil(REPLICATES);
        let size = match sampling {
            Sampling::Pcg => size.min(1 << 30),
            Sampling::Sobol => size.next_power_of_two().min(u64::from(LARGEST_NET)),
        };
        let blocks = samples.div_ceil(size).max(REPLICATES);
        Some(Self {
            blocks: u32::try_from(blocks).ok()?,
            size: u32::try_from(size).ok()?,
        })
    }

    /// Paths in all.
    pub fn samples(self) -> u64 {
        u64::from(self.blocks) * u64::from(self.size)
    }
}

/// What to render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// What paths have in common.
    pub estimator: Estimator,
    /// Where their random numbers come from.
    pub sampling: Sampling,
    /// Seed of the run.
    pub seed: u64,
    /// Paths per pixel and spot (`Independent`), paths per pixel (`Shared`) or points between the walls (`Factored`).
    pub budget: Budget,
}

/// How a long render talks to whoever started it.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Called from any thread with the number of paths just finished.
    pub progress: &'a (dyn Fn(u64) + Sync),
    /// Set from outside to stop the render.
    pub stop: &'a AtomicBool,
}

impl std::fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Control")
            .field("stop", &self.stop)
            .finish_non_exhaustive()
    }
}

/// Traced columns of Φcam.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// Flux of light that met exactly n + 1 surfaces, W: \[n\] is pixels × spots.
    pub bounces: Vec<Matrix>,
    /// Flux, the sum of `bounces`: pixels × spots, W.
    pub flux: Matrix,
    /// Standard error of `flux` from the spread of the blocks, W.
    pub stderr: Matrix,
}

/// Paths, or points, that a block really has: more than `plan` asks for where the surfaces between the walls are divided into texture
/// cells, each of which gets its share rounded up.
pub fn block_size(scene: &Scene, plan: &Plan) -> usize {
    let beams = Beams::new(scene);
    let setting = Setting::new(scene, plan, &beams, 0..1);
    let own = || (0..scene.camera.pixels()).any(|p| OwnPoints::fits(&setting, p));
    if plan.estimator == Estimator::Factored || own() {
        return setting.strata.block_size();
    }
    plan.budget.size as usize
}

/// The surface for which `plan` has no estimator, by name: [`Estimator::Factored`] needs all that light may meet between the first and the
/// last wall to be Lambertian, for its points are the same for all pixels and spots.
pub fn obstacle<'a>(scene: &'a Scene, plan: &Plan) -> Option<&'a str> {
    if plan.estimator != Estimator::Factored || scene.surfaces.iter().all(Surface::is_lambertian) {
        return None;
    }
    let beams = Beams::new(scene);
    let setting = Setting::new(scene, plan, &beams, 0..1);
    let met = setting.between.iter().map(|s| &scene.surfaces[*s as usize]);
    let glossy = met.filter(|s| !s.is_lambertian()).map(|s| s.name.as_str());
    glossy.into_iter().next()
}

/// Which bits a plan leads to, apart from the plan itself: raised whenever a change of the tracer, of the random streams or of the order of sums
/// changes any of them. What was traced under another number is never added to what is traced under this one.
pub const NUMERICS: u32 = 1;

/// Traces the columns `spots` of Φcam. The same plan gives the same bits for every number of threads and every range
/// that a spot is part of. `None` if it was stopped.
///
/// # Panics
/// If `spots` reaches beyond the scene's spots, or there is an [`obstacle`].
pub fn render(
    scene: &Scene,
    plan: &Plan,
    spots: Range<usize>,
    control: Control<'_>,
) -> Option<Traced> {
    let tally = Tally::new(scene, plan, spots.len(), 0);
    if spots.is_empty() {
        return Some(tally.dark());
    }
    let go_on = &mut |_: &Tally| ControlFlow::Continue(u32::MAX);
    trace(
        scene,
        plan,
        spots,
        tally,
        plan.budget.blocks,
        control,
        go_on,
    )
    .traced()
}

/// Traces the columns `spots` from where `tally` ends up to block `end` (exclusive). After the first few blocks, one if they are long, `after` sees
/// what is there; it ends the work, or says how many blocks to trace before it looks again (under `Factored` it sees every one). What comes back is shorter than asked for if it did, or if `control` says stop; what is there is whole
/// in any case, and can be gone on with.
///
/// # Panics
/// If `spots` reaches beyond the scene's spots, `tally` is not of these columns, or there is an [`obstacle`].
pub fn trace(
    scene: &Scene,
    plan: &Plan,
    spots: Range<usize>,
    tally: Tally,
    end: u32,
    control: Control<'_>,
    after: &mut dyn FnMut(&Tally) -> ControlFlow<(), u32>,
) -> Tally {
    assert!(
        tally.is_of(scene, plan, spots.len()),
        "a tally of other columns"
    );
    if spots.is_empty() || tally.range().end >= end {
        return tally;
    }
    let beams = Beams::new(scene);
    let setting = Setting::new(scene, plan, &beams, spots.clone());
    if plan.estimator == Estimator::Factored {
        assert!(
            setting.plain,
            "factored needs Lambertian surfaces between the walls"
        );
        return Factored::new(&setting).trace(tally, end, control, after);
    }
    by_pixel(&setting, &spots, tally, end, control, after)
}

/// Paths that are traced before the first look at what is there.
const FIRST_LOOK: u64 = 1 << 18;

/// Every pixel on its own, a few blocks at a time.
fn by_pixel(
    setting: &Setting<'_>,
    spots: &Range<usize>,
    mut tally: Tally,
    end: u32,
    control: Control<'_>,
    after: &mut dyn FnMut(&Tally) -> ControlFlow<(), u32>,
) -> Tally {
    let plan = setting.plan;
    let tracer = PixelTracer::new(setting);
    let pixels = setting.scene.camera.pixels();
    let serve_all = plan.estimator.serves_all_spots();
    let paths = u64::from(plan.budget.size) * if serve_all { 1 } else { spots.len() as u64 };
    let all = paths.saturating_mul(pixels as u64).max(1);
    let mut together = u32::try_from(FIRST_LOOK / all).unwrap_or(u32::MAX).max(1);
    while tally.range().end < end {
        let first = tally.range().end;
        let blocks = first..end.min(first.saturating_add(together));
        let row = |pixel| {
            if control.stop.load(Ordering::Relaxed) {
                return None;
            }
            let row = tracer.trace(pixel, spots, blocks.clone());
            (control.progress)(paths * u64::from(blocks.end - blocks.start));
            Some(row)
        };
        let rows: Option<Vec<Tree<Moments>>> = (0..pixels).into_par_iter().map(row).collect();
        let Some(rows) = rows else { break };
        tally.add_rows(&rows).expect("blocks follow one another");
        match after(&tally) {
            ControlFlow::Break(()) => break,
            ControlFlow::Continue(blocks) => together = blocks.max(1),
        }
    }
    tally
}
