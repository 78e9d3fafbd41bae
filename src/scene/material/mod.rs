//! Materials: how a surface scatters light.
//!
//! A BRDF f_r(ω_i, ω_o) is in sr⁻¹ and not multiplied by a cosine. Directions are unit vectors that
//! point away from the surface, in a frame whose z axis is the normal of its front. Every material
//! is isotropic, reciprocal, f_r(ω_i, ω_o) = f_r(ω_o, ω_i), and reflects no more than it receives,
//! ∫ f_r cosθ_o dω_o ≤ 1.
//!
//! | `surface.material` | what it is |
//! | --- | --- |
//! | `{ lambertian = ρ }` | ρ/π |
//! | `{ oren_nayar = ρ, roughness = σ }` | rough and matt, [`OrenNayar`] (EON, not the classical qualitative model); σ in radians, 0 to π/2 |
//! | `{ paint = ρ, roughness = α, ior = 1.5 }` | satin paint, [`Coated`]: white (ρ = 1) reflects all light; α from 0.01 to 1, ior above 1, up to 4 |
//! | `{ coated = ρ, roughness = α, ior = 1.5 }` | the same as in Mitsuba's `roughplastic`, where light that meets a second facet is lost: white reflects 0.6 to 0.7 of it at α = 0.3 |
//! | `{ conductor = { eta = 0.2, k = 3.9 }, roughness = α, reflectance = ρ }` | rough metal, [`Conductor`]; ρ is 1 if absent |
//! | `{ measured = "paint.binary", channel = "red", scale = ρ }` | a table in a file, [`Measured`]; ρ is 1 if absent |
//! | `{ mixture = [{ weight = 0.7, material = { … } }, …] }` | a sum of materials; weights ≥ 0 that add up to 1 at most |
//! | `{ shining = x, exitance = 1, falloff = [nu, nv] }` | reflects nothing and shines by itself, [`Shining`]; hidden surfaces only, with the keys of the table in [`crate::scene`] |
//!
//! ρ is a number in [0, 1] or an albedo table; in a mixture, a number.

mod coated;
mod conductor;
mod file;
mod fresnel;
mod ggx;
mod grid;
mod lobe;
mod measured;
mod merl;
mod oren_nayar;
mod shining;
mod variants;

use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

pub use coated::{Coated, SecondFacet};
pub use conductor::Conductor;
pub use file::{IndexTable, MaterialTable, PartTable};
pub use ggx::{Ggx, mirrored};
pub use lobe::Lobe;
pub use measured::Measured;
pub use merl::Channel;
pub use oren_nayar::OrenNayar;
pub use shining::{FallOff, Shining, Shown};

use crate::geometry::DVec3;
use crate::num::quadrature::Rule;

/// How a surface scatters light.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// ρ/π in every direction.
    Lambertian,
    /// Rough and matt.
    OrenNayar(OrenNayar),
    /// Satin paint, and its form that loses light.
    Coated(Arc<Coated>),
    /// Rough metal.
    Conductor(Conductor),
    /// A table from a file.
    Measured(Arc<Measured>),
    /// A sum of materials.
    Mixture(Arc<[Part]>),
    /// Nothing: it shines.
    Shining(Shining),
}

/// One material of a mixture.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What its BRDF is multiplied by.
    pub weight: f64,
    /// Its albedo: a part has no texture.
    pub albedo: f64,
    /// What it is; no mixture.
    pub material: Material,
    /// Weight times white-sky albedo over the sum of all parts': how often it is sampled.
    pub share: f64,
}

/// Nodes of the polar angle, and of the cosine of incidence, in quadratures of reflectance.
const NODES: usize = 48;
const INCIDENCES: usize = 24;

impl Material {
    /// f_r(ω_i, ω_o), sr⁻¹, where the texture's value is `albedo` ∈ [0, 1]; 0 unless both
    /// directions are above the surface. `wi` points to where the light comes from, `wo` to where
    /// it goes.
    pub fn brdf(&self, albedo: f64, wi: DVec3, wo: DVec3) -> f64 {
        if !(wi.z > 0.0 && wo.z > 0.0) {
            return 0.0;
        }
        match self {
            Self::Lambertian => albedo * FRAC_1_PI,
            Self::Shining(_) => 0.0,
            Self::OrenNayar(m) => m.brdf(albedo, wi, wo),
            Self::Coated(m) => m.brdf(albedo, wi, wo),
            Self::Conductor(m) => m.brdf(albedo, wi, wo),
            Self::Measured(m) => albedo * m.brdf(wi, wo),
            Self::Mixture(parts) => {
                let part = |p: &Part| p.weight * p.material.brdf(p.albedo, wi, wo);
                albedo * parts.iter().map(part).sum::<f64>()
            }
        }
    }

    /// Whether f_r is the same for all directions; of what shines, its radiance.
    pub fn is_lambertian(&self) -> bool {
        match self {
            Self::Lambertian => true,
            Self::Shining(shining) => shining.is_lambertian(),
            _ => false,
        }
    }

    /// Whether nothing is reflected where the texture's value is `albedo`.
    pub fn is_black(&self, albedo: f64) -> bool {
        match self {
            Self::Lambertian | Self::OrenNayar(_) | Self::Conductor(_) | Self::Measured(_) => {
                albedo <= 0.0
            }
            // The coat reflects over a black ground too.
            Self::Coated(_) => false,
            Self::Shining(_) => true,
            Self::Mixture(parts) => {
                let dark = |p: &Part| p.weight <= 0.0 || p.material.is_black(p.albedo);
                albedo <= 0.0 || parts.iter().all(dark)
            }
        }
    }

    /// Share of the entries of a measured table that was not measured; of a mixture that of the
    /// part that lacks most.
    pub fn unmeasured(&self) -> f64 {
        match self {
            Self::Measured(m) => m.unmeasured(),
            Self::Mixture(parts) => {
                let each = parts.iter().map(|p| p.material.unmeasured());
                each.fold(0.0, f64::max)
            }
            _ => 0.0,
        }
    }

    /// Where the light that leaves along `wo` comes from, roughly; of a mixture each part has
    /// its own.
    pub fn lobe(&self, albedo: f64, wo: DVec3) -> Lobe {
        match self {
            Self::Lambertian | Self::OrenNayar(_) | Self::Mixture(_) | Self::Shining(_) => {
                Lobe::cosine()
            }
            Self::Coated(m) => m.lobe(albedo, wo),
            Self::Conductor(m) => Lobe {
                glossy: 1.0,
                ggx: m.ggx,
            },
            Self::Measured(m) => m.lobe(),
        }
    }

    /// Directional–hemispherical reflectance ∫ f_r cosθ_o dω_o of light from `wi`, by
    /// quadrature where it has no closed form.
    pub fn directional_albedo(&self, albedo: f64, wi: DVec3) -> f64 {
        self.reflected(albedo, wi, &Rule::gauss_legendre(NODES))
    }

    /// The mean of [`Self::directional_albedo`] over incident directions, weighted by the cosine, 2
    /// ∫ E(μ) μ dμ: its reflectance of light that comes evenly from everywhere, and the albedo of
    /// the Lambertian surface that reflects as much.
    pub fn white_sky_albedo(&self, albedo: f64) -> f64 {
        match self {
            Self::Lambertian => albedo,
            Self::Shining(_) => 0.0,
            Self::OrenNayar(m) => m.white_sky_albedo(albedo),
            Self::Mixture(parts) => {
                let part = |p: &Part| p.weight * p.material.white_sky_albedo(p.albedo);
                albedo * parts.iter().map(part).sum::<f64>()
            }
            material => {
                if let Self::Coated(m) = material
                    && let Some(reflected) = m.white_sky_albedo(albedo)
                {
                    return reflected;
                }
                let rule = Rule::gauss_legendre(NODES);
                let term = |(mu, weight): (f64, f64)| {
                    2.0 * weight * mu * self.reflected(albedo, slanted(mu), &rule)
                };
                Rule::gauss_legendre(INCIDENCES)
                    .on(0.0, 1.0)
                    .map(term)
                    .sum()
            }
        }
    }

    fn reflected(&self, albedo: f64, wi: DVec3, rule: &Rule) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        match self {
            Self::Lambertian => albedo,
            Self::Shining(_) => 0.0,
            Self::OrenNayar(m) => m.directional_albedo(albedo, wi.z),
            Self::Mixture(parts) => {
                let part = |p: &Part| p.weight * p.material.reflected(p.albedo, wi, rule);
                albedo * parts.iter().map(part).sum::<f64>()
            }
            material => {
                if let Self::Coated(m) = material
                    && let Some(reflected) = m.directional_albedo(albedo, wi.z)
                {
                    return reflected;
                }
                self.lobe(albedo, wi)
                    .integral(wi, rule, |w, _| self.brdf(albedo, wi, w) * w.z)
            }
        }
    }
}

/// A direction whose cosine to the normal is `mu`.
fn slanted(mu: f64) -> DVec3 {
    DVec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu)
}

#[cfg(test)]
mod tests;
#[cfg(test)]
pub(crate) use tests::zoo;
