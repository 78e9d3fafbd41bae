//! The point of a mesh, and that of a triangle, nearest to another point.

use super::Mesh;
use super::group::Group;
use crate::geometry::{DVec3, Interaction};

impl Mesh {
    /// The point of the mesh nearest to `p`, and its triangle; of triangles equally near the first.
    pub fn at_position(&self, p: DVec3) -> (u32, Interaction) {
        let mut best = (f64::INFINITY, u32::MAX, [0.0; 2]);
        self.tree.around(p, |leaf| {
            for group in self.leaf(leaf) {
                for (triangle, corners) in group.members() {
                    let (distance, uv) = on_triangle(corners, p);
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

    /// The groups of a leaf.
    fn leaf(&self, first: u32) -> impl Iterator<Item = &Group> {
        let groups = &self.groups[first as usize..];
        let more = groups.iter().take_while(|g| !g.last).count();
        groups[..=more].iter()
    }
}

/// Distance of `p` from the triangle, and the weights of the second and the third corner at the
/// nearest point: inside if p projects there, else the nearest of the three edges.
pub(super) fn on_triangle([a, b, c]: [DVec3; 3], p: DVec3) -> (f64, [f64; 2]) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(ac);
    let square = normal.length_squared();
    let (v, w) = (
        ap.cross(ac).dot(normal) / square,
        ab.cross(ap).dot(normal) / square,
    );
    let distance = |[v, w]: [f64; 2]| (ab * v + ac * w - ap).length();
    if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
        return (distance([v, w]), [v, w]);
    }
    let along = |edge: DVec3, from: DVec3| (from.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
    let s = along(c - b, p - b);
    let edges = [[along(ab, ap), 0.0], [0.0, along(ac, ap)], [1.0 - s, s]];
    edges
        .map(|uv| (distance(uv), uv))
        .into_iter()
        .fold((f64::INFINITY, [0.0; 2]), |best, next| {
            if next.0 < best.0 { next } else { best }
        })
}
