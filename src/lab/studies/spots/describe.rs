//! What is said of ranks over spots.

use super::{RankOfSpots, SpotRanks};
use crate::lab::finding::{
    Axis, Cell, Column, Curve, Describe, Figure, Finding, Mark, Plot, Table, listed,
};
use crate::num::digits::figure;

impl SpotRanks {
    /// The rank with the most spots at each tolerance, and from how many spots on it is that.
    fn sentence(&self) -> String {
        let Some(last) = self.steps.last() else {
            return "No number of spots was studied.".to_owned();
        };
        let reached = |(k, tolerance): (usize, &f64)| {
            let same = |s: &&RankOfSpots| s.ranks[k] == last.ranks[k];
            let first = self.steps.iter().find(same).map_or(0, |s| s.spots);
            format!(
                "{} at a tolerance of {} (from {first} spots on)",
                last.ranks[k],
                figure(*tolerance, 1)
            )
        };
        let ranks: Vec<String> = self.tolerances.iter().enumerate().map(reached).collect();
        format!(
            "With {} spots the rank of Φcam on {} is {}; it cannot exceed {}.",
            last.spots,
            self.scene,
            listed(&ranks),
            last.bound
        )
    }

    fn table(&self) -> Table {
        let rank = |tolerance: &f64| {
            let name = format!("rank at {}", figure(*tolerance, 1));
            Column::text(&name, &format!("rank_{tolerance:e}"))
        };
        let mut columns = vec![
            Column::text("spots", "spots"),
            Column::text("min(p, r₊, l)", "bound"),
        ];
        columns.extend(self.tolerances.iter().map(rank));
        columns.push(Column::number("last σ over σ₁(L)", "last_sigma", "", 2));
        let row = |s: &RankOfSpots| {
            let mut row: Vec<Cell> = vec![s.spots.into(), s.bound.into()];
            row.extend(s.ranks.iter().map(|rank| Cell::from(*rank)));
            row.push(s.last.into());
            row
        };
        Table {
            caption: format!(
                "Rank of Φcam: p = {} pixels, r = {} elements, r₊ = {} {}",
                self.pixels,
                self.elements,
                self.reflecting,
                if self.obstructed {
                    "terms of those that reflect"
                } else {
                    "of which reflect"
                }
            ),
            file: Some("spots.csv".to_owned()),
            columns,
            rows: self.steps.iter().map(row).collect(),
            ..Table::default()
        }
    }

    fn figure(&self, title: &str) -> Figure {
        let curve = |name: String, rank: &dyn Fn(&RankOfSpots) -> usize| {
            let points = self.steps.iter().map(|s| [s.spots as f64, rank(s) as f64]);
            Curve::new(name, Mark::Line, points.collect())
        };
        let mut curves = vec![curve("min(p, r₊, l)".to_owned(), &|s| s.bound)];
        curves.extend(self.tolerances.iter().enumerate().map(|(k, tolerance)| {
            curve(format!("tolerance {}", figure(*tolerance, 1)), &|s| {
                s.ranks[k]
            })
        }));
        let upwards = Axis::linear("rank of Φcam", [0.0, 1.0]);
        let plot = Plot::new("", [Axis::decades("spots"), upwards], curves);
        Figure::new("spots.svg", title, vec![plot])
    }
}

impl Describe for SpotRanks {
    fn describe(&self) -> Finding {
        let title = format!("Rank of Φcam and number of spots: {}", self.scene);
        Finding {
            sentence: self.sentence(),
            notes: vec![
                format!(
                    "The tolerance is the size of the noise: the norm of the error of Φcam over \
                     the largest singular value with all {} spots. Directions below it are lost.",
                    self.all_spots
                ),
                if self.obstructed {
                    "Φcam is that of the matrix model past what stands in the way: light of three \
                     bounces, integrated over elements, footprints and spots. Light of more \
                     bounces may add directions."
                } else {
                    "Φcam is that of the matrix model: light of three bounces, with pixels, \
                     elements and spots taken at their centres. Structure finer than the \
                     elements, light of more bounces and the extent of the spots may add \
                     directions."
                }
                .to_owned(),
                "The spots are spread over those of the scene: each is as far from those before \
                 it as any. Other choices of as many spots may have another rank, within the same \
                 bound (`phicam study layout` looks for the best)."
                    .to_owned(),
            ],
            tables: vec![self.table()],
            figures: vec![self.figure(&title)],
            title,
            ..Finding::default()
        }
    }
}
