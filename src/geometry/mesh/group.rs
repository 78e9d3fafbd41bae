//! Triangles side by side, as they lie in a leaf of the tree.

use crate::geometry::{DVec3, Ray};

/// Triangles in a group.
pub(super) const GROUP: usize = 8;

/// A few triangles, coordinate by coordinate.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Group {
    /// By axis and corner; absent triangles are not a number and are never met.
    corners: [[[f64; GROUP]; 3]; 3],
    /// Numbers of the triangles in their mesh.
    pub(super) triangles: [u32; GROUP],
    /// Whether the leaf ends here.
    pub(super) last: bool,
}

/// A ray, sheared so that it runs along the third of its axes (Woop, Benthin and Wald, *Watertight
/// ray/triangle intersection*, 2013).
#[derive(Clone, Copy, Debug)]
pub(super) struct Sheared {
    axes: [usize; 3],
    origin: [f64; 3],
    shear: [f64; 3],
}

impl Sheared {
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Self {
        let d = ray.direction.abs();
        let z = if d.x > d.y {
            if d.x > d.z { 0 } else { 2 }
        } else if d.y > d.z {
            1
        } else {
            2
        };
        let axes = [[1, 2, 0], [2, 0, 1], [0, 1, 2]][z];
        let component = |v: DVec3| axes.map(|a: usize| v.to_array()[a]);
        let [dx, dy, dz] = component(ray.direction);
        Self {
            axes,
            origin: component(ray.origin),
            shear: [dx / dz, dy / dz, 1.0 / dz],
        }
    }
}

/// What the ray finds in a group: by triangle the distance, and a bit for each that it meets at 0 <
/// t ≤ limit.
pub(super) type Met = ([f64; GROUP], u32);

impl Group {
    /// At most [`GROUP`] triangles with their numbers.
    pub(super) fn new(triangles: impl Iterator<Item = (u32, [DVec3; 3])>) -> Self {
        let mut group = Self {
            corners: [[[f64::NAN; GROUP]; 3]; 3],
            triangles: [u32::MAX; GROUP],
            last: false,
        };
        for (k, (number, corners)) in triangles.enumerate() {
            group.triangles[k] = number;
            for (c, corner) in corners.iter().enumerate() {
                for axis in 0..3 {
                    group.corners[axis][c][k] = corner[axis];
                }
            }
        }
        group
    }

    /// A number that depends on each of the group's cache lines.
    #[inline(always)]
    pub(super) fn touch(&self) -> u32 {
        let lines = self.corners.as_flattened().iter();
        self.triangles[0] ^ lines.fold(0, |bits, line| bits ^ line[0].to_bits() as u32)
    }

    /// The corners of triangle `k` of the group.
    #[inline(always)]
    pub(super) fn corners(&self, k: usize) -> [DVec3; 3] {
        let [x, y, z] = &self.corners;
        [
            DVec3::new(x[0][k], y[0][k], z[0][k]),
            DVec3::new(x[1][k], y[1][k], z[1][k]),
            DVec3::new(x[2][k], y[2][k], z[2][k]),
        ]
    }

    /// The triangles and their numbers.
    pub(super) fn members(&self) -> impl Iterator<Item = (u32, [DVec3; 3])> {
        let present = (0..GROUP).filter(|k| self.triangles[*k] != u32::MAX);
        present.map(|k| (self.triangles[k], self.corners(k)))
    }

    /// With the corners a, b, c in the sheared space of the ray, where it is the axis, it passes
    /// inside if u = c×b, v = a×c and w = b×a (cross products in the plane) have one sign; then t =
    /// (u·a_z + v·b_z + w·c_z)/(u + v + w). The edge of two neighbours has the same product in both
    /// up to its sign, bit for bit, and 0 belongs to both: nothing passes between them.
    #[inline(always)]
    pub(super) fn meet(&self, ray: &Sheared, limit: f64) -> Met {
        let [ax, ay, az] = ray.axes;
        let [cx, cy, cz] = [&self.corners[ax], &self.corners[ay], &self.corners[az]];
        let [ox, oy, oz] = ray.origin;
        let [sx, sy, sz] = ray.shear;
        let mut t = [0.0; GROUP];
        let mut bits = [0_u64; GROUP];
        for k in 0..GROUP {
            let corner = |i: usize| {
                let z = cz[i][k] - oz;
                [cx[i][k] - ox - sx * z, cy[i][k] - oy - sy * z, sz * z]
            };
            let (a, b, c) = (corner(0), corner(1), corner(2));
            let u = c[0] * b[1] - c[1] * b[0];
            let v = a[0] * c[1] - a[1] * c[0];
            let w = b[0] * a[1] - b[1] * a[0];
            let sum = u + v + w;
            t[k] = (u * a[2] + v * b[2] + w * c[2]) / sum;
            let inside =
                ((u >= 0.0) & (v >= 0.0) & (w >= 0.0)) | ((u <= 0.0) & (v <= 0.0) & (w <= 0.0));
            let met = inside & (t[k] > 0.0) & (t[k] <= limit);
            bits[k] = if met { 1 << k } else { 0 };
        }
        (t, bits.iter().fold(0, |a, b| a | b) as u32)
    }
}
