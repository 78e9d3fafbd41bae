//! The noise study in a sentence and tables.

use super::super::noise::{level, place};
use super::super::page::Tone;
use super::account::{Account, Table, figure, perhaps};
use crate::study::{Best, LIMITS, Lost, NoiseStudy, Reach};

/// The published method, named beside the best one.
const PUBLISHED: &str = "pinv";
/// More objects than this are left to the table.
const MOST_NAMED: usize = 3;

/// Which method bears how much noise, and every threshold.
pub fn noise_account(study: &NoiseStudy) -> Account {
    let [high, low] = LIMITS;
    let said: Vec<String> = study
        .best
        .iter()
        .take(MOST_NAMED)
        .map(|b| best(study, b))
        .collect();
    let more = match study.best.len() {
        n if n > MOST_NAMED => format!(" ({} further objects in the table)", n - MOST_NAMED),
        _ => String::new(),
    };
    let to = if falls(study) { "down" } else { "up" };
    let sentence = format!(
        "The mean raw MTF stays at {high} or more {to} to this level ({}): {}{more}.",
        study.axis_title,
        said.join("; ")
    );
    let side = |n: usize| format!("{n} × {n}");
    let mut lost = Table::new(
        format!(
            "{} at which the mean MTF over {} draws falls to {high} and to {low} ({} kernel)",
            study.axis_title, study.seeds, study.kernel
        ),
        3,
        &["checks", "elements", "method"],
    );
    for kind in ["raw", "normalized"] {
        lost.head
            .extend([high, low].map(|l| format!("MTF {kind} {l}")));
    }
    lost.rows = study
        .curves
        .iter()
        .map(|c| {
            let levels = c.lost_raw.iter().chain(&c.lost_normalized);
            [side(c.board), side(c.elements), c.method.clone()]
                .into_iter()
                .chain(levels.map(|l| level(*l)))
                .collect()
        })
        .collect();
    lost.note = format!(
        "{}. Always: below at the quietest level already; never: not below at any; undefined: before that some draw gave nothing, or no mean is known.",
        study.axis_words.trim_end_matches('.')
    );
    let mut bests = Table::new(
        format!(
            "The best method: mean raw MTF of {high} or more up to the loudest noise, of equals the least RMSE"
        ),
        3,
        &[
            "checks",
            "elements",
            "method",
            "level",
            "RMSE",
            "RMSE over bound",
        ],
    );
    bests.rows = study
        .best
        .iter()
        .map(|b| {
            let sign = if b.reach == Some(Reach::AtLeast) {
                "to "
            } else {
                ""
            };
            vec![
                side(b.board),
                side(b.elements),
                b.method.clone().unwrap_or_else(|| "none".to_owned()),
                format!("{sign}{}", perhaps(b.level, 2)),
                perhaps(b.rmse, 2),
                perhaps(b.rmse_over_bound, 2),
            ]
        })
        .collect();
    bests.note = "`to`: it has not fallen there, but beyond no level was studied or no mean is known. The bound is that of Cramér and Rao for unbiased recoveries, which methods that use bounds or two \
                  values can undercut."
        .to_owned();
    let mut tables = vec![lost, bests];
    if !study.render_noise.is_empty() {
        let mut renders = Table::new(
            "Noise of renders (relative, rms over entries) and the level of an entry as noisy",
            1,
            &["estimator", "samples", "noise", "level"],
        );
        renders.rows = study
            .render_noise
            .iter()
            .map(|m| {
                vec![
                    m.estimator.clone(),
                    m.samples.to_string(),
                    figure(m.noise, 3),
                    perhaps(m.level, 3),
                ]
            })
            .collect();
        tables.push(renders);
    }
    Account {
        title: format!("How much noise each recovery bears: {}", place(study)),
        tone: Tone::Plain,
        sentence,
        words: String::new(),
        tables,
    }
}

/// Whether the level falls as the noise grows: photons, exposures, bits.
fn falls(study: &NoiseStudy) -> bool {
    let ends = study
        .curves
        .first()
        .map(|c| (c.points.first(), c.points.last()));
    matches!(ends, Some((Some(quiet), Some(loud))) if quiet.level > loud.level)
}

/// The best method of an object beside the published one.
fn best(study: &NoiseStudy, b: &Best) -> String {
    let object = format!(
        "{0} × {0} checks on {1} × {1} elements",
        b.board, b.elements
    );
    let own = study
        .curves
        .iter()
        .find(|c| [c.board, c.elements] == [b.board, b.elements] && c.method == PUBLISHED);
    let published = own
        .filter(|c| b.method.as_deref() != Some(&c.method))
        .map_or(String::new(), |c| {
            let told = match c.lost_raw[0] {
                Lost::At(x) => figure(x, 2),
                Lost::Before => "not even the quietest".to_owned(),
                Lost::Never => "the loudest studied".to_owned(),
                Lost::Unknown => "undefined".to_owned(),
            };
            format!(" (the published {PUBLISHED}: {told})")
        });
    match (&b.method, b.level) {
        (Some(method), Some(level)) => {
            let sign = match (b.reach, falls(study)) {
                (Some(Reach::AtLeast), false) => "at least ",
                (Some(Reach::AtLeast), true) => "at most ",
                _ => "",
            };
            format!(
                "{object}: {sign}{} by {method}{published}",
                figure(level, 2)
            )
        }
        _ => format!("{object}: no method reaches it{published}"),
    }
}
