//! The shape of a reflection: where a material sends most of its light.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, TAU};

use super::ggx::{Ggx, mirrored};
use crate::geometry::DVec3;
use crate::num::quadrature::Rule;

/// A density over incident directions: mirrored in a visible normal with probability `glossy`, by
/// the cosine otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// Probability of the mirrored directions, in [0, 1].
    pub glossy: f64,
    /// Their interface.
    pub ggx: Ggx,
}

impl Lobe {
    /// The cosine alone.
    pub(super) fn cosine() -> Self {
        Self {
            glossy: 0.0,
            ggx: Ggx::new(1.0),
        }
    }

    /// Per solid angle: q D(h) G₁(ω_o)/(4 cosθ_o) + (1 − q) cosθ_i/π; 0 below the surface. Over the
    /// hemisphere it adds up to 1 less the mirrored directions that point below.
    pub fn density(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return 0.0;
        }
        let cosine = (1.0 - self.glossy) * wi.z * FRAC_1_PI;
        if self.glossy == 0.0 {
            return cosine;
        }
        self.glossy * self.ggx.visible_density(wo, wi) + cosine
    }

    /// ∫ f(ω, p(ω)) dω over the hemisphere, p the density: each of the two maps carries the rule
    /// over (the polar angle by Gauss–Legendre, the azimuth by twice as many midpoints), weighted
    /// against the other by their mixture, so that a sharp lobe is met by as many nodes as a wide
    /// one.
    pub(super) fn integral(
        &self,
        wo: DVec3,
        rule: &Rule,
        mut f: impl FnMut(DVec3, f64) -> f64,
    ) -> f64 {
        let azimuths = 2 * rule.nodes.len();
        let turn = |k: usize| TAU * (k as f64 + 0.5) / azimuths as f64;
        let mut term = |w: DVec3| {
            if w.z <= 0.0 {
                return 0.0;
            }
            let p = self.density(wo, w);
            f(w, p) / p
        };
        let mut glossy = 0.0;
        if self.glossy > 0.0 {
            let cap = self.ggx.cap(wo);
            for (tau, weight) in rule.on(0.0, libm::acos(-cap.axis.z)) {
                let (sin, cos) = libm::sincos(tau);
                let scale = weight * sin / (1.0 + cap.axis.z);
                for k in 0..azimuths {
                    glossy += scale * term(mirrored(wo, cap.normal(cos, turn(k))));
                }
            }
        }
        let mut cosine = 0.0;
        if self.glossy < 1.0 {
            for (theta, weight) in rule.on(0.0, FRAC_PI_2) {
                let (sin, cos) = libm::sincos(theta);
                for k in 0..azimuths {
                    let (y, x) = libm::sincos(turn(k));
                    cosine += weight * 2.0 * sin * cos * term(DVec3::new(sin * x, sin * y, cos));
                }
            }
        }
        (self.glossy * glossy + (1.0 - self.glossy) * cosine) / azimuths as f64
    }
}
