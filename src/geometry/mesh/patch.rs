//! Meshes that are parallelograms in their texture coordinates.

use super::Mesh;
use crate::geometry::Parallelogram;

/// More triangles than this are not looked at.
const MOST: usize = 1 << 20;
/// How far a vertex may be from its place and count as there: rounding of its coordinates.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// How far it may be at most, over the shorter side: files round to six digits or to f32.
const NEAR: f64 = 1e-6;
/// How far a triangle's area element may then be from the patch's, over that.
const UNEVEN: f64 = 2e-6;

/// What a mesh is in its texture coordinates: corner + u·a + v·b.
#[derive(Clone, Debug)]
pub struct Patch {
    pub(in crate::geometry) plane: Parallelogram,
    /// How far its vertices are from there, length; 0 within rounding.
    pub(in crate::geometry) off: f64,
}

impl Patch {
    /// Whether its vertices are there to rounding.
    pub fn is_exact(&self) -> bool {
        self.off == 0.0
    }
}

/// A place in the picture by its bits, so that it can be sorted.
type Key = [u64; 2];

/// The patch corner + u·a + v·b that a mesh is, (u, v) its texture coordinates, if it is one: every
/// vertex is at its place to 1e-6 of the shorter side, every triangle has its share of the area to
/// 2e-6, none is turned over, and what is left of the triangles' sides after those shared by two is
/// the rim of \[0, 1\]². Then the triangles cover the patch once.
pub(super) fn of(mesh: &Mesh) -> Option<Patch> {
    let uv = mesh.uv()?;
    if uv.len() > MOST {
        return None;
    }
    let corners = || {
        let places = mesh.triangles().as_flattened().iter();
        places
            .map(|c| mesh.positions()[*c as usize])
            .zip(uv.as_flattened())
    };
    let at = |u: f64, v: f64| corners().find(|(_, c)| **c == [u, v]).map(|(p, _)| p);
    let (corner, u, v) = (at(0.0, 0.0)?, at(1.0, 0.0)?, at(0.0, 1.0)?);
    let patch = Parallelogram::new(corner, u - corner, v - corner)?;
    let (low, high) = mesh.bounds();
    let reach = low.abs().max(high.abs()).max_element();
    let is_inside = |c: &[f64; 2]| c.iter().all(|x| (0.0..=1.0).contains(x));
    if !corners().all(|(_, c)| is_inside(c)) {
        return None;
    }
    let off = corners().map(|(p, c)| (p - patch.at(*c).position).abs().max_element());
    let off = off.fold(0.0, f64::max);
    let is_exact = off <= ROUNDING * reach;
    let fits = off <= NEAR * patch.u().length().min(patch.v().length());
    let turn =
        |[a, b, c]: &[[f64; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let is_turned = uv.iter().map(turn).find(|t| *t != 0.0)? < 0.0;
    let even = uv
        .iter()
        .map(turn)
        .all(|t| t == 0.0 || (t < 0.0) == is_turned);
    let is_level = |t: usize| {
        let share = 0.5 * turn(&uv[t]).abs() * patch.area();
        (mesh.triangle_area(t as u32) - share).abs() <= UNEVEN * share
    };
    let fits = fits && even && (is_exact || (0..uv.len()).all(is_level));
    if !fits || !is_rim(uv) {
        return None;
    }
    let off = if is_exact { 0.0 } else { off };
    let plane = if is_turned { patch.turned() } else { patch };
    Some(Patch { plane, off })
}

/// Whether the sides that no two triangles share lie on the rim of the unit square, and make it up.
fn is_rim(uv: &[[[f64; 2]; 3]]) -> bool {
    // Adding 0 makes −0 the same as 0.
    let key = |p: [f64; 2]| p.map(|x| (x + 0.0).to_bits());
    let mut sides: Vec<(Key, Key, bool)> = Vec::with_capacity(3 * uv.len());
    for [a, b, c] in uv {
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let (p, q) = (key(*p), key(*q));
            sides.push((p.min(q), p.max(q), p < q));
        }
    }
    sides.sort_unstable();
    let mut length = 0.0;
    for same in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let forth = same.iter().filter(|s| s.2).count();
        match forth.abs_diff(same.len() - forth) {
            0 => {}
            1 => {
                let [p, q] = [same[0].0, same[0].1].map(|k| k.map(f64::from_bits));
                let on = |d: usize| p[d] == q[d] && (p[d] == 0.0 || p[d] == 1.0);
                if !on(0) && !on(1) {
                    return false;
                }
                length += (q[0] - p[0]).abs() + (q[1] - p[1]).abs();
            }
            _ => return false,
        }
    }
    (length - 4.0).abs() < 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::DVec3;

    fn mesh(
        places: &[[f64; 2]],
        triangles: &[[u32; 3]],
        position: impl Fn([f64; 2]) -> DVec3,
    ) -> Mesh {
        let uv = triangles.iter().map(|t| t.map(|c| places[c as usize]));
        let positions = places.iter().map(|p| position(*p)).collect();
        let mesh = Mesh::new(positions, triangles.to_vec()).unwrap();
        mesh.with_uv(uv.collect()).unwrap()
    }

    fn sheared([u, v]: [f64; 2]) -> DVec3 {
        DVec3::new(4.0 + 2.0 * u, v, 0.5 * u + 0.25 * v)
    }

    const SQUARE: [[f64; 2]; 5] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.25, 0.75]];
    const STAR: [[u32; 3]; 4] = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];

    #[test]
    fn a_parallelogram_of_triangles_is_found() {
        for flip in [false, true] {
            let triangles = STAR.map(|[a, b, c]| if flip { [a, c, b] } else { [a, b, c] });
            let found = of(&mesh(&SQUARE, &triangles, sheared)).unwrap();
            assert!(found.is_exact());
            let at = found.plane.at([0.3, 0.6]);
            assert!((at.position - sheared([0.3, 0.6])).length() < 1e-15);
            let [a, b, c] = triangles[0].map(|c| sheared(SQUARE[c as usize]));
            assert!(at.normal.dot((b - a).cross(c - a)) > 0.0);
        }
    }

    #[test]
    fn what_is_no_parallelogram_is_not() {
        // A hole, a triangle twice, one turned over, a bump, and a picture that ends early.
        assert!(of(&mesh(&SQUARE, &STAR[..3], sheared)).is_none());
        let twice = [STAR[0], STAR[1], STAR[2], STAR[3], STAR[0]];
        assert!(of(&mesh(&SQUARE, &twice, sheared)).is_none());
        let turned = [STAR[0], STAR[1], STAR[2], [0, 3, 4]];
        assert!(of(&mesh(&SQUARE, &turned, sheared)).is_none());
        let bump = |by: f64| {
            move |p: [f64; 2]| sheared(p) + DVec3::Z * if p == SQUARE[4] { by } else { 0.0 }
        };
        assert!(of(&mesh(&SQUARE, &STAR, bump(1e-5))).is_none());
        let nearly = of(&mesh(&SQUARE, &STAR, bump(1e-8))).unwrap();
        assert!(!nearly.is_exact() && (nearly.off - 1e-8).abs() < 1e-12);
        let half = SQUARE.map(|[u, v]| [0.5 * u, v]);
        assert!(of(&mesh(&half, &STAR, sheared)).is_none());
    }
}
