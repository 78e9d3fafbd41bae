//! Parts of footprints on the wall, and what the camera sees of them.

use super::wall_point::{self, WallPoint};
use crate::geometry::{Blockers, DVec3, Hidden, Pieces, Polygon, Ray, Shape, area_and_middle};
use crate::scene::Scene;

/// How often a triangle is cut in four where the rim of a large mesh crosses it.
const HALVINGS: u32 = 3;

/// A part of a footprint on the wall.
pub(super) struct Patch {
    /// All of it, at its middle.
    pub whole: WallPoint,
    /// Its corners, where the wall is flat; of a sphere those of the facet in the plane that
    /// touches it in the middle, as the camera sees it: off by the square of the part's size.
    pub corners: Option<Polygon>,
    /// What the camera sees of it,
    pub seen: Vec<Polygon>,
    /// and whether that is all; where there are no corners whether it sees the middle.
    pub open: bool,
}

impl Patch {
    /// Of a square of a pixel's footprint, from a corner on, in coordinates of the footprint.
    pub(super) fn new(
        scene: &Scene,
        pixel: usize,
        ([a, b], side): ([f64; 2], f64),
        hidden: &Hidden,
    ) -> Self {
        let at = |[x, y]: [f64; 2]| {
            let ab = [a + x * side, b + y * side];
            wall_point::seen(scene, pixel, ab, side * side)
        };
        let whole = at([0.5; 2]);
        let rim = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(at);
        let free = |to: DVec3, blockers: &Blockers| {
            let to = wall_point::on_wall(scene, &whole, to);
            let ray = Ray::between(scene.camera.position, to);
            let ends = [None, whole.surface];
            ray.is_some_and(|ray| !scene.bvh().blocked_by(blockers, &ray, ends))
        };
        let Some(corners) = facet(scene, &whole, &rim) else {
            return Self {
                corners: None,
                seen: Vec::new(),
                open: free(whole.position, &Blockers::Any),
                whole,
            };
        };
        let asked = hidden.asked(&corners, whole.surface);
        let mut pieces = Pieces::default();
        let open = !pieces.past([&*corners], &corners, &hidden.shadows) && asked.none();
        let mut seen: Vec<Polygon> = pieces.iter().map(<[DVec3]>::to_vec).collect();
        if !asked.none() {
            let parts = seen.iter().flat_map(|piece| triangles(piece));
            let is_free = |to| free(to, &asked);
            seen = parts
                .flat_map(|part| in_sight(part, HALVINGS, &is_free))
                .collect();
        }
        Self {
            whole,
            corners: Some(corners),
            seen,
            open,
        }
    }
}

/// The parts of a triangle whose middles are in free sight, cut in four as long as that is not so
/// of all its corners alike: the camera looks once, and what is seen serves all cells.
fn in_sight(triangle: Polygon, halvings: u32, is_free: &impl Fn(DVec3) -> bool) -> Vec<Polygon> {
    let open = is_free(area_and_middle(&triangle).1);
    if halvings == 0 || triangle.iter().all(|corner| is_free(*corner) == open) {
        return if open { vec![triangle] } else { Vec::new() };
    }
    let parts = triangles(&triangle).into_iter();
    parts
        .flat_map(|part| in_sight(part, halvings - 1, is_free))
        .collect()
}

/// The corners of what is flat of a part of the wall, or nearly: of a sphere where the camera sees
/// them in the touching plane, if that is near them for the part's size.
fn facet(scene: &Scene, whole: &WallPoint, rim: &[WallPoint; 4]) -> Option<Polygon> {
    /// Distance from a corner to the wall, of that to the middle.
    const NEAR: f64 = 0.5;
    let shape = &scene.surfaces[whole.surface? as usize].shape;
    if rim.iter().any(|w| w.surface != whole.surface) {
        return None;
    }
    if shape.is_flat() {
        return Some(rim.map(|w| w.position).to_vec());
    }
    let Shape::Sphere(_) = shape else { return None };
    let camera = scene.camera.position;
    let height = whole.normal.dot(whole.position - camera);
    let corner = |w: &WallPoint| {
        let line = w.position - camera;
        let corner = camera + line * (height / whole.normal.dot(line));
        let off = (corner - w.position).length();
        (off <= NEAR * (w.position - whole.position).length()).then_some(corner)
    };
    rim.iter().map(corner).collect()
}

/// A convex figure in triangles, each in four.
pub(super) fn triangles(figure: &[DVec3]) -> Vec<Polygon> {
    let Some(first) = figure.first() else {
        return Vec::new();
    };
    let fan = figure[1..]
        .windows(2)
        .map(|pair| [*first, pair[0], pair[1]]);
    fan.flat_map(|[a, b, c]| {
        let [p, q, r] = [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
        [vec![a, p, r], vec![p, b, q], vec![r, q, c], vec![p, q, r]]
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of the triangle (0, 0), (1, 0), (0, 1) the part x + y/3 < 0.4 has the corners (0, 0), (0.4,
    /// 0), (0.1, 0.9) and (0, 1).
    #[test]
    fn a_rim_is_found_by_halving() {
        let triangle = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let is_free = |p: DVec3| p.x + p.y / 3.0 < 0.4;
        let area = |halvings| {
            let parts = in_sight(triangle.clone(), halvings, &is_free);
            let areas = parts.iter().map(|part| area_and_middle(part).0);
            areas.sum::<f64>()
        };
        // Shoelace: ½ (0.4·0.9 − 0.1·0 + 0.1·1 − 0·0.9).
        let truth = 0.5 * (0.4 * 0.9 + 0.1);
        assert!((area(HALVINGS) - truth).abs() < 0.01, "{}", area(HALVINGS));
        assert!((area(8) - truth).abs() < 1e-3, "{}", area(8));
    }
}
