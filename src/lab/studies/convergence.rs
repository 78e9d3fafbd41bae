//! How fast does the error of each estimator fall?

mod curves;
mod slope;

use std::ops::Range;

use super::registered::{Registered, prepared};
use super::traced::{SHARES, TracedSpots, share};
use crate::lab::error::LabError;
use crate::lab::options::Opt;
use crate::lab::problem::lit;
use crate::lab::study::{Sharing, Study, Work};
use crate::matrix::Matrix;
use crate::num::stream::Sampling;
use crate::scene::{Role, Scene};
use crate::transport::{Budget, Control, Estimator, Plan, render};
pub use curves::{Bend, Convergence, Curve, Step};
use slope::{bend, slope, slope_bound, slope_scatter};

const REFLECTING: LabError = LabError::Unsuited(
    "the reference is a quadrature of what meets wall, hidden surface and wall, and an occluder reflects light too (make it black: `material = { lambertian = 0 }`)",
);
const GLOSSY: LabError = LabError::Unsuited(
    "the reference is a quadrature of a Lambertian object, and the scene's is none (use `lambertian` for the hidden surface)",
);
/// Not numbers of paths to draw a line through.
const TOO_FEW: LabError = LabError::Unsuited(
    "the error needs at least two different numbers of samples, each from 1 to 2³² (give, e.g., --samples 64,256)",
);

/// `phicam study convergence`.
pub(super) const STUDY: Registered = Registered {
    name: "convergence",
    about: "How fast the error of each estimator falls: table, JSON, figure",
    scene: Some("thesis"),
    files: "convergence.svg",
    options: &[
        Opt::paths("samples", "Numbers of paths, separated by commas")
            .or("64,128,256,512,1024")
            .list(),
        Opt::seed("Seed"),
    ],
    prepare: |scene, values| {
        let samples: Vec<u64> = values.list("samples")?;
        let tasks = ConvergenceTasks::new(scene, &samples, values.one("seed")?);
        // Before a folder is begun.
        tasks.check()?;
        Ok(prepared(tasks))
    },
};

/// Renders the three-bounce light of a scene with growing numbers of paths, and compares each with
/// converged quadrature. A task is one render; where every spot has paths of its own, that of some
/// of the spots.
#[derive(Debug)]
pub struct ConvergenceTasks {
    scene: Scene,
    samples: Vec<u64>,
    seed: u64,
    renders: Vec<Render>,
}

/// What renders are held against.
#[derive(Debug)]
pub struct Reference {
    /// The three-bounce integral, pixels × spots, W.
    phi: Matrix,
    /// β: how far off it may be, relative Frobenius norm.
    bound: f64,
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
    fn check(&self) -> Result<(), LabError> {
        if self.scene.hidden().any(|(_, s)| !s.is_lambertian()) {
            return Err(GLOSSY);
        }
        let mut samples = self.samples.clone();
        samples.sort_unstable();
        samples.dedup();
        if samples.len() < 2 {
            return Err(TOO_FEW);
        }
        let mut surfaces = self.scene.surfaces.iter();
        if surfaces.any(|s| s.role == Role::Occluder && !s.is_black()) {
            return Err(REFLECTING);
        }
        Ok(())
    }
}

impl Study for ConvergenceTasks {
    type Context = Reference;
    type Output = TracedSpots;
    type Result = Convergence;
    type Error = LabError;

    /// Both samplers: of the two estimators whose paths serve all spots only one is counted, the
    /// other has next to none.
    fn work(&self) -> Work {
        let each = self
            .samples
            .iter()
            .fold(0, |sum: u64, n| sum.saturating_add(*n));
        let each = each.saturating_mul(2);
        Work::samples(&self.scene, each, each)
    }

    fn tasks(&self) -> usize {
        self.renders.iter().map(|r| r.shares).sum()
    }

    /// A render is spread over the threads by itself.
    fn sharing(&self) -> Sharing {
        Sharing::InTurn
    }

    fn context(&self, _: Control<'_>) -> Result<Reference, LabError> {
        self.check()?;
        let integral = lit(&self.scene)?;
        Ok(Reference {
            bound: integral.bound.norm() / integral.phi.norm(),
            phi: integral.phi,
        })
    }

    fn task(
        &self,
        _: &Reference,
        index: usize,
        control: Control<'_>,
    ) -> Result<TracedSpots, LabError> {
        let (of, spots) = self.at(index).ok_or(TOO_FEW)?;
        let plan = Plan {
            estimator: of.estimator,
            sampling: of.sampling,
            seed: self.seed,
            budget: of.budget()?,
        };
        let traced = render(&self.scene, &plan, spots, control)?;
        Ok(TracedSpots::of(traced))
    }

    fn fits(&self, truth: &Reference, index: usize, part: &TracedSpots) -> bool {
        let own = self.at(index);
        own.is_some_and(|(_, spots)| part.shaped((truth.phi.nrows(), spots.len())))
    }

    fn finish(&self, truth: &Reference, parts: Vec<TracedSpots>) -> Result<Convergence, LabError> {
        let Reference { phi: truth, bound } = truth;
        let mut parts = parts.iter();
        let mut curves = Vec::new();
        for renders in self.renders.chunks(self.samples.len().max(1)) {
            let step = |of: &Render| {
                let own: Vec<&TracedSpots> = parts.by_ref().take(of.shares).collect();
                let [flux, stderr] = TracedSpots::join(truth.nrows(), own.into_iter());
                Ok(Step {
                    samples: of.budget()?.samples(),
                    error: (flux - truth).norm() / truth.norm(),
                    stated: stderr.norm() / truth.norm(),
                })
            };
            let steps: Vec<Step> = renders.iter().map(step).collect::<Result<_, LabError>>()?;
            curves.push(Curve {
                estimator: renders[0].estimator.name().to_owned(),
                sampler: renders[0].sampling.name().to_owned(),
                slope: slope(&steps).ok_or(TOO_FEW)?,
                slope_bound: slope_bound(&steps, *bound),
                slope_scatter: slope_scatter(&steps),
                bend: bend(&steps),
                steps,
            });
        }
        Ok(Convergence {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            seed: self.seed,
            quadrature_bound: *bound,
            curves,
        })
    }
}

impl Render {
    fn budget(self) -> Result<Budget, LabError> {
        Budget::new(self.samples, self.sampling).map_err(|_| TOO_FEW)
    }
}

#[cfg(test)]
mod tests;
