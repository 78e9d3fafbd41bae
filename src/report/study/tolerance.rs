//! The tolerance study in a sentence and tables.

use super::super::page::Tone;
use super::account::{Account, Table, figure, listed, perhaps};
use crate::study::{Sensitivity, Tolerance};

/// What loses the pattern first, and every misplacement.
pub fn tolerance_account(study: &Tolerance) -> Account {
    // Sizes compare within a unit only.
    let mut first: Vec<(&Sensitivity, f64)> = Vec::new();
    for (p, lost) in study
        .parameters
        .iter()
        .filter_map(|p| Some((p, p.lost_at?)))
    {
        match first.iter_mut().find(|(q, _)| q.unit == p.unit) {
            Some(least) if lost < least.1 => *least = (p, lost),
            Some(_) => (),
            None => first.push((p, lost)),
        }
    }
    let lost = study
        .parameters
        .iter()
        .filter(|p| p.lost_at.is_some())
        .count();
    let first: Vec<String> = first
        .iter()
        .map(|(p, size)| format!("{} off by {} {}", p.name, figure(*size, 2), p.unit))
        .collect();
    let found = match first.as_slice() {
        [] => "no error of geometry that was studied halves its MTF".to_owned(),
        _ => format!(
            "{lost} of {} errors of geometry can halve it, first {}",
            study.parameters.len(),
            listed(&first)
        ),
    };
    let sentence = format!(
        "With the right geometry and a noise of {} of each entry, joint recovers {} at an MTF raw of {}; {found}.",
        figure(study.noise, 2),
        study.scene,
        perhaps(study.mtf, 3)
    );
    let mut slopes = Table::new(
        "Change of Φcam where the error is small, and where the pattern is lost",
        1,
        &[
            "what is off",
            "dΦ/Φ a unit",
            "after the best single scale",
            "MTF halved at",
        ],
    );
    let mut rows = Table::new(
        "Every size",
        1,
        &[
            "what is off",
            "size",
            "‖ΔΦ‖/‖Φ‖",
            "after the best single scale",
            "MTF raw",
        ],
    );
    for p in &study.parameters {
        let slope = p.rows.first();
        let lost = p.lost_at.map_or("not lost, or undefined".to_owned(), |s| {
            format!("{} {}", figure(s, 2), p.unit)
        });
        slopes.rows.push(vec![
            p.name.clone(),
            perhaps(slope.map(|r| r.change / r.size), 2),
            perhaps(slope.map(|r| r.after_scale / r.size), 2),
            lost,
        ]);
        rows.rows.extend(p.rows.iter().map(|r| {
            vec![
                p.name.clone(),
                format!("{} {}", figure(r.size, 2), p.unit),
                figure(r.change, 3),
                figure(r.after_scale, 3),
                perhaps(r.mtf, 3),
            ]
        }));
    }
    Account {
        title: format!("How wrong the assumed geometry may be: {}", study.scene),
        tone: Tone::Plain,
        sentence,
        words: String::new(),
        tables: vec![slopes, rows],
    }
}
