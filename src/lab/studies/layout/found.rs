//! The layouts, in tables and a drawing.

use serde::{Deserialize, Serialize};

use crate::lab::finding::{
    Axis, Cell, Column, Curve, Describe, Figure, Finding, Mark, Plot, Table,
};
use crate::num::digits::figure;

/// What a layout leaves, and what is resolved with it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Row {
    pub name: String,
    /// Spots that light anything.
    pub spots: usize,
    /// Share of the prior variance of the picture that is left.
    pub risk: f64,
    /// Directions whose signal is above the noise.
    pub directions: usize,
    /// Of each board the most noise at which it is resolved.
    pub limits: Vec<Option<f64>>,
}

/// The search for the best layout.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Optimum {
    /// (x, y) of each.
    pub candidates: Vec<[f64; 2]>,
    /// Their best weights, 0 to 1.
    pub weights: Vec<f64>,
    /// Risk with these weights.
    pub relaxed: f64,
    /// What no layout of the candidates can be below.
    pub bound: f64,
    /// Steps to the weights.
    pub steps: usize,
    pub exchanges: usize,
    /// Risk before the spots leave the grid.
    pub on_grid: f64,
    /// Part of the risk of the layout that exposures of their own can take off it.
    pub exposures: f64,
    /// (x, y) of the spots.
    pub layout: Vec<[f64; 2]>,
}

/// Layouts of spots compared.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Layouts {
    pub scene: String,
    pub scene_hash: String,
    pub unit: &'static str,
    pub pixels: [usize; 2],
    pub elements: usize,
    pub noise: &'static str,
    pub level: f64,
    pub prior: String,
    /// Parameters of the geometry that are known only roughly.
    pub unsure: usize,
    pub boards: Vec<usize>,
    pub draws: u64,
    /// Corners of flat walls.
    pub walls: Vec<Vec<[f64; 2]>>,
    /// Corners of the camera's view.
    pub view: Vec<[f64; 2]>,
    /// The scene with the best layout.
    #[serde(skip)]
    pub text: String,
    pub rows: Vec<Row>,
    pub optimum: Optimum,
}

impl Layouts {
    /// How much above the bound a risk is, as a share of the bound; of layouts with more spots or
    /// another view it is no gap.
    fn gap(&self, row: &Row) -> Option<f64> {
        let alike = row.spots == self.optimum.layout.len() && !row.name.contains("view");
        alike.then(|| row.risk / self.optimum.bound - 1.0)
    }

    fn table(&self) -> Table {
        let mut columns = vec![
            Column::text("layout", "layout"),
            Column::text("spots", "spots"),
            Column::number("risk", "risk", "", 3),
            Column::number("above the bound", "gap", "%", 2),
            Column::text("directions above the noise", "directions"),
        ];
        columns.extend(
            self.boards
                .iter()
                .map(|n| Column::number(&format!("{n} × {n}"), &format!("noise_{n}"), "", 2)),
        );
        let row = |row: &Row| {
            let mut cells: Vec<Cell> = vec![
                row.name.as_str().into(),
                row.spots.into(),
                row.risk.into(),
                self.gap(row).map(|gap| 100.0 * gap).into(),
                row.directions.into(),
            ];
            cells.extend(row.limits.iter().map(|limit| Cell::from(*limit)));
            cells
        };
        Table {
            caption: format!(
                "Share of the prior variance that is left at a {} noise of {}, how far that is above what any layout on the grid must leave, directions above the noise, and the most noise at which a board has an MTF of 0.9",
                self.noise,
                figure(self.level, 1)
            ),
            file: Some("layout.csv".to_owned()),
            columns,
            rows: self.rows.iter().map(row).collect(),
            ..Table::default()
        }
    }

    /// Places of the spots, and of the candidates with their weights.
    fn places(&self) -> [Table; 2] {
        let place = |[x, y]: &[f64; 2]| vec![Cell::from(*x), Cell::from(*y)];
        let weighed = self.optimum.candidates.iter().zip(&self.optimum.weights);
        let weighed = weighed.map(|(p, w)| [place(p), vec![Cell::from(*w)]].concat());
        let chosen = self.optimum.layout.iter().map(place);
        [
            Table::of_file("places.csv", ["x", "y"], chosen),
            Table::of_file("candidates.csv", ["x", "y", "weight"], weighed),
        ]
    }

    fn drawing(&self) -> Plot {
        let closed = |corners: &[[f64; 2]]| {
            let mut line = corners.to_vec();
            line.extend(corners.first());
            line
        };
        let mut curves: Vec<Curve> = self
            .walls
            .iter()
            .map(|wall| Curve::new("wall", Mark::Line, closed(wall)))
            .collect();
        curves.push(Curve::new("view", Mark::Line, closed(&self.view)));
        let points =
            |name: &str, places: &[[f64; 2]]| Curve::new(name, Mark::Points, places.to_vec());
        curves.push(points("candidate", &self.optimum.candidates));
        curves.push(points("spot", &self.optimum.layout));
        let ends = |k: usize| {
            let all = self.walls.iter().flatten().chain(&self.optimum.candidates);
            let fold = |[a, b]: [f64; 2], p: &[f64; 2]| [a.min(p[k]), b.max(p[k])];
            all.fold([f64::INFINITY, f64::NEG_INFINITY], fold)
        };
        let axis = |name: &str, k: usize| Axis::linear(format!("{name}, {}", self.unit), ends(k));
        Plot::new("", [axis("x", 0), axis("y", 1)], curves)
    }

    fn sentence(&self) -> String {
        let risk = |row: &Row| figure(row.risk, 3);
        let own = self.rows.iter().find(|row| row.name.contains("own"));
        let best = self.rows.iter().find(|row| row.name == "optimised");
        let own = own.map(|row| {
            format!(
                "{} spots of its own leave {} of the variance",
                row.spots,
                risk(row)
            )
        });
        let best = best.map(|row| {
            let [spots, candidates] = [row.spots, self.optimum.candidates.len()];
            let [risk, bound] = [risk(row), figure(self.optimum.bound, 3)];
            // Between the candidates the bound does not hold.
            if row.risk < self.optimum.bound {
                return format!(
                    "{spots} spots between {candidates} candidates leave {risk}, less than the {bound} that bounds all layouts of these: how good any layout can be is told by more --candidates"
                );
            }
            format!(
                "{spots} spots, placed by exchanges of one at a time, leave {risk}, and no layout of {candidates} candidates leaves less than {bound}"
            )
        });
        let said: Vec<String> = own.into_iter().chain(best).collect();
        format!("On {} {}.", self.scene, said.join("; "))
    }
}

impl Describe for Layouts {
    fn describe(&self) -> Finding {
        let title = format!("Where the laser spots should be: {}", self.scene);
        let o = &self.optimum;
        let mut notes = vec![
            format!(
                "The prior is {}, about ½. The bound is that of the best weights of the candidates ({} steps; risk {}), by duality; on the grid the layout leaves {} after {} exchanges of single spots, none of which is left that gains; where its spots then move off the grid (--refine), the bound does not hold.",
                self.prior,
                o.steps,
                figure(o.relaxed, 4),
                figure(o.on_grid, 4),
                o.exchanges
            ),
            format!(
                "Photographs have {} × {} pixels, which are taken by their centres, as elements and spots are. Limits are of {} draws of modelled photographs, recovered by joint with the weight of each entry; their noise is relative to their own light.",
                self.pixels[0], self.pixels[1], self.draws
            ),
            format!(
                "Every spot has the same exposure, and one photograph has one spot. Exposures of their own, of the same sum, would take {} % off the risk; several spots at once gain only where each has the whole power of the laser.",
                figure(100.0 * o.exposures, 2)
            ),
            "`layout.toml` is the scene with these spots.".to_owned(),
        ];
        if self.unsure > 0 {
            notes.push(format!(
                "{} parameters of the geometry are unknowns too, to first order; the risk is that of the picture alone, and limits are of known geometry.",
                self.unsure
            ));
        }
        let [places, candidates] = self.places();
        Finding {
            sentence: self.sentence(),
            notes,
            tables: vec![self.table(), places, candidates],
            figures: vec![Figure::new(
                "layout.svg",
                title.clone(),
                vec![self.drawing()],
            )],
            files: vec![("layout.toml".to_owned(), self.text.clone())],
            title,
            ..Finding::default()
        }
    }
}
