//! The page of a run.

mod bench;
mod difference;
mod explorer;
mod frames;
mod matrices;
mod settings;

use super::axis::significant;
use super::figure::capital;
use super::gallery::{recoveries, slides};
use super::page::{Page, Tone, explained};
use super::picard::picard_svg;
use super::svg::number;
use super::verdict::verdict;
use crate::recovery::{Directions, Picard};
use crate::scene::Scene;
use crate::study::{RunResults, Settings};
use difference::difference;
use explorer::{embed, explorer, served_explorer};
use frames::frames;
use matrices::{deviations, matrices};
pub(super) use settings::{is_builtin, scene_text};
use settings::{scene_file, settings};

/// The whole report as one HTML page that needs no network and no other file: verdict, drawing of the scene, frames,
/// Φcam traced and modelled, z, recoveries beside the truth, light by bounce count, settings, times and the commands
/// that repeat the run. What a run does not have is left out. Pictures larger than 256 (Φcam: 512) entries a side are
/// averaged or thinned for display, and the page says so.
pub fn run_html(results: &RunResults) -> String {
    let mut page = Page::new(&format!("phicam: {}", results.scene.name));
    let tone = match &results.agreement {
        Some(a) if a.agrees => Tone::Good,
        Some(_) => Tone::Bad,
        None => Tone::Plain,
    };
    page.verdict(tone, &format!("{}.", capital(&verdict(results))));
    bench::section(&mut page, &results.scene);
    let fallback = frames(results);
    let explorer = explorer(&mut page, results, &fallback);
    page.section("explorer", "Φcam, entry by entry", &explorer);
    page.section("phi", "The matrix Φcam", &matrices(results));
    page.section("z", "Traced minus modelled", &deviations(results));
    let recovered = slides(&mut page, results) + &recoveries(results);
    page.section("recovered", "Recovered", &recovered);
    page.section(
        "picard",
        "What noise leaves of the signal",
        &picards(results),
    );
    page.section("difference", "Error budget", &difference(results));
    page.section("bounces", "Light by bounce count", &bounces(results));
    page.section("settings", "What was run", &settings(results));
    embed(&mut page, results);
    page.html()
}

/// The page of a folder that holds photographs and Φcam but no report, for a server that hands out its matrices: the scene, the explorer and what was
/// rendered. `model` says whether modelled matrices lie there, too.
pub fn served_html(scene: &Scene, rendered: &Settings, model: bool) -> String {
    let mut page = Page::new(&format!("phicam: {}", scene.name));
    let sentence = format!(
        "{} pixels × {} spots, rendered by {} with {} samples, seed {}.",
        scene.camera.pixels(),
        scene.laser.spots.len(),
        rendered.estimator,
        rendered.samples,
        rendered.seed
    );
    page.verdict(Tone::Plain, &sentence);
    bench::section(&mut page, scene);
    let explorer = served_explorer(&mut page, scene, rendered.seed, model);
    page.section("explorer", "Φcam, entry by entry", &explorer);
    page.section("settings", "What was rendered", &scene_text(scene));
    page.html()
}

/// Singular values with signal and noise in their directions.
fn picards(results: &RunResults) -> String {
    if results.picards.is_empty() {
        return String::new();
    }
    let figure = |p: &Picard| {
        let name = match p.directions {
            Directions::LaserSide => "picard",
            Directions::Joint | Directions::JointWeighted => "picard-joint",
        };
        format!(
            "<figure class=\"plot\" data-name=\"{name}\">\n{}</figure>\n",
            picard_svg(p)
        )
    };
    let figures: String = results.picards.iter().map(figure).collect();
    format!(
        "<p>{}</p>\n{figures}",
        explained(
            "A Picard plot: singular values fall, and where the signal has sunk into the noise an inversion must stop."
        )
    )
}

/// Light by the number of surfaces it met.
fn bounces(results: &RunResults) -> String {
    if results.bounces.is_empty() {
        return String::new();
    }
    let mut html = "<div class=\"wide\" tabindex=\"0\" role=\"group\" aria-label=\"Table\"><table>\n<tr><th class=\"n\">surfaces met</th>\
                    <th class=\"n\">share of the flux</th><th></th></tr>\n"
        .to_owned();
    for (n, share) in &results.bounces {
        html.push_str(&format!(
            "<tr><td class=\"n\">{n}</td><td class=\"n\">{} %</td><td><span class=\"bar\" style=\"width:{}px\"></span></td></tr>\n",
            significant(100.0 * share, 3),
            number((200.0 * share).clamp(0.0, 200.0))
        ));
    }
    html.push_str("</table></div>\n");
    html
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
