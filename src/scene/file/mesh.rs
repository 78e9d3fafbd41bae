//! A surface of triangles, as written.

use serde::{Deserialize, Serialize};

use super::Triple;
use crate::scene::exactly;
use crate::scene::mesh::Generator;

/// Triangles from a file, or made by phicam.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct MeshTable {
    /// PLY, OBJ, glTF or GLB file, relative to the scene file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// A mesh that phicam makes itself, in place of a file: bust, sphere, rectangle or box (the
    /// unit cube).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub generate: Option<Generator>,
    /// A flat mask on the unit square, in place of a file: rows of # (opaque) and . (open), the
    /// first at y = 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mask: Option<Vec<String>>,
    /// At least so many triangles (generate).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub faces: Option<u64>,
    /// Factor on all coordinates, or one for each axis; applied first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<ScaleTable>,
    /// Rotations about axes through the origin, in order, after the scale.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotate: Option<Vec<RotationTable>>,
    /// Shift, after the rotations.
    #[serde(
        default,
        deserialize_with = "exactly::maybe",
        skip_serializing_if = "Option::is_none"
    )]
    pub translate: Option<Triple>,
    /// Puts the mesh, as it is turned, down on another surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on: Option<OnTable>,
    /// true: the front is where the corners of a triangle run clockwise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flip: Option<bool>,
    /// true: the mesh is meant to be closed, so that open edges are a defect.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closed: Option<bool>,
}

/// A factor on coordinates.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(
    untagged,
    expecting = "a factor, or one for each axis: 2.5 or [1, 1, 2]"
)]
pub enum ScaleTable {
    /// The same on every axis.
    Uniform(f64),
    /// One for each axis.
    Axes(Triple),
}

/// A turn about an axis through the origin.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RotationTable {
    /// The axis, of any length but 0.
    #[serde(deserialize_with = "exactly::one")]
    pub axis: Triple,
    /// Degrees, counterclockwise seen from the tip of the axis.
    pub angle: f64,
}

/// A place on another surface.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct OnTable {
    /// Name of a surface that comes earlier in the file.
    pub surface: String,
    /// The place on it, in its parameters.
    #[serde(deserialize_with = "exactly::one")]
    pub at: [f64; 2],
}
