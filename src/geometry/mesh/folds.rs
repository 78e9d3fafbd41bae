//! Where a mesh folds, and where it ends.

use super::{DVec3, Mesh, cross};

/// Sine of the angle between two triangles up to which the mesh goes on straight: vertices of
/// single precision turn triangles of one plane by about 1e-7.
const STRAIGHT: f64 = 1e-6;

impl Mesh {
    /// The edges, by their ends, across which its plane changes, and those along which it ends.
    /// Vertices of one place count as one.
    pub fn folds(&self) -> &[[DVec3; 2]] {
        self.folds.get_or_init(|| self.found_folds())
    }

    fn found_folds(&self) -> Vec<[DVec3; 2]> {
        // −0 is 0.
        let key = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
        let mut edges = Vec::with_capacity(3 * self.triangles.len());
        for triangle in (0..self.triangles.len() as u32).filter(|t| self.triangle_area(*t) > 0.0) {
            let corners = self.corners(triangle);
            let normal = cross(corners).normalize_or_zero();
            for k in 0..3 {
                let ends = [corners[k], corners[(k + 1) % 3]];
                let mut keys = ends.map(key);
                keys.sort_unstable();
                edges.push((keys, ends, normal));
            }
        }
        edges.sort_unstable_by_key(|(keys, ..)| *keys);
        let goes_on = |m: DVec3, n: DVec3| m.dot(n) > 0.0 && m.cross(n).length() <= STRAIGHT;
        let same = edges.chunk_by(|(a, ..), (b, ..)| a == b);
        let folds = same.filter_map(|shared| match shared {
            [(_, _, m), (_, _, n)] if goes_on(*m, *n) => None,
            _ => shared.first().map(|(_, ends, _)| *ends),
        });
        folds.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two squares, each of two triangles, with an edge in common: flat they end along the 6 sides
    /// of the outline, bent they have the common edge besides. The diagonals are none. Vertices
    /// that are listed for each triangle again change nothing.
    #[test]
    fn a_mesh_folds_along_edges_and_not_along_diagonals() {
        for (height, count) in [(0.0, 6), (0.1, 7), (-0.1, 7)] {
            let at = |x: f64, y: f64| DVec3::new(x, y, if x > 1.5 { height } else { 0.0 });
            let mut positions = Vec::new();
            for x in [0.0, 1.0] {
                let [a, b, c, d] = [at(x, 0.0), at(x + 1.0, 0.0), at(x + 1.0, 1.0), at(x, 1.0)];
                positions.extend([a, b, c, a, c, d]);
            }
            let triangles = (0..4).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            let mesh = Mesh::new(positions, triangles).unwrap();
            let folds = mesh.folds();
            assert_eq!(folds.len(), count, "{height}: {folds:?}");
            let is_diagonal = |[a, b]: &[DVec3; 2]| a.x != b.x && a.y != b.y;
            assert!(!folds.iter().any(is_diagonal), "{folds:?}");
            let is_common = |[a, b]: &[DVec3; 2]| a.x == 1.0 && b.x == 1.0;
            assert_eq!(folds.iter().any(is_common), height != 0.0);
        }
    }
}
