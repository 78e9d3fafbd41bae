//! What an item comes to: a table, figures, pictures and checks, as plain values.

use serde::{Deserialize, Serialize};

use super::{Check, Item};

/// Side of the published object, in.
const OBJECT: f64 = 4.0;

/// An entry of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A whole number.
    Count(usize),
    /// A number; none where it is not defined.
    Number(Option<f64>),
}

/// How an axis of a figure runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Course {
    /// Evenly, between these ends.
    Linear,
    /// By decades.
    Logarithmic,
}

/// An axis: what it shows (with unit), how it runs, and its ends where it is linear.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FigureAxis {
    /// Name and unit.
    pub title: String,
    /// How it runs.
    pub course: Course,
    /// First and last value; by the data where it is logarithmic.
    pub ends: [f64; 2],
}

/// Where the points of a curve are from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Source {
    /// Computed here.
    Computed,
    /// Read from the published study.
    Published,
}

/// Points with a name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FigureCurve {
    /// Its name in the legend.
    pub name: String,
    /// Where it is from.
    pub source: Source,
    /// (x, y), by growing x.
    pub points: Vec<[f64; 2]>,
}

/// One pair of axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plot {
    /// What it shows.
    pub title: String,
    /// Across and upwards.
    pub axes: [FigureAxis; 2],
    /// Its curves.
    pub curves: Vec<FigureCurve>,
}

/// What the shades of a picture mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Shades {
    /// Reflectances, 0 black and 1 white.
    Reflectance,
    /// Any values, from the smallest to the largest.
    Values,
}

/// A matrix shown as a picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Picture {
    /// What it is.
    pub title: String,
    /// Columns and rows.
    pub size: [usize; 2],
    /// Value of column i, row j at i + j·columns; the first row is the lowest.
    pub values: Vec<f64>,
    /// What runs to the right and what upwards.
    pub axes: [String; 2],
    /// How wide what it shows is, in.
    pub width: f64,
}

/// Pictures on one scale.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gallery {
    /// What they show.
    pub title: String,
    /// What their shades mean.
    pub shades: Shades,
    /// Unit of the values.
    pub unit: String,
    /// The pictures.
    pub pictures: Vec<Picture>,
}

/// An item, computed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reproduction {
    /// Which.
    pub item: Item,
    /// What was published.
    pub title: String,
    /// Kernel, layout, pixels, tolerance rule and normalisation.
    pub caption: String,
    /// Heads of the table's columns.
    pub columns: Vec<String>,
    /// Its rows.
    pub rows: Vec<Vec<Cell>>,
    /// Its figure, a sheet of plots; empty where the table says all.
    pub plots: Vec<Plot>,
    /// Its pictures.
    pub galleries: Vec<Gallery>,
    /// Published beside computed.
    pub checks: Vec<Check>,
    /// What else the numbers say.
    pub notes: Vec<String>,
}

impl Reproduction {
    /// Whether every picture has as many values as its size says.
    pub(super) fn pictured(&self) -> bool {
        let whole = |p: &Picture| p.size[0].checked_mul(p.size[1]) == Some(p.values.len());
        self.galleries.iter().flat_map(|g| &g.pictures).all(whole)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::Count(count)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(Some(number))
    }
}

impl From<Option<f64>> for Cell {
    fn from(number: Option<f64>) -> Self {
        Self::Number(number)
    }
}

/// An even axis.
pub(super) fn linear(title: &str, ends: [f64; 2]) -> FigureAxis {
    FigureAxis {
        title: title.to_owned(),
        course: Course::Linear,
        ends,
    }
}

/// An axis by decades.
pub(super) fn decades(title: &str) -> FigureAxis {
    FigureAxis {
        title: title.to_owned(),
        course: Course::Logarithmic,
        ends: [0.0, 0.0],
    }
}

/// A computed curve.
pub(super) fn computed(name: impl Into<String>, points: Vec<[f64; 2]>) -> FigureCurve {
    FigureCurve {
        name: name.into(),
        source: Source::Computed,
        points,
    }
}

/// A published one.
pub(super) fn published(name: impl Into<String>, points: Vec<[f64; 2]>) -> FigureCurve {
    FigureCurve {
        source: Source::Published,
        ..computed(name, points)
    }
}

/// The elements as a picture, iu to the right and distance from the hinge upwards.
pub(super) fn elements(title: impl Into<String>, side: usize, values: Vec<f64>) -> Picture {
    Picture {
        title: title.into(),
        size: [side; 2],
        values,
        axes: ["x", "d"].map(str::to_owned),
        width: OBJECT,
    }
}
