//! Tables of a re-enacted experiment.

use super::Varied;
use crate::lab::ensemble::Spread;
use crate::lab::finding::{Cell, Column, Place, Table};
use crate::lab::studies::experiment::results::{Experiment, Reading, Setting};
use crate::num::digits::figure;

impl Experiment {
    /// A table for each spread of the glare: a line an analysis, a column a setting.
    pub(super) fn sweep(
        &self,
        settings: &[Setting],
        title: &str,
        x: Varied,
        unit: &str,
    ) -> Vec<Table> {
        let of = |own: &[Setting]| {
            let head =
                |s: &Setting| Column::number(&format!("{}{unit}", figure(x(s), 2)), "", "", 2);
            let cell =
                |reading: &Reading| match (reading.mtf_normalized, reading.in_some(self.seeds)) {
                    (Some(m), Some(of)) => format!("{} ({of})", figure(m.mean, 2)).into(),
                    (m, _) => mean(m),
                };
            let row = |i: usize| {
                let name = own[0].readings[i].analysis.as_str().into();
                let cells = own.iter().map(|s| cell(&s.readings[i]));
                std::iter::once(name).chain(cells).collect()
            };
            let heads = own.iter().map(head);
            Table {
                caption: format!("Normalized modulation {title}; {} glare", own[0].spread),
                columns: std::iter::once(Column::text("analysis", ""))
                    .chain(heads)
                    .collect(),
                rows: (0..own[0].readings.len()).map(row).collect(),
                ..Table::default()
            }
        };
        Setting::by_spread(settings).map(of).collect()
    }

    pub(super) fn limits(&self) -> Table {
        Table {
            caption: "Where each analysis reads the picture".to_owned(),
            place: Place::Page,
            ..Table::of(
                &self.thresholds,
                [
                    Column::text("analysis", "").of(|t| (&t.analysis).into()),
                    Column::text("glare", "").of(|t| (&t.spread).into()),
                    Column::number("largest glare over signal", "", "", 2).of(|t| t.glare.into()),
                    Column::number("shortest exposure", "", "s", 2).of(|t| t.exposure.into()),
                ],
            )
        }
    }

    /// Every reading.
    pub(super) fn file(&self) -> Table {
        let sweeps = [("glare", &self.by_glare), ("exposure", &self.by_exposure)];
        let settings = sweeps
            .into_iter()
            .flat_map(|(name, all)| all.iter().map(move |s| (name, s)));
        let readings = settings.flat_map(|(name, s)| s.readings.iter().map(move |r| (name, s, r)));
        let column = |key| Column::text("", key);
        Table {
            file: Some("experiment.csv".to_owned()),
            place: Place::File,
            ..Table::of(
                readings,
                [
                    column("sweep").of(|(sweep, ..)| Cell::name(sweep)),
                    column("spread").of(|(_, s, _)| Cell::name(&s.spread)),
                    column("glare").of(|(_, s, _)| s.glare.into()),
                    column("fraction").of(|(_, s, _)| s.fraction.into()),
                    column("exposure_s").of(|(_, s, _)| s.exposure.into()),
                    column("electrons").of(|(_, s, _)| s.electrons.into()),
                    column("saturated").of(|(_, s, _)| s.saturated.into()),
                    column("noise").of(|(_, s, _)| s.noise.into()),
                    column("analysis").of(|(.., r)| (&r.analysis).into()),
                    column("mtf").of(|(.., r)| mean(r.mtf)),
                    column("mtf_sd").of(|(.., r)| deviation(r.mtf)),
                    column("mtf_normalized").of(|(.., r)| mean(r.mtf_normalized)),
                    column("mtf_normalized_sd").of(|(.., r)| deviation(r.mtf_normalized)),
                    column("mtf_normalized_draws")
                        .of(|(.., r)| r.mtf_normalized.map_or(0, |m| m.draws).into()),
                    column("correlation").of(|(.., r)| mean(r.correlation)),
                    column("correlation_sd").of(|(.., r)| deviation(r.correlation)),
                    column("failed").of(|(.., r)| r.failed.into()),
                ],
            )
        }
    }
}

fn mean(spread: Option<Spread>) -> Cell {
    spread.map(|s| s.mean).into()
}

fn deviation(spread: Option<Spread>) -> Cell {
    spread.and_then(|s| s.deviation).into()
}
