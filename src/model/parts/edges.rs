//! Edges of walls before the camera.

use crate::geometry::{DVec3, Shape};
use crate::model::place::{CORNERS, halved};
use crate::scene::{Camera, Scene, Surface};

/// An edge of a wall nearer to a corner of a part than this fraction of it passes through it.
const ON_EDGE: f64 = 1e-12;
/// Pixels beyond its own that a segment is looked for in.
const BESIDE: f64 = 1e-6;

/// A convex figure, by its corners.
pub(super) type Outline = Vec<[f64; 2]>;

/// What changes across an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Across {
    /// The facet that the camera sees.
    Facet,
    /// The albedo of the wall, or its slope.
    Albedo,
    /// Which side a hidden surface shows.
    Side,
}

/// A plane through the camera across which the light of what it sees of walls may jump or bend.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    normal: DVec3,
    /// Of a segment: of w from the camera all n·w > 0 between its ends.
    ends: Option<[DVec3; 2]>,
    pub across: Across,
}

/// The edges of a scene's walls.
pub(super) struct Edges {
    /// Without an end.
    lines: Vec<Edge>,
    /// Those that may cross each pixel.
    segments: Vec<Vec<Edge>>,
}

impl Edges {
    /// Of parallelograms and of where meshes fold or end, where what the camera sees jumps; between
    /// the cells of a parallelogram's texture, where its albedo does; and
    /// through the line in which the planes of two walls, or of a wall and a flat hidden surface,
    /// meet, n·w = d and m·w = e: n (e − m·o) − m (d − n·o), o the camera. Beyond the latter a
    /// hidden surface shows its back. Rims of discs and balls are not among them.
    pub(super) fn new(scene: &Scene) -> Self {
        let camera = &scene.camera;
        let mut segments = vec![Vec::new(); camera.pixels()];
        let of = |(_, wall)| {
            let seams = Surface::seams(wall).unwrap_or_default().into_iter();
            let sides = sides(wall).into_iter().map(|ends| (ends, Across::Facet));
            sides.chain(seams.map(|ends| (ends, Across::Albedo)))
        };
        for (ends, across) in scene.relays().flat_map(of) {
            let ends = ends.map(|p| p - camera.position);
            add(camera, (ends, across), &mut segments);
        }
        Self {
            lines: lines(scene),
            segments,
        }
    }

    /// Those that may cross a pixel.
    pub(super) fn of(&self, pixel: usize) -> impl Iterator<Item = &Edge> {
        self.segments[pixel].iter().chain(&self.lines)
    }
}

/// Where what is seen of a wall may jump.
fn sides(wall: &Surface) -> Vec<[DVec3; 2]> {
    match &wall.shape {
        Shape::Parallelogram(p) => p.sides().to_vec(),
        Shape::Instance(body) => body.folds().collect(),
        Shape::Disc(_) | Shape::Sphere(_) => Vec::new(),
    }
}

/// Where the planes of flat surfaces meet.
fn lines(scene: &Scene) -> Vec<Edge> {
    let camera = scene.camera.position;
    let plane = |(_, surface): (usize, &Surface)| match &surface.shape {
        Shape::Parallelogram(p) => Some((p.normal(), p.normal().dot(p.corner() - camera))),
        Shape::Disc(d) => Some((d.normal(), d.normal().dot(d.centre() - camera))),
        _ => None,
    };
    let walls: Vec<(DVec3, f64)> = scene.relays().filter_map(plane).collect();
    let hidden: Vec<(DVec3, f64)> = scene.hidden().filter_map(plane).collect();
    let mut found = Vec::new();
    for (i, (n, d)) in walls.iter().enumerate() {
        let others = walls[..i].iter().map(|plane| (plane, Across::Facet));
        for ((m, e), across) in others.chain(hidden.iter().map(|plane| (plane, Across::Side))) {
            let normal = *n * *e - *m * *d;
            // Parallel planes meet nowhere.
            if normal.length() > ON_EDGE * (d.abs() + e.abs()) {
                found.push(Edge {
                    normal,
                    ends: None,
                    across,
                });
            }
        }
    }
    found
}

/// Adds a segment, its ends from the camera, to the pixels that it may cross.
fn add(camera: &Camera, ([a, b], across): ([DVec3; 2], Across), segments: &mut [Vec<Edge>]) {
    let normal = a.cross(b);
    let edge = Edge {
        normal,
        ends: Some([normal.cross(a), b.cross(normal)]),
        across,
    };
    let to_view = camera.view.corner() - camera.position;
    let view = camera.view.normal() * camera.view.normal().dot(to_view).signum();
    let distance = view.dot(to_view);
    // What is nearer is taken for as far off as this: it may lie beside the camera.
    let least = 1e-6 * distance;
    let [p, q] = [a, b].map(|end| view.dot(end));
    if normal == DVec3::ZERO || p.max(q) <= least {
        return;
    }
    let before = |end: DVec3, depth: f64, other: DVec3, others: f64| {
        if depth >= least {
            return (end, depth);
        }
        (
            end + (other - end) * ((least - depth) / (others - depth)),
            least,
        )
    };
    let ends = [before(a, p, b, q), before(b, q, a, p)].map(|(end, depth)| {
        let at = camera.position + end * (distance / depth);
        camera.view.coordinates(at)
    });
    let range = |axis: usize, count: usize| {
        let [from, to] = [ends[0][axis], ends[1][axis]].map(|x| x * count as f64);
        let first = (from.min(to) - BESIDE).max(0.0) as usize;
        first..((from.max(to) + BESIDE).max(-1.0).floor() + 1.0).min(count as f64) as usize
    };
    for row in range(1, camera.rows) {
        for column in range(0, camera.columns) {
            let pixel = column + row * camera.columns;
            if across != Across::Albedo || edge.may_cross(camera, pixel) {
                segments[pixel].push(edge);
            }
        }
    }
}

impl Edge {
    /// Whether the corners of a pixel's footprint lie on both sides of it: of many cells of a
    /// texture few are near.
    fn may_cross(&self, camera: &Camera, pixel: usize) -> bool {
        let footprint = camera.footprint(pixel);
        let height = |at: [f64; 2]| self.normal.dot(footprint.at(at) - camera.position);
        let heights = CORNERS.map(height);
        heights.iter().any(|h| *h > 0.0) && heights.iter().any(|h| *h < 0.0)
    }

    /// Whether it divides a figure whose corners have these heights over its plane.
    fn divides(
        &self,
        figure: &[[f64; 2]],
        height: &impl Fn([f64; 2]) -> f64,
        from: &impl Fn([f64; 2]) -> DVec3,
    ) -> bool {
        let heights: Vec<f64> = figure.iter().map(|at| height(*at)).collect();
        if heights.iter().all(|h| *h <= 0.0) || heights.iter().all(|h| *h >= 0.0) {
            return false;
        }
        let Some(ends) = self.ends else { return true };
        // Where the plane crosses the figure's rim.
        let crossings = (0..figure.len()).filter_map(|k| {
            let next = (k + 1) % figure.len();
            let (p, q, h, g) = (figure[k], figure[next], heights[k], heights[next]);
            let t = if h == 0.0 { 0.0 } else { h / (h - g) };
            (h == 0.0 || h * g < 0.0).then(|| from([0, 1].map(|i| p[i] + t * (q[i] - p[i]))))
        });
        let crossings: Vec<DVec3> = crossings.collect();
        let beyond = |end: &DVec3| crossings.iter().all(|at| end.dot(*at) <= 0.0);
        !ends.iter().any(beyond)
    }
}

/// The figures into which edges cut the unit square, points of which are so far `from` the camera:
/// along a segment only those that it crosses. None where they are more than `most`.
pub(super) fn figures<'e>(
    edges: impl Iterator<Item = &'e Edge>,
    most: usize,
    from: impl Fn([f64; 2]) -> DVec3,
) -> Option<Vec<Outline>> {
    let mut figures = vec![CORNERS.to_vec()];
    for edge in edges {
        // The height is linear over the square.
        let height = |at| edge.normal.dot(from(at));
        let size = CORNERS.map(|at| height(at).abs()).into_iter();
        let slack = ON_EDGE * size.fold(0.0, f64::max);
        let snapped = |at| match height(at) {
            h if h.abs() <= slack => 0.0,
            h => h,
        };
        if !edge.divides(&CORNERS, &snapped, &from) {
            continue;
        }
        let parts = figures.into_iter().flat_map(|figure| {
            if edge.divides(&figure, &snapped, &from) {
                halved(&figure, snapped).to_vec()
            } else {
                vec![figure]
            }
        });
        figures = parts.filter(|figure| figure.len() > 2).collect();
        if figures.len() > most {
            return None;
        }
    }
    Some(figures)
}
