//! How fast does the error of each estimator fall?

use serde::Serialize;

use crate::model::{Extent, Kernel, ModelError, converged};
use crate::num::stream::Sampling;
use crate::scene::{Role, Scene};
use crate::transport::{Budget, Control, Estimator, Plan, render};

/// One number of paths.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Step {
    /// Paths, as the estimator counts them.
    pub samples: u64,
    /// ‖traced − Φ‖/‖Φ‖ against converged quadrature.
    pub error: f64,
    /// ‖standard error‖/‖Φ‖, as the render states it.
    pub stated: f64,
}

/// The error of one estimator and sampler.
#[derive(Clone, Debug, Serialize)]
pub struct Curve {
    /// Estimator.
    pub estimator: String,
    /// Sampler.
    pub sampler: String,
    /// By growing number of paths.
    pub steps: Vec<Step>,
    /// Slope of ln error against ln samples, least squares: −½ for independent random numbers.
    pub slope: f64,
}

/// The study of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Convergence {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Seed.
    pub seed: u64,
    /// Every estimator with every sampler.
    pub curves: Vec<Curve>,
}

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
pub enum ConvergenceError {
    /// The scene has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The quadrature knows no occlusion.
    #[error(
        "the reference is a quadrature without occlusion, and the scene has surfaces that can block (use a scene of one hidden surface and its wall)"
    )]
    Obstructed,
    /// The hidden surface is not Lambertian.
    #[error(
        "the reference is a quadrature of a Lambertian object, and the scene's is none (use `lambertian` for the hidden surface)"
    )]
    Glossy,
    /// Not numbers of paths to draw a line through.
    #[error("the error needs at least two different numbers of samples, each from 1 to 2³²")]
    Samples,
}

/// Renders the three-bounce light of `scene` with growing numbers of paths, and compares each with converged quadrature. `Ok(None)`
/// if stopped.
///
/// # Errors
/// [`ConvergenceError`].
pub fn convergence(
    scene: &Scene,
    samples: &[u64],
    seed: u64,
    control: Control<'_>,
) -> Result<Option<Convergence>, ConvergenceError> {
    let scene = scene.with_max_bounces(3);
    let truth = converged(&scene, Kernel::Physical, Extent::FULL)?.phi;
    let occluders = scene.surfaces.iter().any(|s| s.role == Role::Occluder);
    let glossy = scene.hidden().any(|(_, s)| !s.is_lambertian());
    if glossy {
        return Err(ConvergenceError::Glossy);
    }
    if occluders || scene.hidden().count() > 1 {
        return Err(ConvergenceError::Obstructed);
    }
    let mut curves = Vec::new();
    for estimator in Estimator::ALL {
        for sampling in [Sampling::Pcg, Sampling::Sobol] {
            let mut steps: Vec<Step> = Vec::new();
            for &wanted in samples {
                let budget = Budget::new(wanted, sampling).ok_or(ConvergenceError::Samples)?;
                let plan = Plan {
                    estimator,
                    sampling,
                    seed,
                    budget,
                };
                let Some(traced) = render(&scene, &plan, 0..scene.laser.spots.len(), control)
                else {
                    return Ok(None);
                };
                steps.push(Step {
                    samples: budget.samples(),
                    error: (traced.flux - &truth).norm() / truth.norm(),
                    stated: traced.stderr.norm() / truth.norm(),
                });
            }
            let slope = slope(&steps).ok_or(ConvergenceError::Samples)?;
            let (estimator, sampler) = (estimator.name().to_owned(), sampling.name().to_owned());
            curves.push(Curve {
                estimator,
                sampler,
                steps,
                slope,
            });
        }
    }
    Ok(Some(Convergence {
        scene: scene.name.clone(),
        scene_hash: scene.hash.clone(),
        seed,
        curves,
    }))
}

/// Least-squares slope of ln error against ln samples; `None` for fewer than two different numbers of samples.
fn slope(steps: &[Step]) -> Option<f64> {
    let logs: Vec<[f64; 2]> = steps
        .iter()
        .map(|s| [libm::log(s.samples as f64), libm::log(s.error)])
        .collect();
    let n = logs.len() as f64;
    let mean = |d: usize| logs.iter().map(|p| p[d]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let spread: f64 = logs.iter().map(|p| (p[0] - x) * (p[0] - x)).sum();
    let along: f64 = logs.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    (spread > 0.0).then(|| along / spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_has_its_exponent() {
        let step = |n: f64| Step {
            samples: n as u64,
            error: 3.0 / (n * n.sqrt()),
            stated: 0.0,
        };
        let found = slope(&[step(16.0), step(64.0), step(1024.0)]).unwrap();
        assert!((found + 1.5).abs() < 1e-12, "{found}");
        assert_eq!(slope(&[step(16.0), step(16.0)]), None);
    }
}
