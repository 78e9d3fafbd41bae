//! What the power study says.

use super::results::{Power, PowerRow};
use crate::lab::finding::{Cell, Column, Describe, Finding, Table, Tone};
use crate::num::digits::figure;

impl Describe for Power {
    fn describe(&self) -> Finding {
        let as_stated = self.rows.iter().all(PowerRow::as_stated);
        Finding {
            title: format!("What validate detects: {}", self.scene),
            tone: if as_stated { Tone::Good } else { Tone::Bad },
            sentence: self.sentence(),
            tables: vec![self.right(), self.wrong()],
            notes: self
                .unmodelled
                .iter()
                .map(|what| format!("Not in the model: {what}."))
                .collect(),
            ..Finding::default()
        }
    }
}

impl Power {
    /// The smallest error that is detected, and how often a right model is rejected.
    fn sentence(&self) -> String {
        let rows = || self.rows.iter();
        // 0 where the right model is rejected.
        let known = rows().filter(|r| r.smallest_scale > 0.0);
        let sharpest = known.min_by(|a, b| a.smallest_scale.total_cmp(&b.smallest_scale));
        let sharpest = sharpest.map_or(String::new(), |r| {
            format!(
                "The smallest scale error that validate detects on {} is {} (median over {} renders by {} with {} samples). ",
                self.scene,
                figure(r.smallest_scale, 2),
                r.seeds,
                r.estimator,
                r.samples
            )
        });
        let alarms: u64 = rows().map(|r| r.false_alarms).sum();
        let renders: u64 = rows().map(|r| r.seeds).sum();
        format!(
            "{sharpest}A right model was rejected {alarms} times in {renders}, a rate of {} at a \
             stated significance of {}: in {} of {} settings the count lies within the central 99 \
             % of its distribution.",
            figure(alarms as f64 / renders.max(1) as f64, 2),
            figure(self.significance, 2),
            rows().filter(|r| r.as_stated()).count(),
            self.rows.len()
        )
    }

    fn right(&self) -> Table {
        Table {
            caption: format!(
                "The right model at a significance of {}, random numbers by {}",
                figure(self.significance, 2),
                self.sampler
            ),
            ..Table::of(
                &self.rows,
                [
                    Column::text("estimator", "").of(|r| Cell::name(&r.estimator)),
                    Column::text("samples", "").of(|r| r.samples.into()),
                    Column::text("seeds", "").of(|r| r.seeds.into()),
                    Column::number("χ²/dof", "", "", 4).of(|r| r.chi2_per_dof.into()),
                    Column::text("false alarms", "").of(|r| r.false_alarms.into()),
                    Column::text("expected", "")
                        .of(|r| format!("{} to {}", r.expected[0], r.expected[1]).into()),
                    Column::text("as stated", "").of(|r| r.as_stated().into()),
                    Column::number("smallest scale error detected, median", "", "", 2)
                        .of(|r| r.smallest_scale.into()),
                ],
            )
        }
    }

    fn wrong(&self) -> Table {
        let all = self.rows.iter();
        Table {
            caption: "Wrong models, rejected".to_owned(),
            ..Table::of(
                all.flat_map(|r| r.detections.iter().map(move |d| (r, d))),
                [
                    Column::text("estimator", "").of(|(r, _)| Cell::name(&r.estimator)),
                    Column::text("what is wrong", "").of(|(_, d)| (&d.error).into()),
                    Column::text("samples", "").of(|(r, _)| r.samples.into()),
                    Column::number("Φcam off by", "", "", 2).of(|(_, d)| d.size.into()),
                    Column::text("rejected", "").of(|(_, d)| d.rejected.into()),
                    Column::text("of", "").of(|(r, _)| r.seeds.into()),
                ],
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_study_outside_of_what_chance_allows_is_bad() {
        let row = |false_alarms, smallest_scale| PowerRow {
            estimator: "shared".to_owned(),
            samples: 64,
            seeds: 40,
            chi2_per_dof: 1.0,
            false_alarms,
            expected: [0, 3],
            detections: Vec::new(),
            smallest_scale,
        };
        let study = |rows| Power {
            scene: "bench".to_owned(),
            scene_hash: String::new(),
            sampler: "sobol".to_owned(),
            significance: 0.01,
            unmodelled: Vec::new(),
            rows,
        };
        let fine = study(vec![row(0, 0.02), row(2, 0.005)]).describe();
        assert_eq!(fine.tone, Tone::Good);
        assert!(
            fine.sentence.contains("is 0.0050 (median over 40"),
            "{}",
            fine.sentence
        );
        // 2 of 80.
        assert!(fine.sentence.contains("2 times in 80, a rate of 0.025"));
        let bad = study(vec![row(0, 0.02), row(9, 0.005)]).describe();
        assert_eq!(bad.tone, Tone::Bad);
        assert!(bad.sentence.contains("1 of 2 settings"), "{}", bad.sentence);
    }
}
