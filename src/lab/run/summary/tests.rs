//! What a summary says of a run.

use super::*;
use crate::lab::sample::{bare, run};
use crate::num::stream::Sampling;
use crate::transport::Estimator;

fn told(finding: &Finding) -> String {
    format!("{:?}", finding.tables)
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
        tails: matrix(0.0),
    };
    let finding = describe_render(&results.scene, &results.plan, &traced, 8.04);
    let texts = finding.tables[0].rows.iter().flatten();
    let texts = texts.map(|c| match c {
        Cell::Text(text) => text.as_str(),
        _ => "",
    });
    let texts = texts.collect::<Vec<_>>().join("\n");
    for words in [
        "2 pixels × 3 spots",
        "1.20 × 10⁻¹¹\u{a0}W over all pixels and spots, standard error 1.00\u{a0}%",
        "1 surfaces 75.0\u{a0}%, 2 surfaces 0\u{a0}%, 3 surfaces 25.0\u{a0}%",
        "error bars\ncan be trusted at all 6 entries",
        "time\n8.0\u{a0}s",
    ] {
        assert!(texts.contains(words), "no {words}: {texts}");
    }
    // 2 %: four times the samples.
    let coarse = Traced {
        stderr: matrix(4e-14),
        ..traced
    };
    let plan = Plan::new(Estimator::Shared, Sampling::Sobol, 1, 512).unwrap();
    let finding = describe_render(&results.scene, &plan, &coarse, 8.04);
    let cure = "`--estimator shared --samples 2048` makes that 1.00";
    assert!(told(&finding).contains(cure), "{finding:?}");
}

/// An entry that no light was met for has an upper bound in place of a standard error: it has
/// no part in the figure for all. Five entries of 1 W ± 0.01 W: 1 %.
#[test]
fn bounds_are_no_part_of_the_overall_error() {
    let of = |last: [f64; 3]| {
        let [flux, stderr, tails] = [0, 1, 2].map(|which| {
            let usual = [1.0, 0.01, 0.0][which];
            Matrix::from_fn(6, 1, |p, _| if p == 5 { last[which] } else { usual })
        });
        relative_stderr(&flux, &stderr, &tails).unwrap()
    };
    let unlit = f64::from(UNLIT);
    assert!((of([0.0, 1e3, unlit]) - 0.01).abs() < 1e-15);
    assert!(of([0.0, 1e3, 0.0]) > 100.0);
}

#[test]
fn disagreement_is_loud() {
    let mut results = run("bench");
    assert_eq!(results.describe().tone, Tone::Good);
    assert!(told(&results.describe()).contains("P(χ²) 0.36"));
    let agreement = results.agreement.as_mut().unwrap();
    assert_eq!(agreement.describe().tables.len(), 1);
    agreement.agrees = false;
    assert_eq!(agreement.describe().tables[1].rows.len(), 1);
    agreement.evidence = false;
    assert!(agreement.verdict().starts_with("no evidence"));
    agreement.evidence = true;
    assert!(results.verdict().contains("DISAGREE") && results.tone() == Tone::Bad);
}

#[test]
fn a_run_without_model_says_so() {
    let found = bare("furnace").describe();
    assert_eq!((found.tone, found.tables.len()), (Tone::Plain, 1));
}

/// The squares of scale and pattern add up to that of the difference.
#[test]
fn the_difference_is_taken_apart() {
    let mut results = run("bench");
    results.agreement.as_mut().unwrap().best_scale = 1.0006;
    let table = results.difference().unwrap();
    let share = |row: usize| match table.rows[row][1] {
        Cell::Share(share) => share.unwrap(),
        _ => panic!("{row}"),
    };
    let sum = share(1).powi(2) + share(2).powi(2);
    assert!((sum.sqrt() / share(0) - 1.0).abs() < 1e-12);
    assert!(bare("bench").difference().is_none());
}
