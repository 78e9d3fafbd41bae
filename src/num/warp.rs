//! Warps: measure-preserving maps from the unit square.
//!
//! A warp maps a point of [0, 1)². Its density, with respect to the measure that the name states,
//! and its inverse stand beside it where they are needed; the tests check every map against both.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_4, TAU};

/// A point of the plane.
pub type Point2 = [f64; 2];

/// Unit square → unit disc, uniform in area (concentric map of Shirley and Chiu, 1997).
pub fn disc(u: Point2) -> Point2 {
    let [a, b] = [2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0];
    if a == 0.0 && b == 0.0 {
        return [0.0, 0.0];
    }
    let (r, phi) = if a.abs() > b.abs() {
        (a, FRAC_PI_4 * (b / a))
    } else {
        (b, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (a / b))
    };
    let (sin, cos) = libm::sincos(phi);
    [r * cos, r * sin]
}

/// Density of [`disc`] per unit area: 1/π inside the unit circle.
pub fn disc_density(p: Point2) -> f64 {
    if p[0] * p[0] + p[1] * p[1] <= 1.0 {
        FRAC_1_PI
    } else {
        0.0
    }
}

/// Inverse of [`disc`].
pub fn disc_inverse(p: Point2) -> Point2 {
    let r = (p[0] * p[0] + p[1] * p[1]).sqrt();
    // φ in [−π/4, 7π/4), so that each quarter of the square is one branch.
    let mut phi = libm::atan2(p[1], p[0]);
    if phi < -FRAC_PI_4 {
        phi += TAU;
    }
    let quarter = phi / FRAC_PI_4;
    let [a, b] = if quarter < 1.0 {
        [r, quarter * r]
    } else if quarter < 3.0 {
        [-(quarter - 2.0) * r, r]
    } else if quarter < 5.0 {
        [-r, -(quarter - 4.0) * r]
    } else {
        [(quarter - 6.0) * r, -r]
    };
    [0.5 * (a + 1.0), 0.5 * (b + 1.0)]
}

/// Unit square → upper hemisphere (z > 0), density cosθ/π per steradian (Malley's method).
pub fn cosine_hemisphere(u: Point2) -> [f64; 3] {
    let [x, y] = disc(u);
    [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]
}

/// Density of [`cosine_hemisphere`] per steradian.
pub fn cosine_hemisphere_density(cos_theta: f64) -> f64 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// Unit square → plane, density 2/(πw²)·exp(−2r²/w²): the profile of a Gaussian beam whose
/// intensity has fallen to 1/e² at radius w = 1. Multiply by w.
pub fn gaussian_spot(u: Point2) -> Point2 {
    // P(r) = 1 − exp(−2r²), inverted; log1p keeps u → 0 exact and u < 1 keeps r finite.
    let r = (-0.5 * libm::log1p(-u[0])).sqrt();
    let (sin, cos) = libm::sincos(TAU * u[1]);
    [r * cos, r * sin]
}

/// Density of [`gaussian_spot`] per unit area (w = 1).
pub fn gaussian_spot_density(p: Point2) -> f64 {
    2.0 * FRAC_1_PI * libm::exp(-2.0 * (p[0] * p[0] + p[1] * p[1]))
}

/// Unit square → unit sphere, uniform per steradian.
pub fn sphere(u: Point2) -> [f64; 3] {
    let z = 1.0 - 2.0 * u[0];
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(TAU * u[1]);
    [r * cos, r * sin, z]
}

/// Inverse of [`sphere`].
pub fn sphere_inverse(w: [f64; 3]) -> Point2 {
    let phi = libm::atan2(w[1], w[0]);
    [
        0.5 * (1.0 - w[2]),
        if phi < 0.0 {
            phi / TAU + 1.0
        } else {
            phi / TAU
        },
    ]
}

/// Unit square → triangle (0, 0), (1, 0), (0, 1), uniform in area, as the barycentric weights (b₁,
/// b₂) of the last two vertices; the point of a triangle a, b, c is a + b₁ (b − a) + b₂ (c − a).
///
/// With r = √u₀ the weight of the first vertex is 1 − r, and u₁ divides the rest:
///
/// > b₁ = r (1 − u₁),   b₂ = r u₁
///
/// (Turk, *Generating random points in triangles*, Graphics Gems, 1990.) Continuous, so strata stay
/// connected.
pub fn triangle(u: Point2) -> Point2 {
    let r = u[0].sqrt();
    [r * (1.0 - u[1]), r * u[1]]
}

/// The u that [`triangle`] maps to the weights b: u₀ = (b₁ + b₂)², u₁ = b₂/(b₁ + b₂).
pub fn triangle_inverse(b: [f64; 2]) -> Point2 {
    let r = b[0] + b[1];
    [r * r, if r > 0.0 { b[1] / r } else { 0.0 }]
}

#[cfg(test)]
mod tests;
