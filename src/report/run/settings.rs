//! What was run, and the commands that repeat it.

use super::super::page::bare;
use super::super::svg::escape;
use crate::lab::{Agreement, RunResults};
use crate::scene::{Scene, builtins};

/// More of the scene's text than this is left out, bytes.
const MOST_TEXT: usize = 200_000;
/// The significance of a test for which none is given.
const USUAL_SIGNIFICANCE: f64 = 1e-3;

/// Commands, settings, times, and the scene file.
pub(super) fn settings(results: &RunResults) -> String {
    let (plan, scene) = (&results.plan, &results.scene);
    let mut facts = results.facts();
    let version = [
        ("version", format!("phicam {}", results.version)),
        ("scene hash", scene.hash.clone()),
    ];
    let more = version.map(|(key, text)| vec![key.into(), text.into()]);
    facts.rows.extend(more);
    let file = scene_file(scene);
    let traced = format!(
        "{file} -o out --estimator {} --sampler {} --samples {} --seed {}",
        plan.estimator,
        plan.sampling,
        plan.budget.samples(),
        plan.seed
    );
    let test = results
        .agreement
        .as_ref()
        .map_or(String::new(), test_options);
    let mut commands = format!("phicam run {traced}{test}\n");
    if results.model.is_some() {
        commands += &format!("phicam validate out{test}\nphicam recover out\n");
    }
    format!(
        "<h3>To repeat it</h3>\n<pre>{}</pre>\n{}{}",
        escape(&commands),
        bare(&facts),
        scene_text(scene)
    )
}

/// The options of a test that are not the usual ones.
fn test_options(a: &Agreement) -> String {
    let mut options = String::new();
    let given = [
        ("kernel", a.kernel.as_str(), "physical"),
        ("integration", a.integration.as_str(), "quadrature"),
    ];
    for (name, value, usual) in given {
        if value != usual {
            options += &format!(" --{name} {value}");
        }
    }
    if a.significance.to_bits() != USUAL_SIGNIFICANCE.to_bits() {
        options += &format!(" --significance {}", a.significance);
    }
    options
}

/// The scene's file, as much of it as there is room for.
pub(in super::super) fn scene_text(scene: &Scene) -> String {
    let mut html = String::new();
    if !is_builtin(scene) {
        html.push_str(
            "<p>The scene is one of its own, not a built-in one; this is its text:</p>\n",
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

/// What commands call the scene: its name, or the file in the folder of the run.
pub(in super::super) fn scene_file(scene: &Scene) -> &str {
    if is_builtin(scene) {
        &scene.name
    } else {
        "scene.toml"
    }
}

/// Whether the scene's name alone is enough to load it again.
pub(in super::super) fn is_builtin(scene: &Scene) -> bool {
    builtins()
        .iter()
        .any(|b| b.name == scene.name && b.text == scene.text)
}
