//! Points between the walls whose BRDF depends on the directions, for estimator
//! [`Factored`](super::Estimator::Factored).
//!
//! ```text
//! Φ̂_3[p, l] = Σ_k C[p, k]·L_3[k, l]·d_k(ω_l, ω_p)
//! ```
//!
//! C and L hold everything but the factor d of the BRDF at y_k ([`vertex`](super::vertex)), which
//! depends on pixel and spot together: no product of matrices. The shadow rays, which cost most,
//! are still those of C and of L.

use super::vertex::Vertex;
use crate::geometry::{Basis, DVec3};
use crate::scene::{Material, Scene};

/// One such point.
pub(super) struct GlossyPoint<'a> {
    material: &'a Material,
    albedo: f64,
    position: DVec3,
    basis: Basis,
    /// By column: where its light comes from, in the point's own axes.
    wi: Vec<DVec3>,
}

impl<'a> GlossyPoint<'a> {
    /// For the point y and what is `lit`, a column each; `None` where y is Lambertian.
    pub(super) fn new(scene: &'a Scene, y: &Vertex, lit: &[Option<Vertex>]) -> Option<Self> {
        let surface = &scene.surfaces[y.shape as usize];
        if surface.is_lambertian() {
            return None;
        }
        let (position, basis) = (y.position, Basis::around(y.normal));
        let towards = |lit: &Option<Vertex>| {
            let along = lit.map_or(DVec3::ZERO, |lit| lit.position - position);
            basis.to_local(along.normalize_or_zero())
        };
        Some(Self {
            material: &surface.material,
            albedo: y.albedo,
            position,
            wi: lit.iter().map(towards).collect(),
            basis,
        })
    }

    /// Adds c·L·d to the sum of each column, for light that goes to the point `to`.
    pub(super) fn add(&self, c: f64, to: DVec3, light: &[f64], sums: &mut [f64]) {
        let wo = (to - self.position).normalize_or_zero();
        let wo = self.basis.to_local(wo);
        for ((sum, light), wi) in sums.iter_mut().zip(light).zip(&self.wi) {
            if *light != 0.0 {
                *sum += c * light * self.material.brdf(self.albedo, *wi, wo);
            }
        }
    }
}
