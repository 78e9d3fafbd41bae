//! Satin paint: a matt ground below a rough clear coat.

use std::f64::consts::{FRAC_1_PI, PI};

use super::fresnel;
use super::ggx::{Ggx, mirrored};
use super::lobe::Lobe;
use crate::geometry::DVec3;
use crate::num::quadrature::Rule;

/// A Lambertian ground of albedo ρ below a rough dielectric interface of relative index η, its facets distributed by [`Ggx`]:
///
/// > f = R(ω_i·h) D(h) G₁(ω_i) G₁(ω_o)/(4 cosθ_i cosθ_o) + T(θ_i) T(θ_o)/η² · ρ/π/(1 − ρ R̄)
///
/// T(θ) is what the interface lets through from outside and R̄ what it returns of diffuse light from inside, both of light that meets one facet,
///
/// > T(θ) = ∫ D_θ(h) (1 − R(ω·h)) G₁(ω_t) dh,   R̄ = 2 ∫₀¹ μ ∫ D_μ(h) R′(ω·h) G₁(ω_r) dh dμ
///
/// with the density D_θ of the facets visible from θ, ω_t refracted, ω_r reflected, R′ Fresnel's reflectance from inside (1/η). No light is
/// absorbed by the coat; what meets a second facet is lost. These are the equations of Mitsuba 3's `roughplastic` with `nonlinear = true`.
///
/// T is tabulated at 513 values of √cosθ by product quadrature and interpolated by cubics; beside a quadrature of 128 × 128 nodes at any angle it
/// is good to 1e-5, and R̄ to 1e-4 (tests).
#[derive(Clone, Debug, PartialEq)]
pub struct Coated {
    ggx: Ggx,
    eta: f64,
    /// T at √cosθ = k/INTERVALS.
    transmittance: Vec<f64>,
    /// 2 ∫ μ T(μ) dμ.
    mean_transmittance: f64,
    /// R̄.
    internal: f64,
}

const INTERVALS: usize = 512;
/// Nodes a side over the visible normals, for T and for R̄, and over the angle, for R̄.
const NODES: usize = 32;
const INTERNAL_NODES: usize = 64;
const INTERNAL_ANGLES: usize = 32;

impl Coated {
    pub(in crate::scene) fn new(alpha: f64, eta: f64) -> Self {
        let ggx = Ggx::new(alpha);
        let rule = Rule::gauss_legendre(NODES);
        let transmittance: Vec<f64> = (0..=INTERVALS)
            .map(|k| (k as f64 / INTERVALS as f64).powi(2))
            .map(|mu| transmitted(&ggx, eta, mu, &rule))
            .collect();
        let mut coated = Self {
            ggx,
            eta,
            transmittance,
            mean_transmittance: 0.0,
            internal: 0.0,
        };
        let outer = Rule::gauss_legendre(INTERNAL_ANGLES);
        let inner = Rule::gauss_legendre(INTERNAL_NODES);
        for (mu, w) in outer.on(0.0, 1.0) {
            coated.mean_transmittance += 2.0 * w * mu * coated.transmittance(mu);
            coated.internal += 2.0 * w * mu * returned(&ggx, 1.0 / eta, mu, &inner);
        }
        coated
    }

    /// T at cosine `mu`: Catmull and Rom's cubic in √μ.
    fn transmittance(&self, mu: f64) -> f64 {
        let x = mu.min(1.0).sqrt() * INTERVALS as f64;
        let k = (x as usize).min(INTERVALS - 1);
        let t = x - k as f64;
        let table = &self.transmittance;
        let (a, b) = (table[k], table[k + 1]);
        // Outside the table the value is mirrored (T is even in √μ) or continued linearly.
        let before = if k == 0 { table[1] } else { table[k - 1] };
        let after = table.get(k + 2).copied().unwrap_or(2.0 * b - a);
        let (da, db) = (0.5 * (b - before), 0.5 * (after - a));
        a + t * (da + t * (3.0 * (b - a) - 2.0 * da - db + t * (2.0 * (a - b) + da + db)))
    }

    /// f_r of directions above the surface, sr⁻¹.
    pub(super) fn brdf(&self, albedo: f64, incident: DVec3, exitant: DVec3) -> f64 {
        let (mirror, cosine) = self.ggx.reflection(incident, exitant);
        let through = self.transmittance(incident.z) * self.transmittance(exitant.z);
        fresnel::dielectric(cosine, self.eta).0 * mirror + FRAC_1_PI * through * self.ground(albedo)
    }

    /// ρ/η²/(1 − ρ R̄).
    fn ground(&self, albedo: f64) -> f64 {
        albedo / (self.eta * self.eta * (1.0 - albedo * self.internal))
    }

    /// The coat's reflection in proportion to what it does not let through, against the ground's.
    pub(super) fn lobe(&self, albedo: f64, exitant: DVec3) -> Lobe {
        let through = self.transmittance(exitant.z);
        let coat = (1.0 - through).max(f64::MIN_POSITIVE);
        let ground = through * self.mean_transmittance * self.ground(albedo);
        Lobe {
            glossy: coat / (coat + ground),
            ggx: self.ggx,
        }
    }
}

/// Σ over the normals visible from the cosine `mu` of `f`(direction, normal): Gauss–Legendre in the polar angle of the cap, midpoints in its azimuth,
/// one half of which mirrors the other.
fn over_visible(ggx: &Ggx, mu: f64, rule: &Rule, mut f: impl FnMut(DVec3, DVec3) -> f64) -> f64 {
    let w = DVec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
    let cap = ggx.cap(w);
    let n = rule.nodes.len();
    let mut sum = 0.0;
    for (tau, weight) in rule.on(0.0, libm::acos(-cap.axis.z)) {
        let (sin, cos) = libm::sincos(tau);
        for k in 0..n {
            let h = cap.normal(cos, PI * (k as f64 + 0.5) / n as f64);
            sum += weight * sin * f(w, h);
        }
    }
    sum / (n as f64 * (1.0 + cap.axis.z))
}

/// T at cosine `mu`.
fn transmitted(ggx: &Ggx, eta: f64, mu: f64, rule: &Rule) -> f64 {
    over_visible(ggx, mu, rule, |w, h| {
        let c = w.dot(h).max(0.0);
        let (reflected, refracted) = fresnel::dielectric(c, eta);
        let below = h * (c / eta - refracted) - w / eta;
        if below.z < 0.0 {
            (1.0 - reflected) * ggx.masking(below)
        } else {
            0.0
        }
    })
}

/// What an interface of relative index `eta` reflects at cosine `mu`.
fn returned(ggx: &Ggx, eta: f64, mu: f64, rule: &Rule) -> f64 {
    over_visible(ggx, mu, rule, |w, h| {
        let above = mirrored(w, h);
        if above.z > 0.0 {
            fresnel::dielectric(w.dot(h).max(0.0), eta).0 * ggx.masking(above)
        } else {
            0.0
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table beside a quadrature of 16 times as many nodes, between its entries too.
    #[test]
    fn tables_are_as_good_as_stated() {
        let fine = Rule::gauss_legendre(128);
        for (alpha, eta) in [
            (0.01, 1.5),
            (0.05, 1.5),
            (0.3, 1.5),
            (1.0, 1.5),
            (0.3, 1.1),
            (0.3, 4.0),
        ] {
            let coated = Coated::new(alpha, eta);
            let mut worst: f64 = 0.0;
            for k in 0..=300 {
                let mu = (f64::from(k) / 300.0).powi(2);
                let exact = transmitted(&coated.ggx, eta, mu, &fine);
                worst = worst.max((coated.transmittance(mu) - exact).abs());
            }
            let mut internal = 0.0;
            for (mu, w) in Rule::gauss_legendre(96).on(0.0, 1.0) {
                internal += 2.0 * w * mu * returned(&coated.ggx, 1.0 / eta, mu, &fine);
            }
            println!(
                "{alpha} {eta}: T {worst:e}, R {:e} {}",
                coated.internal - internal,
                internal
            );
            assert!(worst < 1e-5, "α {alpha} η {eta}: {worst}");
            assert!(
                (coated.internal - internal).abs() < 1e-4,
                "α {alpha} η {eta}: {internal}"
            );
        }
    }
}
