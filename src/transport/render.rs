//! The estimators of Φcam.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::beam::Beams;
use super::factored::Factored;
use super::own::OwnPoints;
use super::pixel::PixelTracer;
use super::setting::Setting;
use crate::matrix::Matrix;
use crate::num::stream::{LARGEST_NET, Sampling};
use crate::num::summation::mean_and_stderr;
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

impl Traced {
    /// No columns at all.
    fn dark(pixels: usize, orders: usize) -> Self {
        let nothing = || Matrix::zeros(pixels, 0);
        Self {
            bounces: (0..orders).map(|_| nothing()).collect(),
            flux: nothing(),
            stderr: nothing(),
        }
    }
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
    let columns = spots.len();
    let pixels = scene.camera.pixels();
    let orders = scene.max_bounces as usize;
    if spots.is_empty() {
        return Some(Traced::dark(pixels, orders));
    }
    let beams = Beams::new(scene);
    let setting = Setting::new(scene, plan, &beams, spots.clone());
    if plan.estimator == Estimator::Factored {
        assert!(
            setting.plain,
            "factored needs Lambertian surfaces between the walls"
        );
        return Factored::new(&setting).render(control);
    }
    let tracer = PixelTracer::new(&setting);
    let rows: Vec<Option<Row>> = (0..pixels)
        .into_par_iter()
        .map(|pixel| {
            if control.stop.load(Ordering::Relaxed) {
                return None;
            }
            let sums = tracer.trace(pixel, &spots);
            let row = Row::from_blocks(&sums, orders, columns);
            let shared = plan.estimator == Estimator::Shared;
            let paths = plan.budget.samples() * if shared { 1 } else { columns as u64 };
            (control.progress)(paths);
            Some(row)
        })
        .collect();
    let rows: Vec<Row> = rows.into_iter().collect::<Option<_>>()?;
    let gather =
        |f: &dyn Fn(&Row, usize) -> f64| Matrix::from_fn(pixels, columns, |p, l| f(&rows[p], l));
    Some(Traced {
        bounces: (0..orders)
            .map(|n| gather(&|row, l| row.bounces[n * columns + l]))
            .collect(),
        flux: gather(&|row, l| row.flux[l]),
        stderr: gather(&|row, l| row.stderr[l]),
    })
}

/// One row of Φcam.
struct Row {
    /// \[order · columns + column\].
    bounces: Vec<f64>,
    flux: Vec<f64>,
    stderr: Vec<f64>,
}

impl Row {
    /// Means and standard errors from the estimates of the blocks \[block\]\[order · columns + column\].
    fn from_blocks(blocks: &[Vec<f64>], orders: usize, columns: usize) -> Self {
        let replicates = |f: &dyn Fn(&Vec<f64>) -> f64| {
            let means: Vec<f64> = blocks.iter().map(f).collect();
            mean_and_stderr(&means)
        };
        let bounces: Vec<f64> = (0..orders * columns)
            .map(|i| replicates(&|block| block[i]).0)
            .collect();
        let total = |values: &[f64], l: usize| (0..orders).map(|n| values[n * columns + l]).sum();
        let flux = (0..columns).map(|l| total(&bounces, l)).collect();
        let stderr = (0..columns)
            .map(|l| replicates(&|block| total(block, l)).1)
            .collect();
        Self {
            bounces,
            flux,
            stderr,
        }
    }
}
