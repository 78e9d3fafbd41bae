//! What is wrong with a surface of triangles.

mod display;

use super::Triangles;
use crate::geometry::{DVec3, is_proper};

/// How many of each kind of defect a mesh has. Vertices at one position count as one vertex, so a
/// seam of the texture is no edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Defects {
    /// Faces of the mesh.
    pub faces: usize,
    /// Faces with a vertex that is not there or not finite. They are in none of the numbers below.
    pub not_finite: usize,
    /// Faces without area: |e₁ × e₂| up to 1e-12·|e₁||e₂|.
    pub degenerate: usize,
    /// Faces between the same three vertices as an earlier one, running the same way around. They
    /// are in none of the numbers below.
    pub duplicate: usize,
    /// The same where they run the other way: the backs of earlier faces.
    pub reverse: usize,
    /// Edges of one face only.
    pub open_edges: usize,
    /// Edges that their two faces run along in the same direction: one of them shows its back where
    /// the other shows its front.
    pub turned_edges: usize,
    /// Edges of more than two faces.
    pub crowded_edges: usize,
    /// Σ a·(b × c)/6 with the origin moved to a vertex, length³: the volume of a closed body whose
    /// faces show their fronts outwards.
    pub signed_volume: f64,
}

/// What becomes of a face.
#[derive(Clone, Copy, PartialEq)]
enum Fate {
    Kept,
    NotFinite,
    Degenerate,
    Duplicate,
    Reverse,
}

/// A position with the bits that sort it, and its vertex.
type Keyed = ([u64; 3], u32);

impl Defects {
    /// Counts the defects of a mesh.
    pub fn of(mesh: &Triangles) -> Self {
        Self::judge(mesh).0
    }

    /// Whether the faces enclose a body: every edge has two faces that run along it in opposite
    /// directions.
    pub fn is_closed(&self) -> bool {
        self.faces > self.not_finite
            && self.open_edges + self.turned_edges + self.crowded_edges == 0
    }

    /// Whether the faces enclose a body and show their backs outwards.
    pub fn is_inside_out(&self) -> bool {
        self.is_closed() && self.signed_volume < 0.0
    }

    /// Whether none was found; an open surface is none, a body inside out is one.
    pub fn is_empty(&self) -> bool {
        let dropped = self.not_finite + self.degenerate + self.duplicate + self.reverse;
        dropped + self.turned_edges + self.crowded_edges == 0 && !self.is_inside_out()
    }

    /// Those of the surface with front and back exchanged.
    pub fn turned(self) -> Self {
        Self {
            signed_volume: -self.signed_volume,
            ..self
        }
    }

    fn judge(mesh: &Triangles) -> (Self, Vec<Fate>) {
        let welded = weld(&mesh.positions);
        let finite: Vec<bool> = mesh.positions.iter().map(|p| p.is_finite()).collect();
        let sound = |t: &[u32; 3]| t.iter().all(|c| finite.get(*c as usize) == Some(&true));
        // A texture coordinate beyond 2²⁴ has no digits left for a place in the picture.
        let places = |uv: &[[f64; 2]; 3]| uv.as_flattened().iter().all(|x| x.abs() < 1.7e7);
        let painted = |i: usize| {
            mesh.uv
                .as_ref()
                .is_none_or(|uv| uv.get(i).is_some_and(places))
        };
        let mut fates: Vec<Fate> = mesh
            .triangles
            .iter()
            .enumerate()
            .map(|(i, t)| {
                if !(sound(t) && painted(i)) {
                    Fate::NotFinite
                } else if is_proper(t.map(|c| mesh.positions[c as usize])) {
                    Fate::Kept
                } else {
                    Fate::Degenerate
                }
            })
            .collect();
        let vertex = |c: u32| welded.get(c as usize).copied().unwrap_or(u32::MAX);
        let corners = |i: usize| mesh.triangles[i].map(vertex);
        let vertices = mesh.positions.len();
        for (later, is_reverse) in twins(vertices, &fates, corners) {
            fates[later as usize] = if is_reverse {
                Fate::Reverse
            } else {
                Fate::Duplicate
            };
        }
        let count = |fate| fates.iter().filter(|f| **f == fate).count();
        let mut found = Self {
            faces: fates.len(),
            not_finite: count(Fate::NotFinite),
            degenerate: count(Fate::Degenerate),
            duplicate: count(Fate::Duplicate),
            reverse: count(Fate::Reverse),
            signed_volume: volume(mesh, &fates),
            ..Self::default()
        };
        found.count_edges(vertices, &fates, corners);
        (found, fates)
    }

    /// Counts the edges of the faces that remain. A face without area but with three vertices still
    /// closes what its neighbours leave open.
    fn count_edges(
        &mut self,
        vertices: usize,
        fates: &[Fate],
        corners: impl Fn(usize) -> [u32; 3],
    ) {
        let edges = || {
            let kept = (0..fates.len()).filter(|i| has_edges(fates[*i], corners(*i)));
            kept.flat_map(|i| {
                let [a, b, c] = corners(i);
                [(a, b), (b, c), (c, a)].map(|(from, to)| {
                    if from < to {
                        (from, u64::from(to) << 1)
                    } else {
                        (to, u64::from(from) << 1 | 1)
                    }
                })
            })
        };
        each_bucket(vertices, edges, |bucket| {
            for edge in bucket.chunk_by(|a, b| a >> 1 == b >> 1) {
                match edge {
                    [_] => self.open_edges += 1,
                    [a, b] if a == b => self.turned_edges += 1,
                    [_, _] => {}
                    _ => self.crowded_edges += 1,
                }
            }
        });
    }
}

impl Triangles {
    /// The mesh without the faces that no geometry can be made of: not finite, without area, or
    /// given twice. Vertices stay, but those that are not finite move to the origin, where no face
    /// is left to use them. The defects are those of the mesh as it was.
    pub fn mended(mut self) -> (Self, Defects) {
        let (found, fates) = Defects::judge(&self);
        let mut keep = fates.iter().map(|f| *f == Fate::Kept);
        self.triangles.retain(|_| keep.next() == Some(true));
        if let Some(uv) = &mut self.uv {
            let mut keep = fates.iter().map(|f| *f == Fate::Kept);
            uv.retain(|_| keep.next() == Some(true));
        }
        for position in &mut self.positions {
            if !position.is_finite() {
                *position = DVec3::ZERO;
            }
        }
        (self, found)
    }
}

/// For each vertex the first vertex at the same position.
fn weld(positions: &[DVec3]) -> Vec<u32> {
    // Adding 0 makes −0 the same as 0.
    let key = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut order: Vec<Keyed> = (0..).zip(positions).map(|(i, p)| (key(*p), i)).collect();
    order.sort_unstable();
    let mut first = vec![0; positions.len()];
    for group in order.chunk_by(|a, b| a.0 == b.0) {
        for (_, vertex) in group {
            first[*vertex as usize] = group[0].1;
        }
    }
    first
}

/// The faces between the same three vertices as an earlier one, and whether they run around them
/// the other way.
fn twins(vertices: usize, fates: &[Fate], corners: impl Fn(usize) -> [u32; 3]) -> Vec<(u32, bool)> {
    let faces = || {
        let kept = (0..fates.len()).filter(|i| has_edges(fates[*i], corners(*i)));
        kept.map(|i| {
            let mut sorted = corners(i);
            sorted.sort_unstable();
            (sorted[0], (sorted[1], sorted[2], i as u32))
        })
    };
    let mut later = Vec::new();
    each_bucket(vertices, faces, |bucket| {
        for twins in bucket.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let first = is_odd(corners(twins[0].2 as usize));
            let reverse = |t: u32| is_odd(corners(t as usize)) != first;
            later.extend(twins[1..].iter().map(|t| (t.2, reverse(t.2))));
        }
    });
    later
}

/// Whether its vertices come in order only after an odd number of exchanges.
fn is_odd([a, b, c]: [u32; 3]) -> bool {
    (u8::from(a > b) + u8::from(b > c) + u8::from(a > c)) % 2 == 1
}

/// Whether a face takes part in the surface's connections.
fn has_edges(fate: Fate, [a, b, c]: [u32; 3]) -> bool {
    match fate {
        Fate::Kept => true,
        Fate::Degenerate => a != b && b != c && c != a,
        Fate::NotFinite | Fate::Duplicate | Fate::Reverse => false,
    }
}

/// Puts items into buckets 0 to `count` − 1 and visits each bucket, sorted: much faster than one
/// sort of all where buckets are small.
fn each_bucket<T: Copy + Default + Ord, I: Iterator<Item = (u32, T)>>(
    count: usize,
    items: impl Fn() -> I,
    mut visit: impl FnMut(&[T]),
) {
    let mut ends = vec![0_usize; count];
    for (bucket, _) in items() {
        ends[bucket as usize] += 1;
    }
    let mut total = 0;
    for end in &mut ends {
        total += std::mem::replace(end, total);
    }
    let mut sorted = vec![T::default(); total];
    for (bucket, item) in items() {
        let end = &mut ends[bucket as usize];
        sorted[*end] = item;
        *end += 1;
    }
    let mut start = 0;
    for end in ends {
        let bucket = &mut sorted[start..end];
        bucket.sort_unstable();
        visit(bucket);
        start = end;
    }
}

fn volume(mesh: &Triangles, fates: &[Fate]) -> f64 {
    let kept = || {
        let faces = mesh.triangles.iter().zip(fates);
        faces.filter(|(_, f)| matches!(f, Fate::Kept | Fate::Degenerate))
    };
    let at = |c: u32| mesh.positions[c as usize];
    let Some(origin) = kept().next().map(|(t, _)| at(t[0])) else {
        return 0.0;
    };
    let six: f64 = kept()
        .map(|(t, _)| {
            let [a, b, c] = t.map(|c| at(c) - origin);
            a.dot(b.cross(c))
        })
        .sum();
    six / 6.0
}
