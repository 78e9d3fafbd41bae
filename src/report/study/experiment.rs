//! The re-enacted experiment in its own words and in tables.

use super::super::experiment::spreads;
use super::super::page::Tone;
use super::account::{Account, Table, figure, perhaps};
use crate::study::{Experiment, Setting};

/// What is said of a setting in the head of its column.
type Head = fn(&Setting) -> String;

/// The findings in plain words, and the modulation under every setting.
pub fn experiment_account(study: &Experiment) -> Account {
    let mut tables = Vec::new();
    let sweeps: [(&[Setting], &str, Head); 2] = [
        (
            &study.by_glare,
            "by glare over signal, at the longest exposure",
            |s| figure(s.glare, 2),
        ),
        (
            &study.by_exposure,
            "by exposure of a frame, glare as strong as the signal",
            |s| format!("{} s", figure(s.exposure, 2)),
        ),
    ];
    for (settings, title, head) in sweeps {
        for spread in spreads(settings) {
            let of: Vec<&Setting> = settings.iter().filter(|s| s.spread == spread).collect();
            let heads: Vec<String> = of.iter().map(|s| head(s)).collect();
            let heads: Vec<&str> = std::iter::once("analysis")
                .chain(heads.iter().map(String::as_str))
                .collect();
            let mut table = Table::new(
                format!("Normalized modulation {title}; {spread} glare"),
                1,
                &heads,
            );
            for i in 0..of[0].readings.len() {
                let reading =
                    |s: &&Setting| perhaps(s.readings[i].mtf_normalized.map(|m| m.mean), 2);
                let name = of[0].readings[i].analysis.clone();
                table.rows.push(
                    std::iter::once(name)
                        .chain(of.iter().map(reading))
                        .collect(),
                );
            }
            tables.push(table);
        }
    }
    let mut limits = Table::new(
        "Where each analysis reads the board",
        2,
        &[
            "analysis",
            "glare",
            "largest glare over signal",
            "shortest exposure, s",
        ],
    );
    limits.rows = study
        .thresholds
        .iter()
        .map(|t| {
            vec![
                t.analysis.clone(),
                t.spread.clone(),
                perhaps(t.glare, 2),
                perhaps(t.exposure, 2),
            ]
        })
        .collect();
    tables.push(limits);
    Account {
        title: format!("The experiment, again: {}", study.scene),
        tone: Tone::Plain,
        sentence: first(&study.words).to_owned(),
        words: study.words.clone(),
        tables,
    }
}

/// The first two sentences: how strong the glare is, and what the published analysis finds under it.
fn first(words: &str) -> &str {
    let ends = words.match_indices(". ").map(|(at, _)| at + 1);
    ends.take(2).last().map_or(words, |end| &words[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_sentences_are_told_on_top() {
        assert_eq!(
            first("It is 0.5 W. It `falls`. More. And more."),
            "It is 0.5 W. It `falls`."
        );
        assert_eq!(first("Only one."), "Only one.");
    }
}
