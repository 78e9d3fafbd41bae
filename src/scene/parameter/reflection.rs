//! How walls reflect.

use super::{Kind, surfaces, unknown};
use crate::scene::error::{Fault, keys};
use crate::scene::{Material, Role, Scene};

/// The parameter `which` of the material of `what`; of a mixture's part `what` is
/// `WALL.mixture.K`.
pub(super) fn named(scene: &Scene, what: &str, which: &str, name: &str) -> Result<Kind, Fault> {
    let (body, part) = match (what.rsplit_once(".mixture."), which) {
        (Some((body, part)), "weight") => (body, Some(part.parse().map_err(|_| unknown(name))?)),
        (None, "roughness" | "ior") => (what, None),
        _ => return Err(unknown(name)),
    };
    let ids = surfaces(scene, body);
    if ids.is_empty() {
        return Err(unknown(name));
    }
    if ids.iter().all(|id| scene.surfaces[*id].role != Role::Relay) {
        let cause = format!(
            "`{body}` is no wall: the model takes hidden surfaces for Lambertian, what their elements \
             reflect is the picture, and all else for black"
        );
        let cure = "leave it out; free how the wall reflects";
        return Err(Fault::new(keys!["surface"], cause, cure));
    }
    let has = |material: &Material| match (part, material) {
        (Some(part), Material::Mixture(parts)) => parts.len() > 1 && part < parts.len(),
        (Some(_), _) => false,
        (None, material) if which == "ior" => material.has_coat(),
        (None, material) => material.has_roughness(),
    };
    let concerned = |id: &usize| {
        let surface = &scene.surfaces[*id];
        surface.role == Role::Relay && has(&surface.material)
    };
    let ids: Vec<usize> = ids.into_iter().filter(concerned).collect();
    if ids.is_empty() {
        let lacks = match which {
            "roughness" => "a roughness",
            "ior" => "a coat",
            _ => "a mixture of two parts or more with one of this number, from 0",
        };
        let cause = format!("the material of `{body}` has not {lacks}, and so no `{name}`");
        let cure = "give it such a material, or leave it out";
        return Err(Fault::new(keys!["surface"], cause, cure));
    }
    Ok(match part {
        Some(part) => Kind::Weight(ids, part),
        None if which == "ior" => Kind::Contrast(ids),
        None => Kind::Roughness(ids),
    })
}
