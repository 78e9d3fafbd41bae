//! Directions in which a path leaves a surface.

use std::f64::consts::FRAC_1_PI;

use crate::geometry::DVec3;
use crate::num::warp;
use crate::scene::material::{Material, Part, mirrored};

/// A direction of incidence distributed by [`density`], for u ∈ [0, 1)² and `choice` ∈ [0, 1); `None` where it points below the surface.
pub(super) fn sample(
    material: &Material,
    albedo: f64,
    exitant: DVec3,
    u: [f64; 2],
    choice: f64,
) -> Option<DVec3> {
    match material {
        Material::Lambertian => Some(DVec3::from_array(warp::cosine_hemisphere(u))),
        Material::Mixture(parts) => {
            let (part, rest) = chosen(parts, choice)?;
            sample(&part.material, part.albedo, exitant, u, rest)
        }
        _ => {
            let lobe = material.lobe(albedo, exitant);
            if choice >= lobe.glossy {
                return Some(DVec3::from_array(warp::cosine_hemisphere(u)));
            }
            let incident = mirrored(exitant, lobe.ggx.visible_normal(exitant, u));
            (incident.z > 0.0).then_some(incident)
        }
    }
}

/// Probability per solid angle that [`sample`] gives `incident`; over the hemisphere it adds up to 1 less the probability of `None`.
pub(super) fn density(material: &Material, albedo: f64, exitant: DVec3, incident: DVec3) -> f64 {
    match material {
        Material::Lambertian => incident.z.max(0.0) * FRAC_1_PI,
        Material::Mixture(parts) => parts
            .iter()
            .map(|p| p.share * density(&p.material, p.albedo, exitant, incident))
            .sum(),
        _ => material.lobe(albedo, exitant).density(exitant, incident),
    }
}

/// The part that `choice` falls on, and its place within the part's share, again in [0, 1).
fn chosen(parts: &[Part], choice: f64) -> Option<(&Part, f64)> {
    let mut left = choice;
    for part in parts {
        if left < part.share {
            return Some((part, left / part.share));
        }
        left -= part.share;
    }
    // The shares add up to 1 up to rounding.
    let last = parts.iter().rfind(|p| p.share > 0.0)?;
    Some((last, 1.0 - f64::EPSILON))
}

#[cfg(test)]
mod tests;
