//! What the occluders do, in tables and a figure.

use serde::{Deserialize, Serialize};

use super::kinds::{Kind, Place};
use super::photographed::Photographed;
use crate::lab::finding::{
    Axis, Cell, Column, Curve, Describe, Figure, Finding, Mark, Plot, Table, listed,
};
use crate::lab::studies::grey::{self, LEVELS};
use crate::lab::studies::subject::{Recovery, Subject};
use crate::num::digits::figure;

/// Pixels a side, and spots, of the scene on which the place is searched.
pub(super) const SEARCHED: [usize; 2] = [12, 25];

/// An occluder at its best place.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Row {
    pub kind: Kind,
    pub spots: usize,
    pub place: Place,
    /// Places that were tried.
    pub tries: usize,
    /// Directions whose signal, τ s, is above a noise of 10 %, 1 %, 0.1 %, 0.01 %.
    pub directions: Vec<usize>,
    /// Share of the prior variance that is left at the level of the plan.
    pub risk: f64,
    /// Of each picture the most noise at which it is resolved.
    pub limits: Vec<Option<f64>>,
    /// Of each picture what traced photographs show.
    pub seen: Vec<Photographed>,
    pub misplaced: Vec<Misplaced>,
}

/// What a wrong place costs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Misplaced {
    pub by: f64,
    /// Of the first picture at the level of the plan.
    pub recovery: Recovery,
}

/// What the occluders do.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Occluders {
    pub scene: String,
    pub scene_hash: String,
    pub pixels: usize,
    pub elements: usize,
    pub noise: String,
    pub level: f64,
    pub subjects: Vec<Subject>,
    pub sensor: &'static str,
    pub draws: u64,
    pub rows: Vec<Row>,
}

impl Occluders {
    fn table(&self) -> Table {
        let mut columns = vec![
            Column::text("occluder", "occluder"),
            Column::text("spots", "spots"),
            Column::number("height", "height", "", 3),
            Column::number("aside, u", "offset_u", "", 2),
            Column::number("aside, v", "offset_v", "", 2),
            Column::number("size", "size", "", 3),
        ];
        columns.extend(grey::columns());
        columns.extend(
            self.subjects
                .iter()
                .map(|s| Column::number(&s.name(), &format!("noise_{}", s.column()), "", 2)),
        );
        let row = |row: &Row| {
            let [u, v] = row.place.offset;
            let there = |x: f64| Cell::Number((row.kind != Kind::None).then_some(x));
            let mut cells = vec![Cell::name(row.kind.name()), row.spots.into()];
            cells.extend([row.place.height, u, v, row.place.size].map(there));
            cells.extend(row.directions.iter().map(|n| Cell::from(*n)));
            cells.push(row.risk.into());
            cells.extend(row.limits.iter().map(|x| Cell::Number(*x)));
            cells
        };
        Table {
            caption: format!(
                "Directions above a noise, of {} elements, share of the prior variance that is left at {}, and the most {} noise at which a board has an MTF of 0.9, another picture a correlation of 0.9",
                self.elements,
                figure(self.level, 1),
                self.noise
            ),
            file: Some("occluder.csv".to_owned()),
            columns,
            rows: self.rows.iter().map(row).collect(),
            ..Table::default()
        }
    }

    fn misplaced(&self) -> Table {
        let each = self
            .rows
            .iter()
            .flat_map(|row| row.misplaced.iter().map(move |m| (row, m)));
        Table {
            caption: format!(
                "The model's occluder misplaced along the view: {} of {} at a noise of {}, and how probable so bad a fit is",
                self.subjects[0].measure(),
                self.subjects[0].name(),
                figure(self.level, 1)
            ),
            file: Some("misplaced.csv".to_owned()),
            ..Table::of(
                each,
                [
                    Column::text("occluder", "occluder").of(|(row, _)| Cell::name(row.kind.name())),
                    Column::text("spots", "spots").of(|(row, _)| row.spots.into()),
                    Column::number("by", "by", "", 2).of(|(_, m)| m.by.into()),
                    Column::number(self.subjects[0].measure(), "likeness", "", 3)
                        .of(|(_, m)| m.recovery.likeness.into()),
                    Column::number("P of the fit", "p", "", 2).of(|(_, m)| m.recovery.p.into()),
                ],
            )
        }
    }

    fn seen(&self) -> Table {
        let each = self
            .rows
            .iter()
            .flat_map(|row| row.seen.iter().map(move |seen| (row, seen)));
        Table {
            caption: format!(
                "Traced photographs through the sensor {}: the fewest frames a spot, of 1, 2, 4, …, that resolve the picture (else the most tried), and what joint makes of them",
                self.sensor
            ),
            file: Some("traced.csv".to_owned()),
            ..Table::of(
                each,
                [
                    Column::text("occluder", "occluder").of(|(row, _)| Cell::name(row.kind.name())),
                    Column::text("spots", "spots").of(|(row, _)| row.spots.into()),
                    Column::text("picture", "picture").of(|(_, s)| Cell::name(&s.subject.name())),
                    Column::number("exposure", "exposure", "s", 2).of(|(_, s)| s.exposure.into()),
                    Column::text("frames", "frames").of(|(_, s)| (s.frames as usize).into()),
                    Column::number("time in all", "time", "s", 2).of(|(row, s)| {
                        let photographs = s.frames as usize * row.spots;
                        (s.exposure * photographs as f64).into()
                    }),
                    Column::text("measure", "measure").of(|(_, s)| Cell::name(s.subject.measure())),
                    Column::number("value", "value", "", 3).of(|(_, s)| s.recovery.likeness.into()),
                    Column::number("P of the fit", "p", "", 2).of(|(_, s)| s.recovery.p.into()),
                ],
            )
        }
    }

    fn sentence(&self) -> String {
        let risk = |row: &&Row| row.risk;
        let least = self.rows.iter().min_by(|a, b| risk(a).total_cmp(&risk(b)));
        let least = least.filter(|row| row.kind != Kind::None);
        let none = self.rows.iter().find(|row| row.kind == Kind::None);
        let of = |row: &Row| {
            format!(
                "{} with {} spots leaves {} of the variance at a noise of {}",
                row.kind.name(),
                row.spots,
                figure(row.risk, 2),
                figure(self.level, 1)
            )
        };
        let said: Vec<String> = [none, least].into_iter().flatten().map(of).collect();
        format!("On {} {}.", self.scene, listed(&said))
    }
}

impl Describe for Occluders {
    fn describe(&self) -> Finding {
        let title = format!("Occluders between object and wall: {}", self.scene);
        let curve = |row: &Row| {
            let points = LEVELS.iter().zip(&row.directions);
            let points = points.map(|(l, n)| [*l, *n as f64]).collect();
            Curve::new(
                format!("{}, {} spots", row.kind.name(), row.spots),
                Mark::Line,
                points,
            )
        };
        let axes = [
            Axis::decades("noise"),
            Axis::linear("directions above it", [0.0, self.elements as f64]),
        ];
        let plot = Plot::new("", axes, self.rows.iter().map(curve).collect());
        let mut tables = vec![self.table()];
        if self.rows.iter().any(|row| !row.seen.is_empty()) {
            tables.push(self.seen());
        }
        if self.rows.iter().any(|row| !row.misplaced.is_empty()) {
            tables.push(self.misplaced());
        }
        Finding {
            sentence: self.sentence(),
            notes: vec![
                format!(
                    "Places are searched on at most {} × {} pixels and {} spots by compass search: a local optimum.",
                    SEARCHED[0], SEARCHED[0], SEARCHED[1]
                ),
                format!(
                    "Boards have albedos 0 and 1. Limits are of {} draws of photographs of the matrix model (elements and spots at their centres), recovered by joint; a dash is a limit below 1e-14, or a picture of which no light comes into view. Occluders are black; of one that reflects `recover --occluder-light` estimates the light. What stands in the scene's way by itself stays there in every row.",
                    self.draws
                ),
            ],
            tables,
            figures: vec![Figure::new("occluder.svg", title.clone(), vec![plot])],
            title,
            ..Finding::default()
        }
    }
}
