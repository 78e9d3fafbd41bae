//! Matrices that are shown as pictures.

use serde::{Deserialize, Serialize};

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

impl Gallery {
    /// Pictures of reflectances.
    pub fn reflectances(title: impl Into<String>, pictures: Vec<Picture>) -> Self {
        Self {
            title: title.into(),
            shades: Shades::Reflectance,
            unit: String::new(),
            pictures,
        }
    }
}
