//! Materials that differ from a given one in a single parameter, as a wrong assumption does.

use std::sync::Arc;

use super::{Ggx, Material, OrenNayar, Part};

/// Largest slope deviation of a rough matt surface, radians.
pub(super) const MOST_SIGMA: f64 = std::f64::consts::FRAC_PI_2;
/// Range of the roughness of interfaces.
pub(super) const LEAST_ALPHA: f64 = 0.01;
pub(super) const MOST_ALPHA: f64 = 1.0;
/// Largest refractive index of a coat.
pub(super) const MOST_INDEX: f64 = 4.0;

impl Material {
    /// Whether it, or a part of it, is stated with a roughness.
    pub fn has_roughness(&self) -> bool {
        match self {
            Self::Lambertian | Self::Measured(_) | Self::Shining(_) => false,
            Self::OrenNayar(_) | Self::Coated(_) | Self::Conductor(_) => true,
            Self::Mixture(parts) => parts.iter().any(|p| p.material.has_roughness()),
        }
    }

    /// Whether it, or a part of it, has a clear coat.
    pub fn has_coat(&self) -> bool {
        match self {
            Self::Mixture(parts) => parts.iter().any(|p| p.material.has_coat()),
            material => matches!(material, Self::Coated(_)),
        }
    }

    /// The same material with `factor` times the roughness; of a mixture, every part that has one.
    /// `None` where nothing has a roughness, or one leaves the range that scene files are held to.
    pub fn with_roughness_times(&self, factor: f64) -> Option<Self> {
        let alpha = |ggx: &Ggx| {
            let alpha = ggx.alpha() * factor;
            (LEAST_ALPHA..=MOST_ALPHA).contains(&alpha).then_some(alpha)
        };
        match self {
            Self::Lambertian | Self::Measured(_) | Self::Shining(_) => None,
            Self::OrenNayar(m) => {
                let sigma = m.sigma() * factor;
                let within = sigma > 0.0 && sigma <= MOST_SIGMA;
                within.then(|| Self::OrenNayar(OrenNayar::new(sigma)))
            }
            Self::Coated(m) => {
                let coated = m.with(alpha(&m.ggx())?, m.index());
                Some(Self::Coated(Arc::new(coated)))
            }
            Self::Conductor(m) => Some(Self::Conductor(m.with(Ggx::new(alpha(&m.ggx)?)))),
            Self::Mixture(parts) => changed(parts, Self::has_roughness, |m| {
                m.with_roughness_times(factor)
            }),
        }
    }

    /// The same material with a coat of refractive index 1 + `factor`·(n − 1) in place of n; of a
    /// mixture, every coated part. `None` where nothing is coated, or the index leaves the range
    /// that scene files are held to.
    pub fn with_contrast_times(&self, factor: f64) -> Option<Self> {
        match self {
            Self::Coated(m) => {
                let index = 1.0 + factor * (m.index() - 1.0);
                let within = index > 1.0 && index <= MOST_INDEX;
                within.then(|| Self::Coated(Arc::new(m.with(m.ggx().alpha(), index))))
            }
            Self::Mixture(parts) => {
                changed(parts, Self::has_coat, |m| m.with_contrast_times(factor))
            }
            _ => None,
        }
    }

    /// The mixture with `by` added to the weight of one part and taken from all others in
    /// proportion: their sum stays, and f_r is linear in it. `None` of what is no mixture of
    /// several, and where a weight leaves the range from 0 to their sum.
    pub fn with_weight_plus(&self, part: usize, by: f64) -> Option<Self> {
        let Self::Mixture(parts) = self else {
            return None;
        };
        let weights: Vec<f64> = parts.iter().map(|p| p.weight).collect();
        let mut parts = parts.to_vec();
        for (own, weight) in parts.iter_mut().zip(shifted(&weights, part, by)?) {
            own.weight = weight;
        }
        Some(Self::mixture(parts))
    }

    /// The sum of `parts`, with the share of each set by what it reflects.
    pub(super) fn mixture(mut parts: Vec<Part>) -> Self {
        for part in &mut parts {
            part.share = part.weight * part.material.white_sky_albedo(part.albedo);
        }
        let total: f64 = parts.iter().map(|p| p.share).sum();
        let even = 1.0 / parts.len() as f64;
        for part in &mut parts {
            part.share = if total > 0.0 {
                part.share / total
            } else {
                even
            };
        }
        Self::Mixture(parts.into())
    }
}

/// [`Material::with_weight_plus`] of the weights alone.
pub(super) fn shifted(weights: &[f64], part: usize, by: f64) -> Option<Vec<f64>> {
    let sum: f64 = weights.iter().sum();
    let own = weights.get(part)?;
    let (weight, others) = (own + by, sum - own);
    if !(0.0..=sum).contains(&weight) || others <= 0.0 {
        return None;
    }
    let each = weights.iter().enumerate();
    let each = each.map(|(k, w)| {
        if k == part {
            weight
        } else {
            w * (sum - weight) / others
        }
    });
    Some(each.collect())
}

/// The mixture with those parts changed that are `concerned`; `None` where none is, or one cannot
/// be changed.
fn changed(
    parts: &[Part],
    concerned: impl Fn(&Material) -> bool,
    change: impl Fn(&Material) -> Option<Material>,
) -> Option<Material> {
    let mut parts = parts.to_vec();
    let mut any = false;
    for part in parts.iter_mut().filter(|p| concerned(&p.material)) {
        part.material = change(&part.material)?;
        any = true;
    }
    any.then(|| Material::mixture(parts))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::material::{Coated, Conductor, SecondFacet};

    fn coated(alpha: f64, eta: f64) -> Material {
        Material::Coated(Arc::new(Coated::new(alpha, eta, SecondFacet::Absorbs)))
    }

    #[test]
    fn only_what_is_changed_changes() {
        let paint = coated(0.3, 1.5);
        assert_eq!(paint.with_roughness_times(2.0), Some(coated(0.6, 1.5)));
        assert_eq!(paint.with_contrast_times(0.8), Some(coated(0.3, 1.4)));
        let passes =
            |alpha| Material::Coated(Arc::new(Coated::new(alpha, 1.5, SecondFacet::Passes)));
        assert_eq!(passes(0.3).with_roughness_times(2.0), Some(passes(0.6)));
        let matt = Material::OrenNayar(OrenNayar::new(0.4));
        let rougher = Material::OrenNayar(OrenNayar::new(0.8));
        assert_eq!(matt.with_roughness_times(2.0), Some(rougher));
        let metal = |alpha| Material::Conductor(Conductor::new(alpha, 0.2, 3.9));
        assert_eq!(metal(0.2).with_roughness_times(0.5), Some(metal(0.1)));
        assert_eq!(metal(0.2).with_contrast_times(0.5), None);
    }

    #[test]
    fn what_leaves_its_range_is_refused() {
        assert_eq!(Material::Lambertian.with_roughness_times(2.0), None);
        assert_eq!(coated(0.6, 1.5).with_roughness_times(2.0), None);
        assert_eq!(coated(0.01, 1.5).with_roughness_times(0.5), None);
        assert_eq!(coated(0.3, 3.0).with_contrast_times(2.0), None);
        let roughest = Material::OrenNayar(OrenNayar::new(1.0));
        assert_eq!(roughest.with_roughness_times(2.0), None);
    }

    /// Of a mixture of matt and satin parts the satin ones become rougher; the shares follow what
    /// the parts then reflect.
    #[test]
    fn parts_of_a_mixture_change_by_themselves() {
        let of = |satin: Material| {
            let part = |weight, albedo, material| Part {
                weight,
                albedo,
                material,
                share: 0.0,
            };
            Material::mixture(vec![
                part(0.6, 0.7, Material::Lambertian),
                part(0.4, 0.2, satin),
            ])
        };
        let mixture = of(coated(0.3, 1.5));
        let rougher = mixture.with_roughness_times(2.0);
        assert_eq!(rougher, Some(of(coated(0.6, 1.5))));
        assert_eq!(mixture.with_roughness_times(4.0), None);
        let Some(Material::Mixture(parts)) = rougher else {
            panic!("no mixture")
        };
        let reflected = coated(0.6, 1.5).white_sky_albedo(0.2) * 0.4;
        let share = reflected / (reflected + 0.42);
        assert!((parts[1].share - share).abs() < 1e-14);
        let matt = Material::mixture(vec![parts[0].clone()]);
        assert_eq!(matt.with_roughness_times(2.0), None);
    }
}
