//! The gallery of recovered objects.

mod slides;

use super::colour::Scale;
use super::figure::{Entries, MOST, Reduction, figure, legend, note, reduced};
use super::page::{bare, explained};
use super::svg::escape;
use crate::lab::{FIT_LEVEL, RunResults, by_surface, determined, fits, recovery, warnings};
use crate::num::digits::perhaps;

pub(super) use slides::slides;

/// More recoveries than this are listed, not shown.
const MOST_PICTURES: usize = 16;

/// Recovered objects, surface by surface, beside the truth.
pub(super) fn recoveries(results: &RunResults) -> String {
    let told = warnings(&results.recovered);
    let told = told
        .iter()
        .map(|w| format!("<p class=\"warning\">{}</p>\n", explained(w)));
    let mut html: String = told.collect();
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
        let (_, said) = picture("", &first.reflectance);
        let last = [nu, nv].map(|n| n.saturating_sub(1));
        let (mut panels, mut figures) = (Vec::new(), String::new());
        if let Some(truth) = &first.truth {
            let (panel, _) = picture("truth", truth);
            figures.push_str(&figure(&panel, last, Entries::Square, &scale, ""));
            panels.push(panel);
        }
        if let Some(shares) = &first.determined_share {
            let (panel, _) = picture("determined by the photographs", shares);
            let more = format!(
                "<br>1 white: wholly, 0 black: not at all. {}",
                determined(&group[..1])
            );
            figures.push_str(&figure(&panel, last, Entries::Square, &scale, &more));
        }
        for r in group.iter().take(left) {
            let (panel, _) = picture(&r.method, &r.reflectance);
            let more = format!(
                "<br>MTF {} raw, {} normalized",
                perhaps(r.mtf_raw, 3),
                perhaps(r.mtf_normalized, 3)
            );
            figures.push_str(&figure(&panel, last, Entries::Square, &scale, &more));
            panels.push(panel);
            for (what, values) in r.beside_it() {
                let (panel, _) = picture(&format!("{}, {what}", r.method), values);
                figures.push_str(&figure(&panel, last, Entries::Square, &scale, ""));
            }
        }
        let unseen = group.len().saturating_sub(left);
        left -= left.min(group.len());
        let more = (unseen > 0)
            .then(|| format!("{unseen} of these recoveries are listed without a picture"));
        html.push_str(&format!(
            "<h3>{}</h3>\n<p>Reflectance of {nu} × {nv} elements, black 0, white 1, the same grey scale for \
             all.</p>\n<div class=\"row\">\n{figures}</div>\n{}{}{}{}\
             <p class=\"note\">MTF: (white − black)/(white + black) over the elements that are white and black in truth; \
             raw as recovered, normalized after stretching the recovered values to 0…1.</p>\n\
             <p>Does what each would photograph fit the photographs? χ² of Φ − C diag(ρ̂) D in standard errors; \
             a picture that explains them has χ²/dof near 1, and a smaller P than {FIT_LEVEL} by chance in one \
             of {} only.</p>\n{}",
            escape(&first.surface),
            legend(&scale, "reflectance", &panels),
            note(said),
            note(more),
            bare(&recovery(&group)),
            1.0 / FIT_LEVEL,
            bare(&fits(&group))
        ));
    }
    html
}
