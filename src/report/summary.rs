//! A run in short: for programs and for the terminal.

use serde_json::{Value, json};

use super::axis::significant;
use super::picture::wrapped;
use super::verdict::verdict;
use crate::study::{RecoveredObject, RunResults};

/// Columns of the terminal that the table keeps to.
const WIDTH: usize = 80;

/// What a run found, without any matrix, as indented JSON. What is absent or not a finite number is `null`. Fluxes in
/// W, times in s.
pub fn summary_json(results: &RunResults) -> String {
    let scene = &results.scene;
    let recovered = |r: &RecoveredObject| {
        json!({
            "surface": r.surface,
            "method": r.method,
            "elements": r.elements,
            "mtf": { "raw": r.mtf_raw, "normalized": r.mtf_normalized },
            "correlation": r.correlation,
            "rmse": r.rmse,
            "parameter": r.parameter,
        })
    };
    let bounces = results
        .bounces
        .iter()
        .map(|(n, share)| json!({ "surfaces": n, "share": share }));
    let times = results
        .times
        .iter()
        .map(|(stage, s)| json!({ "stage": stage, "seconds": s }));
    let value = json!({
        "verdict": verdict(results),
        "scene": {
            "name": scene.name,
            "hash": scene.hash,
            "unit": scene.unit.symbol(),
            "max_bounces": scene.max_bounces,
        },
        "settings": results.settings,
        "phi": {
            "pixels": results.phi.nrows(),
            "spots": results.phi.ncols(),
            "total": results.phi.sum(),
            "relative_stderr": relative_stderr(results),
        },
        "agreement": results.agreement,
        "bounces": bounces.collect::<Vec<Value>>(),
        "recovered": results.recovered.iter().map(recovered).collect::<Vec<Value>>(),
        "times": times.collect::<Vec<Value>>(),
    });
    // A `Value` always has a JSON text.
    format!("{value:#}\n")
}

/// ‖standard error‖/‖Φcam‖; `None` where there is no light.
pub(super) fn relative_stderr(results: &RunResults) -> Option<f64> {
    let norm = results.phi.norm();
    (norm > 0.0).then(|| results.stderr.norm() / norm)
}

/// What a run found as plain text of at most 80 columns, verdict first. Names from the scene lose control characters.
pub fn summary_table(results: &RunResults) -> String {
    let mut out = String::new();
    let mut put = |line: &str| {
        out.push_str(line.trim_end());
        out.push('\n');
    };
    for line in wrapped(&verdict(results), WIDTH) {
        put(&line);
    }
    put("");
    for (key, text) in facts(results) {
        for (i, line) in wrapped(&clean(&text), WIDTH - 14).iter().enumerate() {
            put(&format!("{:<13} {line}", if i == 0 { key } else { "" }));
        }
    }
    let mut surface = None;
    for r in &results.recovered {
        if surface != Some(&r.surface) {
            surface = Some(&r.surface);
            put("");
            for line in wrapped(
                &clean(&format!(
                    "recovered: {}, {} × {} elements",
                    r.surface, r.elements[0], r.elements[1]
                )),
                WIDTH,
            ) {
                put(&line);
            }
            put(&format!(
                "  {:<20} {:>9} {:>11} {:>12} {:>10}",
                "method", "MTF raw", "normalized", "correlation", "RMSE"
            ));
        }
        let number = |x: Option<f64>| x.map_or("–".to_owned(), |x| significant(x, 3));
        let row = [r.mtf_raw, r.mtf_normalized, r.correlation, Some(r.rmse)].map(number);
        let method = super::svg::shortened(&clean(&r.method), 20);
        put(&format!(
            "  {method:<20} {:>9} {:>11} {:>12} {:>10}",
            row[0], row[1], row[2], row[3]
        ));
        for line in wrapped(&clean(&r.parameter), WIDTH - 4) {
            put(&format!("    {line}"));
        }
    }
    out
}

/// Lines of the table: a key and what is to be said.
pub(super) fn facts(results: &RunResults) -> Vec<(&'static str, String)> {
    let (s, scene) = (&results.settings, &results.scene);
    let hash: String = scene.hash.chars().take(12).collect();
    let percent = |x: f64| format!("{}\u{a0}%", significant(100.0 * x, 3));
    let mut facts = vec![
        (
            "scene",
            format!(
                "{} ({hash}), {} pixels × {} spots",
                scene.name,
                results.phi.nrows(),
                results.phi.ncols()
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
    let noise = relative_stderr(results).map_or(String::new(), |e| {
        format!(", standard error {}", percent(e))
    });
    facts.push((
        "flux",
        format!(
            "{}\u{a0}W over all pixels and spots{noise}",
            significant(results.phi.sum(), 3)
        ),
    ));
    if !results.bounces.is_empty() {
        let share = |(n, share): &(u32, f64)| format!("{n} surfaces {}", percent(*share));
        facts.push((
            "light by path",
            results
                .bounces
                .iter()
                .map(share)
                .collect::<Vec<_>>()
                .join(", "),
        ));
    }
    if let Some(a) = &results.agreement {
        facts.push((
            "difference",
            format!(
                "{} of the model; {} expected from noise, at most {} from its discretisation; best scale {}",
                percent(a.relative_difference),
                percent(a.relative_noise),
                percent(a.relative_discretisation),
                significant(a.best_scale, 5)
            ),
        ));
        facts.push((
            "test",
            format!(
                "{} model, {}; significance {}, P(χ²) {}",
                a.kernel,
                a.integration,
                significant(a.significance, 2),
                significant(a.chi2_p, 2)
            ),
        ));
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

#[cfg(test)]
mod tests {
    use super::super::sample::{bare, run};
    use super::*;

    #[test]
    fn json_parses_back_and_has_no_matrix() {
        let results = run("bench");
        let value: Value = serde_json::from_str(&summary_json(&results)).unwrap();
        assert_eq!(value["scene"]["name"], "bench");
        assert_eq!(value["scene"]["hash"], results.scene.hash.as_str());
        assert_eq!(value["settings"]["seed"].as_u64(), Some(u64::MAX));
        assert_eq!(value["agreement"]["chi2_per_dof"].as_f64(), Some(1.003));
        assert_eq!(
            value["recovered"][1]["mtf"]["raw"].as_f64(),
            results.recovered[1].mtf_raw
        );
        assert_eq!(value["phi"]["total"].as_f64(), Some(results.phi.sum()));
        assert!(value["recovered"][0].get("reflectance").is_none());
        assert!(summary_json(&results).len() < 20_000);
    }

    #[test]
    fn json_of_a_run_without_model_or_with_nonsense_still_parses() {
        let mut results = bare("furnace");
        results.phi[(0, 0)] = f64::NAN;
        let value: Value = serde_json::from_str(&summary_json(&results)).unwrap();
        assert!(value["agreement"].is_null() && value["phi"]["total"].is_null());
    }

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
