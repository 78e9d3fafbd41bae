//! Rays, and where they meet surfaces.

use super::DVec3;

/// A ray: origin + t·direction for 0 < t < length, the direction a unit vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start.
    pub origin: DVec3,
    /// Unit vector.
    pub direction: DVec3,
    /// Largest t; infinite for a half-line.
    pub length: f64,
}

impl Ray {
    /// The half-line from `origin` along the unit vector `direction`.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self {
            origin,
            direction,
            length: f64::INFINITY,
        }
    }

    /// The segment from `a` to `b`; `None` if they coincide.
    pub fn between(a: DVec3, b: DVec3) -> Option<Self> {
        let length = (b - a).length();
        (length > 0.0).then(|| Self {
            origin: a,
            direction: (b - a) / length,
            length,
        })
    }
}

/// A point of a surface, exactly on it to f64 rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interaction {
    /// Position.
    pub position: DVec3,
    /// Unit normal of the front.
    pub normal: DVec3,
    /// Parameters in [0, 1]²; on a mesh its texture coordinates, or (0, 0) where it has none.
    pub uv: [f64; 2],
}

/// Where a ray meets one shape; [`Hit`](super::Hit) is the first of all shapes of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection {
    /// Distance along the ray.
    pub t: f64,
    /// The triangle of a mesh; 0 for every other shape.
    pub triangle: u32,
}
