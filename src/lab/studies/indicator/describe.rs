//! The study in words, tables and a figure.

use super::configuration::Configuration;
use super::noisy::{NoisyOutcome, NoisyPoint};
use super::study::Indicator;
use super::summary::{Coefficients, NoisySummary};
use crate::lab::finding::{
    Axis, Cell, Column, Curve, Describe, Figure, Finding, Mark, Plot, Table,
};
use crate::num::digits::{figure, perhaps};

impl Describe for Indicator {
    fn describe(&self) -> Finding {
        let noisy = self.noisy.iter().filter(|n| n.compared > 1);
        let noisy = noisy.map(|n| {
            let caption = format!("Correlation with the mean MTF under noise, {}", n.method);
            coefficients(&caption, &n.coefficients)
        });
        let caption = "Correlation with the raw MTF without noise";
        let mut tables = vec![coefficients(caption, &self.coefficients), self.summary()];
        tables.extend(noisy);
        tables.extend([self.configured(), self.points()]);
        Finding {
            title: format!("What predicts the modulation of pinv: {}", self.scene),
            sentence: self.sentence(),
            tables,
            figures: vec![self.figure()],
            ..Finding::default()
        }
    }
}

impl Indicator {
    /// What predicts the modulation best, and how well the closed form does.
    fn sentence(&self) -> String {
        let size = |c: &&Coefficients| c.pearson.map_or(-1.0, f64::abs);
        let best = self.coefficients.iter();
        let best = best.max_by(|a, b| size(a).total_cmp(&size(b)));
        let best = best.map_or(String::new(), |c| {
            format!(
                "Over {} configurations of {}, the raw MTF of pinv without noise is predicted best by {} (Pearson {}, \
                 Spearman {}). ",
                self.configurations.len(),
                self.scene,
                c.indicator,
                perhaps(c.pearson, 4),
                perhaps(c.spearman, 4)
            )
        });
        let sum = |of: fn(&NoisySummary) -> usize| self.noisy.iter().map(of).sum();
        let noisy = match sum(|n| n.compared) {
            0 => "No point under noise has a prediction.".to_owned(),
            n => format!(
                "Under noise {} of {n} predicted means lie within three standard errors of what {} draws give.",
                sum(|n| n.within_three),
                self.seeds
            ),
        };
        format!(
            "{best}The projected object and the recovery differ by {} at most. {noisy}",
            figure(self.identity, 2)
        )
    }

    /// Predicted against measured, a row a method.
    fn summary(&self) -> Table {
        let count = |name: &str| Column::text(name, "");
        let row = |n: &NoisySummary| {
            let of = |x: f64| Cell::from((n.compared > 0).then_some(x));
            vec![
                Cell::name(&n.method),
                n.compared.into(),
                n.within_three.into(),
                of(n.largest_z),
                of(n.largest_p),
                n.undefined.into(),
                n.without_covariance.into(),
                n.failed.into(),
            ]
        };
        let columns = vec![
            count("method"),
            count("compared"),
            count("within 3 s.e."),
            Column::number("largest z", "", "", 3),
            Column::number("its p", "", "", 2),
            count("without a mean"),
            count("without covariance"),
            count("failed"),
        ];
        let caption = "Under noise: predicted against measured";
        Table::new(caption, columns, self.noisy.iter().map(row))
            .noted("Without a mean: the spread of white + black is above a tenth of its mean.")
    }

    /// Every configuration without noise.
    fn configured(&self) -> Table {
        let row = |c: &Configuration| {
            vec![
                Cell::from(&*c.layout),
                c.spots.into(),
                Cell::Name(c.half_width.to_string()),
                c.elements.into(),
                c.board.into(),
                Cell::name(&c.kernel),
                c.rank.into(),
                c.kept.into(),
                c.projected.into(),
                c.mtf.into(),
                c.condition.into(),
                c.smallest_eigenvalue.into(),
                c.smallest_square.into(),
            ]
        };
        let keys = "layout,spots,half_width,elements,board,kernel,rank,kept,projected,mtf,condition,smallest_eigenvalue,\
                    smallest_square";
        let rows = self.configurations.iter().map(row);
        Table::of_file("indicator.csv", keys.split(','), rows)
    }

    /// Every point under noise.
    fn points(&self) -> Table {
        let row = |p: &NoisyPoint| {
            let nothing = Cell::Number(None);
            let (name, rest) = match &p.outcome {
                NoisyOutcome::Compared(c) => {
                    let predicted = [c.kept, c.mean, c.deviation, c.spread, c.measured.mean];
                    let measured = [c.measured.deviation.into(), c.measured.draws.into()];
                    let cells = predicted.map(Cell::from).into_iter();
                    let cells = cells.chain(measured).chain([c.z.into()]);
                    ("compared", cells.collect())
                }
                NoisyOutcome::Undefined { spread } => {
                    let mut cells = vec![nothing; 8];
                    cells[3] = (*spread).into();
                    ("undefined", cells)
                }
                NoisyOutcome::NoCovariance => ("no covariance", vec![nothing; 8]),
                NoisyOutcome::Failed { .. } => ("failed", vec![nothing; 8]),
            };
            let method = Cell::name(&p.method);
            let own = [p.configuration.into(), method, p.noise.into()];
            let own = own.into_iter().chain([Cell::name(name)]);
            own.chain(rest).collect()
        };
        let keys = "configuration,method,noise,outcome,kept,predicted,predicted_deviation,spread,measured,\
                    measured_deviation,draws,z";
        let rows = self.points.iter().map(row);
        Table::of_file("indicator-noise.csv", keys.split(','), rows)
    }

    /// Measured raw MTF against the indicator, the condition number and the smallest eigenvalue,
    /// and under noise against the closed form.
    fn figure(&self) -> Figure {
        let modulation = |title: &str| Axis::clipped(title, [-0.2, 1.2]);
        let against = |x: Axis, of: fn(&Configuration) -> f64| {
            let points = self.configurations.iter().map(|c| [of(c), c.mtf]);
            let curve = Curve::new("", Mark::Points, points.collect());
            Plot::new("", [x, modulation("raw MTF without noise")], vec![curve])
        };
        let predicted = |n: &NoisySummary| {
            let own = self.points.iter().filter(|p| p.method == n.method);
            let points = own.filter_map(|p| match &p.outcome {
                NoisyOutcome::Compared(c) => Some([c.mean, c.measured.mean]),
                _ => None,
            });
            Curve::new(n.method.clone(), Mark::Points, points.collect())
        };
        let axes = ["predicted mean MTF under noise", "measured mean MTF"].map(modulation);
        let eigenvalue = Axis::decades("|smallest eigenvalue of G12·G12ᵀ| / largest");
        let plots = vec![
            against(modulation("‖P c‖² / ‖c‖²"), |c| c.kept),
            against(Axis::decades("condition number σ1/σk"), |c| c.condition),
            against(eigenvalue, |c| c.smallest_eigenvalue.abs()),
            Plot::new("", axes, self.noisy.iter().map(predicted).collect()),
        ];
        let title = format!("What predicts the raw MTF of pinv: {}", self.scene);
        Figure::new("indicator.svg", title, plots)
    }
}

fn coefficients(caption: &str, all: &[Coefficients]) -> Table {
    Table {
        caption: caption.to_owned(),
        ..Table::of(
            all,
            [
                Column::text("figure", "").of(|c| (&*c.indicator).into()),
                Column::number("Pearson", "", "", 6).of(|c| c.pearson.into()),
                Column::number("Spearman", "", "", 6).of(|c| c.spearman.into()),
                Column::text("configurations", "").of(|c| c.configurations.into()),
            ],
        )
    }
}
