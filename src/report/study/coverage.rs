//! The coverage study in a sentence and a table.

use super::super::page::Tone;
use super::account::{Account, Table, figure, listed, perhaps};
use crate::study::{Coverage, CoverageRow};

/// What bands cover is short of what they state where it is more than so many standard errors below.
const SHORT: f64 = 3.0;

/// Which bands cover what they state, and every method.
pub fn coverage_account(study: &Coverage) -> Account {
    let percent = |x: f64| format!("{:.1} %", 100.0 * x);
    let error = |r: &CoverageRow| {
        r.stderr
            .map_or(String::new(), |s| format!(" ± {:.1}", 100.0 * s))
    };
    let judged: Vec<(&CoverageRow, f64)> = study
        .rows
        .iter()
        .filter_map(|r| Some((r, r.covered?)))
        .collect();
    let short = |&&(r, covered): &&(&CoverageRow, f64)| {
        r.stderr
            .is_some_and(|s| covered < study.confidence - SHORT * s)
    };
    let say = |(r, covered): &&(&CoverageRow, f64)| {
        format!("{} {}{}", r.method, percent(*covered), error(r))
    };
    let below: Vec<String> = judged.iter().filter(short).map(|x| say(&x)).collect();
    let fine: Vec<String> = judged
        .iter()
        .filter(|x| !short(x))
        .map(|x| say(&x))
        .collect();
    let silent = study.rows.len() - judged.len();
    let silent = match silent {
        0 => String::new(),
        n => format!(" {n} of the methods gave no bands."),
    };
    let failing = match below.as_slice() {
        [] => String::new(),
        some => format!(
            "; short of it, by more than three standard errors, fall {}",
            listed(some)
        ),
    };
    let sentence = format!(
        "Bands of {} on {} at a noise of {} cover the true reflectance no less than stated: {}{failing}.{silent}",
        percent(study.confidence),
        study.scene,
        figure(study.noise, 2),
        listed(&fine)
    );
    let mut table = Table::new(
        format!(
            "What bands of {} cover: {} elements, noise {} of each entry, {} seeds",
            percent(study.confidence),
            study.elements,
            figure(study.noise, 2),
            study.seeds
        ),
        2,
        &[
            "method",
            "bands",
            "covered",
            "the least covered element",
            "rms bias",
            "mean width",
        ],
    );
    table.rows = study
        .rows
        .iter()
        .map(|r| {
            vec![
                r.method.clone(),
                r.bands.clone().unwrap_or_else(|| "–".to_owned()),
                r.covered.map_or("–".to_owned(), |c| percent(c) + &error(r)),
                r.least.map_or("–".to_owned(), percent),
                perhaps(r.bias, 2),
                perhaps(r.width, 2),
            ]
        })
        .collect();
    let reasons: Vec<String> = study
        .rows
        .iter()
        .filter_map(|r| {
            Some(format!(
                "{}: {} of {} seeds gave nothing: {}.",
                r.method,
                r.failed,
                study.seeds,
                r.reason.as_ref()?
            ))
        })
        .collect();
    table.note = reasons.join(" ");
    Account {
        title: format!("How often bands cover the truth: {}", study.scene),
        tone: if below.is_empty() {
            Tone::Good
        } else {
            Tone::Bad
        },
        sentence,
        words: String::new(),
        tables: vec![table],
    }
}
