//! The scene file as written: TOML tables, strict, unchecked. [`Scene`](super::Scene) is what they
//! mean.
//!
//! Unknown keys are errors. [`scene`](crate::scene) has the reference of the keys.

mod mesh;
mod spots;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::axes::AxesTable;
use super::builtin::builtins;
use super::error::SceneError;
use super::exactly;
use super::material::MaterialTable;
use super::parse::{parse, write};
use super::sensor::SensorSettings;
use super::surface::Role;
use super::unit::Unit;
use crate::geometry::Facing;
pub use mesh::{MeshTable, OnTable, RotationTable, ScaleTable};
pub use spots::{Layout, LineTable, SpotsTable};

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
    #[serde(deserialize_with = "exactly::one")]
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

/// The `[camera]` table.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CameraTable {
    /// The pinhole.
    #[serde(deserialize_with = "exactly::one")]
    pub position: Triple,
    /// Area of the aperture, unit²; it stands parallel to the wall.
    pub aperture_area: f64,
    /// Rectangle on the wall that the pixel grid covers exactly.
    pub view: ViewTable,
    /// Columns (along x) and rows (along y).
    #[serde(deserialize_with = "exactly::one")]
    pub pixels: [u32; 2],
}

/// A rectangle on the wall.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ViewTable {
    /// Its ends in x.
    #[serde(deserialize_with = "exactly::one")]
    pub x: [f64; 2],
    /// Its ends in y.
    #[serde(deserialize_with = "exactly::one")]
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
    #[serde(deserialize_with = "exactly::one")]
    pub centre: Triple,
    /// Normal of the front, of any length but 0.
    #[serde(deserialize_with = "exactly::one")]
    pub normal: Triple,
    /// Radius, above 0.
    pub radius: f64,
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
    #[serde(deserialize_with = "exactly::one")]
    pub corner: Triple,
    /// First edge; the front normal is u × v.
    #[serde(deserialize_with = "exactly::one")]
    pub u: Triple,
    /// Second edge.
    #[serde(deserialize_with = "exactly::one")]
    pub v: Triple,
}

/// A sphere.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SphereTable {
    /// Centre.
    #[serde(deserialize_with = "exactly::one")]
    pub centre: Triple,
    /// Radius, above 0.
    pub radius: f64,
    /// The side that reflects: outside (a ball) or inside (a cavity).
    pub face: Facing,
}

#[cfg(test)]
mod tests;
