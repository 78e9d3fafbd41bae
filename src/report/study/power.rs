//! The power study in a sentence and tables.

use super::super::page::Tone;
use super::account::{Account, Table, figure};
use crate::study::{Power, PowerRow};

/// The smallest error that is detected, and how often a right model is rejected.
pub fn power_account(power: &Power) -> Account {
    let within = |r: &PowerRow| (r.expected[0]..=r.expected[1]).contains(&r.false_alarms);
    let sharpest = power
        .rows
        .iter()
        .min_by(|a, b| a.smallest_scale.total_cmp(&b.smallest_scale));
    let sharpest = sharpest.map_or(String::new(), |r| {
        format!(
            "The smallest scale error that validate detects on {} is {} (median over {} renders by {} with {} samples). ",
            power.scene,
            figure(r.smallest_scale, 2),
            r.seeds,
            r.estimator,
            r.samples
        )
    });
    let alarms: u64 = power.rows.iter().map(|r| r.false_alarms).sum();
    let renders: u64 = power.rows.iter().map(|r| r.seeds).sum();
    let fine = power.rows.iter().filter(|r| within(r)).count();
    let rate = match renders {
        0 => 0.0,
        n => alarms as f64 / n as f64,
    };
    let sentence = format!(
        "{sharpest}A right model was rejected {alarms} times in {renders}, a rate of {} at a stated significance of {}: {fine} of {} settings lie where 99 % of such counts do.",
        figure(rate, 2),
        figure(power.significance, 2),
        power.rows.len()
    );
    let mut right = Table::new(
        format!(
            "The right model, at a significance of {}",
            figure(power.significance, 2)
        ),
        1,
        &[
            "estimator",
            "samples",
            "seeds",
            "χ²/dof",
            "false alarms",
            "expected",
            "smallest scale error detected, median",
        ],
    );
    let mut wrong = Table::new(
        "Wrong models, rejected",
        2,
        &[
            "estimator",
            "what is wrong",
            "samples",
            "Φcam off by",
            "rejected",
            "of",
        ],
    );
    for r in &power.rows {
        right.rows.push(vec![
            r.estimator.clone(),
            r.samples.to_string(),
            r.seeds.to_string(),
            figure(r.chi2_per_dof, 4),
            r.false_alarms.to_string(),
            format!("{} to {}", r.expected[0], r.expected[1]),
            figure(r.smallest_scale, 2),
        ]);
        wrong.rows.extend(r.detections.iter().map(|d| {
            vec![
                r.estimator.clone(),
                d.error.clone(),
                r.samples.to_string(),
                figure(d.size, 2),
                d.rejected.to_string(),
                r.seeds.to_string(),
            ]
        }));
    }
    Account {
        title: format!("What validate detects: {}", power.scene),
        tone: if fine == power.rows.len() {
            Tone::Good
        } else {
            Tone::Bad
        },
        sentence,
        words: String::new(),
        tables: vec![right, wrong],
    }
}
