//! Rough matt surfaces: Oren and Nayar's model in its energy-preserving form.

use std::f64::consts::{FRAC_1_PI, PI};

use crate::geometry::DVec3;

/// The energy-preserving Oren–Nayar model (EON: Portsmouth, Kutz and Hill, *EON: a practical
/// energy-preserving rough diffuse BRDF*, 2025) on the single scattering of Fujii (*A tiny
/// improvement of Oren–Nayar reflectance model*, 2012):
///
/// > f = ρ/π · A (1 + r s/t) + ρ_m/π · (1 − E(μ_i))(1 − E(μ_o))/(1 − Ē)
///
/// > A = 1/(1 + c₁ r),   s = ω_i·ω_o − μ_i μ_o,   t = max(μ_i, μ_o) for s > 0, else 1,   c₁ = ½ − 2/(3π),   c₂ = ⅔ − 28/(15π)
///
/// > E(μ) = A (1 + r G(μ)/π),   G = s_θ (θ − s_θ μ) + ⅔ (s_θ (1 − s_θ³)/μ − s_θ),   Ē = A (1 + c₂ r),   ρ_m = ρ² Ē/(1 − ρ (1 − Ē))
///
/// The classical qualitative model loses light, and its s/t is discontinuous; this one reflects
/// exactly all light at ρ = 1 and every angle. The roughness is Oren and Nayar's standard deviation
/// σ of the facets' slope angle, in radians: r is the ratio of their two coefficients,
///
/// > r = B/A = 0.45 σ²/(σ² + 0.09) / (1 − ½ σ²/(σ² + 0.33))
///
/// (M. Oren and S. K. Nayar, *Generalization of Lambert's reflectance model*, 1994); EON itself
/// takes r ∈ \[0, 1\] as its roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrenNayar {
    sigma: f64,
    r: f64,
    a: f64,
}

const C1: f64 = 0.5 - 2.0 / (3.0 * PI);
const C2: f64 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

impl OrenNayar {
    /// Of slope deviation σ ≥ 0 in radians.
    pub(in crate::scene) fn new(sigma: f64) -> Self {
        let s2 = sigma * sigma;
        let r = 0.45 * s2 / (s2 + 0.09) / (1.0 - 0.5 * s2 / (s2 + 0.33));
        Self {
            sigma,
            r,
            a: 1.0 / (1.0 + C1 * r),
        }
    }

    /// σ.
    pub(super) fn sigma(&self) -> f64 {
        self.sigma
    }

    /// r = B/A, EON's roughness.
    pub fn ratio(&self) -> f64 {
        self.r
    }

    /// f_r of directions above the surface, sr⁻¹.
    pub(super) fn brdf(&self, albedo: f64, wi: DVec3, wo: DVec3) -> f64 {
        let Self { r, a, .. } = *self;
        let s = wi.x * wo.x + wi.y * wo.y;
        let ratio = if s > 0.0 { s / wi.z.max(wo.z) } else { s };
        let single = albedo * a * (1.0 + r * ratio);
        // 1 − E = A r (c₁ − G/π) and 1 − Ē = A r (c₁ − c₂), without cancellation.
        let lost = a * r * missing(wi.z) * missing(wo.z) / (C1 - C2);
        FRAC_1_PI * (single + self.multiple(albedo) * lost)
    }

    /// ρ_m.
    fn multiple(&self, albedo: f64) -> f64 {
        let mean = self.a * (1.0 + C2 * self.r);
        albedo * albedo * mean / (1.0 - albedo * (1.0 - mean))
    }

    /// ρ E(μ) + ρ_m (1 − E(μ)).
    pub(super) fn directional_albedo(&self, albedo: f64, mu: f64) -> f64 {
        let once = 1.0 - self.a * self.r * missing(mu);
        albedo * once + self.multiple(albedo) * (1.0 - once)
    }

    /// ρ Ē + ρ_m (1 − Ē).
    pub(super) fn white_sky_albedo(&self, albedo: f64) -> f64 {
        let mean = self.a * (1.0 + C2 * self.r);
        albedo * mean + self.multiple(albedo) * (1.0 - mean)
    }
}

/// c₁ − G(μ)/π.
fn missing(mu: f64) -> f64 {
    let s = (1.0 - mu * mu).max(0.0).sqrt();
    // (1 − s³)/μ = μ (1 + s + s²)/(1 + s).
    let third = s * mu * (1.0 + s + s * s) / (1.0 + s) - s;
    let theta = libm::acos(mu.min(1.0));
    C1 - FRAC_1_PI * (s * (theta - s * mu) + 2.0 / 3.0 * third)
}
