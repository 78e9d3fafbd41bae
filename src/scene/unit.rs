//! Units of length.

use serde::{Deserialize, Serialize};

/// The length unit of a scene.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
pub enum Unit {
    /// Metre.
    #[serde(rename = "m")]
    Metre,
    /// Centimetre.
    #[serde(rename = "cm")]
    Centimetre,
    /// Millimetre.
    #[serde(rename = "mm")]
    Millimetre,
    /// Inch, 25.4 mm.
    #[serde(rename = "in")]
    Inch,
}

impl Unit {
    /// How many of it make an inch of 25.4 mm.
    pub fn per_inch(self) -> f64 {
        match self {
            Self::Metre => 0.0254,
            Self::Centimetre => 2.54,
            Self::Millimetre => 25.4,
            Self::Inch => 1.0,
        }
    }

    /// Its symbol: m, cm, mm, in.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Centimetre => "cm",
            Self::Millimetre => "mm",
            Self::Inch => "in",
        }
    }
}
