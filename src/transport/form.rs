//! The geometric factor between two points.

use crate::geometry::{DVec3, Ray};

/// A position and the unit normal there.
pub(super) type Oriented = (DVec3, DVec3);

/// cosθ·cosθ′/d² (length⁻²) between two points that face each other, with the segment from the first to the second;
/// visibility is not part of it. `None` if either sees only the other's back.
pub(super) fn form(a: Oriented, b: Oriented) -> Option<(f64, Ray)> {
    let ray = Ray::between(a.0, b.0)?;
    let (cos_a, cos_b) = (a.1.dot(ray.direction), -b.1.dot(ray.direction));
    (cos_a > 0.0 && cos_b > 0.0).then(|| (cos_a * cos_b / (ray.length * ray.length), ray))
}
