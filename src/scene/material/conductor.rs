//! Rough metal.

use super::fresnel;
use super::ggx::Ggx;
use crate::geometry::DVec3;

/// A rough conductor of refractive index η + ik, its facets distributed by [`Ggx`]:
///
/// > f = ρ · R(ω_i·h) D(h) G₁(ω_i) G₁(ω_o)/(4 cosθ_i cosθ_o)
///
/// Light that meets a second facet is lost; ρ, the texture's value, multiplies all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    pub(super) ggx: Ggx,
    eta: f64,
    k: f64,
}

impl Conductor {
    pub(in crate::scene) fn new(alpha: f64, eta: f64, k: f64) -> Self {
        Self {
            ggx: Ggx::new(alpha),
            eta,
            k,
        }
    }

    /// The same metal with another interface.
    pub(super) fn with(self, ggx: Ggx) -> Self {
        Self { ggx, ..self }
    }

    /// Its surface.
    pub fn ggx(&self) -> Ggx {
        self.ggx
    }

    /// η and k.
    pub fn index(&self) -> [f64; 2] {
        [self.eta, self.k]
    }

    /// f_r of directions above the surface, sr⁻¹.
    pub(super) fn brdf(&self, albedo: f64, wi: DVec3, wo: DVec3) -> f64 {
        let (mirror, cosine) = self.ggx.reflection(wi, wo);
        albedo * fresnel::conductor(cosine, self.eta, self.k) * mirror
    }
}
