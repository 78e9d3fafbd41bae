//! What the error budget says.

use super::results::{ErrorBudget, Term};
use crate::lab::ensemble::Estimate;
use crate::lab::finding::{
    Axis, Column, Curve, Describe, Figure, Finding, Mark, Plot, Spacing, Table, Tone,
};
use crate::num::digits::figure;

impl Describe for ErrorBudget {
    fn describe(&self) -> Finding {
        let closes = self.closure.closes;
        Finding {
            title: format!("Error budget: {}", self.scene),
            tone: if closes { Tone::Good } else { Tone::Bad },
            sentence: self.sentence(),
            tables: vec![self.table()],
            figures: vec![self.figure()],
            ..Finding::default()
        }
    }
}

impl ErrorBudget {
    /// Whether the parts add up, which is the largest of them, and what is left.
    fn sentence(&self) -> String {
        let c = &self.closure;
        let both = |e: Estimate| format!("{} ± {}", figure(e.value, 3), figure(e.stderr, 2));
        let in_sum = self.terms.iter().filter(|t| t.in_sum);
        let largest = in_sum.max_by(|a, b| a.size.value.total_cmp(&b.size.value));
        let largest = largest.map_or(String::new(), |t| {
            let sign = if t.size.value > c.sum.value {
                " (parts of other sign take from it)"
            } else {
                ""
            };
            format!(
                "; the largest of them is {}, {}{sign}",
                t.name,
                figure(t.size.value, 2)
            )
        });
        let times = if c.expected > 0.0 {
            c.rest / c.expected
        } else {
            0.0
        };
        format!(
            "Relative to the flux, frames and matrix model of {} differ by {}, and the parts {} \
             to {}{largest}. The remainder, {}, is {} of the {} expected from noise (z = {}, \
             within ±3 if the budget closes).",
            self.scene,
            both(c.total),
            if c.closes {
                "add up"
            } else {
                "DO NOT ADD UP: they come"
            },
            both(c.sum),
            figure(c.rest, 2),
            figure(times, 3),
            figure(c.expected, 2),
            figure(c.z, 2)
        )
    }

    fn table(&self) -> Table {
        Table {
            caption: "What the matrix model leaves out, relative to the light of three bounces with nothing in the way (norm over all entries of Φcam)".to_owned(),
            file: Some("budget.csv".to_owned()),
            note: format!(
                "Terms outside the sum would be added by a model that takes the étendue as \
                 constant. The object's signal, the part of Φcam that its pattern causes, is {} \
                 of the flux.",
                figure(self.signal, 3)
            ),
            ..Table::of(
                &self.terms,
                [
                    Column::text("cause", "cause").of(|t| (&t.name).into()),
                    Column::estimate("size", "size", "", 3).of(|t| t.size.into()),
                    Column::estimate("after the best single scale", "after_scale", "", 3)
                        .of(|t| t.after_scale.into()),
                    Column::number("of the object's signal", "of_signal", "", 3)
                        .of(|t| t.of_signal.into()),
                    Column::text("in the sum", "in_sum").of(|t| t.in_sum.into()),
                ],
            )
        }
    }

    /// One bar a cause, with the part that survives the best single scale below it.
    fn figure(&self) -> Figure {
        let shown = || self.terms.iter().filter(|t| t.size.value > 0.0);
        let name = |t: &Term| {
            if t.in_sum {
                t.name.clone()
            } else {
                format!("({})", t.name)
            }
        };
        let bars = |name: &str, f: fn(&Term) -> Estimate| Curve {
            name: name.to_owned(),
            mark: Mark::Bars,
            points: shown()
                .enumerate()
                .map(|(i, t)| [f(t).value, i as f64])
                .collect(),
            stderr: shown().map(|t| f(t).stderr).collect(),
        };
        let mut curves = vec![
            bars("relative to the flux", |t| t.size),
            bars("after the best single scale", |t| t.after_scale),
        ];
        if self.signal > 0.0 {
            let points = vec![[self.signal, 0.0], [self.signal, shown().count() as f64]];
            curves.push(Curve::new("the object's signal", Mark::Level, points));
        }
        let across = Axis::decades("‖term‖ / ‖Φcam‖ over all pixels and spots");
        let upwards = Axis {
            title: String::new(),
            spacing: Spacing::Categories(shown().map(name).collect()),
        };
        let title = format!("What the matrix model leaves out: {}", self.scene);
        let plot = Plot::new("", [across, upwards], curves);
        Figure::new("budget.svg", title, vec![plot])
    }
}

#[cfg(test)]
mod tests {
    use super::super::results::Closure;
    use super::*;

    fn estimate(value: f64, stderr: f64) -> Estimate {
        Estimate { value, stderr }
    }

    fn budget(closes: bool) -> ErrorBudget {
        let term = |name: &str, size, in_sum| Term {
            name: name.to_owned(),
            size: estimate(size, 1e-5),
            after_scale: estimate(0.5 * size, 1e-5),
            of_signal: 2.0 * size,
            in_sum,
        };
        ErrorBudget {
            scene: "bench".to_owned(),
            scene_hash: String::new(),
            seed: 1,
            ensemble_samples: 1,
            run_samples: 1,
            signal: 0.065,
            terms: vec![
                term("element area", 1.7e-3, true),
                term("5 bounces", 0.012, true),
                term("étendue", 0.5, false),
            ],
            closure: Closure {
                total: estimate(0.0121, 1e-4),
                sum: estimate(0.012, 1e-4),
                rest: 3e-4,
                expected: 2.9e-4,
                z: if closes { 0.4 } else { 7.0 },
                closes,
            },
        }
    }

    /// A budget that does not close is not told as one that does; the largest cause is one of those
    /// in the sum.
    #[test]
    fn a_budget_is_told_as_it_is() {
        let good = budget(true).describe();
        assert_eq!(good.tone, Tone::Good);
        for words in [
            "the parts add up to 0.0120 ± 1.0 × 10⁻⁴",
            "largest of them is 5 bounces, 0.012",
        ] {
            assert!(good.sentence.contains(words), "{}", good.sentence);
        }
        assert!(!good.sentence.contains("other sign"));
        let mut less = budget(true);
        less.closure.sum = estimate(0.0098, 1e-4);
        assert!(
            less.describe()
                .sentence
                .contains("0.012 (parts of other sign")
        );
        let bad = budget(false).describe();
        assert_eq!(bad.tone, Tone::Bad);
        assert!(bad.sentence.contains("DO NOT ADD UP") && bad.sentence.contains("z = 7.0"));
    }

    /// What is not in the sum is drawn in brackets, and the signal is a line across all bars.
    #[test]
    fn every_cause_has_its_bars() {
        let figure = budget(true).describe().figures.remove(0);
        let [_, causes] = &figure.plots[0].axes;
        let Spacing::Categories(names) = &causes.spacing else {
            panic!("{causes:?}")
        };
        assert_eq!(names, &["element area", "5 bounces", "(étendue)"]);
        let curves = &figure.plots[0].curves;
        assert_eq!(curves[1].points[1], [0.006, 1.0]);
        assert_eq!(curves[2].points[0][0], curves[2].points[1][0]);
    }
}
