//! The study of wall BRDFs in a sentence and tables.

use super::super::brdf::{rows, spread, verdict};
use super::super::page::Tone;
use super::account::{Account, Table, figure, listed, perhaps};
use crate::study::BrdfStudy;

/// Whether the light agrees with the model that knows the wall, what it rejects, and every assumption.
pub fn brdf_account(study: &BrdfStudy) -> Account {
    let known = study.known();
    let g = &known.agreement;
    let others = study.assumptions.iter().skip(1);
    let (accepted, rejected): (Vec<_>, Vec<_>) = others.partition(|a| a.agreement.agrees);
    let names = |all: Vec<&crate::study::Assumption>| -> Vec<String> {
        let name = |a: &crate::study::Assumption| {
            format!(
                "{} (off by {})",
                a.name,
                figure(a.agreement.relative_difference, 2)
            )
        };
        all.into_iter().map(name).collect()
    };
    let (accepted, rejected) = (names(accepted), names(rejected));
    let also = match accepted.as_slice() {
        [] => String::new(),
        some => format!("; it also accepts {}", listed(some)),
    };
    let reach = study
        .ratios
        .iter()
        .filter(|r| r.reaches == Some(true))
        .count();
    let judged = study.ratios.iter().filter(|r| r.reaches.is_some()).count();
    let sentence = format!(
        "On {}, at a significance of {}, the traced light {} the model that knows the wall's BRDF (difference {}, of which noise {}) and rejects {}{also}. With the known BRDF, {reach} of {judged} \
         recoveries that work on a Lambertian wall reach it within 10 %.",
        study.scene,
        figure(g.significance, 2),
        if g.agrees { "agrees with" } else { "REJECTS" },
        figure(g.relative_difference, 2),
        figure(g.relative_noise, 2),
        listed(&rejected)
    );
    let mut agreement = Table::new(
        format!(
            "What is assumed of the wall against the light traced by {} with {} samples",
            study.estimator, study.samples
        ),
        2,
        &[
            "assumed of the wall",
            "verdict",
            "difference",
            "noise",
            "largest z",
            "scale",
        ],
    );
    agreement.rows = rows(study)
        .map(|a| {
            let g = &a.agreement;
            vec![
                a.name.clone(),
                verdict(a).to_owned(),
                figure(g.relative_difference, 3),
                figure(g.relative_noise, 3),
                figure(g.largest_z, 3),
                figure(a.scale, 5),
            ]
        })
        .collect();
    let mut tables = vec![agreement];
    for (k, q) in known.qualities.iter().enumerate() {
        let mut table = Table::new(
            format!(
                "Recovered by {} at a noise of {} of each entry, {} draws",
                q.method,
                figure(q.noise, 2),
                study.draws
            ),
            1,
            &["assumed of the wall", "MTF raw", "correlation", "RMSE"],
        );
        let of = |a: &crate::study::Assumption| {
            let q = &a.qualities[k];
            vec![
                a.name.clone(),
                spread(q.mtf_raw),
                spread(q.correlation),
                spread(q.rmse),
            ]
        };
        table.rows = rows(study).map(of).collect();
        let reasons = rows(study).filter_map(|a| {
            let q = &a.qualities[k];
            Some(format!(
                "{}: {} draws gave nothing: {}.",
                a.name,
                q.failed,
                q.reason.as_ref()?
            ))
        });
        table.note = reasons.collect::<Vec<_>>().join(" ");
        tables.push(table);
    }
    let mut ratios = Table::new(
        "Recovery with the known BRDF over that of a Lambertian wall of equal albedo",
        1,
        &[
            "method",
            "noise",
            "MTF raw ×",
            "correlation ×",
            "RMSE ×",
            "within 10 %",
        ],
    );
    ratios.rows = study
        .ratios
        .iter()
        .map(|r| {
            let reaches = match r.reaches {
                Some(true) => "yes",
                Some(false) => "no",
                None => "that one recovers nothing either",
            };
            vec![
                r.method.clone(),
                figure(r.noise, 2),
                perhaps(r.mtf_raw, 4),
                perhaps(r.correlation, 4),
                perhaps(r.rmse, 4),
                reaches.to_owned(),
            ]
        })
        .collect();
    tables.push(ratios);
    Account {
        title: format!("What knowing the wall's BRDF is worth: {}", study.scene),
        tone: if g.agrees { Tone::Good } else { Tone::Bad },
        sentence,
        words: String::new(),
        tables,
    }
}
