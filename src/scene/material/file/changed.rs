//! Tables whose numbers change as those of the materials do in
//! [`variants`](crate::scene::material::variants).

use super::{COAT, MaterialTable};
use crate::scene::material::variants::shifted;
use crate::scene::texture::AlbedoTable;

impl MaterialTable {
    /// A part's table too, where it is a mixture.
    fn each(&mut self, change: &dyn Fn(&mut Self)) {
        change(self);
        for part in self.mixture.iter_mut().flatten() {
            change(&mut part.material);
        }
    }

    /// Of [`Material::with_roughness_times`](crate::scene::Material::with_roughness_times).
    pub(in crate::scene) fn multiply_roughness(&mut self, factor: f64) {
        self.each(&|own| own.roughness = own.roughness.map(|r| r * factor));
    }

    /// Of [`Material::with_contrast_times`](crate::scene::Material::with_contrast_times).
    pub(in crate::scene) fn multiply_contrast(&mut self, factor: f64) {
        self.each(&|own| {
            if own.paint.is_some() || own.coated.is_some() {
                own.ior = Some(1.0 + factor * (own.ior.unwrap_or(COAT) - 1.0));
            }
        });
    }

    /// Of an albedo that is one number.
    pub(in crate::scene) fn multiply_albedo(&mut self, factor: f64) {
        if self.conductor.is_some() {
            self.reflectance.get_or_insert(AlbedoTable::Constant(1.0));
        }
        if self.measured.is_some() {
            self.scale.get_or_insert(AlbedoTable::Constant(1.0));
        }
        let all = [
            &mut self.lambertian,
            &mut self.oren_nayar,
            &mut self.paint,
            &mut self.coated,
            &mut self.reflectance,
            &mut self.scale,
        ];
        for own in all.into_iter().flatten() {
            if let AlbedoTable::Constant(rho) = own {
                *rho *= factor;
            }
        }
    }

    /// Of [`Material::with_weight_plus`](crate::scene::Material::with_weight_plus).
    pub(in crate::scene) fn add_weight(&mut self, part: usize, by: f64) {
        let parts = self.mixture.as_deref_mut().unwrap_or_default();
        let weights: Vec<f64> = parts.iter().map(|p| p.weight).collect();
        for (own, weight) in parts
            .iter_mut()
            .zip(shifted(&weights, part, by).unwrap_or(weights))
        {
            own.weight = weight;
        }
    }
}
