//! Spheres.

use serde::{Deserialize, Serialize};

use super::{DVec3, Interaction, Ray};
use crate::num::warp;

/// Which side of a sphere is its front.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Facing {
    /// The convex side: a ball.
    Outside,
    /// The concave side: a cavity.
    Inside,
}

/// A sphere. Its parameters are those of the uniform warp: v turns around z, u runs from the top
/// (0) to the bottom (1) with equal areas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre.
    pub centre: DVec3,
    /// Radius, positive.
    pub radius: f64,
    /// Front side.
    pub facing: Facing,
}

/// A root this close to the end of a segment (relative to the radius) is the end itself.
const END: f64 = 1e-9;

impl Sphere {
    /// A sphere; `None` unless centre and radius are finite and the radius is positive.
    pub fn new(centre: DVec3, radius: f64, facing: Facing) -> Option<Self> {
        let proper = centre.is_finite() && (radius * radius).is_finite() && radius > 0.0;
        proper.then_some(Self {
            centre,
            radius,
            facing,
        })
    }

    /// 4πr².
    pub fn area(&self) -> f64 {
        4.0 * std::f64::consts::PI * self.radius * self.radius
    }

    /// Axis-aligned bounds.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let r = DVec3::splat(self.radius);
        (self.centre - r, self.centre + r)
    }

    fn point(&self, outward: DVec3) -> Interaction {
        let [u, v] = warp::sphere_inverse(outward.to_array());
        Interaction {
            position: self.centre + outward * self.radius,
            normal: match self.facing {
                Facing::Outside => outward,
                Facing::Inside => -outward,
            },
            uv: [u.clamp(0.0, 1.0), v.clamp(0.0, 1.0)],
        }
    }

    /// The point with the given parameters.
    pub fn at(&self, uv: [f64; 2]) -> Interaction {
        let mut point = self.point(DVec3::from_array(warp::sphere(uv)));
        point.uv = uv;
        point
    }

    /// Projects `p` onto the sphere.
    pub fn at_position(&self, p: DVec3) -> Interaction {
        self.point((p - self.centre).try_normalize().unwrap_or(DVec3::Z))
    }

    /// The lower and the upper point above or below (x, y), if it is within the radius.
    pub fn at_xy(&self, x: f64, y: f64) -> Vec<Interaction> {
        let [dx, dy] = [x - self.centre.x, y - self.centre.y];
        let height2 = self.radius * self.radius - dx * dx - dy * dy;
        if height2 < 0.0 {
            return Vec::new();
        }
        let point = |dz: f64| self.point(DVec3::new(dx, dy, dz) / self.radius);
        vec![point(-height2.sqrt()), point(height2.sqrt())]
    }

    /// Both roots of |o + t·d − c|² = r², ascending, without cancellation.
    fn roots(&self, ray: &Ray) -> Option<[f64; 2]> {
        let offset = ray.origin - self.centre;
        let b = offset.dot(ray.direction);
        // The discriminant from the foot of the perpendicular, not from b² − c (Haines et al., Ray
        // Tracing Gems, ch. 7).
        let foot = offset - ray.direction * b;
        let discriminant = self.radius * self.radius - foot.length_squared();
        if discriminant < 0.0 {
            return None;
        }
        let root = discriminant.sqrt();
        Some([-b - root, -b + root])
    }

    /// First root in (0, length). A ray that leaves the sphere itself has its start as one root,
    /// the one nearer to 0, which is left out.
    pub fn intersect(&self, ray: &Ray, leaving: bool) -> Option<f64> {
        let [near, far] = self.roots(ray)?;
        let inside = |t: f64| (t > 0.0 && t < ray.length).then_some(t);
        if !leaving {
            return inside(near).or_else(|| inside(far));
        }
        let other = if near.abs() < far.abs() { far } else { near };
        inside(other).filter(|t| *t > END * self.radius)
    }

    /// Whether the sphere blocks the open segment; ends that lie on it do not count as blocked.
    pub fn blocks(&self, ray: &Ray, leaves: bool, arrives: bool) -> bool {
        let end = END * self.radius;
        let lower = if leaves { end } else { 0.0 };
        let upper = if arrives {
            ray.length - end
        } else {
            ray.length
        };
        self.roots(ray)
            .is_some_and(|roots| roots.iter().any(|t| *t > lower && *t < upper))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cavity() -> Sphere {
        Sphere::new(DVec3::new(0.0, 0.0, 2.0), 2.0, Facing::Inside).unwrap()
    }

    /// A chord of length 2r·cosθ leaves the wall at angle θ from the normal.
    #[test]
    fn chords_have_their_closed_length() {
        let s = cavity();
        let start = s.at_xy(0.0, 0.0)[0];
        assert!((start.position - DVec3::ZERO).length() < 1e-15);
        assert!((start.normal - DVec3::Z).length() < 1e-15);
        for theta in [0.0f64, 0.3, 1.0, 1.5] {
            let d = DVec3::new(theta.sin(), 0.0, theta.cos());
            let t = s.intersect(&Ray::new(start.position, d), true).unwrap();
            assert!((t - 4.0 * theta.cos()).abs() < 1e-12, "{theta}: {t}");
        }
    }

    #[test]
    fn a_chord_is_free_and_a_way_out_is_blocked() {
        let s = cavity();
        let (a, b) = (s.at([0.5, 0.5]).position, s.at([0.8, 0.1]).position);
        let chord = Ray::between(a, b).unwrap();
        assert!(!s.blocks(&chord, true, true));
        assert!(s.blocks(
            &Ray::between(a, DVec3::new(9.0, 0.0, 2.0)).unwrap(),
            true,
            false
        ));
        assert!(s.blocks(
            &Ray::between(s.centre, s.centre + DVec3::X * 3.0).unwrap(),
            false,
            false
        ));
        assert!(!s.blocks(
            &Ray::between(s.centre, s.centre + DVec3::X).unwrap(),
            false,
            false
        ));
    }

    #[test]
    fn parameters_and_projection_agree() {
        let s = cavity();
        for uv in [[0.1, 0.2], [0.5, 0.9], [0.93, 0.5]] {
            let p = s.at(uv);
            let q = s.at_position(p.position + p.normal * 1e-5);
            assert!((p.position - q.position).length() < 1e-12);
            assert!((q.uv[0] - uv[0]).abs() < 1e-9 && (q.uv[1] - uv[1]).abs() < 1e-9);
        }
    }
}
