//! How the errors fall, in tables and a figure.

use serde::Serialize;

use crate::lab::finding::{
    self, Axis, Cell, Column, Describe, Figure, Finding, Mark, Plot, Table, listed,
};
use crate::num::digits::figure;

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
    /// How far the bound of the quadrature may have moved it; `None` where an error is below that
    /// bound.
    pub slope_bound: Option<f64>,
    /// Its standard error by how the errors lie about their line; `None` of fewer than three.
    pub slope_scatter: Option<f64>,
    /// Where the stated standard errors fall along no line.
    pub bend: Option<Bend>,
}

/// A step between two numbers of paths at which the stated standard errors leave their line.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bend {
    /// From and to how many.
    pub samples: [u64; 2],
    /// By how many times they fall there.
    pub by: f64,
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
    /// β: ‖bound‖/‖Φ‖ of the quadrature. Errors below it are not measured.
    pub quadrature_bound: f64,
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
        let lost = self.curves.iter().filter(|c| c.slope_bound.is_none());
        let lost: Vec<String> = lost
            .map(|c| format!("{}, {}", c.estimator, c.sampler))
            .collect();
        let floor = if lost.is_empty() {
            String::new()
        } else {
            format!(
                " The quadrature is itself known to {} only: errors of {} fall below that, and \
                 their slopes are its.",
                figure(self.quadrature_bound, 2),
                listed(&lost)
            )
        };
        format!(
            "The relative error of Φcam on {} falls with the number of samples: that {} \
             (independent random numbers have a slope of −½).{}{least}{floor}",
            self.scene,
            listed(&ranges),
            self.bent()
        )
    }
}

impl Convergence {
    /// Whose errors fall along no line, and where they leave it.
    fn bent(&self) -> String {
        let bent = self.curves.iter().filter_map(|c| {
            let Bend { samples, by } = c.bend?;
            Some(format!(
                "of {}, {} by {} from {} to {} samples",
                c.estimator,
                c.sampler,
                figure(by, 2),
                samples[0],
                samples[1]
            ))
        });
        let bent: Vec<String> = bent.collect();
        if bent.is_empty() {
            return String::new();
        }
        format!(
            " Some fall along no line, and have no one slope: stated errors {}. Mostly such a step \
             is where a block first has a point for each lit cell of a texture.",
            listed(&bent)
        )
    }
}

impl Describe for Convergence {
    fn describe(&self) -> Finding {
        let title = format!("How fast the error falls: {}", self.scene);
        let slopes = Table {
            caption: "Slopes of log error against log samples".to_owned(),
            ..Table::of(
                &self.curves,
                [
                    Column::text("estimator", "").of(|c| Cell::name(&c.estimator)),
                    Column::text("sampler", "").of(|c| Cell::name(&c.sampler)),
                    Column::number("slope", "", "", 3).of(|c| c.slope.into()),
                    Column::number("± by the scatter", "slope_scatter", "", 2)
                        .of(|c| c.slope_scatter.into()),
                    Column::number("± by the quadrature", "slope_bound", "", 2)
                        .of(|c| c.slope_bound.into()),
                ],
            )
        };
        let curves = self.curves.iter();
        let steps = Table {
            caption: "Relative error against converged quadrature".to_owned(),
            ..Table::of(
                curves.flat_map(|c| c.steps.iter().map(move |s| (c, s))),
                [
                    Column::text("estimator", "").of(|(c, _)| Cell::name(&c.estimator)),
                    Column::text("sampler", "").of(|(c, _)| Cell::name(&c.sampler)),
                    Column::text("samples", "").of(|(_, s)| s.samples.into()),
                    Column::number("error", "", "", 4).of(|(_, s)| s.error.into()),
                    Column::number("stated standard error", "", "", 4).of(|(_, s)| s.stated.into()),
                ],
            )
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
        let across = "paths per pixel (shared) or per pixel and spot (independent)";
        let axes = [across, "‖Φ̂ − Φ‖ / ‖Φ‖"].map(Axis::decades);
        let plot = Plot::new("", axes, self.curves.iter().map(curve).collect());
        Finding {
            sentence: self.sentence(),
            notes: vec![format!(
                "The quadrature's own bound is {} of ‖Φcam‖: so much an error may be off.",
                figure(self.quadrature_bound, 2)
            )],
            tables: vec![slopes, steps],
            figures: vec![Figure::new("convergence.svg", &title, vec![plot])],
            title,
            ..Finding::default()
        }
    }
}
