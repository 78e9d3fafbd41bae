//! Meshes over a grid of two parameters.

use super::Triangles;
use crate::geometry::DVec3;
use std::f64::consts::{PI, TAU};

/// The sphere of radius 1 around the origin with at least `faces` triangles, wound outwards; each
/// vertex lies on it to rounding. u is the longitude from −y (u = 0.5 at +y) counterclockwise seen
/// from above, v = polar angle / π from the lowest point up.
pub fn sphere(faces: usize) -> Triangles {
    closed(faces, |longitude, v| {
        let polar = PI * v;
        let (sine, height) = (libm::sin(polar), -libm::cos(polar));
        let angle = TAU * longitude;
        let point = DVec3::new(libm::sin(angle) * sine, -libm::cos(angle) * sine, height);
        (point.normalize(), v)
    })
}

/// The unit square \[0, 1\]² in the plane z = 0, front towards +z, as nu × nv cells of two
/// triangles each; u is x and v is y.
pub fn rectangle(nu: u32, nv: u32) -> Triangles {
    let (nu, nv) = (nu.max(1), nv.max(1));
    let at = |i: u32, j: u32| [f64::from(i) / f64::from(nu), f64::from(j) / f64::from(nv)];
    let mut made = Triangles::default();
    for j in 0..=nv {
        for i in 0..=nu {
            let [x, y] = at(i, j);
            made.positions.push(DVec3::new(x, y, 0.0));
        }
    }
    let mut uvs = Vec::new();
    for j in 0..nv {
        for i in 0..nu {
            let cell = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            for corners in [[0, 1, 2], [0, 2, 3]] {
                let triangle = corners.map(|k| cell[k]);
                made.triangles.push(triangle.map(|(i, j)| j * (nu + 1) + i));
                uvs.push(triangle.map(|(i, j)| at(i, j)));
            }
        }
    }
    made.uv = Some(uvs);
    made
}

/// The unit cube \[0, 1\]³, two triangles a side, wound outwards; the texture's unit square covers
/// every side.
pub fn cube() -> Triangles {
    let mut made = Triangles::default();
    let mut uvs = Vec::new();
    for axis in 0..3 {
        for far in [0.0, 1.0] {
            // u × v points along the axis where it is far, against it where it is near.
            let (s, t) = if far > 0.0 {
                ((axis + 1) % 3, (axis + 2) % 3)
            } else {
                ((axis + 2) % 3, (axis + 1) % 3)
            };
            let first = made.positions.len() as u32;
            let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
            for [u, v] in square {
                let mut corner = DVec3::ZERO;
                (corner[axis], corner[s], corner[t]) = (far, u, v);
                made.positions.push(corner);
            }
            for corners in [[0, 1, 2], [0, 2, 3]] {
                made.triangles.push(corners.map(|c| first + c as u32));
                uvs.push(corners.map(|c: usize| square[c]));
            }
        }
    }
    made.uv = Some(uvs);
    made
}

/// A closed body of at least `faces` triangles: `surface` gives the point at longitude u and
/// latitude v in \[0, 1\], and its texture's v. All longitudes meet in one point at v = 0, below,
/// and at v = 1, above; outwards is to the right hand of growing u and v. The texture's u at these
/// two points is the middle of each triangle's.
pub(super) fn closed(faces: usize, surface: impl Fn(f64, f64) -> (DVec3, f64)) -> Triangles {
    // 2·columns·rings triangles: columns at either end, 2·columns in each belt between two rings.
    let columns = (1_u32..)
        .find(|c| 2 * (*c as usize).pow(2) >= faces)
        .unwrap_or(u32::MAX)
        .max(3);
    let rings = (faces.div_ceil(2 * columns as usize) as u32).max(2);
    let mut made = Triangles::default();
    let mut heights = Vec::new();
    let mut put = |u: f64, v: f64| {
        let (point, height) = surface(u, v);
        made.positions.push(point);
        heights.push(height);
    };
    let latitude = |ring: u32| f64::from(ring) / f64::from(rings + 1);
    put(0.0, 0.0);
    for ring in 1..=rings {
        for column in 0..columns {
            put(f64::from(column) / f64::from(columns), latitude(ring));
        }
    }
    put(0.0, 1.0);
    let top = made.positions.len() as u32 - 1;
    let mut uvs = Vec::new();
    let mut face = |corners: [(u32, f64); 3]| {
        made.triangles.push(corners.map(|c| c.0));
        uvs.push(corners.map(|(vertex, column)| {
            let u = column / f64::from(columns);
            [u, heights[vertex as usize]]
        }));
    };
    for column in 0..columns {
        let (left, right) = (f64::from(column), f64::from(column) + 1.0);
        let on = |ring: u32, shift: u32| 1 + (ring - 1) * columns + (column + shift) % columns;
        let middle = f64::from(column) + 0.5;
        face([(0, middle), (on(1, 1), right), (on(1, 0), left)]);
        for ring in 1..rings {
            let (a, b) = ((on(ring, 0), left), (on(ring, 1), right));
            let (d, c) = ((on(ring + 1, 0), left), (on(ring + 1, 1), right));
            face([a, b, c]);
            face([a, c, d]);
        }
        face([(top, middle), (on(rings, 0), left), (on(rings, 1), right)]);
    }
    made.uv = Some(uvs);
    made
}
