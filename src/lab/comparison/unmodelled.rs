//! Light that frames hold and the three-bounce model of a scene does not.

use crate::geometry::{Interaction, Ray, ShapeId};
use crate::scene::{Role, Scene, Spot, Surface, Warning};

/// Bounces of the model.
const MODELLED: u32 = 3;
/// Points of the view along each side at which light straight from a spot is looked for.
const POINTS: usize = 3;
/// And of a wall, at which it may be sent on.
const ACROSS: usize = 9;

/// Light of `scene` that the three-bounce model does not have, in words, none where there is none:
/// of up to its largest number of bounces.
pub fn unmodelled(scene: &Scene) -> Vec<String> {
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
        .map(|warning| match warning {
            Warning::BeamBlocked(spots, by) => format!(
                "light that lands on `{by}`, which stops the beam to {} of {} spots: these are dark in the model",
                spots.len(),
                scene.laser.spots.len()
            ),
            _ => warning.to_string(),
        })
        .collect();
    found.extend(from_wall_to_wall(scene));
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
        found.push(match MODELLED + 1 {
            first if first == scene.max_bounces => format!("light of {first} bounces"),
            first => format!("light of {first} to {} bounces", scene.max_bounces),
        });
    }
    found
}

/// Light that goes from a wall to a wall, as far as frames hold it, in words: of one that is
/// curved, or of walls that meet.
pub fn from_wall_to_wall(scene: &Scene) -> Vec<String> {
    let mut found = Vec::new();
    let seen = seen(scene);
    let lit = spots_that_light_the_view(scene, &seen);
    if lit > 0 && scene.max_bounces > 1 {
        found.push(format!(
            "light of two bounces, from {lit} of {} spots straight to the part of the wall that is seen",
            scene.laser.spots.len()
        ));
    }
    let between = walls_that_light_the_view(scene, &seen);
    if !between.is_empty() && scene.max_bounces >= MODELLED {
        found.push(format!(
            "light of three bounces that {} sends from the spots to the part of the wall that is seen",
            between.join(", ")
        ));
    }
    found
}

/// Spots in front of which a point of the view lies that faces them, as on a curved wall and on
/// walls that meet.
fn spots_that_light_the_view(scene: &Scene, seen: &[(ShapeId, Interaction)]) -> usize {
    if scene.laser.is_shining() {
        return 0;
    }
    let lights = |spot: &&Spot| {
        let of = |to: &(ShapeId, Interaction)| lights(scene, (spot.surface, &spot.target), to);
        seen.iter().any(of)
    };
    scene.laser.spots.iter().filter(lights).count()
}

/// Walls that are not black with a point that a spot lights and that lights a point of the view.
fn walls_that_light_the_view(scene: &Scene, seen: &[(ShapeId, Interaction)]) -> Vec<String> {
    if scene.laser.is_shining() {
        return Vec::new();
    }
    let walls = scene.surfaces.iter().enumerate();
    let walls = walls.filter(|(_, s)| s.role == Role::Relay && !s.is_black());
    let passes_on = |(shape, wall): &(usize, &Surface)| {
        let mut points = grid(ACROSS).map(|at| (*shape as ShapeId, wall.shape.at(at)));
        points.any(|point| {
            let spots = &scene.laser.spots;
            let is_lit = |spot: &Spot| lights(scene, (spot.surface, &spot.target), &point);
            let on = |to: &(ShapeId, Interaction)| lights(scene, (point.0, &point.1), to);
            spots.iter().any(is_lit) && seen.iter().any(on)
        })
    };
    let which = walls.filter(passes_on);
    which.map(|(_, wall)| format!("`{}`", wall.name)).collect()
}

/// Points of a square, so many along each side.
fn grid(count: usize) -> impl Iterator<Item = [f64; 2]> {
    let at = move |k: usize| k as f64 / (count - 1) as f64;
    (0..count * count).map(move |k| [at(k % count), at(k / count)])
}

/// The points of walls that the camera sees.
fn seen(scene: &Scene) -> Vec<(ShapeId, Interaction)> {
    grid(POINTS).filter_map(|at| wall_at(scene, at)).collect()
}

/// Whether light goes from the front of one point to that of another.
fn lights(
    scene: &Scene,
    (own, from): (ShapeId, &Interaction),
    (other, to): &(ShapeId, Interaction),
) -> bool {
    let towards = to.position - from.position;
    towards.dot(from.normal) > 0.0
        && towards.dot(to.normal) < 0.0
        && Ray::between(from.position, to.position)
            .is_some_and(|ray| !scene.bvh().blocked(&ray, [Some(own), Some(*other)]))
}

/// The point of a wall that the camera sees there in its view.
fn wall_at(scene: &Scene, at: [f64; 2]) -> Option<(ShapeId, Interaction)> {
    let seen = scene.seen_through(scene.camera.view.at(at).position);
    seen.filter(|(shape, _)| scene.surfaces[*shape as usize].role == Role::Relay)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Kernel, MatrixModel};

    /// A plate nine tenths of the way to the first spot: as many spots as it stops the beam to are
    /// dark in the model, and it is the light on the plate that the model is said not to have.
    #[test]
    fn spots_whose_beam_is_stopped_are_dark_in_the_model() {
        let bench = Scene::load("bench").unwrap();
        let from = bench.laser.position;
        let at = from.lerp(bench.laser.spots[0].target.position, 0.9);
        let plate = format!(
            "\n[[surface]]\nname = \"plate\"\nrole = \"occluder\"\nsides = \"two\"\n\
             rectangle = {{ corner = [{}, {}, {}], u = [0.2, 0, 0], v = [0, 0.2, 0] }}\n\
             material = {{ lambertian = 0.0 }}\n",
            at.x - 0.1,
            at.y - 0.1,
            at.z
        );
        let scene = Scene::from_toml("stopped", &(bench.text + &plate)).unwrap();
        let model = MatrixModel::new(&scene, Kernel::Physical, Some([2, 2])).unwrap();
        let phi = model.phi();
        let dark = phi.column_iter().filter(|c| c.amax() == 0.0).count();
        assert!((1..10).contains(&dark), "{dark}");
        let told = unmodelled(&scene);
        let due = format!(
            "light that lands on `plate`, which stops the beam to {dark} of {} spots: these are dark in the model",
            phi.ncols()
        );
        assert!(told.contains(&due), "{told:?}");
    }
}
