//! What is said of what bands cover.

use super::{Coverage, CoverageRow};
use crate::lab::finding::{Cell, Column, Describe, Finding, Table, Tone, listed};
use crate::num::digits::figure;

/// What bands cover is short of what they state where it is more than so many standard errors
/// below.
const SHORT: f64 = 3.0;

impl CoverageRow {
    /// Whether its bands cover less than `confidence`; none where it has no bands, or of one draw,
    /// which tells nothing of how often.
    fn falls_short(&self, confidence: f64) -> Option<bool> {
        let (covered, stderr) = self.covered.zip(self.stderr)?;
        Some(covered < confidence - SHORT * stderr)
    }

    /// What its bands cover, in percent.
    fn percent(&self) -> Option<Cell> {
        Some(Cell::Estimate {
            value: 100.0 * self.covered?,
            stderr: self.stderr.map(|s| 100.0 * s),
        })
    }

    /// The method and what its bands cover, in words.
    fn words(&self) -> String {
        let covered = 100.0 * self.covered.unwrap_or(f64::NAN);
        let error = self
            .stderr
            .map_or(String::new(), |s| format!(" ± {:.1}", 100.0 * s));
        format!("{} {covered:.1} %{error}", self.method)
    }
}

impl Describe for Coverage {
    fn describe(&self) -> Finding {
        let named = |short: Option<bool>| {
            let own = self.rows.iter().filter(|r| r.covered.is_some());
            let own = own.filter(|r| r.falls_short(self.confidence) == short);
            own.map(CoverageRow::words).collect::<Vec<_>>()
        };
        let clauses = [
            (
                "are not shown to cover the true reflectance less often than stated",
                named(Some(false)),
            ),
            (
                "fall short by more than three standard errors",
                named(Some(true)),
            ),
            ("tell nothing, as of one draw", named(None)),
        ];
        let said: Vec<String> = clauses
            .iter()
            .filter(|(_, methods)| !methods.is_empty())
            .map(|(what, methods)| format!("{what}: {}", listed(methods)))
            .collect();
        let tone = match &clauses {
            [_, (_, short), _] if !short.is_empty() => Tone::Bad,
            [(_, fine), ..] if !fine.is_empty() => Tone::Good,
            _ => Tone::Plain,
        };
        let silent = match self.rows.iter().filter(|r| r.covered.is_none()).count() {
            0 => String::new(),
            n => format!(" {n} of the methods gave no bands."),
        };
        let stated = format!("{} %", figure(100.0 * self.confidence, 3));
        let noise = figure(self.noise, 2);
        let reason = |r: &CoverageRow| {
            let reason = r.reason.as_ref()?;
            Some(format!(
                "{}: {} of {} seeds gave nothing: {reason}.",
                r.method, r.failed, self.seeds
            ))
        };
        let refuted = |r: &CoverageRow| {
            (r.refuted > 0).then(|| {
                format!(
                    "{}: in {} of {} seeds no reflectances explain the photographs, so that its bands are empty and cover nothing.",
                    r.method, r.refuted, self.seeds
                )
            })
        };
        let table = Table {
            caption: format!(
                "What bands of {stated} cover: {} elements, noise {noise} of each entry, {} seeds",
                self.elements, self.seeds
            ),
            note: self
                .rows
                .iter()
                .flat_map(|r| reason(r).into_iter().chain(refuted(r)))
                .collect::<Vec<_>>()
                .join(" "),
            ..Table::of(
                &self.rows,
                [
                    Column::text("method", "").of(|r| Cell::name(&r.method)),
                    Column::text("promise", "").of(|r| r.bands.as_deref().unwrap_or("–").into()),
                    Column::number("covered", "", "%", 3)
                        .of(|r| r.percent().unwrap_or(Cell::Number(None))),
                    Column::number("the least covered element", "", "%", 3)
                        .of(|r| r.least.map(|x| 100.0 * x).into()),
                    Column::number("all at once", "", "%", 3)
                        .of(|r| r.together.map(|x| 100.0 * x).into()),
                    Column::number("rms bias", "", "", 2).of(|r| r.bias.into()),
                    Column::number("mean width", "", "", 2).of(|r| r.width.into()),
                ],
            )
        };
        Finding {
            title: format!("How often bands cover the truth: {}", self.scene),
            tone,
            sentence: format!(
                "Of {} draws of a noise of {noise} on {}, bands of {stated} {}.{silent}",
                self.seeds,
                self.scene,
                match said.as_slice() {
                    [] => "are none".to_owned(),
                    said => said.join("; these "),
                }
            ),
            tables: vec![table],
            ..Finding::default()
        }
    }
}
