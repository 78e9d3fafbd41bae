//! Results as plain text for the terminal, at most 80 columns wide.

use super::axis::significant;
use super::gallery::by_surface;
use super::picture::wrapped;
use super::summary::relative_stderr;
use super::svg::shortened;
use super::verdict::{sentence, verdict};
use crate::matrix::Matrix;
use crate::scene::Scene;
use crate::study::{Agreement, RecoveredObject, RunResults, Settings};
use crate::transport::Traced;

/// Columns of the terminal that the tables keep to.
const WIDTH: usize = 80;

/// What a run found as plain text of at most 80 columns, verdict first. Names from the scene lose control characters.
pub fn summary_table(results: &RunResults) -> String {
    let mut out = String::new();
    put_wrapped(&mut out, &verdict(results));
    out.push('\n');
    put_facts(&mut out, &facts(results));
    out + &recovery_table(&results.recovered)
}

/// What a render left, as plain text of at most 80 columns: flux and precision, `seconds` of wall time.
pub fn render_table(scene: &Scene, settings: &Settings, traced: &Traced, seconds: f64) -> String {
    let total = traced.flux.sum();
    let share = |m: &Matrix| if total > 0.0 { m.sum() / total } else { 0.0 };
    let bounces: Vec<(u32, f64)> = (1..).zip(traced.bounces.iter().map(share)).collect();
    let norm = traced.flux.norm();
    let error = (norm > 0.0).then(|| traced.stderr.norm() / norm);
    let mut facts = traced_facts(scene, settings, (&traced.flux, error), &bounces);
    facts.push(("time", format!("{}\u{a0}s", significant(seconds, 2))));
    let mut out = String::new();
    put_facts(&mut out, &facts);
    out
}

/// Scene, settings, flux with its relative standard error, and what share of it met how many surfaces.
fn traced_facts(
    scene: &Scene,
    s: &Settings,
    (phi, error): (&Matrix, Option<f64>),
    bounces: &[(u32, f64)],
) -> Vec<(&'static str, String)> {
    let hash: String = scene.hash.chars().take(12).collect();
    let mut facts = vec![
        (
            "scene",
            format!(
                "{} ({hash}), {} pixels × {} spots",
                scene.name,
                phi.nrows(),
                phi.ncols()
            ),
        ),
        (
            "rendered",
            format!(
                "{}, {}, {} samples in {} blocks, seed {}",
                s.estimator, s.sampler, s.samples, s.blocks, s.seed
            ),
        ),
    ];
    let noise = error.map_or(String::new(), |e| {
        format!(", standard error {}", percent(e))
    });
    facts.push((
        "flux",
        format!(
            "{}\u{a0}W over all pixels and spots{noise}",
            significant(phi.sum(), 3)
        ),
    ));
    if !bounces.is_empty() {
        let share = |(n, share): &(u32, f64)| format!("{n} surfaces {}", percent(*share));
        facts.push((
            "light by path",
            bounces.iter().map(share).collect::<Vec<_>>().join(", "),
        ));
    }
    facts
}

/// Lines of the table: a key and what is to be said.
pub(super) fn facts(results: &RunResults) -> Vec<(&'static str, String)> {
    let mut facts = traced_facts(
        &results.scene,
        &results.settings,
        (&results.phi, relative_stderr(results)),
        &results.bounces,
    );
    if let Some(a) = &results.agreement {
        facts.extend(agreement_facts(a));
    }
    if !results.times.is_empty() {
        let total: f64 = results.times.iter().map(|t| t.1).sum();
        let each = results
            .times
            .iter()
            .map(|(stage, t)| format!("{stage} {}\u{a0}s", significant(*t, 2)));
        let each = each.collect::<Vec<_>>().join(", ");
        facts.push(("time", format!("{}\u{a0}s: {each}", significant(total, 2))));
    }
    facts
}

/// Without control characters, which could steer a terminal.
fn clean(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}

/// A verdict as plain text: the sentence, its numbers, and where it fails the worst entries by name.
pub fn verdict_table(agreement: &Agreement) -> String {
    let mut out = String::new();
    put_wrapped(&mut out, &sentence(agreement));
    out.push('\n');
    put_facts(&mut out, &agreement_facts(agreement));
    if !agreement.agrees {
        put(&mut out, "");
        put(
            &mut out,
            "worst entries    pixel    spot      traced (W)    modelled (W)         z",
        );
        for e in &agreement.worst {
            let [traced, modelled] = [e.traced, e.modelled].map(|x| format!("{x:.5e}"));
            let z = significant(e.z, 4);
            put(
                &mut out,
                &format!(
                    "{:>22} {:>7} {traced:>15} {modelled:>15} {z:>9}",
                    e.pixel, e.spot
                ),
            );
        }
    }
    out
}

/// Recovered objects as plain text: a table per hidden surface, below each method the parameter it used.
pub fn recovery_table(objects: &[RecoveredObject]) -> String {
    let mut out = String::new();
    for group in by_surface(objects) {
        let [nu, nv] = group[0].elements;
        put(&mut out, "");
        let head = format!("recovered: {}, {nu} × {nv} elements", group[0].surface);
        put_wrapped(&mut out, &clean(&head));
        let heads = ["MTF raw", "normalized", "correlation", "RMSE"];
        put_row(&mut out, "method", heads.map(str::to_owned));
        group.into_iter().for_each(|r| put_recovery(&mut out, r));
    }
    out
}

/// A method's line, and below it what it chose.
fn put_recovery(out: &mut String, r: &RecoveredObject) {
    let number = |x: Option<f64>| x.map_or("–".to_owned(), |x| significant(x, 3));
    let row = [r.mtf_raw, r.mtf_normalized, r.correlation, Some(r.rmse)].map(number);
    put_row(out, &shortened(&clean(&r.method), 20), row);
    for line in wrapped(&clean(&r.parameter), WIDTH - 4) {
        put(out, &format!("    {line}"));
    }
}

fn put(out: &mut String, line: &str) {
    out.push_str(line.trim_end());
    out.push('\n');
}

fn put_wrapped(out: &mut String, text: &str) {
    for line in wrapped(text, WIDTH) {
        put(out, &line);
    }
}

fn put_facts(out: &mut String, facts: &[(&str, String)]) {
    for (key, text) in facts {
        for (i, line) in wrapped(&clean(text), WIDTH - 14).iter().enumerate() {
            put(
                out,
                &format!("{:<13} {line}", if i == 0 { key } else { "" }),
            );
        }
    }
}

fn put_row(out: &mut String, method: &str, [a, b, c, d]: [String; 4]) {
    put(
        out,
        &format!("  {method:<20} {a:>9} {b:>11} {c:>12} {d:>10}"),
    );
}

/// What an agreement rests on.
fn agreement_facts(a: &Agreement) -> [(&'static str, String); 2] {
    let difference = format!(
        "{} of the model; {} expected from noise, at most {} from its discretisation; best scale {}",
        percent(a.relative_difference),
        percent(a.relative_noise),
        percent(a.relative_discretisation),
        significant(a.best_scale, 5)
    );
    let test = format!(
        "{} model, {}; significance {}, P(χ²) {}, P(|z|) {}",
        a.kernel,
        a.integration,
        significant(a.significance, 2),
        significant(a.chi2_p, 2),
        significant(a.largest_p, 2)
    );
    [("difference", difference), ("test", test)]
}

fn percent(x: f64) -> String {
    format!("{}\u{a0}%", significant(100.0 * x, 3))
}

#[cfg(test)]
mod tests {
    use super::super::sample::{bare, run};
    use super::super::summary::summary_json;
    use super::*;

    #[test]
    fn the_table_keeps_to_80_columns_and_starts_with_the_verdict() {
        let mut results = run("bench");
        results.recovered[0].method = "a method of an extraordinarily long name".repeat(3);
        results.recovered[0].surface = "\u{1b}[31mred".repeat(40);
        for results in [results, bare("furnace")] {
            let table = summary_table(&results);
            for line in table.lines() {
                assert!(line.chars().count() <= WIDTH, "{line}");
            }
            assert!(!table.contains('\u{1b}'));
            let sentence = verdict(&results);
            assert!(table.replace('\n', " ").starts_with(&sentence), "{table}");
        }
    }

    #[test]
    fn a_render_says_its_flux_and_its_precision() {
        let results = run("bench");
        let matrix = |x: f64| Matrix::from_element(2, 3, x);
        // 6 entries of 2e-12 W, a quarter of it from three surfaces; σ is 1 % of Φ.
        let traced = Traced {
            bounces: vec![matrix(1.5e-12), matrix(0.0), matrix(0.5e-12)],
            flux: matrix(2e-12),
            stderr: matrix(2e-14),
        };
        let table = render_table(&results.scene, &results.settings, &traced, 8.04);
        for words in [
            "2 pixels × 3 spots",
            "1.20e-11\u{a0}W over all pixels and spots, standard error 1.00\u{a0}%",
            "1 surfaces 75.0\u{a0}%, 2 surfaces 0\u{a0}%, 3 surfaces 25.0\u{a0}%",
            "time          8.0\u{a0}s",
        ] {
            assert!(table.contains(words), "no {words}: {table}");
        }
    }

    #[test]
    fn disagreement_is_loud() {
        let mut results = run("bench");
        assert!(
            summary_table(&results)
                .starts_with("traced and physical model agree: χ²/dof 1.003 over 30720 entries,")
        );
        results.agreement.as_mut().unwrap().agrees = false;
        assert!(summary_table(&results).contains("DISAGREE"));
        assert!(summary_json(&results).contains("DISAGREE"));
    }
}
