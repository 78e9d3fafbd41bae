//! Floor 2: the scene. Laser and spots, camera and view, surfaces with role, shape and albedo; the TOML file that
//! describes them, and the scenes that are built in.
//!
//! A [`Scene`] that exists is consistent: its spots and its view lie on relay surfaces, nothing has zero area, albedos
//! are in [0, 1], and the camera does not see a hidden face. What is merely suspicious is told by [`Scene::warnings`].
//!
//! All lengths are in the scene's [`Unit`]. Transport does not depend on it: étendue (length²) and form factors
//! (length⁻²) cancel, and fluxes are in W.

mod builtin;
mod camera;
mod check;
mod error;
mod file;
mod laser;
mod parse;
mod spots;
mod surface;
mod texture;

use sha2::{Digest, Sha256};

pub use builtin::{Builtin, builtins};
pub use camera::Camera;
pub use check::Warning;
pub use error::{Place, SceneError};
pub use laser::{Laser, Profile, Spot};
pub use surface::{Role, Surface};
pub use texture::{Cells, Texture};

use crate::geometry::{Bvh, Shape};
use error::{Fault, keys};
use file::{SceneFile, UnitName};

/// Largest number of surfaces that a path may meet.
pub const MOST_BOUNCES: u32 = 1000;

/// The length unit of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Metre.
    Metre,
    /// Centimetre.
    Centimetre,
    /// Millimetre.
    Millimetre,
    /// Inch, 25.4 mm.
    Inch,
}

impl Unit {
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

/// A checked scene.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name.
    pub name: String,
    /// Length unit of every coordinate.
    pub unit: Unit,
    /// Largest number of surfaces met between laser and camera.
    pub max_bounces: u32,
    /// Laser and spots.
    pub laser: Laser,
    /// Pinhole camera.
    pub camera: Camera,
    /// Surfaces; their positions are the shape ids of [`Scene::bvh`].
    pub surfaces: Vec<Surface>,
    /// The text that the scene was read from.
    pub text: String,
    /// SHA-256 (hex) of the scene's content: comments and spelling of numbers do not change it.
    pub hash: String,
    bvh: Bvh,
}

impl Scene {
    /// A built-in scene by name, or a scene file by path.
    ///
    /// # Errors
    /// [`SceneError`] with file, line, cause and cure.
    pub fn load(name_or_path: &str) -> Result<Self, SceneError> {
        if let Some(builtin) = builtins().iter().find(|b| b.name == name_or_path) {
            return Self::from_toml(name_or_path, builtin.text);
        }
        Self::from_toml(name_or_path, &builtin::read(name_or_path)?)
    }

    /// A scene from the text of a scene file; `source` names it in errors.
    ///
    /// # Errors
    /// [`SceneError`] with line, cause and cure.
    pub fn from_toml(source: &str, text: &str) -> Result<Self, SceneError> {
        let file = parse::parse(source, text)?;
        Self::assemble(&file, text).map_err(|fault| parse::locate(source, text, fault))
    }

    /// The same scene with every spot moved by (dx, dy) on the wall.
    ///
    /// # Errors
    /// [`SceneError`] if a spot leaves the wall.
    pub fn with_shifted_spots(&self, [dx, dy]: [f64; 2]) -> Result<Self, SceneError> {
        let places: Vec<[f64; 2]> = self
            .laser
            .spots
            .iter()
            .map(|s| [s.target.position.x + dx, s.target.position.y + dy])
            .collect();
        let spots = laser::place(&places, self.laser.position, &self.surfaces)
            .map_err(|fault| parse::locate(&self.name, &self.text, fault))?;
        let mut scene = self.clone();
        scene.laser.spots = spots;
        Ok(scene)
    }

    fn assemble(file: &SceneFile, text: &str) -> Result<Self, Fault> {
        if file.name.trim().is_empty() {
            return Err(Fault::new(
                keys!["name"],
                "the scene has no name",
                "give it one",
            ));
        }
        if !(1..=MOST_BOUNCES).contains(&file.max_bounces) {
            return Err(Fault::new(
                keys!["max_bounces"],
                format!("max_bounces is {}", file.max_bounces),
                format!("use 1 to {MOST_BOUNCES}; 3 is laser – wall – object – wall – camera"),
            ));
        }
        let surfaces = surface::from_tables(&file.surface)?;
        let shapes: Vec<Shape> = surfaces.iter().map(|s| s.shape.clone()).collect();
        let bvh = Bvh::new(shapes)
            .map_err(|e| Fault::new(keys!["surface"], e.to_string(), "check the coordinates"))?;
        let laser = Laser::from_table(&file.laser, &surfaces)?;
        let camera = Camera::from_table(&file.camera, &surfaces)?;
        let json = serde_json::to_vec(file)
            .map_err(|e| Fault::new(keys![], e.to_string(), "use finite numbers only"))?;
        let hash = Sha256::digest(json)
            .iter()
            .map(|b| format!("{b:02x}"))
            .collect();
        let scene = Self {
            name: file.name.clone(),
            unit: match file.unit {
                UnitName::M => Unit::Metre,
                UnitName::Cm => Unit::Centimetre,
                UnitName::Mm => Unit::Millimetre,
                UnitName::In => Unit::Inch,
            },
            max_bounces: file.max_bounces,
            laser,
            camera,
            surfaces,
            text: text.to_owned(),
            hash,
            bvh,
        };
        check::refuse_visible_hidden_face(&scene)?;
        Ok(scene)
    }

    /// The surfaces' shapes, ready for ray queries.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// The hidden surfaces with their shape ids, in file order.
    pub fn hidden(&self) -> impl Iterator<Item = (usize, &Surface)> {
        self.surfaces
            .iter()
            .enumerate()
            .filter(|(_, s)| s.role == Role::Hidden)
    }

    /// What is suspicious though not wrong.
    pub fn warnings(&self) -> Vec<Warning> {
        check::warnings(self)
    }
}
