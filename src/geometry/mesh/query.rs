//! What rays ask of a mesh.

use super::Mesh;
use super::group::{GROUP, Sheared};
use crate::geometry::tree::Query;
use crate::geometry::{DVec3, Intersection, Ray};

/// Which triangle is met first, by rays that start at points computed from numbers as large as the
/// second field?
pub(super) struct Closest<'a>(pub(super) &'a Mesh, pub(super) f64);

impl Query for Closest<'_> {
    type State = (Sheared, Option<Intersection>);

    #[inline(always)]
    fn begin(&self, ray: &Ray) -> Self::State {
        (Sheared::new(ray), None)
    }

    #[inline(always)]
    fn touch(&self, leaf: u32) -> u32 {
        self.0.groups[leaf as usize].touch()
    }

    #[inline(always)]
    fn visit(&self, ray: &Ray, (sheared, best): &mut Self::State, leaf: u32) -> f64 {
        let mut limit = match best {
            Some(b) => b.t,
            None => ray.length,
        };
        let mut at = leaf as usize;
        loop {
            let group = &self.0.groups[at];
            let (t, mut hits) = group.meet(sheared, limit);
            while hits != 0 {
                let k = hits.trailing_zeros() as usize & (GROUP - 1);
                hits &= hits - 1;
                let (triangle, t) = (group.triangles[k], t[k]);
                let first = match best {
                    Some(b) => t < b.t || (t == b.t && triangle < b.triangle),
                    None => t < ray.length,
                };
                if first && is_off_plane(group.corners(k), ray.origin, self.1) {
                    *best = Some(Intersection { triangle, t });
                    limit = t;
                }
            }
            if group.last {
                return limit;
            }
            at += 1;
        }
    }
}

/// Is any triangle met, by segments whose ends were computed from numbers as large as the second
/// field?
pub(super) struct Any<'a>(pub(super) &'a Mesh, pub(super) f64);

impl Query for Any<'_> {
    type State = (Sheared, bool);

    #[inline(always)]
    fn begin(&self, ray: &Ray) -> Self::State {
        (Sheared::new(ray), false)
    }

    #[inline(always)]
    fn touch(&self, leaf: u32) -> u32 {
        self.0.groups[leaf as usize].touch()
    }

    #[inline(always)]
    fn visit(&self, ray: &Ray, (sheared, found): &mut Self::State, leaf: u32) -> f64 {
        let end = ray.origin + ray.direction * ray.length;
        let mut at = leaf as usize;
        loop {
            let group = &self.0.groups[at];
            let (t, mut hits) = group.meet(sheared, ray.length);
            while hits != 0 {
                let k = hits.trailing_zeros() as usize & (GROUP - 1);
                hits &= hits - 1;
                let corners = group.corners(k);
                let off =
                    is_off_plane(corners, ray.origin, self.1) && is_off_plane(corners, end, self.1);
                if t[k] < ray.length && off {
                    *found = true;
                    return -1.0;
                }
            }
            if group.last {
                return ray.length;
            }
            at += 1;
        }
    }
}

/// Whether `p`, computed from numbers as large as `reach`, is farther from the triangle's plane
/// than rounding; what is not finite is.
#[inline(always)]
fn is_off_plane([a, b, c]: [DVec3; 3], p: DVec3, reach: f64) -> bool {
    const ROUNDING: f64 = 1e-12;
    if !p.is_finite() {
        return true;
    }
    let normal = (b - a).cross(c - a);
    let reach = p.abs().max_element() + a.abs().max_element() + reach;
    normal.dot(p - a).abs() > ROUNDING * reach * normal.length()
}
