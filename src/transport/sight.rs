//! What can be seen from where, judged conservatively.

use crate::geometry::{Shape, ShapeId};
use crate::scene::Scene;

/// Whether light can travel between the fronts of shapes `s` and `t`: no only where geometry forbids it (one lies nowhere above the
/// other's plane) or `t` reflects nothing. Other shapes in between are not asked.
pub(super) fn may_see(scene: &Scene, s: usize, t: usize) -> bool {
    let (from, to) = (&scene.surfaces[s].shape, &scene.surfaces[t]);
    if to.is_black() {
        return false;
    }
    if s == t {
        return from.may_see_itself();
    }
    let slack = 1e-9 * (from.area().sqrt() + to.shape.area().sqrt());
    let above = |a: &Shape, b: &Shape| {
        !a.is_flat() || {
            let p = a.at([0.5, 0.5]);
            b.reaches_above(p.position, p.normal, slack)
        }
    };
    above(from, &to.shape) && above(&to.shape, from)
}

fn sees(scene: &Scene, from: &[ShapeId], t: ShapeId) -> bool {
    from.iter().any(|s| may_see(scene, *s as usize, t as usize))
}

/// The shapes that can be what light meets just before one of `seen`, having left one of `lit` at some time before.
pub(super) fn between(scene: &Scene, seen: &[ShapeId], lit: &[ShapeId]) -> Vec<ShapeId> {
    all_shapes(scene)
        .into_iter()
        .filter(|t| sees(scene, seen, *t) && (scene.max_bounces > 3 || sees(scene, lit, *t)))
        .collect()
}

/// Whether light can go from one of `lit` straight to one of `seen`, and is asked for.
pub(super) fn two_surfaces(scene: &Scene, seen: &[ShapeId], lit: &[ShapeId]) -> bool {
    scene.max_bounces > 1 && lit.iter().any(|t| sees(scene, seen, *t))
}

/// The known shapes, each once; all of the scene where any is unknown.
pub(super) fn known_or_all(scene: &Scene, known: Option<Vec<ShapeId>>) -> Vec<ShapeId> {
    let mut shapes = known.unwrap_or_else(|| all_shapes(scene));
    shapes.sort_unstable();
    shapes.dedup();
    shapes
}

/// All shapes of the scene.
fn all_shapes(scene: &Scene) -> Vec<ShapeId> {
    (0..scene.surfaces.len() as ShapeId).collect()
}
