//! The convergence study as text and as a figure.

use super::axis::significant;
use super::chart::{Axis, Series, legend, panel, sheet};
use crate::study::Convergence;

/// The study as plain text: one line per number of paths, and the slope of each curve.
pub fn convergence_table(study: &Convergence) -> String {
    let mut out = format!(
        "{}: relative error of Φcam against converged quadrature\n",
        study.scene
    );
    for c in &study.curves {
        out += &format!(
            "\n{}, {}: slope {}\n",
            c.estimator,
            c.sampler,
            significant(c.slope, 3)
        );
        for s in &c.steps {
            out += &format!(
                "  {:>10} samples  error {:.3e}  stated {:.3e}\n",
                s.samples, s.error, s.stated
            );
        }
    }
    out
}

/// The study as a figure: error against paths, both logarithmic, one line an estimator and sampler.
pub fn convergence_svg(study: &Convergence) -> String {
    let series: Vec<Series> = study
        .curves
        .iter()
        .map(|c| Series {
            name: format!(
                "{}, {}: slope {}",
                c.estimator,
                c.sampler,
                significant(c.slope, 3)
            ),
            points: c
                .steps
                .iter()
                .map(|s| [s.samples as f64, s.error])
                .collect(),
        })
        .collect();
    let points = || series.iter().flat_map(|s| &s.points);
    let x = Axis::decades(
        points().map(|p| p[0]),
        "paths per pixel (shared) or per pixel and spot (independent)",
    );
    let y = Axis::decades(points().map(|p| p[1]), "‖Φ̂ − Φ‖ / ‖Φ‖");
    let title = format!("How fast the error falls: {}", study.scene);
    let mut svg = sheet([900, 440], &title, "");
    panel(&mut svg, [80.0, 50.0], [520.0, 320.0], [&x, &y], &series);
    legend(&mut svg, [626.0, 64.0], &series);
    svg.raw("</svg>\n");
    svg.text
}
