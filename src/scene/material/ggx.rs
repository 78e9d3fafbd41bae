//! Rough interfaces: the distribution of Trowbridge and Reitz (GGX) with Smith's masking.

use std::f64::consts::{FRAC_1_PI, TAU};

use crate::geometry::DVec3;

/// Microfacets with normals h of density D(h) per solid angle and area of the interface:
///
/// > D(h) = 1/(π α² ((h_x² + h_y²)/α² + h_z²)²),   G₁(ω) = 2/(1 + √(1 + α² tan²θ))
///
/// (Walter, Marschner, Li and Torrance, *Microfacet models for refraction through rough surfaces*,
/// 2007.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    alpha: f64,
}

impl Ggx {
    /// Of roughness α > 0.
    pub(in crate::scene) fn new(alpha: f64) -> Self {
        Self { alpha }
    }

    /// Its roughness.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// D(h), sr⁻¹.
    pub fn distribution(&self, h: DVec3) -> f64 {
        let a2 = self.alpha * self.alpha;
        let q = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z;
        FRAC_1_PI / (a2 * q * q)
    }

    /// G₁(ω): the share of the facets turned towards ω that is not hidden from there. Of |cosθ|
    /// alone.
    pub fn masking(&self, w: DVec3) -> f64 {
        let z = w.z.abs();
        let across = self.alpha * self.alpha * (w.x * w.x + w.y * w.y);
        2.0 * z / (z + (z * z + across).sqrt())
    }

    /// D(h) G₁(ω_i) G₁(ω_o)/(4 cosθ_i cosθ_o), with the two maskings independent of each other
    /// (separable), and cos(ω_i, h): the BRDF of facets that mirror all light. For directions above
    /// the surface.
    pub fn reflection(&self, wi: DVec3, wo: DVec3) -> (f64, f64) {
        let h = (wi + wo).normalize();
        let masking = self.masking(wi) * self.masking(wo);
        let f = self.distribution(h) * masking / (4.0 * wi.z * wo.z);
        (f, wi.dot(h))
    }

    /// A normal of the facets seen from `wo` (above the surface), distributed by D(h) G₁(ω)
    /// max(0, ω·h)/cosθ: the reflection of parallel light off a hemisphere is uniform over a
    /// spherical cap (Dupuy and Benyoub, *Sampling visible GGX normals with spherical caps*, 2023).
    pub fn visible_normal(&self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        let cap = self.cap(wo);
        cap.normal((1.0 - u[1]) * (1.0 + cap.axis.z) - cap.axis.z, TAU * u[0])
    }

    /// Density per solid angle of `wo` mirrored in [`Self::visible_normal`]: D(h) G₁(ω_o)/(4
    /// cosθ_o).
    pub fn visible_density(&self, wo: DVec3, wi: DVec3) -> f64 {
        let h = (wi + wo).normalize();
        self.distribution(h) * self.masking(wo) / (4.0 * wo.z)
    }

    pub(super) fn cap(&self, wo: DVec3) -> Cap {
        let a = self.alpha;
        let axis = DVec3::new(a * wo.x, a * wo.y, wo.z).normalize();
        Cap { alpha: a, axis }
    }
}

/// The cap z ∈ (−axis.z, 1] of the unit sphere from which visible normals are made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cap {
    alpha: f64,
    /// The direction of view where the facets are stretched to α = 1.
    pub axis: DVec3,
}

impl Cap {
    /// The normal of the point of the cap with height `z` and azimuth `phi`.
    pub(super) fn normal(&self, z: f64, phi: f64) -> DVec3 {
        let r = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = libm::sincos(phi);
        let h = DVec3::new(r * cos, r * sin, z) + self.axis;
        DVec3::new(self.alpha * h.x, self.alpha * h.y, h.z.max(0.0)).normalize_or(DVec3::Z)
    }
}

/// ω mirrored in a facet of normal h.
pub fn mirrored(w: DVec3, h: DVec3) -> DVec3 {
    h * (2.0 * w.dot(h)) - w
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::quadrature::Rule;

    const ALPHAS: [f64; 5] = [0.01, 0.05, 0.2, 0.6, 1.0];

    /// A facet of the interface covers its area once: ∫ D(h) cosθ_h dω = 1.
    #[test]
    fn facets_cover_the_surface_once() {
        let rule = Rule::gauss_legendre(64);
        for alpha in ALPHAS {
            let ggx = Ggx::new(alpha);
            // tanθ = α tan t brings all roughnesses to one shape; θ = atan(α tan t), dθ/dt =
            // α/(cos²t + α² sin²t).
            let sum: f64 = rule
                .on(0.0, 0.5 * std::f64::consts::PI)
                .map(|(t, w)| {
                    let (s, c) = t.sin_cos();
                    let theta = (alpha * s / c).atan();
                    let d = ggx.distribution(DVec3::new(theta.sin(), 0.0, theta.cos()));
                    w * d * theta.cos() * theta.sin() * TAU * alpha
                        / (c * c + alpha * alpha * s * s)
                })
                .sum();
            assert!((sum - 1.0).abs() < 1e-12, "α {alpha}: {sum}");
        }
    }

    /// Smith's masking by its definition: the projected area of the visible facets is that of the
    /// interface, ∫ D(h) G₁(ω) max(0, ω·h) dω_h = cosθ.
    #[test]
    fn masking_keeps_the_projected_area() {
        let rule = Rule::gauss_legendre(200);
        for alpha in [0.1, 0.3, 1.0] {
            let ggx = Ggx::new(alpha);
            for theta in [0.0, 0.5, 1.2, 1.5f64] {
                let w = DVec3::new(theta.sin(), 0.0, theta.cos());
                let mut sum = 0.0;
                for (t, wt) in rule.on(0.0, 0.5 * std::f64::consts::PI) {
                    let (s, c) = t.sin_cos();
                    let th = (alpha * s / c).atan();
                    let slope = alpha / (c * c + alpha * alpha * s * s);
                    for k in 0..400 {
                        let phi = TAU * (f64::from(k) + 0.5) / 400.0;
                        let h = DVec3::new(th.sin() * phi.cos(), th.sin() * phi.sin(), th.cos());
                        sum += wt * slope * th.sin() * ggx.distribution(h) * w.dot(h).max(0.0);
                    }
                }
                let g = theta.cos() / (sum * TAU / 400.0);
                assert!(
                    (g - ggx.masking(w)).abs() < 2e-4,
                    "α {alpha} θ {theta}: {g}"
                );
            }
        }
    }

    /// 2/(1 + √(1 + α² tan²θ)).
    #[test]
    fn masking_has_its_closed_form() {
        for alpha in ALPHAS {
            for theta in [0.0, 0.3, 1.0, 1.4, 1.57f64] {
                let w = DVec3::new(theta.sin(), 0.0, theta.cos());
                let t = alpha * theta.tan();
                let g = 2.0 / (1.0 + (1.0 + t * t).sqrt());
                assert!((Ggx::new(alpha).masking(w) / g - 1.0).abs() < 1e-12);
            }
        }
    }
}
