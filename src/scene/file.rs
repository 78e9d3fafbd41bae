//! The scene file as written: TOML tables, strict, unchecked. [`Scene`](super::Scene) is what they
//! mean.
//!
//! Unknown keys are errors. [`scene`](crate::scene) has the reference of the keys.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::axes::AxesTable;
use super::builtin::builtins;
use super::error::SceneError;
use super::material::MaterialTable;
use super::mesh::Generator;
use super::parse::{parse, write};
use super::sensor::SensorSettings;
use super::surface::Role;
use super::unit::Unit;
use crate::geometry::Facing;

impl SceneFile {
    /// A built-in scene to change, by name; `None` if there is none of that name.
    pub fn builtin(name: &str) -> Option<Self> {
        let builtin = builtins().iter().find(|b| b.name == name)?;
        Some(parse(name, builtin.text).ok()?.0)
    }

    /// The text of the scene file.
    ///
    /// # Errors
    /// [`SceneError`] for what TOML cannot express: an integer beyond 2⁶³.
    pub fn toml(&self) -> Result<String, SceneError> {
        write(&self.name, self)
    }

    /// What the light depends on: known answers, sensor and uncertainties left out.
    pub(super) fn of_the_light(&self) -> Self {
        Self {
            known: Vec::new(),
            sensor: None,
            uncertainty: BTreeMap::new(),
            ..self.clone()
        }
    }
}

impl Default for SceneFile {
    /// The bench: [`SceneFile::builtin`] of that name.
    fn default() -> Self {
        Self::builtin("bench").expect("the bench is a valid scene")
    }
}

/// Three coordinates, in the scene's unit.
pub type Triple = [f64; 3];

/// A whole scene file.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Name of the scene.
    pub name: String,
    /// Length unit of every number in the file: m, cm, mm or in.
    pub unit: Unit,
    /// Largest number of surfaces met between laser and camera (3: S1, S2, S3).
    pub max_bounces: u32,
    /// Directions of x and y, in which spots and view are given; none: those of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axes: Option<AxesTable>,
    /// Laser and spots; none where a hidden surface shines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laser: Option<LaserTable>,
    /// Camera and view.
    pub camera: CameraTable,
    /// Surfaces, in the order of their shape ids.
    #[serde(default)]
    pub surface: Vec<SurfaceTable>,
    /// Exact answers. They do not change the light, so they stay out of the hash.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub known: Vec<KnownTable>,
    /// How the light is photographed. It does not change the light either.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor: Option<SensorSettings>,
    /// Standard deviations of what was measured, by the names of [`Parameter`](super::Parameter)s.
    /// They do not change the light either.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub uncertainty: BTreeMap<String, f64>,
}

/// The `[laser]` table.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct LaserTable {
    /// Power that lands on the wall, W.
    pub power: f64,
    /// Wavelength, m (always metres).
    pub wavelength: f64,
    /// Where the beam starts.
    pub position: Triple,
    /// Diameter of the spot on the wall; 0 is an ideal spot. For a Gaussian the 1/e² diameter.
    #[serde(default)]
    pub spot_diameter: f64,
    /// Irradiance over the spot: disc (uniform) or gaussian.
    #[serde(default)]
    pub profile: ProfileShape,
    /// The layout of the spots.
    pub spots: SpotsTable,
}

/// How the power of a wide spot is spread.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum ProfileShape {
    /// Uniform irradiance.
    #[default]
    Disc,
    /// Irradiance ∝ exp(−2r²/w²).
    Gaussian,
}

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
    #[serde(skip_serializing_if = "Option::is_none")]
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
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<Vec<[f64; 2]>>,
}

/// A straight line of spots.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct LineTable {
    /// Its first spot.
    pub from: [f64; 2],
    /// Its last spot.
    pub to: [f64; 2],
    /// Spots on the line, both ends included.
    pub count: u32,
}

/// The `[camera]` table.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CameraTable {
    /// The pinhole.
    pub position: Triple,
    /// Area of the aperture, unit²; it stands parallel to the wall.
    pub aperture_area: f64,
    /// Rectangle on the wall that the pixel grid covers exactly.
    pub view: ViewTable,
    /// Columns (along x) and rows (along y).
    pub pixels: [u32; 2],
}

/// A rectangle on the wall.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ViewTable {
    /// Its ends in x.
    pub x: [f64; 2],
    /// Its ends in y.
    pub y: [f64; 2],
}

/// A `[[surface]]` table: exactly one of `rectangle`, `sphere`, `disc` and `mesh`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SurfaceTable {
    /// Name, unique in the scene.
    pub name: String,
    /// relay (S1 and S3), hidden (S2, recovered) or occluder.
    pub role: Role,
    /// A parallelogram.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rectangle: Option<RectangleTable>,
    /// A sphere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sphere: Option<SphereTable>,
    /// A disc.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub disc: Option<DiscTable>,
    /// A mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<Box<MeshTable>>,
    /// one (default): the front reflects, the back is black; two: both reflect.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sides: Option<Sides>,
    /// How its front reflects.
    pub material: MaterialTable,
    /// Resolution of the matrix model and of the recovery along u and v, or "faces" for one element
    /// to each triangle (hidden surfaces).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elements: Option<ElementsTable>,
}

/// Which sides of a surface reflect.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Sides {
    /// The front.
    One,
    /// Front and back.
    Two,
}

/// What a hidden surface is divided into.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(
    untagged,
    expecting = "elements along u and v, e.g. [8, 8], or \"faces\""
)]
pub enum ElementsTable {
    /// Cells along u and v.
    Grid([u32; 2]),
    /// The triangles of a mesh.
    Faces(FacesName),
}

/// The word `faces`.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum FacesName {
    /// One element for each triangle.
    Faces,
}

/// A disc.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct DiscTable {
    /// Centre.
    pub centre: Triple,
    /// Normal of the front, of any length but 0.
    pub normal: Triple,
    /// Radius, above 0.
    pub radius: f64,
}

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
    #[serde(skip_serializing_if = "Option::is_none")]
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
    pub at: [f64; 2],
}

/// A `[[known]]` table: an entry of Φcam whose exact value is known.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct KnownTable {
    /// Pixel index.
    pub pixel: u64,
    /// Spot index.
    pub spot: u64,
    /// Exact flux into the pixel, W.
    pub flux: f64,
    /// Only light that met exactly so many surfaces; absent: all light.
    pub bounces: Option<u32>,
}

/// A parallelogram; its front normal is u × v.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RectangleTable {
    /// Where both edges begin.
    pub corner: Triple,
    /// First edge; the front normal is u × v.
    pub u: Triple,
    /// Second edge.
    pub v: Triple,
}

/// A sphere.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SphereTable {
    /// Centre.
    pub centre: Triple,
    /// Radius, above 0.
    pub radius: f64,
    /// The side that reflects: outside (a ball) or inside (a cavity).
    pub face: Facing,
}

#[cfg(test)]
mod tests;
