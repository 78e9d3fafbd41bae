//! Sheets of plots: their axes and curves.

use serde::{Deserialize, Serialize};

/// How an axis is divided.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Spacing {
    /// Evenly, at least between these ends.
    Linear([f64; 2]),
    /// Evenly between these ends; points beyond them are left out, and the figure says how many.
    Clipped([f64; 2]),
    /// By decades around the data.
    Logarithmic,
    /// One place for each name, at 0, 1, 2, …; on the axis upwards the first is on top.
    Categories(Vec<String>),
}

/// An axis. Equal ones of one direction have the same ends throughout a figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// What it shows, with its unit.
    pub title: String,
    /// How it is divided.
    pub spacing: Spacing,
}

/// How the points of a curve are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mark {
    /// A line through them.
    Line,
    /// A mark each.
    Points,
    /// A bar each, from the axis of categories.
    Bars,
    /// A mark each, read from the published study.
    Published,
    /// A straight line across the plot, a limit or a level: upright where its points have one x,
    /// else at the y of the first.
    Level,
}

/// Points with a name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Its name in the legend. Curves of one name look the same in every plot of a figure.
    pub name: String,
    /// How it is drawn.
    pub mark: Mark,
    /// (x, y).
    pub points: Vec<[f64; 2]>,
    /// Standard errors of the numbers (y; of bars their lengths), drawn as whiskers; empty for
    /// none.
    pub stderr: Vec<f64>,
}

/// Curves on one pair of axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plot {
    /// What it shows; empty where the figure's title says all.
    pub title: String,
    /// Across and upwards.
    pub axes: [Axis; 2],
    /// Its curves.
    pub curves: Vec<Curve>,
}

/// A sheet of plots: one SVG file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// Name of its file, with `.svg`.
    pub file: String,
    /// What it shows.
    pub title: String,
    /// What is said below the title; empty for nothing.
    pub note: String,
    /// Its plots, in rows.
    pub plots: Vec<Plot>,
}

impl Plot {
    /// Curves on a pair of axes, across and upwards.
    pub fn new(title: impl Into<String>, axes: [Axis; 2], curves: Vec<Curve>) -> Self {
        Self {
            title: title.into(),
            axes,
            curves,
        }
    }
}

impl Figure {
    /// A sheet of plots without a note.
    pub fn new(file: impl Into<String>, title: impl Into<String>, plots: Vec<Plot>) -> Self {
        Self {
            file: file.into(),
            title: title.into(),
            note: String::new(),
            plots,
        }
    }
}

impl Axis {
    /// An even axis that reaches at least from one end to the other.
    pub fn linear(title: impl Into<String>, ends: [f64; 2]) -> Self {
        Self {
            title: title.into(),
            spacing: Spacing::Linear(ends),
        }
    }

    /// An even axis between these ends, without what lies beyond.
    pub fn clipped(title: impl Into<String>, ends: [f64; 2]) -> Self {
        Self {
            title: title.into(),
            spacing: Spacing::Clipped(ends),
        }
    }

    /// An axis by decades.
    pub fn decades(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            spacing: Spacing::Logarithmic,
        }
    }
}

impl Curve {
    /// A curve without error bars.
    pub fn new(name: impl Into<String>, mark: Mark, points: Vec<[f64; 2]>) -> Self {
        Self {
            name: name.into(),
            mark,
            points,
            stderr: Vec::new(),
        }
    }
}
