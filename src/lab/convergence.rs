//! How fast does the error of each estimator fall?

use std::ops::Range;

use serde::Serialize;

use super::error::LabError;
use super::finding::{
    self, Axis, Cell, Column, Describe, Figure, Finding, Mark, Plot, Table, listed,
};
use super::options::Opt;
use super::registered::{Registered, prepared};
use super::study::{Sharing, Study, Work};
use super::traced::{SHARES, TracedSpots, share};
use crate::matrix::Matrix;
use crate::model::{Extent, Kernel, converged};
use crate::num::digits::figure;
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

impl Convergence {
    /// How fast the errors of each sampler fall, and which is the least.
    fn sentence(&self) -> String {
        let mut samplers: Vec<&str> = self.curves.iter().map(|c| c.sampler.as_str()).collect();
        samplers.sort_unstable();
        samplers.dedup();
        let range = |sampler: &&str| {
            let own = self.curves.iter().filter(|c| c.sampler == **sampler);
            let none = [f64::INFINITY, f64::NEG_INFINITY];
            let [low, high] = own.fold(none, |[l, h], c| [l.min(c.slope), h.max(c.slope)]);
            format!(
                "of {sampler} by a slope of {} to {}",
                figure(low, 3),
                figure(high, 3)
            )
        };
        let ranges: Vec<String> = samplers.iter().map(range).collect();
        let last = self
            .curves
            .iter()
            .filter_map(|c| Some((c, c.steps.last()?)));
        let least = last.min_by(|a, b| a.1.error.total_cmp(&b.1.error));
        let least = least.map_or(String::new(), |(c, s)| {
            format!(
                " The smallest error, {}, is that of {}, {} with {} samples.",
                figure(s.error, 2),
                c.estimator,
                c.sampler,
                s.samples
            )
        });
        format!(
            "The relative error of Φcam on {} falls with the number of samples: that {} \
             (independent random numbers have a slope of −½).{least}",
            self.scene,
            listed(&ranges)
        )
    }
}

impl Describe for Convergence {
    fn describe(&self) -> Finding {
        let title = format!("How fast the error falls: {}", self.scene);
        let named = |c: &Curve| {
            [&c.estimator, &c.sampler]
                .map(|n| Cell::Name(n.clone()))
                .to_vec()
        };
        let with = |c: &Curve, more: Vec<Cell>| [named(c), more].concat();
        let heads = [Column::text("estimator", ""), Column::text("sampler", "")];
        let slopes = Table {
            caption: "Slopes of log error against log samples".to_owned(),
            columns: [&heads[..], &[Column::number("slope", "", "", 3)]].concat(),
            rows: self
                .curves
                .iter()
                .map(|c| with(c, vec![c.slope.into()]))
                .collect(),
            ..Table::default()
        };
        let step =
            |c: &Curve, s: &Step| with(c, vec![s.samples.into(), s.error.into(), s.stated.into()]);
        let numbers = [
            Column::text("samples", ""),
            Column::number("error", "", "", 4),
            Column::number("stated standard error", "", "", 4),
        ];
        let steps = Table {
            caption: "Relative error against converged quadrature".to_owned(),
            columns: [&heads[..], &numbers].concat(),
            rows: self
                .curves
                .iter()
                .flat_map(|c| c.steps.iter().map(move |s| step(c, s)))
                .collect(),
            ..Table::default()
        };
        let curve = |c: &Curve| {
            let name = format!(
                "{}, {}: slope {}",
                c.estimator,
                c.sampler,
                figure(c.slope, 3)
            );
            let points = c.steps.iter().map(|s| [s.samples as f64, s.error]);
            finding::Curve::new(name, Mark::Line, points.collect())
        };
        let plot = Plot {
            title: String::new(),
            axes: [
                Axis::decades("paths per pixel (shared) or per pixel and spot (independent)"),
                Axis::decades("‖Φ̂ − Φ‖ / ‖Φ‖"),
            ],
            curves: self.curves.iter().map(curve).collect(),
        };
        Finding {
            sentence: self.sentence(),
            tables: vec![slopes, steps],
            figures: vec![Figure {
                file: "convergence.svg".to_owned(),
                title: title.clone(),
                plots: vec![plot],
                ..Figure::default()
            }],
            title,
            ..Finding::default()
        }
    }
}

const OBSTRUCTED: LabError = LabError::Unsuited(
    "the reference is a quadrature without occlusion, and the scene has surfaces that can block (use a scene of one hidden surface and its wall)",
);
const GLOSSY: LabError = LabError::Unsuited(
    "the reference is a quadrature of a Lambertian object, and the scene's is none (use `lambertian` for the hidden surface)",
);
/// Not numbers of paths to draw a line through.
const TOO_FEW: LabError = LabError::Unsuited(
    "the error needs at least two different numbers of samples, each from 1 to 2³²",
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
        Ok(prepared(ConvergenceTasks::new(
            scene,
            &samples,
            values.one("seed")?,
        )))
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
        let occluders = self.scene.surfaces.iter().any(|s| s.role == Role::Occluder);
        let glossy = self.scene.hidden().any(|(_, s)| !s.is_lambertian());
        if glossy {
            return Err(GLOSSY);
        }
        if occluders || self.scene.hidden().count() > 1 {
            return Err(OBSTRUCTED);
        }
        Ok(())
    }
}

impl Study for ConvergenceTasks {
    /// The three-bounce integral, pixels × spots, W.
    type Context = Matrix;
    type Output = TracedSpots;
    type Result = Convergence;
    type Error = LabError;

    fn name(&self) -> &'static str {
        "convergence"
    }

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

    fn context(&self, _: Control<'_>) -> Result<Matrix, LabError> {
        let truth = converged(&self.scene, Kernel::Physical, Extent::FULL)?.phi;
        self.check()?;
        Ok(truth)
    }

    fn task(
        &self,
        _: &Matrix,
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

    fn fits(&self, truth: &Matrix, index: usize, part: &TracedSpots) -> bool {
        let own = self.at(index);
        own.is_some_and(|(_, spots)| part.shaped((truth.nrows(), spots.len())))
    }

    fn finish(&self, truth: &Matrix, parts: Vec<TracedSpots>) -> Result<Convergence, LabError> {
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
    fn budget(self) -> Result<Budget, LabError> {
        Budget::new(self.samples, self.sampling).map_err(|_| TOO_FEW)
    }
}

/// Least-squares slope of ln error against ln samples; `None` for fewer than two different numbers
/// of samples.
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
mod tests;
