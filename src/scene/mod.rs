//! Floor 2: the scene. Laser and spots, or a hidden surface that shines, camera and view, surfaces with role, shape and albedo; the
//! TOML file that describes them, and the scenes that are built in.
//!
//! A [`Scene`] that exists is consistent: its spots and its view lie on relay surfaces, nothing has
//! zero area, albedos are in \[0, 1\], no two surfaces lie in one place facing the same way, and
//! the camera does not see a hidden face (sampled at 33 × 33 points of it). What is merely
//! suspicious is told by [`Scene::warnings`].
//!
//! All lengths are in the scene's [`Unit`]. Transport does not depend on it: étendue (length²) and
//! form factors (length⁻²) cancel, and fluxes are in W.
//!
//! # The scene file
//!
//! TOML; unknown keys are errors. `phicam scene export bench` writes one out as a start.
//!
//! | key | meaning |
//! | --- | --- |
//! | `name` | name of the scene |
//! | `unit` | length unit of every number in the file: `m`, `cm`, `mm`, `in` |
//! | `max_bounces` | largest number of surfaces met between laser and camera, 1 to 1000; a surface that shines counts as one |
//! | `laser` | `[laser]`; absent where a hidden surface shines |
//! | `laser.power` | power that lands at the spot, W |
//! | `laser.wavelength` | m, whatever the unit |
//! | `laser.position` | where the beams start |
//! | `laser.spot_diameter` | diameter of the spot on the wall; 0 (default) is an ideal spot |
//! | `laser.profile` | `disc` (default): uniform irradiance; `gaussian`: the diameter is 1/e² |
//! | `laser.spots` | the layout, below |
//! | `camera.position` | the pinhole |
//! | `camera.aperture_area` | unit²; aperture and image plane are parallel to the wall |
//! | `camera.view` | `{ x = [a, b], y = [c, d] }`: rectangle on the wall that the pixel grid covers exactly |
//! | `camera.pixels` | columns (x) and rows (y) |
//! | `surface.name`, `surface.role` | `relay` (S1 and S3), `hidden` (S2, recovered), `occluder` |
//! | `surface.rectangle` | `{ corner, u, v }`; the front is the side of u × v |
//! | `surface.disc` | `{ centre, normal, radius }` |
//! | `surface.sphere` | `{ centre, radius, face = "outside" or "inside" }` |
//! | `surface.mesh` | triangles from a file or made by phicam, below |
//! | `surface.sides` | `"one"` (default): the back is black; `"two"`: it reflects as the front does (not of spheres and hidden surfaces) |
//! | `surface.material` | `{ lambertian = ρ }` with ρ a number, one of the tables below, or (hidden surfaces only) `"unknown"`: then nothing is rendered, and what is recovered has no truth; [`material`] has the others |
//! | `surface.elements` | elements along u and v (hidden surfaces only); of a mesh in its texture coordinates, or `"faces"`: one for each triangle |
//! | `known.pixel`, `known.spot` | `[[known]]`, optional, any number: an entry of Φcam whose exact value is known |
//! | `known.flux` | the exact flux into that pixel when that spot is lit, W |
//! | `known.bounces` | only light that met exactly so many surfaces; absent: all light of up to `max_bounces` |
//! | `sensor` | `[sensor]`, optional: how the frames are photographed, below |
//! | `uncertainty` | `[uncertainty]`, optional: how well the geometry was measured, standard deviations by the names of [`Parameter`]s, e.g. `"hinge.angle" = 0.5`; for `phicam calibrate`. It changes neither light nor hash |
//!
//! Surfaces reflect from their front; their back is black; both sides are opaque.
//!
//! A hidden rectangle or disc may shine in place of a laser: `surface.material = { shining = x, … }`.
//! There is no `[laser]` then, no other hidden surface, and Φcam has one column. The surface reflects
//! nothing.
//!
//! | `surface.material` | meaning |
//! | --- | --- |
//! | `shining` | the picture x in \[0, 1\]: a number, an albedo table below, or `"unknown"` |
//! | `exitance` | M, W/unit²: π times the radiance of x = 1 along the normal, which is the exitance of a Lambertian surface of that radiance; default 1 |
//! | `falloff` | `[nu, nv]`: the radiance is x·M/π·cosⁿᵘ(θ_u)·cosⁿᵛ(θ_v), θ_u and θ_v the angles between the normal and the direction's projections on the planes of normal and u, normal and v; default `[0, 0]`, Lambertian; rectangles only |
//! | `wavelength` | m; default 550e-9 |
//! | `light` | `"picture"` (default); `"elements"`: each element shines alone at 1, a column of Φcam each, which is the transport matrix for `recover --camera-side`; with `shining = 1.0` |
//!
//! Numbers that would leave the range of what is computed from them are refused: coordinates beyond
//! 10¹⁵, extents below 10⁻¹⁵ that are not 0, areas beyond the squares of these, powers outside
//! 10⁻⁶⁰ to 10⁶⁰ W, albedos below 10⁻³⁰ that are not 0. The textures of a scene have 2²⁶ cells at
//! most together, and the meshes that it has phicam make 20 million triangles.
//!
//! | `surface.mesh` | meaning |
//! | --- | --- |
//! | `file` | PLY (ASCII or binary), OBJ, glTF or GLB, relative to the scene file; [`mesh`] says what is read of each. The front of a triangle is where its corners run counterclockwise; normals in the file are not used |
//! | `generate` | in place of a file: `"bust"`, `"sphere"`, `"rectangle"` (the unit square) or `"box"` (the unit cube), as `phicam target` writes them |
//! | `mask` | in place of a file: rows of `#` (opaque) and `.` (open) on the unit square, the first at y = 1 |
//! | `faces` | at least so many triangles (`generate`); default 20 000 |
//! | `scale` | a factor, or one for each axis; first |
//! | `rotate` | `[{ axis, angle }, …]`: turns about axes through the origin, degrees, in this order |
//! | `translate` | shift, last |
//! | `on` | `{ surface, at = [u, v] }`: put down, as it is turned, on that place of a rectangle, disc or sphere that comes earlier in the file: its lowest point along the normal there touches, its middle is above the place |
//! | `flip` | `true`: the front of a triangle is where its corners run clockwise |
//! | `closed` | `true`: meant to be a closed body, so that open edges are told |
//!
//! Faces that are degenerate, doubled or not finite are left out, and told by `phicam scene check`
//! with what else is odd; of a face and its reverse the first counts. Faces with more than three
//! corners must be flat, and their sides must not cross. Texture coordinates may lie outside \[0, 1\]:
//! the texture's `wrap` says what is there, and elements are taken in the same way, but no element
//! may lie in several places. Surfaces that name one file share one mesh and one tree, wherever they
//! stand (unless they are stretched). A scene reads files in its own folder and below, and in
//! folders named with `--also-read`; a run keeps copies of them in `files/`.
//!
//! Known answers are for tests and for checks of one's own; they change neither the light nor the
//! scene's hash. The scenes below `scenes/known/` of the repository state theirs, with the
//! derivation in their headers.
//!
//! The sensor is for `phicam expose`; it does not change the hash either, so it may be edited in
//! the folder of a finished run. Every key is optional; without `model` the others change the ideal
//! sensor, which then has shot noise.
//!
//! | `[sensor]` | meaning |
//! | --- | --- |
//! | `model` | built-in sensor: `ideal`, `ccd`, `dslr`, `machine-vision`; their figures are in [`crate::sensor`] |
//! | `quantum_efficiency` | electrons per photon of the laser's wavelength, above 0 and up to 1 |
//! | `dark_current` | electrons per second and pixel |
//! | `full_well` | electrons that a pixel holds; `inf` for no limit |
//! | `read_noise` | electrons, root mean square, per frame |
//! | `gain` | electrons per count |
//! | `bits` | bits of the converter, 1 to 24; 0 for none: counts are then neither rounded nor limited |
//! | `offset` | counts of a pixel without electrons; below 0 counts a converter cuts off |
//! | `shot_noise` | `true`, or `false` for exactly the mean number of electrons |
//! | `relative_noise` | each finished entry is multiplied by 1 + σ·N(0, 1): the published percent error |
//! | `exposure` | time of a frame, s; default 1 |
//! | `frames` | frames averaged; default 1 |
//! | `dark_frames` | frames of the same time without laser, averaged and subtracted; default 0: only the offset is |
//! | `brackets` | exposure times of a series in place of `exposure`, up to 16, s: of each entry the longest counts that a metering frame shows to be safe from saturation |
//! | `ambient` | ambient light, W into each pixel |
//! | `glare` | `{ fraction, spread }`: the part of the spot's light entering the lens that is scattered over the image, `"uniform"` or `{ falloff = d0 }` ∝ 1/(1 + (d/d0)²) at the distance d from the spot on the view's plane |
//!
//! Albedo tables: `{ checkerboard = [nu, nv], dark = …, light = … }` with cell (0, 0), at the
//! corner, dark; `{ cells = [[…], …] }` with rows along v, each along u; `{ ramp = [start, end] }`
//! along u; `{ image = "FILE", … }` and `{ target = "NAME", … }`, pictures. A picture's lower left
//! corner is at (u, v) = (0, 0), so it stands upright where u runs to the right and v upwards. Its
//! linear value x becomes the albedo `dark` + (`light` − `dark`)·x; values outside \[0, 1\] are
//! refused.
//!
//! | picture | meaning |
//! | --- | --- |
//! | `image` | PNG, JPEG or OpenEXR file below the scene's folder, 4096 pixels a side at most; opaque. Of OpenEXR the display window, 0 where it has no data. A camera's note of orientation (EXIF) is not applied |
//! | `target` | built-in picture of [`target`]: `card`, `letters`, `siemens`, `edge`, `usaf`, `ramp` |
//! | `size` | `[columns, rows]` of the target; its own by default |
//! | `transfer` | `"srgb"` or `"linear"`: what the stored values of a PNG or JPEG mean; must be given, for the file does not say. OpenEXR is linear |
//! | `channel` | `"red"`, `"green"`, `"blue"`; `"luminance"`: 0.2126·R + 0.7152·G + 0.0722·B (ITU-R BT.709), linear; `"wavelength"`: of the laser, below; `"grey"` for the only one of a grey picture, the default there |
//! | `filter` | `"nearest"` (default): every pixel is a cell of one albedo; `"bilinear"` between the centres of pixels, level beyond the outermost |
//! | `wrap` | what lies outside \[0, 1\]: `"clamp"` (default), the nearest border, or `"repeat"`, the picture again |
//! | `dark`, `light` | albedo for 0 and 1; default 0 and 1 |
//!
//! `channel = "wavelength"` interpolates between red, green and blue linearly in the laser's
//! wavelength, from 464.2 nm (blue alone) over 549.1 nm (green alone) to 611.4 nm (red alone) and
//! level beyond: the dominant wavelengths of the sRGB primaries seen from its white D65, where the
//! lines from white through the primaries meet the spectral locus of CIE 1931. It is a rule, not a
//! measurement: three numbers do not say how much a pigment reflects at one wavelength.
//!
//! Layouts, in the order in which they list their spots:
//!
//! | `layout` | keys | spots |
//! | --- | --- | --- |
//! | `square` | `centre`, `half_width`, `per_side`, `stagger` | bottom side by growing x, right by growing y, top by falling x, left by falling y; `per_side` each, corners repeated; stagger entry k mod m offsets bottom and top in y, left and right in x |
//! | `grid` | `centre`, `half_width`, `per_side` | rows along +y, each along +x |
//! | `ring` | `centre`, `radius`, `count`, `start_angle` | counter-clockwise from `start_angle` degrees off +x |
//! | `lines` | `lines = [{ from, to, count }, …]`, `stagger` | line after line, ends included; stagger moves to the left of the line |
//! | `random` | `centre`, `half_width`, `count`, `seed` | uniform in the square |
//! | `list` | `points = [[x, y], …]` | as listed |
//!
//! A spot or view given by (x, y) lies on the relay surface straight above or below it along z: of
//! several that show their front the spot takes the one nearest to the laser, the view the one
//! nearest to the camera (inside a cavity, the lower point). Of a wide spot what falls beside the
//! wall is lost. The view's plane is that relay's plane; of a curved relay it is the tangent plane
//! at the view's centre. Pixel index = column + row·columns, columns along +x and rows along +y of
//! the view.

mod body;
mod builtin;
mod camera;
mod check;
mod coordinates;
mod device;
mod displaced;
mod element;
mod error;
pub mod file;
mod files;
mod known;
mod laser;
pub mod material;
pub mod mesh;
mod parameter;
mod parse;
mod pieces;
mod quantity;
mod replaced;
mod sensor;
mod shining;
pub mod spots;
mod surface;
mod surface_tables;
pub mod target;
mod texture;
mod unit;
mod variants;
mod walls;
mod warning;

use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

pub use builtin::{Builtin, builtins};
pub use camera::Camera;
pub use displaced::{Twist, Velocity};
pub use element::Element;
pub use error::{Place, SceneError};
pub use files::{COPIES, Referenced};
pub use known::Known;
pub use laser::{Laser, Profile, Spot};
pub use material::Material;
pub use parameter::Parameter;
pub use parse::read_toml;
pub use quantity::Quantity;
pub use sensor::{Glare, MOST_BRACKETS, SensorModel, SensorSettings, Spread};
pub use surface::{Division, Role, Surface};
pub use texture::{
    AlbedoTable, Bilinear, Cells, Filter, PictureChannel, Texture, VariedTable, Wrap,
};
pub use unit::Unit;
pub use warning::Warning;

use crate::geometry::Bvh;
use error::{Fault, keys};
use file::SceneFile;
use files::{Files, Folders};

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
    /// The text that the scene was read from.
    pub text: String,
    /// The files that it names.
    pub files: Vec<Referenced>,
    /// SHA-256 (hex) of the scene's content: comments and spelling of numbers do not change it.
    pub hash: String,
    bvh: Bvh,
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
        let file = parse::parse(source, text)?;
        Self::assemble(&file, text, files).map_err(|fault| parse::locate(source, text, fault))
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
        let bvh = surface::bvh(&surfaces)?;
        let laser = match (Laser::of_shining(file, &mut surfaces)?, &file.laser) {
            (Some(shining), _) => shining,
            (None, Some(table)) => Laser::from_table(table, &surfaces)?,
            (None, None) => {
                let cause = "nothing gives light: there is no [laser] table, and no surface shines";
                let cure =
                    "add [laser], or let a hidden surface shine: `material = { shining = … }`";
                return Err(Fault::new(keys![], cause, cure));
            }
        };
        let camera = Camera::from_table(&file.camera, &surfaces)?;
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

    /// The hidden surfaces with their shape ids, in file order.
    pub fn hidden(&self) -> impl Iterator<Item = (usize, &Surface)> {
        surface::of_role(Role::Hidden, &self.surfaces)
    }

    /// The hidden surfaces of unknown albedo, by name, in quotes and separated by commas; none where
    /// every albedo is known.
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

/// SHA-256 (hex) of what the light depends on: the tables, and the bytes of the files they name.
fn content_hash(file: &SceneFile, files: &[Referenced]) -> Result<String, Fault> {
    let unfinite =
        |e: serde_json::Error| Fault::new(keys![], e.to_string(), "use finite numbers only");
    let json = serde_json::to_vec(&file.of_the_light()).map_err(unfinite)?;
    let mut digest = Sha256::new_with_prefix(json);
    for file in files {
        digest.update(&file.digest);
    }
    Ok(crate::store::hex(&digest.finalize()))
}
