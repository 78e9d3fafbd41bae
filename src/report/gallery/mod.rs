//! The gallery of recovered objects.

mod slides;

use super::axis::significant;
use super::colour::Scale;
use super::figure::{Entries, MOST, Reduction, figure, legend, note, reduced};
use super::svg::escape;
use crate::study::{RecoveredObject, RunResults};

pub(super) use slides::slides;

/// More recoveries than this are listed, not shown.
const MOST_PICTURES: usize = 16;

fn optional(x: Option<f64>) -> String {
    x.map_or("–".to_owned(), |x| significant(x, 3))
}

/// What was recovered of each surface, in the order in which they first appear: a run lists it method by method.
pub(super) fn by_surface(recovered: &[RecoveredObject]) -> Vec<Vec<&RecoveredObject>> {
    let mut groups: Vec<Vec<&RecoveredObject>> = Vec::new();
    for object in recovered {
        let same = |group: &&mut Vec<&RecoveredObject>| {
            group[0].surface == object.surface && group[0].elements == object.elements
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.push(object),
            None => groups.push(vec![object]),
        }
    }
    groups
}

/// Recovered objects, surface by surface, beside the truth.
pub(super) fn recoveries(results: &RunResults) -> String {
    let mut html = String::new();
    let mut left = MOST_PICTURES;
    for group in by_surface(&results.recovered) {
        let first = group[0];
        let [nu, nv] = first.elements;
        let scale = Scale::reflectance();
        let picture = |title: &str, values: &[f64]| {
            let value = |i: usize, j: usize| values.get(i + j * nu).copied().unwrap_or(f64::NAN);
            reduced(
                title.to_owned(),
                ["iu", "iv"],
                [nu, nv],
                MOST,
                Reduction::Mean,
                value,
            )
        };
        let (truth, said) = picture("truth", &first.truth);
        let last = [nu, nv].map(|n| n.saturating_sub(1));
        let mut figures = figure(&truth, last, Entries::Square, &scale, "");
        let mut panels = vec![truth];
        let mut table = String::new();
        for (k, r) in group.iter().enumerate() {
            if k < left {
                let (panel, _) = picture(&r.method, &r.reflectance);
                let more = format!(
                    "<br>MTF {} raw, {} normalized",
                    optional(r.mtf_raw),
                    optional(r.mtf_normalized)
                );
                figures.push_str(&figure(&panel, last, Entries::Square, &scale, &more));
                panels.push(panel);
            }
            table.push_str(&recovery_row(r));
        }
        let unseen = group.len().saturating_sub(left);
        left -= left.min(group.len());
        let more = (unseen > 0)
            .then(|| format!("{unseen} of these recoveries are listed without a picture"));
        html.push_str(&format!(
            "<h3>{}</h3>\n<p>Reflectance of {nu} × {nv} elements, black 0, white 1, the same grey scale for \
             all.</p>\n<div class=\"row\">\n{figures}</div>\n{}{}{}<div class=\"wide\" tabindex=\"0\" role=\"group\" aria-label=\"Table\"><table>\n<tr><th>method</th>\
             <th class=\"n\">MTF raw</th><th class=\"n\">MTF normalized</th><th class=\"n\">correlation</th>\
             <th class=\"n\">RMSE</th><th>parameter</th></tr>\n{table}</table></div>\n\
             <p class=\"note\">MTF: (white − black)/(white + black) over the elements that are white and black in truth; \
             raw as recovered, normalized after stretching the recovered values to 0…1.</p>\n",
            escape(&first.surface),
            legend(&scale, "reflectance", &panels),
            note(said),
            note(more)
        ));
    }
    html
}

fn recovery_row(r: &RecoveredObject) -> String {
    let numbers = [
        optional(r.mtf_raw),
        optional(r.mtf_normalized),
        optional(r.correlation),
        significant(r.rmse, 3),
    ];
    let numbers: String = numbers
        .iter()
        .map(|c| format!("<td class=\"n\">{}</td>", escape(c)))
        .collect();
    format!(
        "<tr><td>{}</td>{numbers}<td>{}</td></tr>\n",
        escape(&r.method),
        escape(&r.parameter)
    )
}
