//! The convergence study in a sentence and tables.

use super::super::page::Tone;
use super::account::{Account, Table, figure, listed};
use crate::study::{Convergence, Curve};

/// How fast the errors fall, and every error.
pub fn convergence_account(study: &Convergence) -> Account {
    let mut samplers: Vec<&str> = Vec::new();
    for c in &study.curves {
        if !samplers.contains(&c.sampler.as_str()) {
            samplers.push(&c.sampler);
        }
    }
    let range = |sampler: &&str| {
        let slopes = study.curves.iter().filter(|c| c.sampler == **sampler);
        let [low, high] = slopes.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], c| {
            [l.min(c.slope), h.max(c.slope)]
        });
        format!(
            "of {sampler} by a slope of {} to {}",
            figure(low, 3),
            figure(high, 3)
        )
    };
    let ranges: Vec<String> = samplers.iter().map(range).collect();
    let last = |c: &Curve| c.steps.last().map_or(f64::INFINITY, |s| s.error);
    let best = study
        .curves
        .iter()
        .min_by(|a, b| last(a).total_cmp(&last(b)));
    let best = best.and_then(|c| {
        let s = c.steps.last()?;
        Some(format!(
            " The least, {}, is left by {}, {} with {} samples.",
            figure(s.error, 2),
            c.estimator,
            c.sampler,
            s.samples
        ))
    });
    let sentence = format!(
        "The relative error of Φcam on {} falls with the number of samples, that {} (−½ is what independent random numbers have).{}",
        study.scene,
        listed(&ranges),
        best.unwrap_or_default()
    );
    let mut slopes = Table::new(
        "Slopes of log error against log samples",
        2,
        &["estimator", "sampler", "slope"],
    );
    let mut steps = Table::new(
        "Relative error against converged quadrature",
        2,
        &[
            "estimator",
            "sampler",
            "samples",
            "error",
            "stated standard error",
        ],
    );
    for c in &study.curves {
        let named = || vec![c.estimator.clone(), c.sampler.clone()];
        let with = |more: Vec<String>| [named(), more].concat();
        slopes.rows.push(with(vec![figure(c.slope, 3)]));
        steps.rows.extend(c.steps.iter().map(|s| {
            with(vec![
                s.samples.to_string(),
                figure(s.error, 3),
                figure(s.stated, 3),
            ])
        }));
    }
    Account {
        title: format!("How fast the error falls: {}", study.scene),
        tone: Tone::Plain,
        sentence,
        words: String::new(),
        tables: vec![slopes, steps],
    }
}
