//! Triangle meshes.

mod area_map;
mod facets;
mod group;
mod nearest;
mod patch;
mod query;

use super::tree::WideTree;
use super::{DVec3, Interaction, Intersection, Ray};
use crate::num::lanes::widest;
use area_map::AreaMap;
pub use facets::{Facet, Facets};
use group::{GROUP, Group};
pub use patch::Patch;
use query::{Any, Closest};

/// Coordinates beyond this (in scene units) are refused.
const LARGEST: f64 = 1e12;
/// Most triangles of a mesh.
const MOST: usize = 1 << 30;

/// Why triangles make no mesh.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum MeshError {
    /// A vertex is not finite or far outside any bench.
    #[error(
        "vertex {vertex} reaches to {reach:e}: coordinates must be finite and below 1e12 (choose a larger unit)"
    )]
    Unbounded {
        /// Its place in the list.
        vertex: usize,
        /// Largest coordinate.
        reach: f64,
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} names vertex {vertex} of {count}: vertices are counted from 0")]
    NoVertex {
        /// The triangle's place in the list.
        triangle: usize,
        /// What it names.
        vertex: u32,
        /// Number of vertices.
        count: usize,
    },
    /// No triangle has an area.
    #[error("none of the {count} triangles has an area: give a mesh at least one proper triangle")]
    Empty {
        /// Number of triangles.
        count: usize,
    },
    /// Texture coordinates for another number of triangles.
    #[error("{given} triples of texture coordinates for {triangles} triangles: give one to each")]
    Coordinates {
        /// Triples given.
        given: usize,
        /// Number of triangles.
        triangles: usize,
    },
    /// More triangles than can be numbered.
    #[error("{count} triangles are more than 2³⁰: split the mesh")]
    TooMany {
        /// Number of triangles.
        count: usize,
    },
}

/// A surface of triangles, opaque from both sides, its front where the corners of a triangle run
/// counterclockwise.
///
/// Triangles without area (|e₁ × e₂| below 1e-12·|e₁||e₂|) are kept in the list and met by nothing.
/// Two triangles with a common edge leave no gap there: the test of the edge is one and the same
/// number in both.
#[derive(Clone)]
pub struct Mesh {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// By triangle and corner.
    uv: Option<Vec<[[f64; 2]; 3]>>,
    bounds: (DVec3, DVec3),
    /// What it is in its texture coordinates, if that is a parallelogram.
    patch: Option<Patch>,
    area_map: AreaMap,
    tree: WideTree,
    groups: Vec<Group>,
}

impl std::fmt::Debug for Mesh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Mesh({} triangles)", self.triangles.len())
    }
}

impl Mesh {
    /// The mesh of the given vertices and of the triangles between them.
    ///
    /// # Errors
    /// [`MeshError`] for coordinates that are not finite or beyond 1e12, for a vertex that is not
    /// there, for more than 2³⁰ triangles and if no triangle has an area.
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        let reach = |p: &DVec3| {
            if p.is_nan() {
                f64::NAN
            } else {
                p.abs().max_element()
            }
        };
        let far = |p: &DVec3| !p.is_finite() || reach(p) > LARGEST;
        if let Some(vertex) = positions.iter().position(far) {
            let reach = reach(&positions[vertex]);
            return Err(MeshError::Unbounded { vertex, reach });
        }
        let count = positions.len();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|c| **c as usize >= count) {
                return Err(MeshError::NoVertex {
                    triangle,
                    vertex,
                    count,
                });
            }
        }
        let count = triangles.len();
        if count > MOST {
            return Err(MeshError::TooMany { count });
        }
        let corners = |i: u32| triangles[i as usize].map(|c| positions[c as usize]);
        let proper: Vec<u32> = (0..count as u32)
            .filter(|i| is_proper(corners(*i)))
            .collect();
        let boxes: Vec<(DVec3, DVec3)> = proper
            .iter()
            .map(|i| {
                let [a, b, c] = corners(*i);
                (a.min(b).min(c), a.max(b).max(c))
            })
            .collect();
        let Some(bounds) = boxes
            .iter()
            .copied()
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
        else {
            return Err(MeshError::Empty { count });
        };
        let mut groups: Vec<Group> = Vec::new();
        let tree = WideTree::new(&boxes, GROUP as u32, |members| {
            let first = groups.len();
            groups.extend(members.chunks(GROUP).map(|chunk| {
                let named = chunk.iter().map(|m| proper[*m as usize]);
                Group::new(named.map(|i| (i, corners(i))))
            }));
            if let Some(group) = groups.last_mut() {
                group.last = true;
            }
            first as u32
        });
        let mut areas = vec![0.0; triangles.len()];
        for &i in &proper {
            areas[i as usize] = 0.5 * cross(corners(i)).length();
        }
        let (low, high) = bounds;
        let side = (high - low).max_element();
        let area_map = AreaMap::new(&areas, |i| {
            let [a, b, c] = corners(i);
            (a - low + (b - low) + (c - low)) / side
        });
        Ok(Self {
            positions,
            triangles,
            uv: None,
            bounds,
            patch: None,
            area_map,
            tree,
            groups,
        })
    }

    /// The same mesh with texture coordinates by triangle and corner, v growing upwards in the
    /// picture.
    ///
    /// # Errors
    /// [`MeshError::Coordinates`] if there are not as many as triangles.
    pub fn with_uv(self, uv: Vec<[[f64; 2]; 3]>) -> Result<Self, MeshError> {
        if uv.len() != self.triangles.len() {
            return Err(MeshError::Coordinates {
                given: uv.len(),
                triangles: self.triangles.len(),
            });
        }
        let textured = Self {
            uv: Some(uv),
            ..self
        };
        let patch = patch::of(&textured);
        Ok(Self { patch, ..textured })
    }

    /// The patch corner + u·a + v·b that the mesh is, (u, v) its texture coordinates, if it is one
    /// to 1e-6 of its size.
    pub fn patch(&self) -> Option<&Patch> {
        self.patch.as_ref()
    }

    /// Texture coordinates by triangle and corner, if the mesh has any.
    pub fn uv(&self) -> Option<&[[[f64; 2]; 3]]> {
        self.uv.as_deref()
    }

    /// The vertices.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The triangles, each three vertices.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Smallest axis-aligned box: lower and upper corner.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        self.bounds
    }

    /// Σ ½|(b − a) × (c − a)|, length².
    pub fn area(&self) -> f64 {
        self.area_map.area()
    }

    /// The area of one triangle.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn triangle_area(&self, triangle: u32) -> f64 {
        0.5 * cross(self.corners(triangle)).length()
    }

    /// The corners of a triangle.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|c| self.positions[c as usize])
    }

    /// The point of a triangle with the given weights of the second and the third corner. Its
    /// parameters are texture coordinates where the mesh has them, else (0, 0).
    fn point(&self, triangle: u32, [v, w]: [f64; 2]) -> Interaction {
        let [a, b, c] = self.corners(triangle);
        let uv = self.uv.as_ref().map_or([0.0; 2], |uv| {
            let [p, q, r] = uv[triangle as usize];
            [0, 1].map(|d| p[d] + (q[d] - p[d]) * v + (r[d] - p[d]) * w)
        });
        Interaction {
            position: a + (b - a) * v + (c - a) * w,
            normal: cross([a, b, c]).normalize(),
            uv,
        }
    }

    /// The point of a triangle nearest to `p`.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn on_triangle(&self, triangle: u32, p: DVec3) -> Interaction {
        let (_, weights) = nearest::on_triangle(self.corners(triangle), p);
        self.point(triangle, weights)
    }

    /// An equal-area map of the unit square to the mesh: u chooses the triangle, in proportion to
    /// its area and those near each other one after the other, and what is left of it places the
    /// point there together with v.
    pub fn at(&self, uv: [f64; 2]) -> Interaction {
        let (triangle, weights) = self.area_map.point(uv);
        self.point(triangle, weights)
    }

    /// Edges along u that divide the mesh into about `parts` parts: the larger triangles of a mesh
    /// of few, many together of one of many.
    pub fn edges(&self, parts: usize) -> Vec<f64> {
        let count = self.triangles.len();
        if count > parts {
            return (0..=parts).map(|k| k as f64 / parts as f64).collect();
        }
        self.area_map.edges(parts, parts.div_ceil(count))
    }

    /// Points whose convex hull holds what [`Mesh::at`] gives between `low` and `high`.
    pub fn hull(&self, low: [f64; 2], high: [f64; 2]) -> impl Iterator<Item = DVec3> {
        let points = self.area_map.hull(low, high);
        points.map(|(triangle, [v, w])| {
            let [a, b, c] = self.corners(triangle);
            a + (b - a) * v + (c - a) * w
        })
    }

    /// The parameters for which [`Mesh::at`] gives the point of a triangle that is nearest to `p`.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn parameters(&self, triangle: u32, p: DVec3) -> [f64; 2] {
        let (_, weights) = nearest::on_triangle(self.corners(triangle), p);
        self.area_map.inverse(triangle, weights)
    }

    /// The place of a triangle with the given weights of the second and the third corner.
    pub fn place(&self, triangle: u32, [v, w]: [f64; 2]) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        a + (b - a) * v + (c - a) * w
    }

    /// The point of the mesh nearest to `p`, and its triangle; of triangles equally near the first.
    pub fn at_position(&self, p: DVec3) -> (u32, Interaction) {
        let mut best = (f64::INFINITY, u32::MAX, [0.0; 2]);
        self.tree.around(p, |leaf| {
            for group in self.leaf(leaf) {
                for (triangle, corners) in group.members() {
                    let (distance, uv) = nearest::on_triangle(corners, p);
                    if distance < best.0 || (distance == best.0 && triangle < best.1) {
                        best = (distance, triangle, uv);
                    }
                }
            }
            best.0
        });
        let (_, triangle, weights) = best;
        (triangle, self.point(triangle, weights))
    }

    /// First triangle met by the ray at 0 < t < length, from either side. A ray that starts in the
    /// plane of a triangle (to rounding) does not meet it. Where two are met at one distance, the
    /// first of the list counts.
    pub fn closest(&self, ray: &Ray) -> Option<Intersection> {
        self.closest_many(std::slice::from_ref(ray))[0]
    }

    /// [`Mesh::closest`] for many rays: much faster than one by one where the mesh is large.
    pub fn closest_many(&self, rays: &[Ray]) -> Vec<Option<Intersection>> {
        self.closest_of(rays, 0.0)
    }

    /// [`Mesh::closest`] for a ray whose start was computed from numbers as large as `reach`, and
    /// has their rounding.
    pub(super) fn closest_beyond(&self, ray: &Ray, reach: f64) -> Option<Intersection> {
        self.closest_of(std::slice::from_ref(ray), reach)[0]
    }

    fn closest_of(&self, rays: &[Ray], reach: f64) -> Vec<Option<Intersection>> {
        let mut found = vec![None; rays.len()];
        widest(
            #[inline(always)]
            || {
                self.tree
                    .traverse(rays, &Closest(self, reach), |i, (_, hit)| found[i] = hit);
            },
        );
        found
    }

    /// Whether a triangle stands between the two ends of the segment. A segment that starts or ends
    /// in the plane of a triangle (to rounding) is not cut by it.
    pub fn blocks(&self, segment: &Ray) -> bool {
        self.blocks_beyond(segment, 0.0)
    }

    /// [`Mesh::blocks`] for many segments: much faster than one by one where the mesh is large.
    pub fn blocks_many(&self, segments: &[Ray]) -> Vec<bool> {
        self.blocks_many_beyond(segments, 0.0)
    }

    /// [`Mesh::blocks_many`] for segments whose ends were computed from numbers as large as
    /// `reach`, and have their rounding.
    pub(super) fn blocks_many_beyond(&self, segments: &[Ray], reach: f64) -> Vec<bool> {
        let mut found = vec![false; segments.len()];
        self.ask(segments, reach, |i, hit| found[i] = hit);
        found
    }

    /// The same for one segment, without a list.
    pub(super) fn blocks_beyond(&self, segment: &Ray, reach: f64) -> bool {
        let mut found = false;
        self.ask(std::slice::from_ref(segment), reach, |_, hit| found = hit);
        found
    }

    /// Tells of each segment whether a triangle stands in it.
    fn ask(&self, segments: &[Ray], reach: f64, mut tell: impl FnMut(usize, bool)) {
        widest(
            #[inline(always)]
            || {
                self.tree
                    .traverse(segments, &Any(self, reach), |i, (_, hit)| tell(i, hit));
            },
        );
    }

    /// The groups of a leaf.
    fn leaf(&self, first: u32) -> impl Iterator<Item = &Group> {
        let groups = &self.groups[first as usize..];
        let more = groups.iter().take_while(|g| !g.last).count();
        groups[..=more].iter()
    }
}

/// Twice the area along the front's normal.
fn cross([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Whether a triangle has an area beyond rounding.
pub(crate) fn is_proper([a, b, c]: [DVec3; 3]) -> bool {
    let area = cross([a, b, c]).length();
    area > 0.0 && area > 1e-12 * (b - a).length() * (c - a).length()
}

#[cfg(test)]
mod tests;
