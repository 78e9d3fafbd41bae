//! Where the noise of a render lies on an axis.

use serde::{Deserialize, Serialize};

use super::axis::NoiseAxis;
use crate::lab::LabError;
use crate::num::stream::Sampling;
use crate::scene::Scene;
use crate::transport::{Budget, Control, Estimator, Plan, render};

/// The noise of a render.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RenderNoise {
    /// Estimator.
    pub estimator: String,
    /// Paths, as the estimator counts them.
    pub samples: u64,
    /// √(mean of (standard error/flux)²) over the lit entries of the spots rendered. Under `shared`
    /// the errors of a row are correlated, so that no method feels them as it feels independent
    /// noise of the same size.
    pub noise: f64,
    /// The level at which an entry of mean flux is as noisy; none on axes where that is not the
    /// whole of the noise.
    pub level: Option<f64>,
}

/// Spots rendered, spread over the layout.
const SPOTS: usize = 4;

/// The estimators of the renders.
pub(super) const ESTIMATORS: [Estimator; 2] = [Estimator::Independent, Estimator::Shared];

/// Renders a few spots (Sobol' points) with `samples` paths.
pub(super) fn render_noise(
    scene: &Scene,
    axis: &NoiseAxis,
    (estimator, samples, seed): (Estimator, u64, u64),
    control: Control<'_>,
) -> Result<RenderNoise, LabError> {
    let spots = scene.laser.spots.len();
    let count = SPOTS.min(spots);
    let budget = Budget::new(samples, Sampling::Sobol)?;
    let plan = Plan {
        estimator,
        sampling: Sampling::Sobol,
        seed,
        budget,
    };
    let mut squares = Vec::new();
    for spot in (0..count).map(|k| k * spots / count) {
        let traced = render(scene, &plan, spot..spot + 1, control)?;
        let entries = traced.flux.iter().zip(traced.stderr.iter());
        let lit = entries.filter(|(flux, _)| **flux > 0.0);
        squares.extend(lit.map(|(flux, stderr)| (stderr / flux) * (stderr / flux)));
    }
    let noise = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    Ok(RenderNoise {
        estimator: estimator.name().to_owned(),
        samples: budget.samples(),
        noise,
        level: axis.of_relative(noise),
    })
}
