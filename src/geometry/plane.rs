//! Planes.

use super::DVec3;

/// A plane through a point, with a unit normal.
pub(super) struct Plane {
    pub(super) point: DVec3,
    pub(super) normal: DVec3,
}

impl Plane {
    /// Signed distance n·(p − point), and whether that is more than rounding.
    #[inline(always)]
    pub(super) fn height(&self, p: DVec3) -> (f64, bool) {
        const ROUNDING: f64 = 1e-12;
        let height = self.normal.dot(p - self.point);
        let reach = p.abs().max_element() + self.point.abs().max_element();
        (height, height.abs() > ROUNDING * reach)
    }

    /// Its point above (x, y) along z; `None` if it is parallel to z.
    pub(super) fn at_xy(&self, x: f64, y: f64) -> Option<DVec3> {
        if self.normal.z.abs() < 1e-9 {
            return None;
        }
        let foot = DVec3::new(x, y, 0.0);
        let z = self.normal.dot(self.point - foot) / self.normal.z;
        Some(DVec3::new(x, y, z))
    }
}
