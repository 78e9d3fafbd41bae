//! Where the noise of a render lies on the axis of relative noise.

use serde::Serialize;

use crate::num::stream::Sampling;
use crate::scene::Scene;
use crate::transport::{Budget, Control, Estimator, Plan, render};

/// The noise of a render.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RenderNoise {
    /// Estimator.
    pub estimator: String,
    /// Paths, as the estimator counts them.
    pub samples: u64,
    /// √(mean of (standard error/flux)²) over the lit entries of the spots rendered. Under `shared` the errors of a row are correlated, so that
    /// no method feels them as it feels independent noise of the same size.
    pub noise: f64,
}

/// Spots rendered, spread over the layout.
const SPOTS: usize = 4;

/// Renders a few spots by both estimators (Sobol' points) with each number of paths. `None` if stopped, or for a number of paths that cannot be traced.
pub fn render_noise(
    scene: &Scene,
    samples: &[u64],
    seed: u64,
    control: Control<'_>,
) -> Option<Vec<RenderNoise>> {
    let spots = scene.laser.spots.len();
    let count = SPOTS.min(spots);
    let mut marks = Vec::new();
    for estimator in [Estimator::Independent, Estimator::Shared] {
        for &wanted in samples {
            let budget = Budget::new(wanted, Sampling::Sobol)?;
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
            let mean = squares.iter().sum::<f64>() / squares.len() as f64;
            marks.push(RenderNoise {
                estimator: estimator.name().to_owned(),
                samples: budget.samples(),
                noise: mean.sqrt(),
            });
        }
    }
    Some(marks)
}
