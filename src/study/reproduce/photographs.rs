//! Traced photographs, as the items take them.

use std::ops::Range;

use super::{ReproduceError, Watch};
use crate::num::stream::Sampling;
use crate::scene::Scene;
use crate::transport::{Budget, Control, Estimator, Plan, Traced, render};

/// Independent replicates behind each standard error.
pub(super) const REPLICATES: u32 = 32;

/// Traces the columns `spots` of Φcam with 32 replicates of `size` Owen-scrambled Sobol' points for every pixel and spot: errors of different entries are independent.
pub(super) fn traced(
    scene: &Scene,
    size: u32,
    seed: u64,
    spots: Range<usize>,
    watch: Watch<'_>,
) -> Result<Traced, ReproduceError> {
    let plan = Plan {
        estimator: Estimator::Independent,
        sampling: Sampling::Sobol,
        seed,
        budget: Budget {
            blocks: REPLICATES,
            size,
        },
    };
    let control = Control {
        progress: &|_| (),
        stop: watch.0,
    };
    render(scene, &plan, spots, control).ok_or(ReproduceError::Stopped)
}
