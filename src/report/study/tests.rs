use base64::prelude::{BASE64_STANDARD, Engine};

use super::super::page::Tone;
use super::super::svg::well_formed;
use super::account::Table;
use super::*;
use crate::study::{
    Closure, Convergence, Coverage, CoverageRow, Curve, ErrorBudget, Estimate, Power, PowerRow,
    Step, Term,
};

fn account() -> Account {
    let mut table = Table::new("Sizes & <signs>", 1, &["cause", "size"]);
    table.rows = vec![vec!["a < b".to_owned(), "1.0".to_owned()]];
    Account {
        title: "A study: bench".to_owned(),
        tone: Tone::Good,
        sentence: "It closes at 3 % & below.".to_owned(),
        words: "More < words.".to_owned(),
        tables: vec![table],
    }
}

fn asked(file: &str) -> Asked {
    let option = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    Asked {
        study: "noise".to_owned(),
        scene: Scene::load("bench").unwrap(),
        file: file.to_owned(),
        options: vec![
            option("--noise", "1e-3,0.1"),
            option("--sensor", "my sensor"),
        ],
        version: "1.2.3".to_owned(),
    }
}

/// Verdict, figure with its data, tables, files as they are, the scene and the command: all in one page that asks for nothing else.
#[test]
fn a_study_becomes_one_page() {
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\"><metadata>{}</metadata></svg>\n";
    let csv = "level,x\n1e-3,0.25\n";
    let files = [("noise.csv", csv), ("noise.svg", svg)].map(|(n, t)| (n.to_owned(), t.to_owned()));
    let html = study_html(&account(), &asked("bench"), &files);
    well_formed(html.trim_start_matches("<!DOCTYPE html>\n")).unwrap();
    assert!(html.contains("<p class=\"verdict agree\">It closes at 3 % &amp; below.</p>"));
    assert!(html.contains("<figure class=\"plot\" data-name=\"noise\">\n<svg"));
    assert!(html.contains("<p>More &lt; words.</p>"));
    assert!(html.contains("<td>a &lt; b</td><td class=\"n\">1.0</td>"));
    assert!(html.contains(
        "<pre>phicam study noise bench --noise 1e-3,0.1 --sensor &#39;my sensor&#39;</pre>"
    ));
    let link = html
        .split("download=\"noise.csv\" href=\"data:text/csv;base64,")
        .nth(1)
        .unwrap();
    let link = BASE64_STANDARD
        .decode(link.split('"').next().unwrap())
        .unwrap();
    assert_eq!(link, csv.as_bytes());
    let scene = asked("bench").scene;
    assert!(html.contains(&scene.hash) && html.contains("download=\"bench.toml\""));
    // Nothing is fetched: no source, style or link but inside of the page.
    let own = html.split("<script>\n/*").next().unwrap();
    for way in ["src=\"", "@import", "url("] {
        assert!(!own.contains(way), "{way}");
    }
    let mut addresses = own.split("href=\"").skip(1);
    assert!(addresses.all(|a| a.starts_with('#') || a.starts_with("data:")));
    assert!(html.len() < 1_000_000, "{}", html.len());
}

fn estimate(value: f64, stderr: f64) -> Estimate {
    Estimate { value, stderr }
}

fn budget(closes: bool) -> ErrorBudget {
    let term = |name: &str, size, in_sum| Term {
        name: name.to_owned(),
        size: estimate(size, 1e-5),
        after_scale: estimate(0.5 * size, 1e-5),
        of_signal: 2.0 * size,
        in_sum,
    };
    ErrorBudget {
        scene: "bench".to_owned(),
        scene_hash: String::new(),
        seed: 1,
        ensemble_samples: 1,
        run_samples: 1,
        signal: 0.065,
        terms: vec![
            term("element area", 1.7e-3, true),
            term("5 bounces", 0.012, true),
            term("étendue", 0.5, false),
        ],
        closure: Closure {
            total: estimate(0.0121, 1e-4),
            sum: estimate(0.012, 1e-4),
            rest: 3e-4,
            expected: 2.9e-4,
            z: if closes { 0.4 } else { 7.0 },
            closes,
        },
    }
}

/// A budget that does not close is not told as one that does; the largest cause is one of those in the sum.
#[test]
fn a_budget_is_told_as_it_is() {
    let good = budget_account(&budget(true));
    assert_eq!(good.tone, Tone::Good);
    assert!(
        good.sentence
            .contains("the parts add up to 0.0120 ± 1.0 × 10⁻⁴"),
        "{}",
        good.sentence
    );
    assert!(
        good.sentence
            .contains("largest of them is 5 bounces, 0.012")
    );
    let bad = budget_account(&budget(false));
    assert_eq!(bad.tone, Tone::Bad);
    assert!(bad.sentence.contains("DO NOT ADD UP") && bad.sentence.contains("z = 7.0"));
}

#[test]
fn a_power_study_outside_of_what_chance_allows_is_bad() {
    let row = |false_alarms, smallest_scale| PowerRow {
        estimator: "shared".to_owned(),
        samples: 64,
        seeds: 40,
        chi2_per_dof: 1.0,
        false_alarms,
        expected: [0, 3],
        detections: Vec::new(),
        smallest_scale,
    };
    let study = |rows| Power {
        scene: "bench".to_owned(),
        scene_hash: String::new(),
        sampler: "sobol".to_owned(),
        significance: 0.01,
        rows,
    };
    let fine = power_account(&study(vec![row(0, 0.02), row(2, 0.005)]));
    assert_eq!(fine.tone, Tone::Good);
    assert!(
        fine.sentence.contains("is 0.0050 (median over 40"),
        "{}",
        fine.sentence
    );
    // 2 of 80.
    assert!(fine.sentence.contains("2 times in 80, a rate of 0.025"));
    assert_eq!(
        power_account(&study(vec![row(0, 0.02), row(9, 0.005)])).tone,
        Tone::Bad
    );
}

#[test]
fn bands_that_cover_too_little_are_named() {
    let row = |method: &str, covered: Option<f64>| CoverageRow {
        method: method.to_owned(),
        bands: None,
        failed: 0,
        covered,
        stderr: Some(0.01),
        least: None,
        bias: None,
        width: None,
        reason: None,
    };
    let study = Coverage {
        scene: "bench".to_owned(),
        scene_hash: String::new(),
        noise: 0.01,
        confidence: 0.95,
        seeds: 10,
        elements: 4,
        rows: vec![
            row("joint", Some(0.93)),
            row("tsvd", Some(0.6)),
            row("none", None),
        ],
    };
    let found = coverage_account(&study);
    assert_eq!(found.tone, Tone::Bad);
    assert!(
        found
            .sentence
            .contains("no less than stated: joint 93.0 % ± 1.0;"),
        "{}",
        found.sentence
    );
    assert!(
        found
            .sentence
            .contains("fall tsvd 60.0 % ± 1.0. 1 of the methods gave no bands.")
    );
}

#[test]
fn slopes_are_told_by_sampler() {
    let curve = |sampler: &str, slope, error| Curve {
        estimator: "shared".to_owned(),
        sampler: sampler.to_owned(),
        steps: vec![Step {
            samples: 64,
            error,
            stated: error,
        }],
        slope,
    };
    let study = Convergence {
        scene: "bench".to_owned(),
        scene_hash: String::new(),
        seed: 1,
        curves: vec![
            curve("pcg", -0.51, 0.1),
            curve("pcg", -0.49, 0.2),
            curve("sobol", -0.9, 0.01),
        ],
    };
    let sentence = convergence_account(&study).sentence;
    assert!(
        sentence.contains("that of pcg by a slope of −0.510 to −0.490 and of sobol"),
        "{sentence}"
    );
    assert!(
        sentence.contains("0.010, is left by shared, sobol with 64 samples"),
        "{sentence}"
    );
}
