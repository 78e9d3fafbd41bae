//! What is said, tabulated and drawn of a sweep.

use super::{Sweep, SweepStep};
use crate::lab::finding::{
    Axis, Cell, Column, Curve, Describe, Figure, Finding, Mark, Plot, Spacing, Table,
};
use crate::lab::studies::grey::{self, LEVELS};
use crate::num::digits::figure;

/// What roundings of the light make of a share of the prior variance, relative to it.
const ROUNDING: f64 = 1e-9;

impl Sweep {
    /// Where most is known of the picture, and where least.
    fn sentence(&self) -> String {
        let by_risk = |a: &&SweepStep, b: &&SweepStep| a.risk.total_cmp(&b.risk);
        let ends = [
            self.steps.iter().min_by(by_risk),
            self.steps.iter().max_by(by_risk),
        ];
        let [Some(best), Some(worst)] = ends else {
            return "No value was studied.".to_owned();
        };
        let left = |step: &SweepStep| figure(100.0 * step.risk, 2);
        // What is left is the rest of a sum over elements.
        let rest = f64::EPSILON * best.elements.max(worst.elements) as f64;
        if worst.risk - best.risk <= ROUNDING * worst.risk + rest {
            return format!(
                "At a {} noise of {} it makes no difference for the prior variance which of these values {} has: the photographs leave {} %.",
                self.law,
                figure(self.noise, 1),
                self.key,
                left(best)
            );
        }
        if left(best) == left(worst) {
            return format!(
                "At a {} noise of {} these values of {} make hardly any difference: the photographs leave {} % of the prior \
                 variance, by {} % of that less with {} than with {}.",
                self.law,
                figure(self.noise, 1),
                self.key,
                left(best),
                figure(100.0 * (1.0 - best.risk / worst.risk), 1),
                best.value,
                worst.value
            );
        }
        format!(
            "At a {} noise of {} the photographs leave least of the prior variance, {} %, with {} = \
             {}, and most, {} %, with {}.",
            self.law,
            figure(self.noise, 1),
            left(best),
            self.key,
            best.value,
            left(worst),
            worst.value
        )
    }

    fn table(&self) -> Table {
        let mut columns = vec![
            Column::text(&self.key, "value"),
            Column::text("pixels", "pixels"),
            Column::text("spots", "spots"),
            Column::text("elements", "elements"),
            Column::number("brightest", "brightest", "W", 3),
            Column::number("mean", "mean", "W", 3),
        ];
        columns.extend(grey::columns());
        let row = |s: &SweepStep| {
            let mut row: Vec<Cell> = vec![
                Cell::Text(s.value.clone()),
                s.pixels.into(),
                s.spots.into(),
                s.elements.into(),
                s.brightest.into(),
                s.mean.into(),
            ];
            row.extend(s.directions.iter().map(|n| Cell::from(*n)));
            row.push(s.risk.into());
            row
        };
        Table {
            caption: format!(
                "Entries of Φcam, directions of the picture above a {} noise, and the share of the \
                 prior variance that is left at {}",
                self.law,
                figure(self.noise, 1)
            ),
            file: Some("sweep.csv".to_owned()),
            columns,
            rows: self.steps.iter().map(row).collect(),
            ..Table::default()
        }
    }

    /// Directions and risk over the values: at their places where all are numbers, else one beside
    /// the other.
    fn figure(&self, title: &str) -> Figure {
        let numbers: Option<Vec<f64>> = self.steps.iter().map(|s| s.value.parse().ok()).collect();
        let across = match &numbers {
            Some(x) => Axis::linear(&self.key, [x[0]; 2]),
            None => Axis {
                title: self.key.clone(),
                spacing: Spacing::Categories(self.steps.iter().map(|s| s.value.clone()).collect()),
            },
        };
        let x = |k: usize| numbers.as_ref().map_or(k as f64, |x| x[k]);
        let curve = |name: String, y: &dyn Fn(&SweepStep) -> f64| {
            let points = self.steps.iter().enumerate();
            let points = points.map(|(k, s)| [x(k), y(s)]).collect();
            let mark = if numbers.is_some() {
                Mark::Line
            } else {
                Mark::Points
            };
            Curve::new(name, mark, points)
        };
        let directions = LEVELS.iter().enumerate().map(|(k, level)| {
            let name = format!("above {} %", figure(100.0 * level, 1));
            curve(name, &|s| s.directions[k] as f64)
        });
        let risk = curve(format!("risk at {}", figure(self.noise, 1)), &|s| s.risk);
        let upwards = Axis::linear("directions of the picture", [0.0, 1.0]);
        let left = Axis::linear("share of the prior variance left", [0.0, 1.0]);
        let plots = vec![
            Plot::new("", [across.clone(), upwards], directions.collect()),
            Plot::new("", [across, left], vec![risk]),
        ];
        Figure::new("sweep.svg", title, plots)
    }
}

impl Describe for Sweep {
    fn describe(&self) -> Finding {
        let title = format!("{} of {}", self.key, self.scene);
        Finding {
            sentence: self.sentence(),
            notes: vec![
                "Photographs are those of the matrix model: light of three bounces, with pixels, \
                 elements and spots taken at their centres where nothing stands in the way. Its \
                 noise is relative to the light: exposures are not compared, brightness is in \
                 `brightest` and `mean`."
                    .to_owned(),
                "Nothing is known of the picture beforehand but that reflectances lie about ½ with \
                 a standard deviation of ½. The geometry is taken as known exactly \
                 (`phicam study tolerance` asks what of it must be known how well)."
                    .to_owned(),
            ],
            tables: vec![self.table()],
            figures: vec![self.figure(&title)],
            title,
            ..Finding::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shares that differ by rounding are no difference, by less than the digits that are told
    /// hardly any.
    #[test]
    fn roundings_are_no_difference() {
        let step = |value: &str, risk| SweepStep {
            value: value.to_owned(),
            scene_hash: String::new(),
            pixels: 64,
            spots: 24,
            elements: 16,
            brightest: 1.0,
            mean: 1.0,
            directions: vec![16; LEVELS.len()],
            risk,
        };
        let said = |risks: [f64; 2]| {
            let found = Sweep {
                scene: "bench".to_owned(),
                scene_hash: String::new(),
                key: "laser.power".to_owned(),
                law: "relative",
                noise: 0.01,
                steps: vec![step("1 mW", risks[0]), step("5 mW", risks[1])],
            };
            found.describe().sentence
        };
        for same in [[0.440_084_492_919_8, 0.440_084_492_922_1], [0.0, 1e-15]] {
            let said = said(same);
            assert!(said.contains("makes no difference"), "{said}");
        }
        let hardly = said([0.441, 0.44]);
        assert!(
            hardly.contains("hardly any difference")
                && hardly.contains("by 0.2 % of that less with 5 mW"),
            "{hardly}"
        );
        let much = said([0.46, 0.44]);
        assert!(much.contains("laser.power = 5 mW, and most"), "{much}");
    }
}
