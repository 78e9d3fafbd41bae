//! Triangle meshes from files: PLY (ASCII and binary), Wavefront OBJ and glTF 2.0 (`.gltf` and
//! `.glb`).
//!
//! What a file announces is compared with the bytes that follow before memory is taken for it,
//! every index is checked, and a broken file ends in a [`MeshFileError`]. What is wrong with the
//! surface itself, as open edges or faces given twice, is counted by [`Defects`]; a vertex that is
//! not a number is such a defect and no error.
//!
//! Coordinates are taken as they stand: neither unit nor axes are changed.

mod bust;
mod defects;
mod generator;
mod gltf;
mod grid;
mod mask;
mod obj;
mod ply;
mod polygon;
mod write;

pub use bust::bust;
pub use defects::Defects;
pub use generator::Generator;
pub use grid::{cube, rectangle, sphere};
pub use mask::{mask, opaque_runs};
pub use write::{FaceValues, to_ply};

use crate::geometry::DVec3;

/// Triangles as a file gives them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    /// The vertices.
    pub positions: Vec<DVec3>,
    /// The three vertices of each triangle, counterclockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// By triangle and corner, u and v with v growing upwards; only where the file gives them for
    /// every corner.
    pub uv: Option<Vec<[[f64; 2]; 3]>>,
    /// The first face without them, where others have some.
    pub bare: Option<String>,
    /// What the file says of colours, none of which is read.
    pub paint: Option<String>,
}

/// Why a file gives no triangles.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum MeshFileError {
    /// The name does not tell the format.
    #[error(
        "its name ends in none of .ply, .obj, .gltf and .glb: convert `{name}` to one of these formats, or rename it after its own"
    )]
    UnknownFormat {
        /// The file.
        name: String,
    },
    /// The content is not what the name says.
    #[error(
        "`{name}` does not start as a {format} file does: rename the file after its format, or export it again"
    )]
    NotTheFormat {
        /// The file.
        name: String,
        /// What its name says.
        format: &'static str,
    },
    /// More is announced than the file can hold.
    #[error(
        "{what} needs at least {least} bytes and {left} are there: the file was cut short or its header is wrong, export it again"
    )]
    CutShort {
        /// What is announced.
        what: String,
        /// Bytes that it takes at least.
        least: u128,
        /// Bytes of the file that are there for it.
        left: usize,
    },
    /// A place in the file that cannot be understood.
    #[error("{place}: {cause}: {cure}")]
    Malformed {
        /// Line or element.
        place: String,
        /// What is wrong.
        cause: String,
        /// What to do about it.
        cure: &'static str,
    },
    /// A face names what is not there.
    #[error("{place} names {what} {index} of {count}: export the mesh again")]
    NoVertex {
        /// Line or face.
        place: String,
        /// Vertex or texture coordinate.
        what: &'static str,
        /// What it names, as the file counts.
        index: i64,
        /// How many there are.
        count: usize,
    },
    /// A buffer that is not in the mesh's folder.
    #[error(
        "buffer `{uri}` lies outside the mesh's folder: put it beside the mesh and name it relative to it, without `..`, or save as .glb"
    )]
    Outside {
        /// What the file names.
        uri: String,
    },
    /// A buffer that could not be read.
    #[error("buffer `{uri}`: {cause}: put the file beside the mesh, or save as .glb")]
    Buffer {
        /// What the file names.
        uri: String,
        /// Why not.
        cause: String,
    },
    /// The format's own extension or a feature that this reader lacks.
    #[error("{what} is not supported: export the mesh {cure}")]
    Unsupported {
        /// What.
        what: String,
        /// How to export it instead.
        cure: &'static str,
    },
    /// Nothing to see.
    #[error("the file has no faces: export a mesh, not a cloud of points or lines")]
    NoFaces,
    /// More than can be numbered or held.
    #[error("{count} {what} are more than {most}: split the mesh")]
    TooMany {
        /// Vertices or triangles.
        what: &'static str,
        /// How many.
        count: u64,
        /// How many are taken.
        most: u64,
    },
}

/// The triangles of a mesh file. The end of `name` decides the format; `beside` reads a file that
/// the mesh names relative to its own folder (buffers of a `.gltf`) and is never asked for anything
/// that leads out of it by its name. Faces with more than three corners are divided into triangles,
/// concave ones too; those that are not flat (to a thousandth of their size) or whose sides cross
/// are refused. Materials, images, normals and colours are not read.
///
/// # Errors
/// [`MeshFileError`] with cause and cure.
pub fn read(
    name: &str,
    bytes: &[u8],
    beside: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<Triangles, MeshFileError> {
    let extension = name.rsplit_once('.').map(|(_, e)| e.to_ascii_lowercase());
    let expect = |starts: bool, format| {
        if starts {
            Ok(())
        } else {
            Err(MeshFileError::NotTheFormat {
                name: name.to_owned(),
                format,
            })
        }
    };
    let triangles = match extension.as_deref() {
        Some("ply") => {
            expect(bytes.starts_with(b"ply"), "PLY")?;
            ply::read(bytes)?
        }
        Some("obj") => {
            expect(!bytes.contains(&0), "Wavefront OBJ")?;
            obj::read(bytes)?
        }
        Some("gltf") => {
            let first = bytes.iter().find(|b| !b.is_ascii_whitespace());
            expect(first == Some(&b'{'), "glTF")?;
            gltf::read(bytes, beside)?
        }
        Some("glb") => {
            expect(bytes.starts_with(b"glTF"), "binary glTF")?;
            gltf::read_binary(bytes, beside)?
        }
        _ => {
            return Err(MeshFileError::UnknownFormat {
                name: name.to_owned(),
            });
        }
    };
    if triangles.triangles.is_empty() {
        return Err(MeshFileError::NoFaces);
    }
    Ok(triangles)
}

/// A place that another export of the mesh may mend.
fn malformed(place: impl Into<String>, cause: impl Into<String>) -> MeshFileError {
    MeshFileError::Malformed {
        place: place.into(),
        cause: cause.into(),
        cure: "export the mesh again",
    }
}

fn unsupported(what: String, cure: &'static str) -> MeshFileError {
    MeshFileError::Unsupported { what, cure }
}

/// The fan of a face with `corners` corners: right where it is convex, and what stands in for it
/// until its vertices are known.
fn fan(corners: usize) -> Vec<[usize; 3]> {
    (2..corners).map(|k| [0, k - 1, k]).collect()
}

#[cfg(test)]
mod tests;
