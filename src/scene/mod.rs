//! Floor 2: the scene. Laser and spots, or a hidden surface that shines, camera and view, surfaces
//! with role, shape and albedo; the TOML file that describes them, and the scenes that are built
//! in.
//!
//! A [`Scene`] that exists is consistent: its spots and its view lie on relay surfaces, nothing has
//! zero area, albedos are in \[0, 1\], no two surfaces lie in one place facing the same way, and
//! the camera does not see a hidden face (sampled at 33 × 33 points of it). What is merely
//! suspicious is told by [`Scene::warnings`].
//!
//! All lengths are in the scene's [`Unit`]. Transport does not depend on it: étendue (length²) and
//! form factors (length⁻²) cancel, and fluxes are in W.
//!
#![doc = include_str!("reference.md")]

mod axes;
mod body;
mod builtin;
mod camera;
mod check;
mod coordinates;
mod cure;
mod device;
mod dimension;
mod displaced;
mod element;
mod error;
pub(crate) mod exactly;
pub mod file;
mod files;
mod hash;
mod known;
mod laser;
pub mod material;
pub mod mesh;
mod parameter;
mod parse;
mod pieces;
mod quantity;
pub mod reference;
mod replaced;
mod room;
mod sensor;
mod shining;
pub mod spots;
mod surface;
mod surface_tables;
pub mod target;
mod texture;
mod unit;
mod units;
mod variants;
mod walls;
mod warning;

use std::path::{Path, PathBuf};

pub use axes::AxesTable;
pub use builtin::{Builtin, builtins};
pub use camera::Camera;
pub use dimension::{Dimension, NoNumber};
pub use displaced::{MaterialRate, Twist, Velocity};
pub use element::Element;
pub use error::{Place, SceneError};
pub use files::{COPIES, Referenced};
pub use known::Known;
pub use laser::{Laser, Profile, Spot};
pub use material::Material;
pub use parameter::Parameter;
pub use parse::read_toml;
pub use quantity::Quantity;
pub use replaced::quoted;
pub use sensor::{Glare, MOST_BRACKETS, SensorModel, SensorSettings, Spread};
pub use surface::{Division, Role, Surface};
pub use texture::{
    AlbedoTable, Bilinear, Cells, Filter, PictureChannel, Texture, VariedTable, Wrap,
};
pub use unit::Unit;
pub use warning::Warning;

use crate::geometry::{Bvh, DAffine3, DVec3, Interaction, Ray, ShapeId};
use error::{Fault, keys};
use file::SceneFile;
use files::{Files, Folders};
use hash::content_hash;

/// Largest number of surfaces that a path may meet.
pub const MOST_BOUNCES: u32 = 1000;

/// Largest magnitude of a coordinate: rays travel in f32, where the square of a length may not pass
/// 3.4e38.
const FARTHEST: f64 = 1e15;

/// Smallest extent: areas and their inverses stay far from the ends of f64.
const FINEST: f64 = 1e-15;

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
    /// Exact answers that the scene states; empty for most.
    pub known: Vec<Known>,
    /// The sensor and its exposure, where the scene states them.
    pub sensor: Option<SensorSettings>,
    /// Standard deviations of what was measured: names of [`Parameter`]s with degrees, percents or
    /// lengths.
    pub uncertainty: Vec<(String, f64)>,
    /// The text that the scene was read from, with numbers in the place of values with units.
    pub text: String,
    /// The files that it names.
    pub files: Vec<Referenced>,
    /// SHA-256 (hex) of the scene's content: comments and spelling of numbers do not change it.
    pub hash: String,
    bvh: Bvh,
    /// From the coordinates of the file to those of the scene.
    axes: DAffine3,
    /// What was suspicious in the files.
    found: Vec<Warning>,
    /// Where they are read.
    folders: Folders,
}

impl Scene {
    /// A built-in scene by name, or a scene file by path.
    ///
    /// # Errors
    /// [`SceneError`] with file, line, cause and cure.
    pub fn load(name_or_path: &str) -> Result<Self, SceneError> {
        Self::load_with(name_or_path, &[])
    }

    /// The same for a scene that may read meshes, pictures and materials in the folders `also` too,
    /// not only in its own.
    ///
    /// # Errors
    /// [`SceneError`] with file, line, cause and cure.
    pub fn load_with(name_or_path: &str, also: &[PathBuf]) -> Result<Self, SceneError> {
        if let Some(builtin) = builtins().iter().find(|b| b.name == name_or_path) {
            return Self::from_toml(name_or_path, builtin.text);
        }
        let text = builtin::read(name_or_path)?;
        let folder = match Path::new(name_or_path).parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        Self::read(name_or_path, &text, Files::of(folder, also))
    }

    /// A scene made in code. Its text is `file` as TOML. Meshes, pictures and materials are read
    /// from `folder` and below, if there is one.
    ///
    /// ```
    /// use phicam::scene::{Scene, file::SceneFile};
    ///
    /// let mut file = SceneFile::builtin("bench").unwrap();
    /// file.name = "coarse".to_owned();
    /// file.camera.pixels = [8, 8];
    /// file.laser.as_mut().expect("the bench has a laser").spots.per_side = Some(5);
    /// let scene = Scene::new(&file, None)?;
    /// assert_eq!((scene.camera.pixels(), scene.laser.spots.len()), (64, 20));
    /// # Ok::<(), phicam::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError`] with cause and cure; its line is that of [`Scene::text`].
    pub fn new(file: &SceneFile, folder: Option<&Path>) -> Result<Self, SceneError> {
        let text = file.toml()?;
        let files = folder.map_or(Files::default(), |f| Files::of(f, &[]));
        Self::assemble(file, &text, files).map_err(|fault| parse::locate(&file.name, &text, fault))
    }

    /// A scene from the text of a scene file; `source` names it in errors. It may name no other
    /// files, for a text has no folder.
    ///
    /// # Errors
    /// [`SceneError`] with line, cause and cure.
    pub fn from_toml(source: &str, text: &str) -> Result<Self, SceneError> {
        Self::read(source, text, Files::default())
    }

    fn read(source: &str, text: &str, files: Files) -> Result<Self, SceneError> {
        let (file, plain) = parse::parse(source, text)?;
        Self::assemble(&file, &plain, files).map_err(|fault| parse::locate(source, text, fault))
    }

    fn assemble(file: &SceneFile, text: &str, mut files: Files) -> Result<Self, Fault> {
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
        let mut found = Vec::new();
        let wavelength = shining::wavelength(file);
        let mut surfaces =
            surface_tables::from_tables(&file.surface, &mut files, wavelength, &mut found)?;
        let axes = axes::turn(&mut surfaces, file.axes.as_ref())?;
        let bvh = surface::bvh(&surfaces)?;
        let laser = match (Laser::of_shining(file, &mut surfaces)?, &file.laser) {
            (Some(shining), _) => shining,
            (None, Some(table)) => Laser::from_table(table, &axes, &surfaces)?,
            (None, None) => {
                let cause = "nothing gives light: there is no [laser] table, and no surface shines";
                let cure =
                    "add [laser], or let a hidden surface shine: `material = { shining = … }`";
                return Err(Fault::new(keys![], cause, cure));
            }
        };
        let camera = Camera::from_table(&file.camera, &axes, &surfaces)?;
        let known = Known::from_tables(
            &file.known,
            camera.pixels(),
            laser.spots.len(),
            file.max_bounces,
        )?;
        let sensor = file
            .sensor
            .clone()
            .map(SensorSettings::checked)
            .transpose()?;
        let hash = content_hash(file, &files.read)?;
        let mut scene = Self {
            name: file.name.clone(),
            unit: file.unit,
            max_bounces: file.max_bounces,
            laser,
            camera,
            surfaces,
            known,
            sensor,
            uncertainty: Vec::new(),
            text: text.to_owned(),
            files: files.read,
            hash,
            bvh,
            axes,
            found,
            folders: files.folders,
        };
        check::refuse_visible_hidden_face(&scene)?;
        scene.uncertainty = parameter::uncertainty(&scene, &file.uncertainty)?;
        Ok(scene)
    }

    /// The surfaces' shapes, ready for ray queries.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// The surface that the camera sees first through a point of its view, and where.
    pub(crate) fn seen_through(&self, point: DVec3) -> Option<(ShapeId, Interaction)> {
        let sight = Ray::between(self.camera.position, point)?;
        let ray = Ray::new(sight.origin, sight.direction);
        let hit = self.bvh.closest(&ray, None)?;
        Some((hit.shape, self.bvh.point(&ray, hit)))
    }

    /// From the scene's coordinates back to those of its file.
    pub fn to_file(&self) -> DAffine3 {
        self.axes.inverse()
    }

    /// The hidden surfaces with their shape ids, in file order.
    pub fn hidden(&self) -> impl Iterator<Item = (usize, &Surface)> {
        surface::of_role(Role::Hidden, &self.surfaces)
    }

    /// Occluders that reflect and that light may meet on its way, by name, in quotes and separated
    /// by commas; none where there are none, and where the hidden surface shines, of whose picture
    /// they are no term.
    pub fn sent_on(&self) -> Option<String> {
        let occluders = surface::of_role(Role::Occluder, &self.surfaces);
        let names = occluders.filter(|(_, s)| !s.is_black());
        let names: Vec<String> = names.map(|(_, s)| format!("`{}`", s.name)).collect();
        let can = self.max_bounces > 1 && self.shining().is_none();
        (can && !names.is_empty()).then(|| names.join(", "))
    }

    /// The hidden surfaces of unknown albedo, by name, in quotes and separated by commas; none
    /// where every albedo is known.
    pub fn unknown(&self) -> Option<String> {
        let names = self.hidden().filter(|(_, s)| !s.is_known);
        let names: Vec<String> = names.map(|(_, s)| format!("`{}`", s.name)).collect();
        (!names.is_empty()).then(|| names.join(", "))
    }

    /// The relay surfaces with their shape ids, in file order.
    pub fn relays(&self) -> impl Iterator<Item = (usize, &Surface)> {
        surface::of_role(Role::Relay, &self.surfaces)
    }

    /// What is suspicious though not wrong.
    pub fn warnings(&self) -> Vec<Warning> {
        check::warnings(self)
    }
}
