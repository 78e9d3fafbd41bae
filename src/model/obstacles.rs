//! Which surfaces of a scene may stand in the way.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use rayon::prelude::*;

use super::spot::reach;
use super::wall_point;
use crate::geometry::{DVec3, Region, Shape, ShapeId, Side};
use crate::scene::{Scene, Spot, Surface};

/// Shapes that may stand between what the camera sees of the wall, or a spot, and a hidden surface
/// or the device.
pub(super) fn obstacles(scene: &Scene) -> Vec<ShapeId> {
    let device = |p: DVec3| (None, Region::point(p));
    let hidden = around(scene, scene.hidden());
    let reach = DVec3::splat(reach(scene.laser.profile));
    let rim = |spot: &Spot| [spot.target.position - reach, spot.target.position + reach];
    let region = |id, corners: Vec<DVec3>| (Some(id), Region::flat(corners));
    let spots = scene.laser.spots.iter();
    let lit: Vec<End> = spots
        .map(|spot| region(spot.surface, hull(rim(spot).into_iter())))
        .collect();
    // All spots of a wall in one box: mostly that decides.
    let together = scene.relays().filter_map(|(id, _)| {
        let own = scene
            .laser
            .spots
            .iter()
            .filter(|s| s.surface as usize == id);
        let corners: Vec<DVec3> = own.flat_map(rim).collect();
        (!corners.is_empty()).then(|| region(id as ShapeId, hull(corners.into_iter())))
    });
    let together: Vec<End> = together.collect();
    let seen = seen_walls(scene).unwrap_or_else(|| around(scene, scene.relays()));
    let may = |id: &ShapeId| {
        let screen = screen(scene, *id);
        let any = |walls: &[End], from: DVec3| {
            let from = device(from);
            let to = |wall: &End| {
                may_part(scene, *id, [wall, &from]) || may_hide(scene, screen, (wall, &hidden))
            };
            walls.iter().any(to)
        };
        let laser = scene.laser.position;
        let lights = || !scene.laser.is_shining() && any(&together, laser) && any(&lit, laser);
        any(&seen, scene.camera.position) || lights()
    };
    let shapes = 0..scene.bvh().shapes().len() as ShapeId;
    shapes.filter(may).collect()
}

/// Whether one of these obstacles may stand between a hidden surface and each of these places, the
/// wall of each and points around what is looked at of it.
pub(super) fn may_shade(
    scene: &Scene,
    obstacles: &[ShapeId],
    places: impl Iterator<Item = (Option<ShapeId>, Vec<DVec3>)>,
) -> Vec<bool> {
    let hidden = around(scene, scene.hidden());
    let screens = obstacles.iter().map(|id| screen(scene, *id));
    let screens: Vec<(ShapeId, bool)> = screens.collect();
    let places: Vec<_> = places.collect();
    let shaded = |(wall, points): &(Option<ShapeId>, Vec<DVec3>)| {
        let place = (*wall, Region::flat(hull(points.iter().copied())));
        let by = |(id, convex): &(ShapeId, bool)| {
            let is_own = *convex && *wall == Some(*id);
            !is_own && may_hide(scene, (*id, *convex), (&place, &hidden))
        };
        !points.is_empty() && screens.iter().any(by)
    };
    places.par_iter().map(shaded).collect()
}

/// A shape, and whether it hides nothing of itself ([`is_convex`]).
fn screen(scene: &Scene, id: ShapeId) -> (ShapeId, bool) {
    (id, is_convex(&scene.bvh().shapes()[id as usize]))
}

/// Whether a shape may hide any of these surfaces from a wall.
fn may_hide(scene: &Scene, (id, convex): (ShapeId, bool), (wall, hidden): (&End, &[End])) -> bool {
    let mut others = hidden.iter().filter(|(own, _)| *own != Some(id) || !convex);
    others.any(|surface| may_part(scene, id, [wall, surface]))
}

/// Whether a shape may stand between two regions.
fn may_part(scene: &Scene, id: ShapeId, [(s, a), (t, b)]: [&End; 2]) -> bool {
    scene.bvh().may_block(id, a, b, [*s, *t])
}

/// Whether it is a mesh with no vertex in front of any of its triangles, so that it hides nothing
/// of its own front; very large meshes are taken not to be. Vertices are asked box by box: of most
/// boxes no corner is in front.
fn is_convex(shape: &Shape) -> bool {
    const MOST: usize = 1_000_000;
    /// Boxes along each axis.
    const SIDE: f64 = 16.0;
    let Shape::Instance(body) = shape else {
        return false;
    };
    let count = body.mesh().triangles().len();
    if count > MOST {
        return false;
    }
    let (low, high) = body.bounds();
    let slack = 1e-9 * (high - low).length();
    let size = (high - low).max(DVec3::splat(slack)) / SIDE;
    let mut boxes: BTreeMap<[i64; 3], Vec<DVec3>> = BTreeMap::new();
    for p in (0..count as u32).flat_map(|t| body.corners(t)) {
        let place = ((p - low) / size).floor().to_array().map(|x| x as i64);
        boxes.entry(place).or_default().push(p);
    }
    // A corner of one triangle is mostly one of its neighbours' too.
    let boxes = boxes.into_values().map(|mut held| {
        held.sort_by(|p, q| {
            p.to_array()
                .partial_cmp(&q.to_array())
                .unwrap_or(Ordering::Equal)
        });
        held.dedup();
        let (low, high) = ends(held.iter().copied());
        (0.5 * (low + high), 0.5 * (high - low), held)
    });
    let boxes: Vec<(DVec3, DVec3, Vec<DVec3>)> = boxes.collect();
    let is_behind = |t: u32| {
        let [a, b, c] = body.corners(t);
        let outer = (b - a).cross(c - a).normalize_or_zero();
        let normal = match body.side() {
            Side::Outer => outer,
            Side::Inner => -outer,
        };
        boxes.iter().all(|(middle, half, held)| {
            normal.dot(*middle - a) + normal.abs().dot(*half) <= slack
                || held.iter().all(|p| normal.dot(*p - a) <= slack)
        })
    };
    (0..count as u32).into_par_iter().all(is_behind)
}

/// A region of a surface, or a device.
type End = (Option<ShapeId>, Region);

/// These surfaces of a scene.
fn around<'a>(scene: &Scene, all: impl Iterator<Item = (usize, &'a Surface)>) -> Vec<End> {
    let shapes = scene.bvh().shapes();
    all.map(|(id, _)| (Some(id as ShapeId), Region::around(&shapes[id])))
        .collect()
}

/// What the camera sees of one flat wall, if it sees nothing else.
fn seen_walls(scene: &Scene) -> Option<Vec<End>> {
    let camera = &scene.camera;
    let (right, last) = (camera.columns - 1, camera.pixels() - 1);
    let rim = [
        (0, [0.0, 0.0]),
        (right, [1.0, 0.0]),
        (last, [1.0, 1.0]),
        (last - right, [0.0, 1.0]),
    ];
    let rim = rim.map(|(p, ab)| wall_point::seen(scene, p, ab, 1.0));
    let id = rim[0].surface?;
    let one = scene.surfaces[id as usize].shape.is_flat();
    let same = rim.iter().all(|w| w.surface == Some(id));
    let middle = wall_point::seen(scene, last / 2, [0.5; 2], 1.0).surface == Some(id);
    (one && same && middle && scene.relays().count() == 1)
        .then(|| vec![(Some(id), Region::flat(rim.map(|w| w.position).to_vec()))])
}

/// Least and greatest coordinates of points.
pub(super) fn ends(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
        (low.min(p), high.max(p))
    })
}

/// Corners of the axis-aligned box around points: a hull of them.
pub(super) fn hull(points: impl Iterator<Item = DVec3>) -> Vec<DVec3> {
    let (low, high) = ends(points);
    let corner = |k: usize| {
        let pick = |d: usize| if k >> d & 1 == 0 { low[d] } else { high[d] };
        DVec3::new(pick(0), pick(1), pick(2))
    };
    let mut corners: Vec<DVec3> = Vec::with_capacity(8);
    for k in 0..8 {
        let corner = corner(k);
        if !corners.contains(&corner) {
            corners.push(corner);
        }
    }
    corners
}
