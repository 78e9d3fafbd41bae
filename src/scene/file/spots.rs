//! Where the laser points, as written.

use serde::{Deserialize, Serialize};

use crate::scene::exactly;

/// A layout of spots; the table in [`crate::scene`] says which keys it takes.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Layout {
    /// The four sides of a square.
    #[default]
    Square,
    /// Straight lines.
    Lines,
    /// A square grid.
    Grid,
    /// A circle.
    Ring,
    /// Random places in a square.
    Random,
    /// Places as listed.
    List,
}

/// The keys of every layout; which of them a layout takes is checked in `spots`.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SpotsTable {
    /// square, lines, grid, ring, random or list.
    pub layout: Layout,
    /// Centre on the wall (square, grid, ring, random).
    #[serde(
        default,
        deserialize_with = "exactly::maybe",
        skip_serializing_if = "Option::is_none"
    )]
    pub centre: Option<[f64; 2]>,
    /// Half the side of the square (square, grid, random).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub half_width: Option<f64>,
    /// Spots along each side (square, grid).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub per_side: Option<u32>,
    /// Offsets cycled along each side (square, lines); [] or absent for none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stagger: Option<Vec<f64>>,
    /// Straight lines of spots (lines).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lines: Option<Vec<LineTable>>,
    /// Radius (ring).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Number of spots (ring, random).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub count: Option<u32>,
    /// Angle of the first spot from +x, degrees (ring); default 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start_angle: Option<f64>,
    /// Seed of the places (random).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// The spots themselves (list).
    #[serde(
        default,
        deserialize_with = "exactly::each",
        skip_serializing_if = "Option::is_none"
    )]
    pub points: Option<Vec<[f64; 2]>>,
}

/// A straight line of spots.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct LineTable {
    /// Its first spot.
    #[serde(deserialize_with = "exactly::one")]
    pub from: [f64; 2],
    /// Its last spot.
    #[serde(deserialize_with = "exactly::one")]
    pub to: [f64; 2],
    /// Spots on the line, both ends included.
    pub count: u32,
}
