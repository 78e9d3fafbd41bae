//! Settings and results of the tracer.

use std::ops::Range;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::tails::flag_neighbours;
use crate::matrix::Matrix;
use crate::num::control::Stopped;
use crate::num::named::{Named, named};
use crate::num::stream::{LARGEST_NET, Sampling};

named! {
    /// What paths have in common. All are unbiased.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Estimator {
        /// Every (pixel, spot) entry has its own paths: errors are independent.
        Independent = "independent": "Every (pixel, spot) entry has its own paths",
        /// The paths of a pixel serve all spots, one connection per spot and vertex: errors along a
        /// row of Φcam are correlated.
        Shared = "shared": "The paths of a pixel serve all spots",
        /// The points between first and last wall serve all pixels and all spots: Φ̂ is a matrix
        /// product, and the errors of all entries are correlated.
        Factored = "factored": "The points between the walls serve all pixels and all spots",
    }
}

impl Estimator {
    /// Whether one path, or point, serves every spot.
    pub fn serves_all_spots(self) -> bool {
        self != Self::Independent
    }
}

impl FromStr for Estimator {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::by_name(text);
        found.ok_or_else(|| format!("no estimator `{text}` (use independent, shared or factored)"))
    }
}

/// How many paths, in how many independent blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Budget {
    /// Blocks: replicates with random numbers of their own, from whose spread the standard error
    /// comes.
    pub blocks: u32,
    /// Paths in each block.
    pub size: u32,
}

/// A number of paths that cannot be traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0} paths cannot be traced; use at least 1 and at most 2³²")]
pub struct SamplesError(pub u64);

/// Blocks that the samples are divided into, unless that makes a block too large.
const REPLICATES: u64 = 32;

impl Budget {
    /// At least `samples` paths, rounded up to whole blocks: 32 of them; with Sobol' points a block
    /// is a power of two (a net), at most 2¹⁶, and more blocks follow beyond that.
    ///
    /// # Errors
    /// [`SamplesError`] for no samples or more than 2³².
    pub fn new(samples: u64, sampling: Sampling) -> Result<Self, SamplesError> {
        if samples == 0 || samples > 1 << 32 {
            return Err(SamplesError(samples));
        }
        let size = samples.div_ceil(REPLICATES);
        let size = match sampling {
            Sampling::Pcg => size.min(1 << 30),
            Sampling::Sobol => size.next_power_of_two().min(u64::from(LARGEST_NET)),
        };
        let blocks = samples.div_ceil(size).max(REPLICATES);
        let [blocks, size] = [blocks, size].map(|n| u32::try_from(n).expect("below 2³² paths"));
        Ok(Self { blocks, size })
    }

    /// Paths in all.
    pub fn samples(self) -> u64 {
        u64::from(self.blocks) * u64::from(self.size)
    }
}

/// What to render. Files hold it as `seed`, `samples`, `blocks`, `estimator` and `sampler`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "Stored", try_from = "Stored")]
pub struct Plan {
    /// What paths have in common.
    pub estimator: Estimator,
    /// Where their random numbers come from.
    pub sampling: Sampling,
    /// Seed of the run.
    pub seed: u64,
    /// Paths per pixel and spot (`Independent`), paths per pixel (`Shared`) or points between the
    /// walls (`Factored`).
    pub budget: Budget,
}

impl Plan {
    /// The plan of at least `samples` samples, in whole blocks ([`Budget::new`]).
    ///
    /// # Errors
    /// [`SamplesError`].
    pub fn new(
        estimator: Estimator,
        sampling: Sampling,
        seed: u64,
        samples: u64,
    ) -> Result<Self, SamplesError> {
        Ok(Self {
            estimator,
            sampling,
            seed,
            budget: Budget::new(samples, sampling)?,
        })
    }
}

impl std::fmt::Display for Plan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            estimator,
            sampling,
            seed,
            budget,
        } = self;
        let samples = budget.samples();
        write!(f, "{estimator}, {sampling}, {samples} samples, seed {seed}")
    }
}

/// A [`Plan`] as files hold it.
#[derive(Serialize, Deserialize)]
struct Stored {
    seed: u64,
    samples: u64,
    blocks: u32,
    estimator: Estimator,
    sampler: Sampling,
}

impl From<Plan> for Stored {
    fn from(plan: Plan) -> Self {
        Self {
            seed: plan.seed,
            samples: plan.budget.samples(),
            blocks: plan.budget.blocks,
            estimator: plan.estimator,
            sampler: plan.sampling,
        }
    }
}

impl TryFrom<Stored> for Plan {
    type Error = String;

    fn try_from(stored: Stored) -> Result<Self, String> {
        let Stored {
            seed,
            samples,
            blocks,
            ..
        } = stored;
        let plan = Self::new(stored.estimator, stored.sampler, seed, samples);
        let plan = plan.map_err(|error| error.to_string())?;
        if (plan.budget.samples(), plan.budget.blocks) == (samples, blocks) {
            return Ok(plan);
        }
        Err(format!(
            "{samples} samples in {blocks} blocks are no division that this version makes; \
             use the version of phicam that wrote them"
        ))
    }
}

/// Why columns of Φcam were not traced.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RenderError {
    /// It was stopped from outside before it was finished.
    #[error("{0}")]
    Stopped(#[from] Stopped),
    /// The scene does not have these spots.
    #[error("the scene has {count} spots and no spots {}..{}; ask for spots below {count}", range.start, range.end)]
    NoSuchSpots {
        /// What was asked for.
        range: Range<usize>,
        /// Spots of the scene.
        count: usize,
    },
    /// The estimator needs a Lambertian surface in its place, or fewer surfaces in a path.
    #[error(
        "estimator factored needs Lambertian surfaces between the walls where light meets more than three, and `{surface}` is none; use shared, or max_bounces = 3"
    )]
    UnsupportedSurface {
        /// Its name.
        surface: String,
    },
    /// The tally to go on from was made for another scene, plan or number of spots.
    #[error("the tally belongs to another scene, plan or number of spots; begin a new one")]
    ForeignTally,
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
    /// How far `stderr` is to be trusted: 0, or bits of [`tails`](super::tails).
    pub tails: Matrix,
}

impl Traced {
    /// [`tails::flag_neighbours`](flag_neighbours) among these columns.
    pub fn flag_neighbours(&mut self) {
        flag_neighbours(&mut self.tails, &self.flux, &self.stderr);
    }
}
