//! PLY files, read by `ply-rs-bw`.
//!
//! The crate reads elements one after the other and bounds what it allocates ahead. It counts to
//! what the header announces even if an element has no properties, and keeps the last of two
//! properties with one name: both are refused here, and so is a count that the bytes which follow
//! cannot hold.

mod element;

use super::polygon::{self, Early};
use super::{MeshFileError, Triangles, fan, malformed, unsupported};
use crate::geometry::DVec3;
use element::{Face, Skipped, Vertex};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyAccess, PropertyType, ScalarType};

/// Elements read at once: what bounds the memory that they take before they are triangles.
const CHUNK: usize = 4096;

/// The triangles of a PLY file: elements `vertex` (x, y, z and, if there, s t, u v or texture_u
/// texture_v) and `face` (vertex_indices or vertex_index and, if there, texcoord: u and v by
/// corner).
pub(super) fn read(bytes: &[u8]) -> Result<Triangles, MeshFileError> {
    let mut reader = Reader::new(bytes);
    let header = Parser::<Skipped>::new()
        .read_header(&mut reader)
        .map_err(|e| unreadable(String::from("header"), &e))?;
    let length = bytes.len() - reader.get_ref().len();
    refuse_twins(&bytes[..length], &header)?;
    let mut body = Body::default();
    for element in header.elements.values() {
        match element.name.as_str() {
            "vertex" => {
                require(element, &["x", "y", "z"])?;
                each::<Vertex>(&mut reader, element, &header, |_, v| body.vertex(&v))?;
            }
            "face" => each::<Face>(&mut reader, element, &header, |i, f| body.face(i, f))?,
            "tristrips" | "trifans" if element.count > 0 => {
                let what = format!(
                    "a surface in strips or fans of triangles (`{}`)",
                    element.name
                );
                return Err(unsupported(what, "as faces, each with its own corners"));
            }
            _ => each::<Skipped>(&mut reader, element, &header, |_, _| Ok(()))?,
        }
    }
    let mut elements = header.elements.values();
    let is_painted = elements.any(|e| {
        let is_colour = |p: &&str| e.properties.contains_key(*p);
        ["red", "diffuse_red"].iter().any(is_colour)
    });
    Ok(Triangles {
        paint: is_painted.then(|| String::from("colours")),
        ..body.finish()?
    })
}

/// Reads an element and hands each instance on with its place from 0.
fn each<E: PropertyAccess>(
    reader: &mut Reader<&[u8]>,
    element: &ElementDef,
    header: &Header,
    mut found: impl FnMut(usize, E) -> Result<(), MeshFileError>,
) -> Result<(), MeshFileError> {
    let left = reader.get_ref().len();
    let one = least_bytes(element, header.encoding);
    if element.count > 0 && one == 0 {
        return Err(MeshFileError::Malformed {
            place: format!("header, element `{}`", element.name),
            cause: format!("{} of them without a property", element.count),
            cure: "remove the element",
        });
    }
    let least = one as u128 * element.count as u128;
    // The last line of a text need not end.
    if least > left as u128 + 1 {
        return Err(MeshFileError::CutShort {
            what: format!("{} × `{}` of the header", element.count, element.name),
            least,
            left,
        });
    }
    let parser = Parser::<E>::new();
    let mut chunk = element.clone();
    for first in (0..element.count).step_by(CHUNK) {
        chunk.count = CHUNK.min(element.count - first);
        let last = first + chunk.count - 1;
        let place = || format!("`{}` {first} to {last} (counted from 0)", element.name);
        let read = parser.read_payload_for_element(reader, &chunk, header);
        let instances = read.map_err(|e| unreadable(place(), &e))?;
        for (i, instance) in instances.into_iter().enumerate() {
            found(first + i, instance)?;
        }
    }
    Ok(())
}

/// Bytes that one instance takes at least; in a text a digit and a separator for each property.
fn least_bytes(element: &ElementDef, encoding: Encoding) -> usize {
    let size = |t: &ScalarType| match t {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    let properties = element.properties.values();
    properties
        .map(|p| match (encoding, &p.data_type) {
            (Encoding::Ascii, _) => 2,
            (_, PropertyType::Scalar(t) | PropertyType::List(t, _)) => size(t),
        })
        .sum()
}

/// The crate's header keeps one of several elements or properties of one name; what follows would
/// then be read at the wrong places.
fn refuse_twins(text: &[u8], header: &Header) -> Result<(), MeshFileError> {
    let lines = |start: &[u8]| {
        let lines = text.split(|b| *b == b'\n');
        lines.filter(|l| l.starts_with(start)).count()
    };
    let properties: usize = header.elements.values().map(|e| e.properties.len()).sum();
    if lines(b"element") == header.elements.len() && lines(b"property") == properties {
        return Ok(());
    }
    let cause = "an element or a property is named twice";
    Err(malformed("header", cause))
}

fn require(element: &ElementDef, names: &[&str]) -> Result<(), MeshFileError> {
    match names.iter().find(|n| !element.properties.contains_key(**n)) {
        None => Ok(()),
        Some(missing) => Err(malformed(
            format!("header, element `{}`", element.name),
            format!("there is no property `{missing}`"),
        )),
    }
}

/// The crate's error on one line, cut where it quotes a long one.
fn unreadable(place: String, error: &ParseError) -> MeshFileError {
    let words: Vec<String> = error
        .to_string()
        .split_whitespace()
        .take(40)
        .map(|w| w.chars().take(40).collect())
        .collect();
    malformed(place, words.join(" "))
}

/// What has been read.
#[derive(Default)]
struct Body {
    positions: Vec<DVec3>,
    by_vertex: Vec<[f64; 2]>,
    triangles: Vec<[u32; 3]>,
    by_corner: Vec<[[f64; 2]; 3]>,
    /// The largest vertex that a face names, and that face.
    largest: Option<(i64, usize)>,
    /// Faces that stand before their vertices.
    early: Early,
    /// The first face without texture coordinates, where there are any.
    bare: Option<usize>,
}

impl Body {
    fn vertex(&mut self, vertex: &Vertex) -> Result<(), MeshFileError> {
        self.positions.push(DVec3::from_array(vertex.position));
        if let [Some(u), Some(v)] = vertex.uv {
            self.by_vertex.push([u, v]);
        }
        Ok(())
    }

    fn face(&mut self, at: usize, face: Face) -> Result<(), MeshFileError> {
        let refuse = |cause: String| Err(malformed(face_at(at), cause));
        let Some(corners) = face.corners else {
            return refuse(String::from(
                "there is no list `vertex_indices` of integers",
            ));
        };
        let count = corners.len();
        if count < 3 {
            return refuse(format!("{count} corners are no face"));
        }
        if !face.uv.is_empty() && face.uv.len() != 2 * count {
            let numbers = face.uv.len();
            return refuse(format!(
                "{numbers} numbers in `texcoord` for {count} corners"
            ));
        }
        for &corner in &corners {
            if self.largest.is_none_or(|(l, _)| corner > l) {
                self.largest = Some((corner, at));
            }
            if !(0..=i64::from(u32::MAX)).contains(&corner) {
                return Err(self.no_vertex(corner, at));
            }
        }
        if face.uv.is_empty() {
            self.bare = self.bare.or(Some(at));
        }
        let places = corners.iter().map(|c| self.positions.get(*c as usize));
        let places: Option<Vec<DVec3>> = places.map(Option::<&DVec3>::copied).collect();
        let triangles = match places {
            Some(places) => polygon::triangles(&places, || face_at(at))?,
            None => {
                self.early.push((self.triangles.len(), count - 2, at));
                fan(count)
            }
        };
        for [a, b, c] in triangles {
            self.triangles
                .push([corners[a] as u32, corners[b] as u32, corners[c] as u32]);
            if !face.uv.is_empty() {
                let uv = |k: usize| [face.uv[2 * k], face.uv[2 * k + 1]];
                self.by_corner.push([uv(a), uv(b), uv(c)]);
            }
        }
        Ok(())
    }

    /// Divides the faces that stood before their vertices.
    fn divide_early(&mut self) -> Result<(), MeshFileError> {
        let (early, faces) = (&self.early, &mut self.triangles);
        // Where any face has none the coordinates of the others are not used.
        let uvs = self.bare.is_none().then_some(self.by_corner.as_mut_slice());
        polygon::divide_early(early, &self.positions, faces, uvs, face_at)
    }

    fn no_vertex(&self, index: i64, face: usize) -> MeshFileError {
        MeshFileError::NoVertex {
            place: face_at(face),
            what: "vertex",
            index,
            count: self.positions.len(),
        }
    }

    fn finish(mut self) -> Result<Triangles, MeshFileError> {
        if let Some((largest, face)) = self.largest
            && largest >= self.positions.len() as i64
        {
            return Err(self.no_vertex(largest, face));
        }
        self.divide_early()?;
        let partly = !self.by_corner.is_empty();
        let uv = if partly && self.bare.is_none() {
            Some(self.by_corner)
        } else if !self.by_vertex.is_empty() && self.by_vertex.len() == self.positions.len() {
            let corners = |t: &[u32; 3]| t.map(|c| self.by_vertex[c as usize]);
            Some(self.triangles.iter().map(corners).collect())
        } else {
            None
        };
        Ok(Triangles {
            paint: None,
            positions: self.positions,
            triangles: self.triangles,
            bare: self.bare.filter(|_| partly && uv.is_none()).map(face_at),
            uv,
        })
    }
}

fn face_at(face: usize) -> String {
    format!("face {face} (counted from 0)")
}
