//! How fast does the error of each estimator fall?

use std::ops::Range;

use serde::Serialize;

use super::task::matrix::{Columns, SHARES, share};
use super::task::{Division, Sharing};
use crate::matrix::Matrix;
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

/// Renders the three-bounce light of a scene with growing numbers of paths, and compares each with converged quadrature. A task is one render; where every spot has
/// paths of its own, that of some of the spots.
#[derive(Debug)]
pub struct ConvergenceTasks {
    scene: Scene,
    samples: Vec<u64>,
    seed: u64,
    renders: Vec<Render>,
}

/// A render with its tasks.
#[derive(Clone, Copy, Debug)]
struct Render {
    estimator: Estimator,
    sampling: Sampling,
    samples: u64,
    shares: usize,
}

impl ConvergenceTasks {
    /// The study of a scene with these numbers of paths.
    pub fn new(scene: &Scene, samples: &[u64], seed: u64) -> Self {
        let render = |estimator: Estimator, sampling| {
            samples.iter().map(move |samples| Render {
                estimator,
                sampling,
                samples: *samples,
                shares: if estimator.serves_all_spots() {
                    1
                } else {
                    SHARES
                },
            })
        };
        let samplings = [Sampling::Pcg, Sampling::Sobol];
        let renders = Estimator::ALL
            .into_iter()
            .flat_map(|e| samplings.into_iter().flat_map(move |s| render(e, s)));
        Self {
            scene: scene.with_max_bounces(3),
            samples: samples.to_vec(),
            seed,
            renders: renders.collect(),
        }
    }

    /// The render of a task, and its spots.
    fn at(&self, index: usize) -> Option<(Render, Range<usize>)> {
        let mut tasks = self
            .renders
            .iter()
            .flat_map(|r| (0..r.shares).map(move |k| (*r, k)));
        let (render, k) = tasks.nth(index)?;
        Some((render, share(&self.scene, k, render.shares)))
    }

    /// Refuses what the reference does not know.
    fn check(&self) -> Result<(), ConvergenceError> {
        let occluders = self.scene.surfaces.iter().any(|s| s.role == Role::Occluder);
        let glossy = self.scene.hidden().any(|(_, s)| !s.is_lambertian());
        if glossy {
            return Err(ConvergenceError::Glossy);
        }
        if occluders || self.scene.hidden().count() > 1 {
            return Err(ConvergenceError::Obstructed);
        }
        Ok(())
    }
}

impl Division for ConvergenceTasks {
    /// The three-bounce integral, pixels × spots, W.
    type Ground = Matrix;
    type Part = Columns;
    type Finding = Convergence;
    type Error = ConvergenceError;

    fn tasks(&self) -> usize {
        self.renders.iter().map(|r| r.shares).sum()
    }

    /// A render is spread over the threads by itself.
    fn sharing(&self) -> Sharing {
        Sharing::InTurn
    }

    fn ground(&self, _: Control<'_>) -> Result<Option<Matrix>, ConvergenceError> {
        let truth = converged(&self.scene, Kernel::Physical, Extent::FULL)?.phi;
        self.check()?;
        Ok(Some(truth))
    }

    fn task(
        &self,
        _: &Matrix,
        index: usize,
        control: Control<'_>,
    ) -> Result<Option<Columns>, ConvergenceError> {
        let Some((of, spots)) = self.at(index) else {
            return Ok(None);
        };
        let plan = Plan {
            estimator: of.estimator,
            sampling: of.sampling,
            seed: self.seed,
            budget: of.budget()?,
        };
        let traced = render(&self.scene, &plan, spots, control);
        Ok(traced.map(Columns::of))
    }

    fn fits(&self, truth: &Matrix, index: usize, part: &Columns) -> bool {
        let own = self.at(index);
        own.is_some_and(|(_, spots)| part.shaped((truth.nrows(), spots.len())))
    }

    fn finish(&self, truth: &Matrix, parts: Vec<Columns>) -> Result<Convergence, ConvergenceError> {
        let mut parts = parts.iter();
        let mut curves = Vec::new();
        for renders in self.renders.chunks(self.samples.len().max(1)) {
            let step = |of: &Render| {
                let own: Vec<&Columns> = parts.by_ref().take(of.shares).collect();
                let [flux, stderr] = Columns::join(truth.nrows(), own.into_iter());
                Ok(Step {
                    samples: of.budget()?.samples(),
                    error: (flux - truth).norm() / truth.norm(),
                    stated: stderr.norm() / truth.norm(),
                })
            };
            let steps: Vec<Step> = renders
                .iter()
                .map(step)
                .collect::<Result<_, ConvergenceError>>()?;
            curves.push(Curve {
                estimator: renders[0].estimator.name().to_owned(),
                sampler: renders[0].sampling.name().to_owned(),
                slope: slope(&steps).ok_or(ConvergenceError::Samples)?,
                steps,
            });
        }
        Ok(Convergence {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            seed: self.seed,
            curves,
        })
    }
}

impl Render {
    fn budget(self) -> Result<Budget, ConvergenceError> {
        Budget::new(self.samples, self.sampling).ok_or(ConvergenceError::Samples)
    }
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
    use crate::study::task::tests::{divides, refuses, small, unstopped};

    #[test]
    fn it_divides() {
        let tasks = ConvergenceTasks::new(&small("bench"), &[32, 64], 7);
        assert_eq!(divides(&tasks).curves.len(), 6);
        // The last task is of all spots, the first of some.
        let ground = unstopped(|c| tasks.ground(c)).unwrap().unwrap();
        let last = unstopped(|c| tasks.task(&ground, tasks.tasks() - 1, c));
        refuses(&tasks, 0, &last.unwrap().unwrap());
    }

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
