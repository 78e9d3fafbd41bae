//! Triangle meshes.

mod area_map;
mod error;
mod facets;
mod folds;
mod group;
mod nearest;
mod patch;
mod query;
mod rays;

use std::sync::OnceLock;

use super::tree::WideTree;
use super::{DVec3, Interaction};
use area_map::AreaMap;
pub use error::MeshError;
pub use facets::{Facet, Facets};
use group::{GROUP, Group};
pub use patch::Patch;

/// Coordinates beyond this (in scene units) are refused.
const LARGEST: f64 = 1e12;
/// Most triangles of a mesh.
const MOST: usize = 1 << 30;

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
    /// Once they were asked for.
    folds: OnceLock<Vec<[DVec3; 2]>>,
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
            folds: OnceLock::new(),
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
        let [a, b, c] = self.triangles[triangle as usize];
        let at = |c: u32| self.positions[c as usize];
        [at(a), at(b), at(c)]
    }

    /// The point of a triangle with the given weights of the second and the third corner. Its
    /// parameters are texture coordinates where the mesh has them, else (0, 0).
    fn point(&self, triangle: u32, [v, w]: [f64; 2]) -> Interaction {
        let [a, b, c] = self.corners(triangle);
        let uv = self.uv.as_ref().map_or([0.0; 2], |uv| {
            let [p, q, r] = uv[triangle as usize];
            let at = |d: usize| p[d] + (q[d] - p[d]) * v + (r[d] - p[d]) * w;
            [at(0), at(1)]
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
