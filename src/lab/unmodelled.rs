//! Light that frames hold and the three-bounce model of a scene does not.

use crate::geometry::{Interaction, Ray, ShapeId};
use crate::scene::{Role, Scene, Spot, Warning};

/// Bounces of the model.
const MODELLED: u32 = 3;
/// Points of the view along each side at which light straight from a spot is looked for.
const POINTS: usize = 3;

/// What of it `scene` has, in words, none where it has none: of up to its largest number of
/// bounces.
pub(super) fn unmodelled(scene: &Scene) -> Vec<String> {
    let mut found: Vec<String> = scene
        .warnings()
        .iter()
        .filter(|warning| {
            matches!(
                warning,
                Warning::TooFewBounces(_)
                    | Warning::SpotsInView(_)
                    | Warning::BeamBlocked(..)
                    | Warning::PixelsBlocked(..)
            )
        })
        .map(ToString::to_string)
        .collect();
    let lit = spots_that_light_the_view(scene);
    if lit > 0 && scene.max_bounces > 1 {
        found.push(format!(
            "light of two bounces, from {lit} of {} spots straight to the part of the wall that is seen",
            scene.laser.spots.len()
        ));
    }
    let occluders = scene.surfaces.iter().filter(|s| s.role == Role::Occluder);
    let reflecting: Vec<String> = occluders
        .filter(|s| !s.is_black())
        .map(|s| format!("`{}`", s.name))
        .collect();
    if !reflecting.is_empty() && scene.max_bounces > 1 {
        let which = reflecting.join(", ");
        found.push(format!(
            "light that {which} sends on, not black in this scene"
        ));
    }
    if scene.max_bounces > MODELLED {
        found.push(format!(
            "light of {} to {} bounces",
            MODELLED + 1,
            scene.max_bounces
        ));
    }
    found
}

/// Spots in front of which a point of the view lies that faces them, as on a curved wall and on
/// walls that meet.
fn spots_that_light_the_view(scene: &Scene) -> usize {
    if scene.laser.is_shining() {
        return 0;
    }
    let at = |k: usize| k as f64 / (POINTS - 1) as f64;
    let points = (0..POINTS * POINTS).map(|k| [at(k % POINTS), at(k / POINTS)]);
    let seen: Vec<(ShapeId, Interaction)> = points.filter_map(|at| wall_at(scene, at)).collect();
    let lights = |spot: &&Spot| {
        seen.iter().any(|(wall, point)| {
            let (from, to) = (&spot.target, point);
            let towards = to.position - from.position;
            towards.dot(from.normal) > 0.0
                && towards.dot(to.normal) < 0.0
                && Ray::between(from.position, to.position).is_some_and(|ray| {
                    !scene.bvh().blocked(&ray, [Some(spot.surface), Some(*wall)])
                })
        })
    };
    scene.laser.spots.iter().filter(lights).count()
}

/// The point of a wall that the camera sees there in its view.
fn wall_at(scene: &Scene, at: [f64; 2]) -> Option<(ShapeId, Interaction)> {
    let seen = scene.seen_through(scene.camera.view.at(at).position);
    seen.filter(|(shape, _)| scene.surfaces[*shape as usize].role == Role::Relay)
}
