//! The indicator study in a sentence and tables.

use super::super::page::Tone;
use super::account::{Account, Table, figure, perhaps};
use crate::study::{Coefficients, Indicator};

/// What predicts the modulation best, and every coefficient.
pub fn indicator_account(study: &Indicator) -> Account {
    let size = |c: &&Coefficients| c.pearson.map_or(-1.0, f64::abs);
    let best = study
        .coefficients
        .iter()
        .max_by(|a, b| size(a).total_cmp(&size(b)));
    let best = best.map_or(String::new(), |c| {
        format!(
            "Over {} configurations of {}, the raw MTF of pinv without noise is predicted best by {} (Pearson {}, Spearman {}). ",
            study.configurations.len(),
            study.scene,
            c.indicator,
            perhaps(c.pearson, 4),
            perhaps(c.spearman, 4)
        )
    });
    let compared: usize = study.noisy.iter().map(|n| n.compared).sum();
    let within: usize = study.noisy.iter().map(|n| n.within_three).sum();
    let noisy = match compared {
        0 => "No point under noise has a prediction.".to_owned(),
        n => format!(
            "Under noise {within} of {n} predicted means lie within three standard errors of what {} draws give.",
            study.seeds
        ),
    };
    let mut tables = vec![coefficients(
        "Correlation with the raw MTF without noise".to_owned(),
        &study.coefficients,
    )];
    let mut summary = Table::new(
        "Under noise: predicted against measured",
        1,
        &[
            "method",
            "compared",
            "within 3 s.e.",
            "largest z",
            "its p",
            "without a mean",
            "without covariance",
            "failed",
        ],
    );
    for n in &study.noisy {
        let of = |text: String| {
            if n.compared > 0 {
                text
            } else {
                "–".to_owned()
            }
        };
        summary.rows.push(vec![
            n.method.clone(),
            n.compared.to_string(),
            n.within_three.to_string(),
            of(figure(n.largest_z, 3)),
            of(figure(n.largest_p, 2)),
            n.undefined.to_string(),
            n.without_covariance.to_string(),
            n.failed.to_string(),
        ]);
    }
    summary.note =
        "Without a mean: the spread of white + black is above a tenth of its mean.".to_owned();
    tables.push(summary);
    let noisy_tables = study.noisy.iter().filter(|n| n.compared > 1);
    tables.extend(noisy_tables.map(|n| {
        coefficients(
            format!("Correlation with the mean MTF under noise, {}", n.method),
            &n.coefficients,
        )
    }));
    Account {
        title: format!("What predicts the modulation of pinv: {}", study.scene),
        tone: Tone::Plain,
        sentence: format!(
            "{best}The projected object and the recovery differ by {} at most. {noisy}",
            figure(study.identity, 2)
        ),
        words: String::new(),
        tables,
    }
}

fn coefficients(caption: String, all: &[Coefficients]) -> Table {
    let mut table = Table::new(
        caption,
        1,
        &["figure", "Pearson", "Spearman", "configurations"],
    );
    table.rows = all
        .iter()
        .map(|c| {
            vec![
                c.indicator.clone(),
                perhaps(c.pearson, 6),
                perhaps(c.spearman, 6),
                c.configurations.to_string(),
            ]
        })
        .collect();
    table
}
