//! The Picard data as a table and a figure.

use crate::lab::finding::{
    Axis, Cell, Column, Curve, Describe, Figure, Finding, Mark, Place, Plot, Table,
};
use crate::recovery::{Directions, Picard};

impl Describe for Picard {
    /// Coefficients, noise level (W but for weighted directions; none where the noise is not known)
    /// and singular values over the direction. In the figure the singular values are scaled to
    /// begin at the first coefficient: where the coefficients stay above them after that, an
    /// inverse amplifies what is there.
    fn describe(&self) -> Finding {
        let (name, unit, across, up) = match self.directions {
            Directions::LaserSide => (
                "picard",
                "_W",
                "singular direction i of the laser side",
                "root mean square over the pixels, W",
            ),
            Directions::Joint => (
                "picard-joint",
                "_W",
                "singular direction i of all pixels and spots",
                "W",
            ),
            Directions::JointWeighted => (
                "picard-joint",
                "",
                "singular direction i of all pixels and spots, weighted",
                "standard deviations of the noise, about",
            ),
        };
        let (sigma, coefficient) = (self.sigma.as_slice(), self.coefficient.as_slice());
        let noise = self.noise.as_ref().map(|n| n.as_slice());
        let row = |i: usize| -> Vec<Cell> {
            let noise = noise.map(|n| n[i]);
            vec![
                (i + 1).into(),
                sigma[i].into(),
                coefficient[i].into(),
                noise.into(),
            ]
        };
        let column = |key: &str| Column::number("", key, "", 3);
        let keys = [&format!("coefficient{unit}"), &format!("noise{unit}")];
        let table = Table {
            file: Some(format!("{name}.csv")),
            place: Place::File,
            columns: [column("direction"), column("sigma")]
                .into_iter()
                .chain(keys.map(|key| column(key)))
                .collect(),
            rows: (0..sigma.len()).map(row).collect(),
            ..Table::default()
        };
        let scale = match coefficient[0] / sigma[0] {
            scale if scale > 0.0 => scale,
            _ => 1.0,
        };
        let curve = |name: &str, values: &[f64], scale: f64| {
            let points = values.iter().enumerate();
            let points = points.map(|(i, x)| [(i + 1) as f64, x * scale]).collect();
            Curve::new(name, Mark::Line, points)
        };
        let mut curves = vec![
            curve("data in direction i", coefficient, 1.0),
            curve("singular value σᵢ, scaled", sigma, scale),
        ];
        curves.extend(noise.map(|n| curve("noise in direction i", n, 1.0)));
        let title = "Which singular directions rise above the noise".to_owned();
        let across = Axis::linear(across, [1.0, sigma.len() as f64]);
        let plot = Plot::new("", [across, Axis::decades(up)], curves);
        let figure = Figure::new(format!("{name}.svg"), &title, vec![plot]);
        Finding {
            title,
            tables: vec![table],
            figures: vec![figure],
            ..Finding::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;

    fn sample(noise: Option<DVector<f64>>) -> Picard {
        Picard {
            directions: Directions::LaserSide,
            sigma: DVector::from_row_slice(&[2.0, 1e-3, 1e-9]),
            coefficient: DVector::from_row_slice(&[4e-12, 3e-15, 0.0]),
            noise,
        }
    }

    /// Data without any light along the first direction are no reason for a figure without singular
    /// values.
    #[test]
    fn a_first_coefficient_of_zero() {
        let picard = Picard {
            directions: Directions::JointWeighted,
            coefficient: DVector::zeros(3),
            ..sample(None)
        };
        let found = picard.describe();
        let plot = &found.figures[0].plots[0];
        assert_eq!(plot.curves[1].points[0], [1.0, 2.0]);
        assert!(plot.axes[1].title.contains("standard deviations"));
        let keys = found.tables[0].columns.iter().map(|c| c.key.as_str());
        let keys: Vec<&str> = keys.collect();
        assert_eq!(keys, ["direction", "sigma", "coefficient", "noise"]);
        assert_eq!(found.figures[0].file, "picard-joint.svg");
    }

    #[test]
    fn every_direction_has_its_line() {
        let found = sample(Some(DVector::from_element(3, 1e-15))).describe();
        assert_eq!(found.tables[0].file.as_deref(), Some("picard.csv"));
        assert_eq!(found.tables[0].columns[2].key, "coefficient_W");
        let row: Vec<Cell> = vec![2_usize.into(), 1e-3.into(), 3e-15.into(), 1e-15.into()];
        assert_eq!(found.tables[0].rows[1], row);
        assert_eq!(found.figures[0].plots[0].curves.len(), 3);
        let without = sample(None).describe();
        assert!(
            without.tables[0]
                .rows
                .iter()
                .all(|r| r[3] == Cell::Number(None))
        );
        assert_eq!(without.figures[0].plots[0].curves.len(), 2);
    }
}
