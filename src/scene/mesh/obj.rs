//! Wavefront OBJ files: `v`, `vt` and `f` (`fo` in old ones); `mtllib` is told, surfaces that are
//! not faces, other files' statements and unknown words are refused, and the statements without any
//! area are read over.
//!
//! Read here and not by `tobj` 4.0.5, which multiplies a texture coordinate's index before it
//! checks it (an overflow that panics or wraps around), gives a corner without texture coordinate
//! the one of the corner before it, and names no lines.

use super::polygon::{self, Early};
use super::{MeshFileError, Triangles, fan, unsupported};
use crate::geometry::DVec3;
use std::str::FromStr;

const CURE: &str = "mend the line, or export the mesh again";

/// Statements without an area (Wavefront's file formats, appendix B1): vertex data, points, lines
/// and curves, what belongs to curves and surfaces, groups, looks.
const WITHOUT_AREA: &str = "vn vp p l curv curv2 cdc cstype deg bmat step parm trim hole scrv sp end \
    con res g s mg o bevel c_interp d_interp lod usemtl mtllib usemap maplib shadow_obj trace_obj ctech \
    stech";

/// The triangles of an OBJ file.
pub(super) fn read(bytes: &[u8]) -> Result<Triangles, MeshFileError> {
    let mut body = Body::default();
    let mut joined = Vec::new();
    // A byte order mark belongs to no statement.
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    for (i, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        if let Some(start) = line.strip_suffix(b"\\") {
            joined.extend_from_slice(start);
            joined.push(b' ');
        } else if joined.is_empty() {
            body.statement(i + 1, line)?;
        } else {
            joined.extend_from_slice(line);
            body.statement(i + 1, &joined)?;
            joined.clear();
        }
    }
    if !joined.is_empty() {
        body.statement(bytes.iter().filter(|b| **b == b'\n').count() + 1, &joined)?;
    }
    body.finish()
}

/// One kind of vertex data.
#[derive(Clone, Copy)]
enum Kind {
    Position,
    Uv,
}

/// What has been read.
#[derive(Default)]
struct Body {
    positions: Vec<DVec3>,
    uvs: Vec<[f64; 2]>,
    triangles: Vec<[u32; 3]>,
    /// By triangle and corner; shorter than `triangles` if a face came without.
    triangle_uvs: Vec<[u32; 3]>,
    /// Corners of the face at hand.
    corners: Vec<(u32, Option<u32>)>,
    /// Largest index of each kind that was named ahead of its definition, and its line.
    ahead: [Option<(u32, usize)>; 2],
    /// Faces that stand before their vertices.
    early: Early,
    /// Line of the first face without texture coordinates.
    bare: Option<usize>,
    /// The first material library.
    library: Option<String>,
}

impl Body {
    /// Takes the statement that ends in line `at`, from 1.
    fn statement(&mut self, at: usize, line: &[u8]) -> Result<(), MeshFileError> {
        let line = line.split(|b| *b == b'#').next().unwrap_or_default();
        let mut words = line
            .split(|b| b.is_ascii_whitespace())
            .filter(|w| !w.is_empty());
        match words.next() {
            Some(b"v") => {
                let [x, y, z] = numbers(at, words, "v x y z")?;
                self.positions.push(DVec3::new(x, y, z));
            }
            Some(b"vt") => {
                // A texture along a line has no v.
                let list: Vec<&[u8]> = words.collect();
                let uv = match list.len() {
                    1 => [numbers::<f64, 1>(at, list.into_iter(), "vt u")?[0], 0.0],
                    _ => numbers(at, list.into_iter(), "vt u v")?,
                };
                self.uvs.push(uv);
            }
            Some(b"f" | b"fo") => self.face(at, words)?,
            Some(b"mtllib") if self.library.is_none() => {
                self.library = Some(quoted(line.trim_ascii()[6..].trim_ascii()));
            }
            Some(word) => read_over(at, word)?,
            None => {}
        }
        Ok(())
    }

    fn face<'a>(
        &mut self,
        at: usize,
        words: impl Iterator<Item = &'a [u8]>,
    ) -> Result<(), MeshFileError> {
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        for word in words {
            let mut parts = word.split(|b| *b == b'/');
            let position = self.index(at, parts.next().unwrap_or_default(), Kind::Position)?;
            let uv = match parts.next() {
                None | Some(b"") => None,
                Some(part) => Some(self.index(at, part, Kind::Uv)?),
            };
            corners.push((position, uv));
        }
        let count = corners.len();
        if count < 3 {
            return Err(malformed(at, format!("{count} corners are no face")));
        }
        if corners.iter().any(|c| c.1.is_none()) {
            self.bare = self.bare.or(Some(at));
        }
        let places = corners.iter().map(|c| self.positions.get(c.0 as usize));
        let places: Option<Vec<DVec3>> = places.map(Option::<&DVec3>::copied).collect();
        let triangles = match places {
            Some(places) => polygon::triangles(&places, || line(at))?,
            None => {
                self.early.push((self.triangles.len(), count - 2, at));
                fan(count)
            }
        };
        for triangle in triangles {
            self.triangles.push(triangle.map(|k| corners[k].0));
            if let [Some(a), Some(b), Some(c)] = triangle.map(|k| corners[k].1) {
                self.triangle_uvs.push([a, b, c]);
            }
        }
        self.corners = corners;
        Ok(())
    }

    /// Divides the faces that stood before their vertices.
    fn divide_early(&mut self) -> Result<(), MeshFileError> {
        let (early, faces) = (&self.early, &mut self.triangles);
        // Where any face has none the coordinates of the others are not used.
        let uvs = self
            .bare
            .is_none()
            .then_some(self.triangle_uvs.as_mut_slice());
        polygon::divide_early(early, &self.positions, faces, uvs, line)
    }

    fn count(&self, kind: Kind) -> usize {
        match kind {
            Kind::Position => self.positions.len(),
            Kind::Uv => self.uvs.len(),
        }
    }

    /// From 1 onwards, or from −1 backwards from the last that was read; here from 0.
    fn index(&mut self, at: usize, word: &[u8], kind: Kind) -> Result<u32, MeshFileError> {
        let count = self.count(kind);
        let Some(index) = parse::<i64>(word) else {
            return Err(malformed(at, format!("`{}` is no corner", quoted(word))));
        };
        let from_zero = match index {
            1.. => Some(index - 1),
            _ => (count as i64).checked_add(index).filter(|i| *i >= 0),
        };
        match from_zero.map(u32::try_from) {
            Some(Ok(found)) if index != 0 => {
                let ahead = &mut self.ahead[kind as usize];
                if found as usize >= count && ahead.is_none_or(|(most, _)| found > most) {
                    *ahead = Some((found, at));
                }
                Ok(found)
            }
            _ => Err(no_vertex(at, kind, index, count)),
        }
    }

    fn finish(mut self) -> Result<Triangles, MeshFileError> {
        for kind in [Kind::Position, Kind::Uv] {
            let count = self.count(kind);
            match self.ahead[kind as usize] {
                Some((most, at)) if most as usize >= count => {
                    return Err(no_vertex(at, kind, i64::from(most) + 1, count));
                }
                _ => {}
            }
        }
        self.divide_early()?;
        let whole = self.bare.is_none();
        let uv = |t: &[u32; 3]| t.map(|c| self.uvs[c as usize]);
        Ok(Triangles {
            uv: whole.then(|| self.triangle_uvs.iter().map(uv).collect()),
            positions: self.positions,
            triangles: self.triangles,
            bare: self.bare.filter(|_| !self.uvs.is_empty()).map(line),
            paint: self.library.map(|name| format!("materials in `{name}`")),
        })
    }
}

/// Refuses a statement whose geometry would be lost.
fn read_over(at: usize, word: &[u8]) -> Result<(), MeshFileError> {
    let name = quoted(word);
    let of = |what: &str| format!("`{name}` in line {at}, {what},");
    match word {
        b"surf" | b"bsp" | b"bzp" | b"cdp" => Err(unsupported(of("a curved surface"), "as faces")),
        b"call" | b"csh" => {
            let what = of("which takes statements from elsewhere");
            Err(unsupported(what, "as one file"))
        }
        _ if WITHOUT_AREA
            .split(' ')
            .any(|known| known.as_bytes() == word) =>
        {
            Ok(())
        }
        _ => Err(malformed(at, format!("`{name}` is no statement of OBJ"))),
    }
}

fn line(at: usize) -> String {
    format!("line {at}")
}

fn parse<T: FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// The first numbers of a statement; more, as weights or colours, are read over.
fn numbers<'a, T: FromStr + Copy + Default, const N: usize>(
    at: usize,
    mut words: impl Iterator<Item = &'a [u8]>,
    form: &str,
) -> Result<[T; N], MeshFileError> {
    let mut found = [T::default(); N];
    for value in &mut found {
        let Some(word) = words.next() else {
            return Err(malformed(at, format!("a number is missing in `{form}`")));
        };
        let Some(number) = parse(word) else {
            return Err(malformed(at, format!("`{}` is no number", quoted(word))));
        };
        *value = number;
    }
    Ok(found)
}

fn quoted(word: &[u8]) -> String {
    String::from_utf8_lossy(word).chars().take(40).collect()
}

fn malformed(at: usize, cause: String) -> MeshFileError {
    MeshFileError::Malformed {
        place: line(at),
        cause,
        cure: CURE,
    }
}

fn no_vertex(at: usize, kind: Kind, index: i64, count: usize) -> MeshFileError {
    MeshFileError::NoVertex {
        place: line(at),
        what: match kind {
            Kind::Position => "vertex",
            Kind::Uv => "texture coordinate",
        },
        index,
        count,
    }
}
