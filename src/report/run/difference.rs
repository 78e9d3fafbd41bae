//! What the difference between traced and modelled light is made of.

use super::super::axis::significant;
use super::super::page::explained;
use super::super::svg::{escape, number};
use crate::study::RunResults;

/// A table of shares of ‖modelled Φcam‖: the measured difference, its part along the model (a scale) and across it (a shape), and what is known of the
/// causes: noise of the path tracer, the model's discretisation, light that met more surfaces than the model counts.
///
/// With s the best scale, traced − modelled = (traced − s·modelled) + (s − 1)·modelled, and both parts are orthogonal: their squares add up.
pub(super) fn difference(results: &RunResults) -> String {
    let Some(a) = &results.agreement else {
        return String::new();
    };
    let scale = (a.best_scale - 1.0).abs();
    let shape = (a.relative_difference.powi(2) - scale.powi(2))
        .max(0.0)
        .sqrt();
    let beyond = results.bounces.iter().filter(|(n, _)| *n > 3);
    let beyond: f64 = beyond.map(|(_, share)| share).sum();
    let traced = results.scene.max_bounces > 3;
    let rows = [
        ("measured: ‖traced − modelled‖", a.relative_difference, ""),
        (
            "of it a scale that all entries share",
            scale,
            "best single scale less 1",
        ),
        ("of it a pattern", shape, "what the best scale leaves"),
        (
            "expected: noise of the path tracer",
            a.relative_noise,
            "‖standard error‖",
        ),
        (
            "at most: elements and pixels taken at their centres",
            a.relative_discretisation,
            "stated bound of the model; 0 with --integration quadrature",
        ),
        (
            "light that met more than three surfaces",
            if traced { beyond } else { f64::NAN },
            if traced {
                "share of the traced flux; the model has three surfaces"
            } else {
                "not traced: the scene's max_bounces is 3"
            },
        ),
    ];
    let most = rows
        .iter()
        .map(|r| r.1)
        .fold(0.0, f64::max)
        .max(f64::MIN_POSITIVE);
    let row = |(what, share, how): &(&str, f64, &str)| {
        let percent = match share.is_nan() {
            true => "unknown".to_owned(),
            false => format!("{} %", significant(100.0 * share, 3)),
        };
        format!(
            "<tr><td>{}</td><td class=\"n\">{percent}</td><td><span class=\"bar\" style=\"width:{}px\"></span></td><td class=\"note\">{}</td></tr>\n",
            explained(what),
            number(160.0 * share.max(0.0) / most),
            escape(how)
        )
    };
    let file = super::scene_file(&results.scene);
    format!(
        "<p>Shares of ‖modelled Φcam‖ (root of the sum of squares over all entries).</p>\n<div class=\"wide\" tabindex=\"0\" role=\"group\" aria-label=\"Table\"><table>\n\
         <tr><th>what</th><th class=\"n\">share</th><th><span class=\"hidden\">bar</span></th><th>how it is known</th></tr>\n{}</table></div>\n\
         <p class=\"note\"><code>phicam study budget {}</code> takes it apart cause by cause: elements, pixels, spots, bounces, occlusion.</p>\n",
        rows.iter().map(row).collect::<String>(),
        escape(file)
    )
}
