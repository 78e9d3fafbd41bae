//! Meshes of a scene: read or made, mended, placed.

use std::collections::HashMap;
use std::sync::Arc;

use super::error::{Fault, Step, keys};
use super::file::{MeshTable, ScaleTable};
use super::files::{Files, LARGEST};
use super::mesh::{self, Defects, Generator, Triangles};
use super::room::refuse_larger;
use super::surface::Surface;
use crate::geometry::{DAffine3, DQuat, DVec3, Instance, Mesh, Shape, Side};

/// Triangles of a mesh that phicam makes, unless the scene says how many.
const FACES: u64 = 20_000;
/// More are not made, of all meshes of a scene together.
const MOST_FACES: u64 = 20_000_000;

/// Bytes that a triangle takes while its mesh is made, upper bound: as it is read or made, its box
/// and its share of the trees over the boxes. Measured: 550 of a bust, 460 of a square.
const FACE: f64 = 640.0;
/// Bytes that a byte of a mesh file takes while it is read.
const READ: f64 = 8.0;

/// What meshes share: two surfaces that name one mesh at one stretch use one copy, and one tree.
#[derive(Debug, Default)]
pub(super) struct Meshes {
    made: HashMap<String, Made>,
    /// Triangles that phicam was asked to make.
    faces: u64,
}

/// A mesh, and what its file says besides.
#[derive(Clone, Debug)]
struct Made {
    mesh: Arc<Mesh>,
    told: Told,
}

/// What is told of a mesh.
#[derive(Clone, Debug)]
pub(super) struct Told {
    pub defects: Defects,
    /// Its first face without texture coordinates, where others have them.
    pub bare: Option<String>,
    /// What its file says of colours.
    pub paint: Option<String>,
}

impl Meshes {
    /// The mesh of a table, in its place; `earlier` are the surfaces that it may stand on.
    pub(super) fn place(
        &mut self,
        table: &MeshTable,
        earlier: &[Surface],
        files: &mut Files,
    ) -> Result<(Instance, Told), Fault> {
        let scale = match table.scale.unwrap_or(ScaleTable::Uniform(1.0)) {
            ScaleTable::Uniform(s) => [s; 3],
            ScaleTable::Axes(s) => s,
        };
        if scale.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
            let cause = format!("a mesh cannot be scaled by {scale:?}");
            return Err(Fault::new(keys!["scale"], cause, "use factors above 0"));
        }
        // A similarity is left to the body; a stretch changes the mesh.
        let [sx, sy, sz] = scale;
        let (uniform, stretch) = if sx == sy && sy == sz {
            (sx, None)
        } else {
            (1.0, Some(DVec3::from_array(scale)))
        };
        let Made { mesh, mut told } = self.mesh(table, stretch, files)?;
        let mut turned = DAffine3::from_scale(DVec3::splat(uniform));
        for (i, r) in table.rotate.iter().flatten().enumerate() {
            let axis = DVec3::from_array(r.axis).try_normalize();
            let (Some(axis), true) = (axis, r.angle.is_finite()) else {
                let cause = format!("rotation about {:?} by {}", r.axis, r.angle);
                let cure = "give an axis that is not zero and a finite angle in degrees";
                return Err(Fault::new(keys!["rotate", i], cause, cure));
            };
            turned = DAffine3::from_quat(rotation(axis, r.angle)) * turned;
        }
        let shift = self.shift(table, &mesh, &turned, earlier)?;
        let placement = DAffine3::from_translation(shift) * turned;
        let side = if table.flip == Some(true) {
            told.defects = told.defects.turned();
            Side::Inner
        } else {
            Side::Outer
        };
        let body = Instance::new(mesh, placement, side).ok_or_else(|| {
            let cure = "use finite factors, angles and places";
            Fault::new(keys![], "the mesh has no proper place", cure)
        })?;
        Ok((body, told))
    }

    /// Where the turned mesh goes.
    fn shift(
        &self,
        table: &MeshTable,
        mesh: &Mesh,
        turned: &DAffine3,
        earlier: &[Surface],
    ) -> Result<DVec3, Fault> {
        let shift = DVec3::from_array(table.translate.unwrap_or_default());
        if !shift.is_finite() {
            let cause = format!("translate = {:?}", shift.to_array());
            return Err(Fault::new(keys!["translate"], cause, "use finite numbers"));
        }
        let Some(on) = &table.on else {
            return Ok(shift);
        };
        let Some(below) = earlier.iter().find(|s| s.name == on.surface) else {
            let cause = format!("no surface before this one is called `{}`", on.surface);
            let cure = "name a surface that comes earlier in the file";
            return Err(Fault::new(keys!["on", "surface"], cause, cure));
        };
        if on.at.iter().any(|c| !(0.0..=1.0).contains(c)) {
            let cause = format!("{:?} is no place on a surface", on.at);
            return Err(Fault::new(
                keys!["on", "at"],
                cause,
                "use two numbers from 0 to 1",
            ));
        }
        if matches!(below.shape, Shape::Instance(_)) {
            let cause = format!(
                "`{}` is a mesh, and has no places by parameters",
                on.surface
            );
            let cure = "put it on a rectangle or a disc, or use `translate`";
            return Err(Fault::new(keys!["on", "surface"], cause, cure));
        }
        let foot = below.shape.at(on.at);
        let (mut low, mut high, mut height) = (DVec3::INFINITY, DVec3::NEG_INFINITY, f64::INFINITY);
        for p in mesh.positions() {
            let p = turned.transform_point3(*p);
            (low, high) = (low.min(p), high.max(p));
            height = height.min(p.dot(foot.normal));
        }
        let middle = 0.5 * (low + high);
        let across = middle - foot.normal * middle.dot(foot.normal);
        Ok(shift + foot.position - across - foot.normal * height)
    }

    fn mesh(
        &mut self,
        table: &MeshTable,
        stretch: Option<DVec3>,
        files: &mut Files,
    ) -> Result<Made, Fault> {
        let key = format!(
            "{:?} {:?} {:?} {:?} {stretch:?}",
            table.file, table.generate, table.mask, table.faces
        );
        if let Some(made) = self.made.get(&key) {
            return Ok(made.clone());
        }
        let (at, mut triangles): (Step, Triangles) = match (
            &table.file,
            table.generate,
            &table.mask,
        ) {
            (Some(file), None, None) => {
                if table.faces.is_some() {
                    let cause = "`faces` belongs to `generate`: a file has the triangles it has";
                    return Err(Fault::new(keys!["faces"], cause, "remove `faces`"));
                }
                (Step::Key("file"), read(file, files)?)
            }
            (None, None, Some(rows)) => {
                if table.faces.is_some() {
                    let cause = "a mask has the triangles of its cells, and no `faces`";
                    return Err(Fault::new(keys!["faces"], cause, "remove `faces`"));
                }
                let fault = |(cause, cure)| Fault::new(keys!["mask"], cause, cure);
                (Step::Key("mask"), mesh::mask(rows).map_err(fault)?)
            }
            (None, Some(generator), None) => (
                Step::Key("generate"),
                self.generate(generator, table.faces)?,
            ),
            _ => {
                let cause = "a mesh needs exactly one of `file`, `generate` and `mask`";
                let cure = "add `file = \"body.ply\"`, `generate = \"bust\"`, or `mask = [\"#.\", \".#\"]`";
                return Err(Fault::new(keys![], cause, cure));
            }
        };
        refuse_faces(triangles.triangles.len()).map_err(|f| f.within([at.clone()]))?;
        for p in &mut triangles.positions {
            *p *= stretch.unwrap_or(DVec3::ONE);
        }
        let (mut triangles, defects) = triangles.mended();
        if triangles.triangles.is_empty() && defects.faces > 0 {
            let cause = format!(
                "none of the {} triangles can be used: {} have a corner that is not there or no finite number, {} no area",
                defects.faces, defects.not_finite, defects.degenerate
            );
            return Err(Fault::new(
                [at.clone()],
                cause,
                "mend the mesh, or use another",
            ));
        }
        let told = Told {
            defects,
            bare: triangles.bare.take(),
            paint: triangles.paint.take(),
        };
        let fault = |e: crate::geometry::MeshError| {
            Fault::new([at.clone()], e.to_string(), "mend the mesh, or use another")
        };
        let mut mesh = Mesh::new(triangles.positions, triangles.triangles).map_err(&fault)?;
        if let Some(uv) = triangles.uv {
            mesh = mesh.with_uv(uv).map_err(&fault)?;
        }
        let mesh = Arc::new(mesh);
        let made = Made { mesh, told };
        self.made.insert(key, made.clone());
        Ok(made)
    }

    fn generate(&mut self, generator: Generator, faces: Option<u64>) -> Result<Triangles, Fault> {
        if generator == Generator::Box && faces.is_some() {
            let cause = "a box has its 12 triangles, and no `faces`";
            return Err(Fault::new(keys!["faces"], cause, "remove `faces`"));
        }
        let usual = if generator == Generator::Box {
            12
        } else {
            FACES
        };
        let faces = faces.unwrap_or(usual);
        self.faces = self.faces.saturating_add(faces);
        if faces == 0 || self.faces > MOST_FACES {
            let cause = format!("{faces} triangles, {} with those before", self.faces);
            let cure = format!("use 1 to {MOST_FACES}, for all meshes of the scene together");
            return Err(Fault::new(keys!["faces"], cause, cure));
        }
        refuse_faces(faces as usize).map_err(|f| f.within(keys!["faces"]))?;
        Ok(generator.triangles(faces as usize))
    }
}

/// Refuses a mesh of so many triangles if it does not fit into memory.
fn refuse_faces(faces: usize) -> Result<(), Fault> {
    let what = format!("a mesh of {faces} triangles");
    refuse_larger(&what, FACE * faces as f64, "use fewer triangles")
}

/// The rotation by `degrees` about a unit vector: q = (axis·sin ½φ, cos ½φ).
pub(super) fn rotation(axis: DVec3, degrees: f64) -> DQuat {
    let (sin, cos) = libm::sincos(0.5 * degrees.to_radians());
    let v = axis * sin;
    DQuat::from_xyzw(v.x, v.y, v.z, cos)
}

fn read(name: &str, files: &mut Files) -> Result<Triangles, Fault> {
    let fault = |(cause, cure): (String, String)| Fault::new(keys!["file"], cause, cure);
    let bytes = files.bytes(name, LARGEST).map_err(fault)?;
    let what = format!("mesh `{name}` of {} bytes", bytes.len());
    refuse_larger(&what, READ * bytes.len() as f64, "use fewer triangles")
        .map_err(|f| f.within(keys!["file"]))?;
    let folder = name.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut beside = |other: &str| {
        let path = match folder {
            "" => other.to_owned(),
            folder => format!("{folder}/{other}"),
        };
        files.bytes_or_words(&path, LARGEST)
    };
    mesh::read(name, &bytes, &mut beside).map_err(|e| {
        Fault::new(
            keys!["file"],
            format!("`{name}`: {e}"),
            "mend the file, or use another",
        )
    })
}
