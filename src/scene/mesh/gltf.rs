//! glTF 2.0: `.gltf` with buffers beside it or in it, and `.glb`.
//!
//! The document is read by `gltf-json`, which leaves indices unchecked; the container and the
//! buffers are read here: `gltf` 1.4.1 subtracts a header's length unchecked, allocates what the
//! header says, and takes 82 s of processor time to compile.
//!
//! All triangles of the default scene (the first if none is marked), in the places where its nodes
//! put them; a node that mirrors keeps the front of its triangles. Not read: materials, images,
//! animations; refused: what moves the vertices or repeats a mesh besides, as skins, morph targets
//! of non-zero weight and instances.

mod accessor;
mod buffer;
mod deformed;
mod glb;
mod walk;

use super::{MeshFileError, Triangles, malformed, unsupported};
use crate::geometry::DVec3;
use accessor::Elements;
use buffer::Buffers;
use glam::DMat4;
use gltf_json::Root;
use gltf_json::accessor::Type;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::scene::Node;
use gltf_json::validation::Checked;
use std::collections::BTreeMap;
use walk::Walk;

/// Nodes that share a mesh may multiply vertices and triangles up to this even if the file has
/// fewer bytes.
const MOST_SHARED: u64 = 1 << 22;

/// Reads a file beside the mesh.
pub(super) type Beside<'a> = &'a mut dyn FnMut(&str) -> Result<Vec<u8>, String>;

/// The triangles of a `.gltf` file.
pub(super) fn read(json: &[u8], beside: Beside<'_>) -> Result<Triangles, MeshFileError> {
    assemble(json, None, beside)
}

/// The triangles of a `.glb` file.
pub(super) fn read_binary(bytes: &[u8], beside: Beside<'_>) -> Result<Triangles, MeshFileError> {
    let (json, chunk) = glb::chunks(bytes)?;
    assemble(json, chunk, beside)
}

fn assemble(
    json: &[u8],
    chunk: Option<&[u8]>,
    beside: Beside<'_>,
) -> Result<Triangles, MeshFileError> {
    let root = Root::from_slice(json).map_err(|e| {
        let place = format!("line {} column {} of the JSON", e.line(), e.column());
        malformed(place, e.to_string().chars().take(200).collect::<String>())
    })?;
    refuse_unsupported(&root)?;
    let bytes = json.len() + chunk.map_or(0, <[u8]>::len);
    let mut body = Body {
        buffers: Buffers::new(&root, chunk, beside),
        root: &root,
        bytes: bytes as u64,
        visited: 0,
        made: Triangles::default(),
        uvs: Vec::new(),
    };
    body.scene()?;
    let Body { mut made, uvs, .. } = body;
    made.uv = (uvs.len() == made.triangles.len()).then_some(uvs);
    Ok(made)
}

fn refuse_unsupported(root: &Root) -> Result<(), MeshFileError> {
    let version = &root.asset.version;
    if !version.starts_with("2.") {
        let version: String = version.chars().take(20).collect();
        return Err(unsupported(
            format!("glTF version `{version}`"),
            "as glTF 2.0",
        ));
    }
    // It may be used without being required: who does not know it shows one of the copies.
    let instances = "EXT_mesh_gpu_instancing";
    if root.extensions_used.iter().any(|e| e == instances) {
        let what = format!("extension `{instances}` (copies of one mesh)");
        return Err(unsupported(what, "with its instances made real"));
    }
    // Extensions that leave the shape alone.
    let harmless = [
        "KHR_materials_",
        "KHR_texture_basisu",
        "KHR_lights_",
        "KHR_mesh_quantization",
    ];
    let harmful = |e: &&String| !harmless.iter().any(|h| e.starts_with(h));
    match root.extensions_required.iter().find(harmful) {
        None => Ok(()),
        Some(extension) => {
            let extension: String = extension.chars().take(60).collect();
            Err(unsupported(
                format!("extension `{extension}`"),
                "without it",
            ))
        }
    }
}

/// More primitives are not walked through.
const MOST_VISITED: usize = 1 << 20;

/// What has been read.
struct Body<'a> {
    root: &'a Root,
    buffers: Buffers<'a>,
    /// Length of the file.
    bytes: u64,
    /// Primitives met so far, again for each node that shows them.
    visited: usize,
    made: Triangles,
    /// By triangle and corner; shorter than the triangles if some came without.
    uvs: Vec<[[f64; 2]; 3]>,
}

impl<'a> Body<'a> {
    fn scene(&mut self) -> Result<(), MeshFileError> {
        let at = self.root.scene.map_or(0, |s| s.value());
        let Some(scene) = self.root.scenes.get(at) else {
            return Err(missing(format!("scene {at}"), self.root.scenes.len()));
        };
        let mut walk = Walk::new(self.root, scene)?;
        while let Some((node, placed)) = walk.next()? {
            if let Some(mesh) = node.mesh {
                self.mesh(mesh.value(), node, placed)?;
            }
        }
        Ok(())
    }

    fn mesh(&mut self, at: usize, node: &Node, placed: DMat4) -> Result<(), MeshFileError> {
        let Some(mesh) = self.root.meshes.get(at) else {
            return Err(missing(format!("mesh {at}"), self.root.meshes.len()));
        };
        deformed::refuse(at, mesh, node)?;
        // Primitives of one mesh often share their vertices.
        let mut shared: BTreeMap<usize, u32> = BTreeMap::new();
        for (i, primitive) in mesh.primitives.iter().enumerate() {
            self.visited += 1;
            if self.visited > MOST_VISITED {
                let what = "parts, meshes counted wherever they stand";
                let what = format!("more than {MOST_VISITED} {what}");
                return Err(unsupported(what, "as fewer"));
            }
            let place = format!("mesh {at}, primitive {i}");
            let mode = match primitive.mode {
                Checked::Valid(
                    mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan),
                ) => mode,
                Checked::Valid(_) => continue,
                Checked::Invalid => return Err(malformed(place, "its mode is none of 0 to 6")),
            };
            self.primitive(&place, primitive, mode, placed, &mut shared)?;
        }
        Ok(())
    }

    fn primitive(
        &mut self,
        place: &str,
        primitive: &Primitive,
        mode: Mode,
        placed: DMat4,
        shared: &mut BTreeMap<usize, u32>,
    ) -> Result<(), MeshFileError> {
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic));
        let Some(positions) = attribute(Semantic::Positions) else {
            return Ok(());
        };
        let position = self.elements(positions.value(), Type::Vec3)?;
        let uv = match attribute(Semantic::TexCoords(0)) {
            None => None,
            Some(uv) => Some(self.elements(uv.value(), Type::Vec2)?),
        };
        if primitive.material.is_some() {
            self.made.paint = Some(String::from("materials"));
        }
        if let Some(uv) = &uv
            && uv.count != position.count
        {
            let cause = format!(
                "{} texture coordinates for {} vertices",
                uv.count, position.count
            );
            return Err(malformed(place, cause));
        }
        let first = match shared.get(&positions.value()) {
            Some(first) => *first,
            None => {
                let first = self.made.positions.len();
                self.bound("vertices", first, position.count)?;
                let vertex = |i| placed.transform_point3(DVec3::from_array(position.vector(i)));
                self.made.positions.extend((0..position.count).map(vertex));
                shared.insert(positions.value(), first as u32);
                first as u32
            }
        };
        let indices = match primitive.indices {
            None => (0..position.count as u32).collect(),
            Some(indices) => self.indices(place, indices.value(), position.count)?,
        };
        let corners = corners(place, &indices, mode)?;
        self.bound("triangles", self.made.triangles.len(), corners.len())?;
        let mirrored = placed.determinant() < 0.0;
        for mut triangle in corners {
            if mirrored {
                triangle.swap(1, 2);
            }
            self.made.triangles.push(triangle.map(|c| first + c));
            if let Some(uv) = &uv {
                self.uvs.push(triangle.map(|c| {
                    let [u, v] = uv.vector(c as usize);
                    [u, 1.0 - v]
                }));
            }
        }
        Ok(())
    }

    fn elements(&mut self, at: usize, kind: Type) -> Result<Elements<'a>, MeshFileError> {
        Elements::new(self.root, &mut self.buffers, at, kind)
    }

    /// The indices of a primitive, each below `count`.
    fn indices(&mut self, place: &str, at: usize, count: usize) -> Result<Vec<u32>, MeshFileError> {
        let elements = self.elements(at, Type::Scalar)?;
        let indices = elements.indices(&format!("accessor {at}"))?;
        match indices.iter().position(|i| *i as usize >= count) {
            None => Ok(indices),
            Some(k) => Err(MeshFileError::NoVertex {
                place: format!("{place}, index {k} (counted from 0)"),
                what: "vertex",
                index: i64::from(indices[k]),
                count,
            }),
        }
    }

    /// Nodes that share a mesh could make a small file large.
    fn bound(&self, what: &'static str, made: usize, more: usize) -> Result<(), MeshFileError> {
        let most = MOST_SHARED
            .max(self.bytes + self.buffers.read_beside())
            .min(u64::from(u32::MAX));
        let count = made as u64 + more as u64;
        if count <= most {
            Ok(())
        } else {
            Err(MeshFileError::TooMany { what, count, most })
        }
    }
}

/// Three vertices for each triangle, as the mode says (glTF 2.0, section 3.7.2.1).
fn corners(place: &str, indices: &[u32], mode: Mode) -> Result<Vec<[u32; 3]>, MeshFileError> {
    let strip = |(i, w): (usize, &[u32])| match i % 2 {
        0 => [w[0], w[1], w[2]],
        _ => [w[0], w[2], w[1]],
    };
    let fan = |w: &[u32]| [w[0], w[1], indices[0]];
    match mode {
        Mode::TriangleStrip => Ok(indices.windows(3).enumerate().map(strip).collect()),
        Mode::TriangleFan => {
            let rest = indices.get(1..).unwrap_or_default();
            Ok(rest.windows(2).map(fan).collect())
        }
        _ => {
            let (triangles, rest) = indices.as_chunks::<3>();
            if rest.is_empty() {
                return Ok(triangles.to_vec());
            }
            let cause = format!("{} corners do not make whole triangles", indices.len());
            Err(malformed(place, cause))
        }
    }
}

fn missing(what: String, count: usize) -> MeshFileError {
    malformed(what, format!("there are {count} (counted from 0)"))
}
