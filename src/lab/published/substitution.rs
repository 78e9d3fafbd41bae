//! Traced Φcam in place of the modelled one, in the items that compare both.

use super::case::{Row, curve};
use super::outcome::{Trial, stretched};
use super::sheet::elements;
use super::traced::NAMES;
use crate::lab::finding::{Axis, Gallery, Plot};

/// A board is told where its normalized MTF is at least this.
const TOLD: f64 = 0.5;

/// The rows of one light.
fn of<'a>(rows: &'a [Row<'a>], light: usize) -> impl Iterator<Item = &'a Row<'a>> {
    rows.iter().filter(move |r| r.phi == NAMES[light])
}

/// Normalized MTF of every light over `across`, a curve for each label.
pub(super) fn plot(rows: &[Row<'_>], across: Axis, x: fn(&Row<'_>) -> f64) -> Plot {
    let mut labels: Vec<&str> = of(rows, 0).map(|r| r.case.label).collect();
    labels.dedup();
    let curves = (0..NAMES.len()).flat_map(|light| labels.iter().map(move |l| (light, *l)));
    let curve = |(light, label): (usize, &str)| {
        let own = of(rows, light).filter(|r| r.case.label == label);
        curve(format!("{}, {label}", NAMES[light]), own, x, |o| {
            o.normalized
        })
    };
    Plot::new(
        "traced in place of modelled Φ, physical kernel",
        [across, Axis::linear("normalized MTF", [-0.4, 1.0])],
        curves.map(curve).collect(),
    )
}

/// What both traced lights come to at the half-widths `shown`.
pub(super) fn gallery(rows: &[Row<'_>], shown: &[f64]) -> Gallery {
    let own = rows
        .iter()
        .filter(|r| NAMES[2..].contains(&r.phi) && shown.contains(&r.half_width()));
    let pictures = own.map(|r| {
        let title = format!("{} in., {}, {}", r.half_width(), r.case.label, r.phi);
        elements(
            title,
            r.case.published.elements,
            stretched(&r.outcome.values),
        )
    });
    Gallery::reflectances(
        "Recovered from traced Φ, physical kernel, stretched to [0, 1]",
        pictures.collect(),
    )
}

/// What becomes of the recovery, and of what.
pub(super) fn words(rows: &[Row<'_>]) -> String {
    let told = |light| {
        of(rows, light)
            .filter(|r| r.outcome.normalized >= Some(TOLD))
            .count()
    };
    let noise = |light| of(rows, light).map(|r| r.outcome.noise).fold(0.0, f64::max);
    let most = |f: fn(&Trial) -> f64| of(rows, 0).map(|r| f(r.trial)).fold(0.0, f64::max);
    format!(
        "Traced in place of modelled Φ: of {} cases {} reach a normalized MTF of {TOLD} with Φ modelled for the footprints' centres, {} with the noise of the render put on it, \
         {} with the mean of the trace and {} with Φ as rendered. The mean is up to {:.1e} of Φ away from the model, which takes elements at their centres, \
         with a standard error of up to {:.1e}; the noise of the render is up to {:.1e}. The inverse multiplies both by up to σ1/σk = {:.1e}.",
        of(rows, 0).count(),
        told(0),
        told(1),
        told(2),
        told(3),
        most(|t| t.difference),
        noise(2),
        noise(3),
        most(|t| t.condition)
    )
}
