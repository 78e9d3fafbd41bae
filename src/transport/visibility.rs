//! Visibility. What can stand between two surfaces is judged first, conservatively; rays are cast
//! only where something can.

use crate::geometry::{Blockers, Bvh, DVec3, Ray, Region, ShapeId};
use crate::scene::Scene;

/// Whether light can travel between the fronts of shapes `s` and `t`: no only where one lies
/// nowhere above the other's plane, or where `t` is black. Shapes in between are not considered.
pub(super) fn may_be_visible(scene: &Scene, s: ShapeId, t: ShapeId) -> bool {
    may_reach(scene, &(s, None), t)
}

/// The end of a path: a shape, and the part of it where the path ends, if that is known.
pub(super) type End = (ShapeId, Option<Region>);

/// The same from an end of a path.
pub(super) fn may_reach(scene: &Scene, from: &End, t: ShapeId) -> bool {
    !scene.surfaces[t as usize].is_black() && may_face(scene, from, &(t, None))
}

/// Whether the light that lands on `t`, or with which it shines, may reach `from`.
pub(super) fn may_light(scene: &Scene, from: &End, t: &End) -> bool {
    sends_light(scene, t.0) && may_face(scene, from, t)
}

/// Whether light leaves a shape that is lit, or that shines.
pub(super) fn sends_light(scene: &Scene, id: ShapeId) -> bool {
    let surface = &scene.surfaces[id as usize];
    let shines = surface.shining().is_some() && surface.albedo.largest() > 0.0;
    shines || !surface.is_black()
}

/// Whether the fronts of two ends may see each other.
fn may_face(scene: &Scene, s: &End, t: &End) -> bool {
    let [from, to] = [s, t].map(|(id, _)| &scene.surfaces[*id as usize].shape);
    if s.0 == t.0 {
        return from.may_see_itself();
    }
    let slack = 1e-9 * (from.area().sqrt() + to.area().sqrt());
    let above = |a: &End, b: &End| {
        let [plane, shape] = [a, b].map(|(id, _)| &scene.surfaces[*id as usize].shape);
        !plane.is_flat() || {
            let p = plane.at([0.5, 0.5]);
            match &b.1 {
                Some(part) => part.reaches_above(p.position, p.normal, slack),
                None => shape.reaches_above(p.position, p.normal, slack),
            }
        }
    };
    above(s, t) && above(t, s)
}

/// Whether light can travel between `t` and any of `from`.
pub(super) fn any_may_be_visible(scene: &Scene, from: &[ShapeId], t: ShapeId) -> bool {
    from.iter().any(|s| may_be_visible(scene, *s, t))
}

/// The shapes that light can meet just before one of `seen`, after it has met one of `lit`.
pub(super) fn between(scene: &Scene, seen: &[ShapeId], lit: &[ShapeId]) -> Vec<ShapeId> {
    let lit_can_reach = |t: ShapeId| scene.max_bounces > 3 || any_may_be_visible(scene, lit, t);
    all_shapes(scene)
        .filter(|t| any_may_be_visible(scene, seen, *t) && lit_can_reach(*t))
        .collect()
}

/// The known shapes, each once; all shapes of the scene if `known` is `None`.
pub(super) fn known_or_all(scene: &Scene, known: Option<Vec<ShapeId>>) -> Vec<ShapeId> {
    let mut shapes = known.unwrap_or_else(|| all_shapes(scene).collect());
    shapes.sort_unstable();
    shapes.dedup();
    shapes
}

/// All shapes of the scene, as ends of which no more is known.
pub(super) fn all_ends(scene: &Scene) -> Vec<End> {
    all_shapes(scene).map(|t| (t, None)).collect()
}

pub(super) fn all_shapes(scene: &Scene) -> impl Iterator<Item = ShapeId> {
    0..scene.surfaces.len() as ShapeId
}

/// A point of a shape.
pub(super) type Place = (DVec3, ShapeId);

/// Sets to 0 every entry whose segment is blocked. No ray is cast for entries that are 0 already,
/// nor where `blockers` gives nothing; `ends` gives the ends of the segment.
#[inline]
pub(super) fn hide<'b>(
    bvh: &Bvh,
    entries: &mut [f64],
    blockers: impl Fn(usize) -> Option<&'b Blockers>,
    ends: impl Fn(usize) -> [Place; 2],
) {
    let (mut places, mut asked) = (Vec::new(), Vec::new());
    let (mut rays, mut shapes) = (Vec::new(), Vec::new());
    for (i, entry) in entries.iter_mut().enumerate().filter(|(_, e)| **e != 0.0) {
        let Some(blockers) = blockers(i).filter(|b| !b.none()) else {
            continue;
        };
        let [from, to] = ends(i);
        let Some(ray) = Ray::between(from.0, to.0) else {
            *entry = 0.0;
            continue;
        };
        places.push(i);
        asked.push(blockers);
        rays.push(ray);
        shapes.push([Some(from.1), Some(to.1)]);
    }
    let mut start = 0;
    for same in asked.chunk_by(|a, b| a == b) {
        let group = start..start + same.len();
        start = group.end;
        let blocked = bvh.blocked_many(same[0], &rays[group.clone()], &shapes[group.clone()]);
        for (place, _) in places[group].iter().zip(blocked).filter(|(_, b)| *b) {
            entries[*place] = 0.0;
        }
    }
}
