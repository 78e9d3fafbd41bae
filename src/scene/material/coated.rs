//! Satin paint: a matt ground below a rough clear coat.

use std::f64::consts::{FRAC_1_PI, PI};

use super::fresnel;
use super::ggx::{Ggx, mirrored};
use super::lobe::Lobe;
use crate::geometry::DVec3;
use crate::num::quadrature::Rule;

/// What becomes of light that meets a second facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SecondFacet {
    /// It goes through: `paint`.
    Passes,
    /// It is lost: `coated`.
    Absorbs,
}

/// A Lambertian ground of albedo ρ below a rough dielectric interface of relative index η, its
/// facets distributed by [`Ggx`]:
///
/// > f = R(ω_i·h) D(h) G₁(ω_i) G₁(ω_o)/(4 cosθ_i cosθ_o) + T(θ_i) T(θ_o)/η² · ρ/π/(1 − ρ R̄)
///
/// T(θ) is what the interface lets through from outside and R̄ what it returns of diffuse light
/// from inside. With D_θ the density of the facets visible from θ, ω_t refracted, ω_r reflected and
/// R′ Fresnel's reflectance from inside (1/η), there are two such coats.
///
/// **Paint** ([`SecondFacet::Passes`]) loses nothing. What the first facet reflects away is
/// reflected, all else reaches the ground, in both directions:
///
/// > T(θ) = 1 − E(θ),   E(θ) = ∫ D_θ(h) R(ω·h) G₁(ω_r) dh,   R̄ = 1 − 2/η² ∫₀¹ μ T(μ) dμ
///
/// The second line is reciprocity: inside radiance is η² times that outside. At ρ = 1 this reflects
/// E + T·(2/η² ∫ μ T dμ)/(1 − R̄) = 1 at every angle, as a loss-free white must; tests find 1
/// within 3e-4, most at normal incidence and a high index, and 2e-4 for paint (η = 1.5). At η = 1
/// it is ρ/π. What is assumed: light masked after its first facet goes through the second one,
/// where a few hundredths would be reflected once more; it then has the colour of the ground, not
/// that of the coat. Between the facets, that is all of E that single scattering leaves out (Heitz
/// and others, *Multiple-scattering microfacet BSDFs with the Smith model*, 2016).
///
/// **Coated** ([`SecondFacet::Absorbs`]) takes single scattering alone, of light that meets one
/// facet,
///
/// > T(θ) = ∫ D_θ(h) (1 − R(ω·h)) G₁(ω_t) dh,   R̄ = 2 ∫₀¹ μ ∫ D_μ(h) R′(ω·h) G₁(ω_r) dh dμ
///
/// and what meets a second one is lost: at ρ = 1 and η = 1.5 of all light 0.075 to 0.13 for α =
/// 0.1, 0.30 to 0.39 for α = 0.3, 0.66 to 0.85 for α = 1, from normal to grazing incidence. These
/// are the equations of Mitsuba 3's `roughplastic` with `nonlinear = true`.
///
/// T is tabulated at 513 values of √cosθ by product quadrature and interpolated by cubics; beside a
/// quadrature of 128 × 128 nodes at any angle it is good to 1e-5 (paint: 3e-4), and R̄ to 1e-4
/// (tests).
#[derive(Clone, Debug, PartialEq)]
pub struct Coated {
    ggx: Ggx,
    eta: f64,
    second: SecondFacet,
    /// T at √cosθ = k/INTERVALS.
    transmittance: Vec<f64>,
    /// 2 ∫ μ T(μ) dμ.
    mean_transmittance: f64,
    /// R̄.
    internal: f64,
}

const INTERVALS: usize = 512;
/// Nodes a side over the visible normals, for T (more for paint, where reflection ends at the
/// horizon with a kink) and for R̄, and over the angle, for R̄.
const NODES: usize = 32;
const PAINT_NODES: usize = 64;
const INTERNAL_NODES: usize = 96;
const INTERNAL_ANGLES: usize = 32;

impl Coated {
    pub(in crate::scene) fn new(alpha: f64, eta: f64, second: SecondFacet) -> Self {
        let ggx = Ggx::new(alpha);
        let rule = Rule::gauss_legendre(match second {
            SecondFacet::Passes => PAINT_NODES,
            SecondFacet::Absorbs => NODES,
        });
        let through = |mu: f64| match second {
            SecondFacet::Passes => 1.0 - returned(&ggx, eta, mu, &rule),
            SecondFacet::Absorbs => transmitted(&ggx, eta, mu, &rule),
        };
        let transmittance: Vec<f64> = (0..=INTERVALS)
            .map(|k| (k as f64 / INTERVALS as f64).powi(2))
            .map(through)
            .collect();
        let mut coated = Self {
            ggx,
            eta,
            second,
            transmittance,
            mean_transmittance: 0.0,
            internal: 0.0,
        };
        let outer = Rule::gauss_legendre(INTERNAL_ANGLES);
        for (mu, w) in outer.on(0.0, 1.0) {
            coated.mean_transmittance += 2.0 * w * mu * coated.transmittance(mu);
        }
        coated.internal = match second {
            SecondFacet::Passes => 1.0 - coated.mean_transmittance / (eta * eta),
            SecondFacet::Absorbs => internal(&ggx, eta, &outer),
        };
        coated
    }

    /// What becomes of light that meets a second facet.
    pub fn second_facet(&self) -> SecondFacet {
        self.second
    }

    /// The same coat with another roughness and index.
    pub(super) fn with(&self, alpha: f64, eta: f64) -> Self {
        Self::new(alpha, eta, self.second)
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

    /// Its interface.
    pub fn ggx(&self) -> Ggx {
        self.ggx
    }

    /// The refractive index of the coat.
    pub fn index(&self) -> f64 {
        self.eta
    }

    /// R̄, what the interface returns of diffuse light from inside.
    pub fn internal_reflectance(&self) -> f64 {
        self.internal
    }

    /// f_r of directions above the surface, sr⁻¹.
    pub(super) fn brdf(&self, albedo: f64, wi: DVec3, wo: DVec3) -> f64 {
        let (mirror, cosine) = self.ggx.reflection(wi, wo);
        let through = self.transmittance(wi.z) * self.transmittance(wo.z);
        fresnel::dielectric(cosine, self.eta).0 * mirror + FRAC_1_PI * through * self.ground(albedo)
    }

    /// ρ/η²/(1 − ρ R̄).
    fn ground(&self, albedo: f64) -> f64 {
        albedo / (self.eta * self.eta * (1.0 - albedo * self.internal))
    }

    /// What paint reflects of light from the cosine `mu`, E + T·g = 1 − T·(1 − g), g what comes
    /// back of the light below: 1 over a ground of ρ = 1. `None` where light is lost.
    pub(super) fn directional_albedo(&self, albedo: f64, mu: f64) -> Option<f64> {
        self.reflects(albedo, self.transmittance(mu))
    }

    /// The same of light that comes evenly from everywhere.
    pub(super) fn white_sky_albedo(&self, albedo: f64) -> Option<f64> {
        self.reflects(albedo, self.mean_transmittance)
    }

    fn reflects(&self, albedo: f64, through: f64) -> Option<f64> {
        let back = self.mean_transmittance * self.ground(albedo);
        (self.second == SecondFacet::Passes).then_some(1.0 - through * (1.0 - back))
    }

    /// The coat's reflection in proportion to what it does not let through, against the ground's.
    pub(super) fn lobe(&self, albedo: f64, wo: DVec3) -> Lobe {
        let through = self.transmittance(wo.z);
        let coat = (1.0 - through).max(f64::MIN_POSITIVE);
        let ground = through * self.mean_transmittance * self.ground(albedo);
        Lobe {
            glossy: coat / (coat + ground),
            ggx: self.ggx,
        }
    }
}

/// Σ over the normals visible from the cosine `mu` of `f`(direction, normal): Gauss–Legendre in the
/// polar angle of the cap, denser towards its rim, where steep facets are, and midpoints in its
/// azimuth, one half of which mirrors the other.
fn over_visible(ggx: &Ggx, mu: f64, rule: &Rule, mut f: impl FnMut(DVec3, DVec3) -> f64) -> f64 {
    let w = DVec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
    let cap = ggx.cap(w);
    let n = rule.nodes.len();
    let mut sum = 0.0;
    let rim = libm::acos(-cap.axis.z);
    for (x, weight) in rule.on(0.0, 1.0) {
        let (sin, cos) = libm::sincos(rim * (1.0 - x * x));
        let weight = weight * 2.0 * x * rim;
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

/// R̄ of single scattering.
fn internal(ggx: &Ggx, eta: f64, outer: &Rule) -> f64 {
    let inner = Rule::gauss_legendre(INTERNAL_NODES);
    // Total reflection ends at the critical angle, as the root of what is above it: μ = μ_c ± s²
    // meets it with many nodes and no root.
    let critical = (1.0 - 1.0 / (eta * eta)).max(0.0).sqrt();
    let mut sum = 0.0;
    for (reach, side) in [(critical, -1.0), (1.0 - critical, 1.0)] {
        for (s, w) in outer.on(0.0, reach.sqrt()) {
            let mu = critical + side * s * s;
            sum += 4.0 * w * s * mu * returned(ggx, 1.0 / eta, mu, &inner);
        }
    }
    sum
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
mod tests;
