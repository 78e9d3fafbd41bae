//! The page of a run.

use std::collections::BTreeSet;

use super::axis::significant;
use super::colour::Scale;
use super::drawing::bench_svg;
use super::figure::{Entries, MOST, Reduction, figure, legend, note, reduced};
use super::gallery::recoveries;
use super::page::{Page, Tone};
use super::picture::Panel;
use super::svg::{escape, number};
use super::table::facts;
use super::verdict::verdict;
use crate::matrix::Matrix;
use crate::scene::{Scene, builtins};
use crate::study::RunResults;

/// More of the scene's text than this is left out, bytes.
const MOST_TEXT: usize = 200_000;

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
    let mut sentence = verdict(results);
    if let Some(first) = sentence.get(..1).map(str::to_uppercase) {
        sentence.replace_range(..1, &first);
    }
    page.verdict(tone, &format!("{sentence}."));
    let bench = format!(
        "<figure class=\"bench\">\n{}</figure>\n",
        bench_svg(&results.scene)
    );
    page.section("scene", "The scene", &bench);
    page.section("frames", "Frames", &frames(results));
    page.section("phi", "The matrix Φcam", &matrices(results));
    page.section("z", "Traced minus modelled", &deviations(results));
    page.section("recovered", "Recovered", &recoveries(results));
    page.section("bounces", "Light by bounce count", &bounces(results));
    page.section("settings", "What was run", &settings(results));
    page.html()
}

/// The photographs of the first, the middle and the last spot.
fn frames(results: &RunResults) -> String {
    let (camera, phi) = (&results.scene.camera, &results.phi);
    let (p, l) = phi.shape();
    if l == 0 || p == 0 {
        return String::new();
    }
    let size = [camera.columns, camera.rows];
    let spots: BTreeSet<usize> = [0, l / 2, l - 1].into();
    let mut said = None;
    let panels: Vec<Panel> = spots
        .into_iter()
        .map(|spot| {
            let place = results
                .scene
                .laser
                .spots
                .get(spot)
                .map_or(String::new(), |s| {
                    let at = s.target.position;
                    format!(" at ({}, {})", significant(at.x, 3), significant(at.y, 3))
                });
            let value = |i: usize, j: usize| {
                phi.get((i + j * size[0], spot))
                    .copied()
                    .unwrap_or(f64::NAN)
            };
            let title = format!("spot {spot}{place}");
            let (panel, note) = reduced(
                title,
                ["column, +x", "row, +y"],
                size,
                MOST,
                Reduction::Mean,
                value,
            );
            said = note;
            panel
        })
        .collect();
    let scale = Scale::sequential(panels.iter().flat_map(|p| &p.values));
    let ends = size.map(|n| n.saturating_sub(1));
    let figures: String = panels
        .iter()
        .map(|p| figure(p, ends, Entries::Square, &scale, ""))
        .collect();
    format!(
        "<p>What the camera records for the first, the middle and the last laser spot: flux into each \
         pixel. One scale for all, from the smallest to the largest value shown.</p>\n\
         <div class=\"row\">\n{figures}</div>\n{}{}",
        legend(&scale, "W", &panels),
        note(said)
    )
}

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
fn matrices(results: &RunResults) -> String {
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

/// z of every entry, and the entries that stand out most.
fn deviations(results: &RunResults) -> String {
    let mut html = String::new();
    let limit = results.agreement.as_ref().map_or(4.0, |a| a.z_limit);
    if let Some(z) = results.z.as_ref().filter(|z| !z.is_empty()) {
        let scale = Scale::symmetric(limit);
        let (panel, said) = map("z", z, Reduction::Pick);
        let [_, shown] = scale.range();
        html.push_str(&format!(
            "<p>z: the difference of every entry in units of its standard error. If the \
             model is right it is noise, without pattern, and stays within ±{}.</p>\n<div class=\"row\">\n{}</div>\n{}{}",
            significant(shown, 2),
            figure(&panel, ends(z), Entries::Stretched, &scale, ""),
            legend(&scale, "standard errors", &[panel]),
            note(said)
        ));
    }
    let worst = results.agreement.as_ref().map_or(&[][..], |a| &a.worst);
    if !worst.is_empty() {
        html.push_str("<p>The entries that differ most:</p>\n<div class=\"wide\"><table>\n<tr><th class=\"n\">pixel</th><th class=\"n\">spot</th><th class=\"n\">traced / W</th><th class=\"n\">modelled / W</th><th class=\"n\">z</th></tr>\n");
        for e in worst.iter().take(10) {
            let row = [
                e.pixel.to_string(),
                e.spot.to_string(),
                significant(e.traced, 4),
                significant(e.modelled, 4),
                significant(e.z, 3),
            ];
            html.push_str(&cells(&row));
        }
        html.push_str("</table></div>\n");
    }
    html
}

/// A row of numbers.
fn cells(row: &[String]) -> String {
    let cells: String = row
        .iter()
        .map(|c| format!("<td class=\"n\">{}</td>", escape(c)))
        .collect();
    format!("<tr>{cells}</tr>\n")
}

/// Light by the number of surfaces it met.
fn bounces(results: &RunResults) -> String {
    if results.bounces.is_empty() {
        return String::new();
    }
    let mut html = "<div class=\"wide\"><table>\n<tr><th class=\"n\">surfaces met</th>\
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

/// Settings, times, commands, and the scene file.
fn settings(results: &RunResults) -> String {
    let (s, scene) = (&results.settings, &results.scene);
    let mut html = "<div class=\"wide\"><table>\n".to_owned();
    let version = [
        ("version", format!("phicam {}", s.version)),
        ("scene hash", scene.hash.clone()),
    ];
    for (key, text) in facts(results).into_iter().chain(version) {
        html.push_str(&format!(
            "<tr><th>{}</th><td>{}</td></tr>\n",
            escape(key),
            escape(&text)
        ));
    }
    html.push_str("</table></div>\n<h3>To repeat it</h3>\n");
    let builtin = is_builtin(scene);
    let file = if builtin {
        scene.name.as_str()
    } else {
        "scene.toml"
    };
    let mut commands = format!(
        "phicam run {file} -o out --estimator {} --sampler {} --samples {} --seed {}\n",
        s.estimator, s.sampler, s.samples, s.seed
    );
    if let Some(a) = &results.agreement {
        commands.push_str(&format!("phicam validate out --kernel {}\n", a.kernel));
    }
    html.push_str(&format!("<pre>{}</pre>\n", escape(&commands)));
    if !builtin {
        html.push_str(
            "<p><code>scene.toml</code> lies in the folder of this run; this is its text:</p>\n",
        );
    }
    let mut end = scene.text.len().min(MOST_TEXT);
    while !scene.text.is_char_boundary(end) {
        end -= 1;
    }
    let cut = if end < scene.text.len() {
        "\n… (the rest is left out here)"
    } else {
        ""
    };
    html.push_str(&format!(
        "<details><summary>The scene file</summary>\n<pre>{}{cut}</pre>\n</details>\n",
        escape(&scene.text[..end])
    ));
    html
}

/// Whether the scene's name alone is enough to load it again.
pub(super) fn is_builtin(scene: &Scene) -> bool {
    builtins()
        .iter()
        .any(|b| b.name == scene.name && b.text == scene.text)
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
