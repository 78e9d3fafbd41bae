//! The scene file as written: TOML tables, strict, unchecked. [`Scene`](super::Scene) is what they mean.
//!
//! Unknown keys are errors. The doc comment of each field is the documentation of its key.

use serde::{Deserialize, Serialize};

use super::material::MaterialTable;
use super::mesh::Generator;
use super::sensor::SensorSettings;

/// Three coordinates, in the scene's unit.
pub(super) type Triple = [f64; 3];

/// A whole scene file.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    /// Name of the scene.
    pub name: String,
    /// Length unit of every number in the file: m, cm, mm or in.
    pub unit: UnitName,
    /// Largest number of surfaces met between laser and camera (3: S1, S2, S3).
    pub max_bounces: u32,
    pub laser: LaserTable,
    pub camera: CameraTable,
    #[serde(default)]
    pub surface: Vec<SurfaceTable>,
    /// Exact answers. They do not change the light, so they stay out of the hash, which is taken from what is serialised.
    #[serde(default, skip_serializing)]
    pub known: Vec<KnownTable>,
    /// How the light is photographed. It does not change the light either.
    #[serde(default, skip_serializing)]
    pub sensor: Option<SensorSettings>,
}

#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum UnitName {
    M,
    Cm,
    Mm,
    In,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LaserTable {
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
    pub profile: ProfileName,
    pub spots: SpotsTable,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum ProfileName {
    #[default]
    Disc,
    Gaussian,
}

#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum LayoutName {
    Square,
    Lines,
    Grid,
    Ring,
    Random,
    List,
}

/// The keys of every layout; which of them a layout takes is checked in `spots`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SpotsTable {
    /// square, lines, grid, ring, random or list.
    pub layout: LayoutName,
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

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LineTable {
    pub from: [f64; 2],
    pub to: [f64; 2],
    /// Spots on the line, both ends included.
    pub count: u32,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraTable {
    /// The pinhole.
    pub position: Triple,
    /// Area of the aperture, unit²; it stands parallel to the wall.
    pub aperture_area: f64,
    /// Rectangle on the wall that the pixel grid covers exactly.
    pub view: ViewTable,
    /// Columns (along x) and rows (along y).
    pub pixels: [u32; 2],
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ViewTable {
    pub x: [f64; 2],
    pub y: [f64; 2],
}

#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum RoleName {
    Relay,
    Hidden,
    Occluder,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SurfaceTable {
    pub name: String,
    /// relay (S1 and S3), hidden (S2, recovered) or occluder.
    pub role: RoleName,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rectangle: Option<RectangleTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sphere: Option<SphereTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub disc: Option<DiscTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<Box<MeshTable>>,
    /// one (default): the front reflects, the back is black; two: both reflect.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sides: Option<SidesName>,
    pub material: MaterialTable,
    /// Resolution of the matrix model and of the recovery along u and v, or "faces" for one element to each triangle (hidden surfaces).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elements: Option<ElementsTable>,
}

#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum SidesName {
    One,
    Two,
}

#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(
    untagged,
    expecting = "elements along u and v, e.g. [8, 8], or \"faces\""
)]
pub(super) enum ElementsTable {
    Grid([u32; 2]),
    Faces(FacesName),
}

#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum FacesName {
    Faces,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DiscTable {
    pub centre: Triple,
    /// Normal of the front, of any length but 0.
    pub normal: Triple,
    pub radius: f64,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshTable {
    /// PLY, OBJ, glTF or GLB file, relative to the scene file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// A mesh that phicam makes itself, in place of a file: bust, sphere, rectangle or box (the unit cube).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub generate: Option<Generator>,
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
    /// true: the mesh is meant to be closed, so that open edges are a defect.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closed: Option<bool>,
}

#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(
    untagged,
    expecting = "a factor, or one for each axis: 2.5 or [1, 1, 2]"
)]
pub(super) enum ScaleTable {
    Uniform(f64),
    Axes(Triple),
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RotationTable {
    pub axis: Triple,
    /// Degrees, counterclockwise seen from the tip of the axis.
    pub angle: f64,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OnTable {
    /// Name of a surface that comes earlier in the file.
    pub surface: String,
    /// The place on it, in its parameters.
    pub at: [f64; 2],
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KnownTable {
    /// Pixel index.
    pub pixel: u64,
    /// Spot index.
    pub spot: u64,
    /// Exact flux into the pixel, W.
    pub flux: f64,
    /// Only light that met exactly so many surfaces; absent: all light.
    pub bounces: Option<u32>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RectangleTable {
    pub corner: Triple,
    /// First edge; the front normal is u × v.
    pub u: Triple,
    /// Second edge.
    pub v: Triple,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SphereTable {
    pub centre: Triple,
    pub radius: f64,
    /// The side that reflects: outside (a ball) or inside (a cavity).
    pub face: FaceName,
}

#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum FaceName {
    Outside,
    Inside,
}
