//! The page of a run.

mod answer;
mod bench;
mod explorer;
mod frames;
mod matrices;
mod settings;

use super::gallery::{recoveries, slides};
use super::page::{Page, Room, Tone, bare, explained};
use super::plot::figure_svg;
use super::svg::escape;
use crate::lab::RunResults;
use crate::lab::finding::Describe;
use crate::scene::Scene;
use crate::transport::Plan;
use explorer::{embed, explorer, served_explorer};
use frames::frames;
use matrices::{deviations, matrices};
pub(super) use settings::{is_builtin, scene_text};
use settings::{scene_file, settings};

/// The whole report as one HTML page that needs no network and no other file: first the answer
/// (truth, what was recovered, how sure, whether the light agrees); then how it was done (drawing
/// of the scene, commands that repeat the run, settings, times, scene file); then what there is to
/// explore (recoveries, frames, Φcam traced and modelled, z, light by bounce count). What a run
/// does not have is left out. Pictures larger than 256 (Φcam: 512) entries a side are averaged or
/// thinned for display, and the page says so.
pub fn run_html(results: &RunResults) -> String {
    let mut page = Page::new(&format!("phicam: {}", results.scene.name));
    page.answer(&answer::answer(results));
    bench::section(&mut page, &results.scene);
    page.section("settings", "How it was run", &settings(results));
    let recovered = slides(&mut page, results) + &recoveries(results);
    page.section("recovered", "Recovered", &recovered);
    let fallback = frames(results);
    let explorer = explorer(&mut page, results, &fallback);
    page.section("explorer", "Φcam, entry by entry", &explorer);
    page.section("phi", "The matrix Φcam", &matrices(results));
    page.section("z", "Traced minus modelled", &deviations(results));
    page.section(
        "picard",
        "What noise leaves of the signal",
        &picards(results),
    );
    page.section("difference", "Error budget", &difference(results));
    page.section("bounces", "Light by bounce count", &bounces(results));
    embed(&mut page, results);
    page.html()
}

/// The page of a folder that holds photographs and Φcam but no report, for a server that hands out
/// its matrices: the scene, the explorer and what was rendered. `model` says whether modelled
/// matrices lie there, too.
pub fn served_html(scene: &Scene, plan: &Plan, model: bool) -> String {
    let mut page = Page::new(&format!("phicam: {}", scene.name));
    let sentence = format!(
        "{} pixels × {} spots, rendered by {} with {} samples, seed {}.",
        scene.camera.pixels(),
        scene.laser.spots.len(),
        plan.estimator,
        plan.budget.samples(),
        plan.seed
    );
    page.verdict(Tone::Plain, &sentence);
    bench::section(&mut page, scene);
    let explorer = served_explorer(&mut page, scene, plan.seed, model);
    page.section("explorer", "Φcam, entry by entry", &explorer);
    page.section("settings", "What was rendered", &scene_text(scene));
    page.html()
}

/// Singular values with signal and noise in their directions.
fn picards(results: &RunResults) -> String {
    let mut room = Room::new();
    let figures = results.picards.iter().flat_map(|p| p.describe().figures);
    let figures: String = figures
        .map(|f| room.figure(&f.file, &figure_svg(&f)))
        .collect();
    if figures.is_empty() {
        return figures;
    }
    let what = "A Picard plot: singular values fall, and an inversion must stop where the signal \
         falls below the noise.";
    format!("<p>{}</p>\n{figures}", explained(what))
}

/// Light by the number of surfaces it met.
fn bounces(results: &RunResults) -> String {
    if results.bounces.is_empty() {
        return String::new();
    }
    bare(&results.light_by_surfaces())
}

/// What the difference between traced and modelled light is made of.
fn difference(results: &RunResults) -> String {
    let Some(parts) = results.difference() else {
        return String::new();
    };
    format!(
        "<p>Shares of ‖modelled Φcam‖ (root of the sum of squares over all entries).</p>\n{}\
         <p class=\"note\"><code>phicam study budget {}</code> takes it apart cause by cause: elements, pixels, spots, bounces, occlusion.</p>\n",
        bare(&parts),
        escape(scene_file(&results.scene))
    )
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
