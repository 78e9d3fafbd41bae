//! How walls reflect.

use super::{Kind, surfaces, unknown};
use crate::geometry::Ray;
use crate::scene::error::{Fault, keys};
use crate::scene::{Material, Role, Scene, Texture};

/// The parameter `which` of the material of `what`; of a mixture's part `what` is
/// `WALL.mixture.K`.
pub(super) fn named(scene: &Scene, what: &str, which: &str, name: &str) -> Result<Kind, Fault> {
    let (body, part) = match (what.rsplit_once(".mixture."), which) {
        (Some((body, part)), "weight") => (body, Some(part.parse().map_err(|_| unknown(name))?)),
        (None, "roughness" | "ior" | "albedo") => (what, None),
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
    if which == "albedo" {
        return albedo(scene, ids, (body, name));
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

/// The albedo of these walls, if light tells it from the scale of all light.
fn albedo(scene: &Scene, ids: Vec<usize>, (body, name): (&str, &str)) -> Result<Kind, Fault> {
    let refuse = |cause: String, cure| Err(Fault::new(keys!["surface"], cause, cure));
    let walls = ids.into_iter();
    let walls: Vec<usize> = walls
        .filter(|id| scene.surfaces[*id].role == Role::Relay)
        .collect();
    if let Some(times) = times_met(scene, &walls) {
        let power = [
            "changes no light",
            "is a factor of all light",
            "is a factor of all light twice, at the spot and in view",
        ];
        return refuse(
            format!(
                "`{name}` {}: no photograph tells it from the scale, nor that from how bright the picture is",
                power[times]
            ),
            "leave it out; where the scale is unknown say so (--free-scale, --scale-error of validate and recover)",
        );
    }
    let has_number = |id: &usize| {
        let surface = &scene.surfaces[*id];
        let is_one = !matches!(surface.material, Material::Mixture(_));
        is_one && matches!(surface.albedo, Texture::Constant(_))
    };
    if !walls.iter().all(has_number) {
        return refuse(
            format!("the albedo of `{body}` is not one number"),
            "free the weights of a mixture (NAME.mixture.0.weight); what varies over a wall is not estimated",
        );
    }
    Ok(Kind::Albedo(walls))
}

/// How often all light meets these walls, at the spots and in view, if it does equally often: of
/// each all lie on them, or none.
fn times_met(scene: &Scene, walls: &[usize]) -> Option<usize> {
    let is_on = |id: usize| walls.contains(&id);
    let spots = scene.laser.spots.iter().map(|s| is_on(s.surface as usize));
    let camera = &scene.camera;
    let seen = (0..camera.pixels()).flat_map(|p| {
        let footprint = camera.footprint(p);
        INSIDE.map(|at| {
            let line = footprint.at(at) - camera.position;
            let ray = Ray::new(camera.position, line.normalize_or_zero());
            let met = scene.relays().filter_map(|(id, s)| {
                let met = s.shape.intersect(&ray, false)?;
                Some((met.t, id))
            });
            met.min_by(|a, b| a.0.total_cmp(&b.0))
                .map(|(_, id)| is_on(id))
        })
    });
    let alike = |each: Vec<bool>| {
        let first = *each.first().unwrap_or(&false);
        each.iter()
            .all(|on| *on == first)
            .then_some(usize::from(first))
    };
    Some(alike(spots.collect())? + alike(seen.flatten().collect())?)
}

/// Places of a footprint, within it: walls may meet at its sides.
const INSIDE: [[f64; 2]; 5] = [[0.5, 0.5], [0.1, 0.1], [0.9, 0.1], [0.1, 0.9], [0.9, 0.9]];
