//! The first screen of a run's page: what was hidden, what came back, how sure that is, and whether
//! the light agrees.

use super::super::colour::{Law, Map, Scale};
use super::super::figure::{Reduction, capital, note, reduced, shot};
use super::super::page::{claim, explained};
use super::super::svg::escape;
use crate::lab::{Answer, RecoveredObject, RunResults};
use crate::num::digits::figure;

/// Pictures of more hidden surfaces than this are left to the section on what was recovered.
const MOST_SURFACES: usize = 3;
/// Standard errors from this share of the largest up look alike.
const SAME: f64 = 0.95;
/// Most entries a side of a picture, which is shown at 240 px or less.
const MOST: usize = 128;

/// Pictures beside claims.
pub(super) fn answer(results: &RunResults) -> String {
    let answer = results.answer();
    let claims = answer.claims.iter().chain([&answer.agreement]);
    let claims: String = claims
        .map(|c| claim(c.tone, &capital(c.about), &c.sentence))
        .collect();
    let (class, pictures) = pictures(&answer);
    format!(
        "<section id=\"answer\" class=\"answer{class}\" aria-label=\"Answer\">\n{pictures}<div class=\"claims\">\n{claims}</div>\n</section>\n"
    )
}

/// The pictures of the first surfaces, and the class of how many there are.
fn pictures(answer: &Answer<'_>) -> (&'static str, String) {
    let count = answer.pictures.len();
    let shown = answer.pictures.iter().take(MOST_SURFACES);
    let mut html: String = shown.map(|r| surface(r, count > 1)).collect();
    if html.is_empty() {
        return ("", html);
    }
    html += "<p class=\"note\">Grey is reflectance: black 0, white 1.</p>\n";
    if count > MOST_SURFACES {
        let more = count - MOST_SURFACES;
        html += &format!(
            "<p class=\"note\">{more} further surfaces: see <a href=\"#recovered\">what was recovered</a>.</p>\n"
        );
    }
    let class = if count > 1 { " several" } else { "" };
    (class, format!("<div class=\"shots\">\n{html}</div>\n"))
}

/// Truth, what was recovered, and how far that is known.
fn surface(r: &RecoveredObject, named: bool) -> String {
    let [nu, nv] = r.elements;
    let mut said = None;
    let grey = Scale::reflectance();
    let mut picture = |name: &str, values: &[f64], scale: &Scale, caption: &str| {
        let value = |i: usize, j: usize| values.get(i + j * nu).copied().unwrap_or(f64::NAN);
        let title = format!("{name} of {}", r.surface);
        let (panel, note) = reduced(title, ["iu", "iv"], [nu, nv], MOST, Reduction::Mean, value);
        said = note;
        shot(&panel, scale, &explained(caption))
    };
    let truth = match &r.truth {
        Some(truth) => picture("truth", truth, &grey, "truth"),
        None => "<figure class=\"shot\"><div class=\"unknown\">not known</div><figcaption>truth</figcaption></figure>\n".to_owned(),
    };
    let caption = format!("recovered by {}", r.method);
    let found = picture("what was recovered", &r.reflectance, &grey, &caption);
    let errors = r.standard_error.as_ref();
    let finite = |all: &Vec<f64>| {
        all.iter()
            .copied()
            .filter(|x| x.is_finite())
            .fold(0.0, f64::max)
    };
    let most = errors.map_or(0.0, finite);
    // An error that all elements share is a number, told beside the picture.
    let differ = |all: &&Vec<f64>| all.iter().any(|x| *x < SAME * most || x.is_infinite());
    let sure = match (errors.filter(differ), &r.determined_share) {
        (Some(errors), _) => {
            let scale = Scale::between(Map::Viridis, Law::Linear, [0.0, most]);
            let caption = format!("standard error, dark 0, bright {}", figure(most, 2));
            picture("standard error", errors, &scale.unwrap_or(grey), &caption)
        }
        (None, Some(shares)) => picture(
            "what the photographs determine",
            shares,
            &grey,
            "determined by the photographs, white: wholly",
        ),
        (None, None) => String::new(),
    };
    let name = if named {
        format!("<p class=\"name\">{}</p>\n", escape(&r.surface))
    } else {
        String::new()
    };
    format!(
        "{name}<div class=\"three\">\n{truth}{found}{sure}</div>\n{}",
        note(said)
    )
}
