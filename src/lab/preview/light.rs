//! Ordinary light: a sky, a lamp over the viewer's shoulder, a weak lamp at the viewer's eye.

use std::f64::consts::PI;

use super::viewpoint::Lens;
use crate::geometry::{Basis, DVec3};
use crate::num::warp;

/// Linear red, green and blue; 1 is the white of the picture.
pub type Colour = [f64; 3];

/// Radiance of the sky straight below and straight above; it changes evenly with the height
/// between.
const SKY: [f64; 2] = [0.16, 0.50];
/// Irradiance of a surface that faces the lamp over the shoulder, and of one that faces the eye.
const KEY: f64 = 0.50 * PI;
const EYE: f64 = 0.14 * PI;
/// No sample counts for more, three times white, so that a glossy surface does not sparkle.
const MOST: f64 = 3.0;
/// Where the lamp stands: to the left, up and back, as seen by the viewer; its radius at
/// distance 1.
const PLACE: [f64; 3] = [-0.55, 0.85, -0.75];
const RADIUS: f64 = 0.10;

/// The light of one picture.
pub(super) struct Light {
    up: DVec3,
    key: Basis,
}

impl Light {
    pub(super) fn beside(lens: &Lens) -> Self {
        let [right, up, ahead] = lens.axes();
        let [a, b, c] = PLACE;
        Self {
            up,
            key: Basis::around((right * a + up * b + ahead * c).normalize()),
        }
    }

    /// Light that leaves a point with the unit normal `normal` towards `viewer`, by one direction
    /// to the sky and one to the lamp: `brdf` of a direction to the light, `lit` whether light
    /// comes from there, `u` four numbers in [0, 1).
    pub(super) fn reflected(
        &self,
        normal: DVec3,
        viewer: DVec3,
        brdf: impl Fn(DVec3) -> f64,
        lit: impl Fn(DVec3) -> bool,
        u: [f64; 4],
    ) -> f64 {
        // Density cosθ/π: the cosine cancels.
        let sky = Basis::around(normal).to_world(warp::cosine_hemisphere([u[0], u[1]]));
        let height = 0.5 + 0.5 * sky.dot(self.up);
        let from_sky = if lit(sky) {
            PI * brdf(sky) * (SKY[0] + (SKY[1] - SKY[0]) * height)
        } else {
            0.0
        };
        let [a, b] = warp::disc([u[2], u[3]]);
        let key = self.key.to_world([RADIUS * a, RADIUS * b, 1.0]).normalize();
        let slope = normal.dot(key);
        let from_key = if slope > 0.0 && lit(key) {
            KEY * slope * brdf(key)
        } else {
            0.0
        };
        let from_eye = EYE * normal.dot(viewer).max(0.0) * brdf(viewer);
        from_sky.min(MOST) + from_key.min(MOST) + from_eye.min(MOST)
    }
}
