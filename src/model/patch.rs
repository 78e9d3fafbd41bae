//! Parts of footprints on the wall, and what the camera sees of them.

use super::parts::{Crossed, Figure, Footprints};
use super::wall_point::{self, WallPoint};
use crate::geometry::{
    Blockers, DVec3, Hidden, Pieces, Polygon, Ray, Shape, ShapeId, area_and_middle,
};
use crate::scene::Scene;

/// How often what a rim crosses that is not followed exactly is cut in four.
const HALVINGS: u32 = 3;
/// Distance of what is flat from a plane, of its size: facets that go on straight turn by less.
const FLAT: f64 = 1e-4;

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
    /// Its share of the footprint,
    pub share: f64,
    /// and the share of it of which it is not known what the camera sees there.
    pub undecided: f64,
    /// Whether an edge of the wall bounds it.
    pub is_cut: bool,
    /// The wall, where none of it may hide any of this.
    pub unasked: Option<ShapeId>,
}

impl Patch {
    /// Of a square of a pixel's footprint, from a corner on, in coordinates of the footprint, cut
    /// along the edges of the walls; in four where a rim that is none of these crosses it.
    pub(super) fn all(
        footprints: &Footprints<'_>,
        pixel: usize,
        square: ([f64; 2], f64),
        hidden: &Hidden,
    ) -> Vec<Self> {
        Self::halved(footprints, pixel, square, (hidden, HALVINGS))
    }

    fn halved(
        footprints: &Footprints<'_>,
        pixel: usize,
        square @ ([a, b], side): ([f64; 2], f64),
        (hidden, halvings): (&Hidden, u32),
    ) -> Vec<Self> {
        let figures = footprints.figures(pixel, square);
        let of = |figure| Self::new(footprints.scene, pixel, figure, hidden);
        let found: Vec<Self> = figures.iter().map(of).collect();
        let is_decided = |p: &Self| p.corners.is_some() || p.undecided == 0.0;
        if halvings == 0 || found.iter().all(is_decided) {
            return found;
        }
        let half = 0.5 * side;
        let quarters = [[a, b], [a + half, b], [a, b + half], [a + half, b + half]];
        let quarter = |from| Self::halved(footprints, pixel, (from, half), (hidden, halvings - 1));
        quarters.into_iter().flat_map(quarter).collect()
    }

    fn new(scene: &Scene, pixel: usize, figure: &Figure, hidden: &Hidden) -> Self {
        let at = |ab: [f64; 2]| wall_point::seen(scene, pixel, ab, figure.share);
        let whole = at(figure.middle);
        let free = |to: DVec3, wall: Option<ShapeId>, blockers: &Blockers| {
            let ray = Ray::between(scene.camera.position, to);
            ray.is_some_and(|ray| !scene.bvh().blocked_by(blockers, &ray, [None, wall]))
        };
        let found = Self {
            whole,
            corners: None,
            seen: Vec::new(),
            open: false,
            share: figure.share,
            undecided: 0.0,
            is_cut: figure.crossed != Crossed::Not,
            unasked: None,
        };
        let Some(corners) = facet(scene, &whole, pixel, figure) else {
            let sees = |w: &WallPoint| {
                let id = w.surface?;
                free(w.position, Some(id), &Blockers::Any).then_some(id)
            };
            let own = sees(&whole);
            let mut rim = (0..figure.corners.len()).map(|k| at(figure.within(k)));
            let alike = rim.all(|w| sees(&w) == own);
            return Self {
                open: own.is_some(),
                undecided: if alike { 0.0 } else { 1.0 },
                ..found
            };
        };
        let found = Self {
            corners: Some(corners),
            ..found
        };
        let corners = found.corners.as_deref().unwrap_or_default();
        let size = area_and_middle(corners).0.sqrt();
        let unasked = behind_itself(scene, &whole, size);
        let asked = hidden.asked(corners, unasked);
        let mut pieces = Pieces::default();
        let open = !pieces.past([corners], corners, &hidden.shadows) && asked.none();
        let mut seen: Vec<Polygon> = pieces.iter().map(<[DVec3]>::to_vec).collect();
        let mut undecided = 0.0;
        if !asked.none() {
            let is_free = |to| {
                let to = wall_point::on_wall(scene, &whole, to);
                free(to, whole.surface, &asked)
            };
            let parts = seen.iter().flat_map(|piece| triangles(piece));
            let mut left = Vec::new();
            for part in parts {
                undecided += in_sight(part, HALVINGS, &is_free, &mut left);
            }
            seen = left;
            undecided /= area_and_middle(corners).0;
        }
        Self {
            seen,
            open,
            undecided,
            unasked,
            ..found
        }
    }
}

/// The wall about a point, if none of it may hide any of what is `size` about that: it is no mesh,
/// or one of which nothing is above the plane there. That of very large ones is not asked.
fn behind_itself(scene: &Scene, at: &WallPoint, size: f64) -> Option<ShapeId> {
    const MOST: usize = 100_000;
    at.surface
        .filter(|id| match &scene.surfaces[*id as usize].shape {
            Shape::Instance(body) => {
                body.mesh().triangles().len() <= MOST
                    && !body.reaches_above(at.position, at.normal, FLAT * size)
            }
            _ => true,
        })
}

/// Adds the parts of a triangle whose middles are in free sight, cut in four as long as that is not
/// so of all its corners alike: the camera looks once, and what is seen serves all cells. Returns
/// the area of those of which it is not so at last.
fn in_sight(
    triangle: Polygon,
    halvings: u32,
    is_free: &impl Fn(DVec3) -> bool,
    seen: &mut Vec<Polygon>,
) -> f64 {
    let (area, middle) = area_and_middle(&triangle);
    let open = is_free(middle);
    let alike = triangle.iter().all(|corner| is_free(*corner) == open);
    if alike || halvings == 0 {
        if open {
            seen.push(triangle);
        }
        return if alike { 0.0 } else { area };
    }
    let parts = triangles(&triangle).into_iter();
    parts
        .map(|part| in_sight(part, halvings - 1, is_free, seen))
        .sum()
}

/// The corners of what is flat of a part of the wall, or nearly: of a sphere where the camera sees
/// them in the touching plane, if that is near them for the part's size.
fn facet(scene: &Scene, whole: &WallPoint, pixel: usize, figure: &Figure) -> Option<Polygon> {
    let at = |ab: [f64; 2]| wall_point::seen(scene, pixel, ab, figure.share);
    let shape = &scene.surfaces[whole.surface? as usize].shape;
    let is_square = figure.crossed == Crossed::Not && !matches!(shape, Shape::Instance(_));
    if is_square {
        let rim: Vec<WallPoint> = figure.corners.iter().map(|ab| at(*ab)).collect();
        if rim.iter().all(|w| w.surface == whole.surface) {
            return if shape.is_flat() {
                Some(rim.iter().map(|w| w.position).collect())
            } else {
                touching(scene, whole, &rim)
            };
        }
    }
    let rim: Vec<WallPoint> = (0..figure.corners.len())
        .map(|k| at(figure.within(k)))
        .collect();
    let spread = rim.iter().map(|w| (w.position - whole.position).length());
    let size = spread.fold(0.0, f64::max);
    let is_in_plane = |w: &WallPoint| {
        let off = whole.normal.dot(w.position - whole.position).abs();
        w.surface == whole.surface && off <= FLAT * size
    };
    let is_curved = matches!(shape, Shape::Sphere(_));
    if is_curved || figure.crossed == Crossed::TooOften || !rim.iter().all(is_in_plane) {
        return None;
    }
    let (camera, footprint) = (scene.camera.position, scene.camera.footprint(pixel));
    let height = whole.normal.dot(whole.position - camera);
    let corner = |ab: &[f64; 2]| {
        let line = footprint.at(*ab) - camera;
        camera + line * (height / whole.normal.dot(line))
    };
    Some(figure.corners.iter().map(corner).collect())
}

/// The corners of a facet that touches a sphere.
fn touching(scene: &Scene, whole: &WallPoint, rim: &[WallPoint]) -> Option<Polygon> {
    /// Distance from a corner to the wall, of that to the middle.
    const NEAR: f64 = 0.5;
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
            let mut parts = Vec::new();
            let undecided = in_sight(triangle.clone(), halvings, &is_free, &mut parts);
            let areas = parts.iter().map(|part| area_and_middle(part).0);
            (areas.sum::<f64>(), undecided)
        };
        // Shoelace: ½ (0.4·0.9 − 0.1·0 + 0.1·1 − 0·0.9).
        let truth = 0.5 * (0.4 * 0.9 + 0.1);
        for (halvings, near) in [(HALVINGS, 0.01), (8, 1e-3)] {
            let (found, undecided) = area(halvings);
            assert!((found - truth).abs() < near, "{halvings}: {found}");
            // The rim, of length 0.9, crosses triangles of this side.
            let side = 0.5f64.powi(halvings as i32);
            assert!((found - truth).abs() <= undecided && undecided <= 4.0 * side);
        }
    }
}
