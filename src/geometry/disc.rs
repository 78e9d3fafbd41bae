//! Discs.

use glam::DAffine3;

use super::plane::Plane;
use super::{Basis, DVec3, Interaction, Parallelogram, Ray};
use crate::num::warp;

/// Planes nearer than this fraction of the sizes involved are one.
const SLACK: f64 = 1e-9;

/// A flat disc. Its parameters are those of the equal-area map of the square to the disc (Shirley
/// and Chiu, 1997).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    centre: DVec3,
    radius: f64,
    basis: Basis,
}

impl Disc {
    /// The disc whose front shows along `normal`; `None` unless all is finite, the normal not zero
    /// and the radius positive.
    pub fn new(centre: DVec3, normal: DVec3, radius: f64) -> Option<Self> {
        let proper = centre.is_finite() && (radius * radius).is_finite() && radius > 0.0;
        let normal = normal.try_normalize().filter(|_| proper)?;
        Some(Self {
            centre,
            radius,
            basis: Basis::around(normal),
        })
    }

    /// Its centre.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// Its radius.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Unit normal of the front.
    pub fn normal(&self) -> DVec3 {
        self.basis.n
    }

    /// The same disc with its front turned to the other side.
    pub fn turned(&self) -> Option<Self> {
        Self::new(self.centre, -self.basis.n, self.radius)
    }

    /// The disc after a rigid motion.
    pub fn moved(&self, motion: &DAffine3) -> Option<Self> {
        let centre = motion.transform_point3(self.centre);
        Self::new(centre, motion.transform_vector3(self.basis.n), self.radius)
    }

    /// πr².
    pub fn area(&self) -> f64 {
        std::f64::consts::PI * self.radius * self.radius
    }

    /// Half of the extent along each axis is r·√(1 − n²).
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let n = self.basis.n;
        let half = (DVec3::ONE - n * n).max(DVec3::ZERO);
        let half = DVec3::new(half.x.sqrt(), half.y.sqrt(), half.z.sqrt()) * self.radius;
        (self.centre - half, self.centre + half)
    }

    /// The point with the given parameters.
    pub fn at(&self, uv: [f64; 2]) -> Interaction {
        let [x, y] = warp::disc(uv).map(|c| c * self.radius);
        Interaction {
            position: self.centre + self.basis.to_world([x, y, 0.0]),
            normal: self.basis.n,
            uv,
        }
    }

    /// In the plane, in radii.
    fn coordinates(&self, p: DVec3) -> [f64; 2] {
        let offset = (p - self.centre) / self.radius;
        [self.basis.s.dot(offset), self.basis.t.dot(offset)]
    }

    /// The point nearest to `p`.
    pub fn at_position(&self, p: DVec3) -> Interaction {
        let [x, y] = self.coordinates(p);
        let beyond = (x * x + y * y).sqrt().max(1.0);
        let [x, y] = [x / beyond, y / beyond];
        let place = self.basis.to_world([x, y, 0.0]) * self.radius;
        Interaction {
            position: self.centre + place,
            normal: self.basis.n,
            uv: warp::disc_inverse([x, y]).map(|c| c.clamp(0.0, 1.0)),
        }
    }

    /// The point above (x, y) along z, if the disc has one.
    pub fn at_xy(&self, x: f64, y: f64) -> Option<Interaction> {
        let p = self.plane().at_xy(x, y)?;
        self.contains(p).then(|| self.at_position(p))
    }

    /// Whether a point of the plane lies on the disc, its rim within a few roundings.
    fn contains(&self, p: DVec3) -> bool {
        const EDGE: f64 = 1e-12;
        let [x, y] = self.coordinates(p);
        x * x + y * y <= 1.0 + EDGE
    }

    fn plane(&self) -> Plane {
        Plane {
            point: self.centre,
            normal: self.basis.n,
        }
    }

    /// Whether two discs lie in one plane (to a billionth of their size), face the same way and
    /// have more than a point in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        let size = self.radius + other.radius;
        self.faces_along(other.centre, other.basis.n, size)
            && (other.centre - self.centre).length() < size * (1.0 - SLACK)
    }

    /// The same for a patch.
    pub fn overlaps_patch(&self, patch: &Parallelogram) -> bool {
        let size = self.radius + patch.u().length() + patch.v().length();
        let near = patch.at_position(self.centre).position;
        self.faces_along(patch.corner(), patch.normal(), size)
            && (near - self.centre).length() < self.radius - SLACK * size
    }

    fn faces_along(&self, point: DVec3, normal: DVec3, size: f64) -> bool {
        normal.dot(self.basis.n) > 1.0 - SLACK
            && self.basis.n.dot(point - self.centre).abs() <= SLACK * size
    }

    /// Intersection with the plane inside the disc. A ray that starts in the plane (to rounding)
    /// does not meet it.
    pub fn intersect(&self, ray: &Ray) -> Option<f64> {
        let (height, off) = self.plane().height(ray.origin);
        let t = -height / self.basis.n.dot(ray.direction);
        let within = off && t > 0.0 && t < ray.length;
        (within && self.contains(ray.origin + ray.direction * t)).then_some(t)
    }

    /// Whether the disc stands between the two ends of the segment; one that starts or ends in its
    /// plane is not cut by it.
    pub fn blocks(&self, segment: &Ray) -> bool {
        let (_, off) = self
            .plane()
            .height(segment.origin + segment.direction * segment.length);
        off && self.intersect(segment).is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc() -> Disc {
        Disc::new(DVec3::new(1.0, -2.0, 0.5), DVec3::new(1.0, 2.0, 2.0), 1.5).unwrap()
    }

    /// In the plane, a ray meets the disc exactly if it passes within the radius of the centre.
    #[test]
    fn rays_meet_it_within_the_radius() {
        let d = disc();
        for (r, meets) in [(0.0, true), (1.49, true), (1.51, false)] {
            for angle in [0.1, 1.7, 4.0] {
                let (sin, cos) = libm::sincos(angle);
                let aim = d.centre + (d.basis.s * cos + d.basis.t * sin) * r;
                let from = DVec3::new(3.0, 3.0, 4.0);
                let ray = Ray::new(from, (aim - from).normalize());
                let t = d.intersect(&ray);
                assert_eq!(t.is_some(), meets, "{r} {angle}");
                let segment = Ray::between(from, aim + (aim - from) * 0.5).unwrap();
                assert_eq!(d.blocks(&segment), meets);
                assert!(!d.blocks(&Ray::between(from, aim).unwrap()), "its own end");
                if let Some(t) = t {
                    assert!((t - (aim - from).length()).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn overlap_is_in_one_plane_and_of_one_front() {
        let at = |x: f64, n: DVec3| Disc::new(DVec3::new(x, 0.0, 1.0), n, 1.0).unwrap();
        let d = at(0.0, DVec3::Z);
        assert!(d.overlaps(&at(1.9, DVec3::Z)) && !d.overlaps(&at(2.0, DVec3::Z)));
        assert!(!d.overlaps(&at(0.5, -DVec3::Z)));
        let patch = |x: f64, z: f64| {
            let corner = DVec3::new(x, -3.0, z);
            Parallelogram::new(corner, DVec3::X, DVec3::Y * 6.0).unwrap()
        };
        assert!(d.overlaps_patch(&patch(0.9, 1.0)) && !d.overlaps_patch(&patch(1.0, 1.0)));
        assert!(!d.overlaps_patch(&patch(0.9, 1.1)));
        assert!(!d.overlaps_patch(&patch(0.9, 1.0).turned()));
    }

    #[test]
    fn parameters_and_projection_agree() {
        let d = disc();
        for uv in [[0.1, 0.2], [0.5, 0.9], [0.93, 0.5]] {
            let p = d.at(uv);
            let q = d.at_position(p.position + p.normal * 0.1);
            assert!((p.position - q.position).length() < 1e-12);
            assert!((q.uv[0] - uv[0]).abs() < 1e-9 && (q.uv[1] - uv[1]).abs() < 1e-9);
        }
    }

    /// The bounds hold all points of the rim and are reached by some.
    #[test]
    fn bounds_are_tight() {
        let d = disc();
        let (low, high) = d.bounds();
        let rim = (0..7200).map(|k| {
            let (sin, cos) = libm::sincos(f64::from(k) * std::f64::consts::TAU / 7200.0);
            d.centre + (d.basis.s * cos + d.basis.t * sin) * d.radius
        });
        let (mut a, mut b) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for p in rim {
            (a, b) = (a.min(p), b.max(p));
        }
        assert!((a - low).abs().max_element() < 1e-5 && (b - high).abs().max_element() < 1e-5);
        assert!(a.cmpge(low - 1e-12).all() && b.cmple(high + 1e-12).all());
    }
}
