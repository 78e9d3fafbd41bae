//! Φcam as a whole: traced, modelled, and z.

use super::super::colour::Scale;
use super::super::figure::{Entries, MOST, Reduction, figure, legend, note, reduced};
use super::super::page::{bare, table};
use super::super::panel::Panel;
use crate::lab::{Agreement, RunResults};
use crate::matrix::Matrix;
use crate::num::digits::significant;

/// A matrix of pixels × spots: spots to the right, pixels upwards.
fn map(title: &str, matrix: &Matrix, reduction: Reduction) -> (Panel, Option<String>) {
    let size = [matrix.ncols(), matrix.nrows()];
    let value = |spot: usize, pixel: usize| matrix[(pixel, spot)];
    reduced(
        title.to_owned(),
        ["spot", "pixel"],
        size,
        2 * MOST,
        reduction,
        value,
    )
}

fn ends(matrix: &Matrix) -> [usize; 2] {
    [matrix.ncols(), matrix.nrows()].map(|n| n.saturating_sub(1))
}

/// Φcam, traced and modelled.
pub(super) fn matrices(results: &RunResults) -> String {
    if results.phi.is_empty() {
        return String::new();
    }
    let (traced, said) = map("Φcam, traced", &results.phi, Reduction::Mean);
    let mut panels = vec![traced];
    if let Some(model) = &results.model {
        panels.push(map("Φcam, modelled", model, Reduction::Mean).0);
    }
    let scale = Scale::sequential(panels.iter().flat_map(|p| &p.values));
    let figures: String = panels
        .iter()
        .map(|p| figure(p, ends(&results.phi), Entries::Stretched, &scale, ""))
        .collect();
    format!(
        "<p>Flux into every pixel (upwards: column + row · {} columns) for every spot (to the \
         right), on one scale.</p>\n<div class=\"row\">\n{figures}</div>\n{}{}",
        results.scene.camera.columns,
        legend(&scale, "W", &panels),
        note(said)
    )
}

/// z of every entry, the entries that stand out most, and the parameters of the scene fitted alone.
pub(super) fn deviations(results: &RunResults) -> String {
    let mut html = String::new();
    let limit = results.agreement.as_ref().map_or(4.0, |a| a.z_limit);
    if let Some(z) = results.z.as_ref().filter(|z| !z.is_empty()) {
        let scale = Scale::symmetric(limit);
        let (panel, said) = map("z", z, Reduction::Pick);
        let [_, shown] = scale.range();
        html.push_str(&format!(
            "<p>z: the difference of every entry in units of its standard error, as the standard normal deviate that \
             is as improbable by Student's law of N − 1 degrees of freedom, of N blocks. If the \
             model is right it is noise, without pattern, and stays within ±{}. \
             It is 0 where the entry is left out, as its standard error is in doubt, and where the difference is no \
             more than the model's stated bound, which is taken off first.</p>\n<div class=\"beside\">\n<div>\n{}{}{}</div>\n{}</div>\n",
            significant(shown, 2),
            figure(&panel, ends(z), Entries::Stretched, &scale, ""),
            legend(&scale, "standard errors", &[panel]),
            note(said),
            worst(results)
        ));
    }
    let parameters = results.agreement.as_ref().and_then(Agreement::parameters);
    html + &parameters.as_ref().map_or(String::new(), table)
}

/// The entries that stand out most.
fn worst(results: &RunResults) -> String {
    let agreement = results.agreement.as_ref().filter(|a| !a.worst.is_empty());
    agreement.map_or(String::new(), |agreement| {
        format!(
            "<div>\n<p>The entries that differ most:</p>\n{}</div>\n",
            bare(&agreement.worst_entries())
        )
    })
}
