//! Parts of a pixel's footprint.

use super::{
    Ball, FAR, MOST_FOOTPRINT_CUTS, MOST_FOOTPRINT_PARTS, folded, nodes_a_side, plane_nodes,
};
use crate::geometry::{DVec3, Shape};
use crate::model::place::{CORNERS, area_of, halved, within};
use crate::scene::{Scene, Surface};

/// An edge of a wall nearer to a corner of a part than this fraction of it passes through it.
const ON_EDGE: f64 = 1e-12;

/// A part of a footprint: corner and side in its coordinates, the ball around what is seen there,
/// and its distance from the hidden surfaces in radii.
pub(in crate::model) struct FootprintPart {
    pub from: [f64; 2],
    pub side: f64,
    pub ball: Ball,
    distance: f64,
    /// Where [`edges`] cross it, triangles of its unit square in each of which the camera sees one
    /// wall, or none, and the front of a flat hidden surface, or its back: the integrand is smooth.
    /// None where it is whole.
    triangles: Vec<[[f64; 2]; 3]>,
}

impl FootprintPart {
    /// All of a footprint by its middle.
    pub(in crate::model) fn centre(scene: &Scene, pixel: usize) -> Self {
        let middle = scene.camera.footprint(pixel).at([0.5; 2]);
        Self {
            from: [0.0; 2],
            side: 1.0,
            ball: Ball {
                middle,
                radius: 0.0,
            },
            distance: f64::INFINITY,
            triangles: Vec::new(),
        }
    }

    /// Coordinates in the footprint with shares of it.
    pub(in crate::model) fn nodes(&self, level: usize) -> Vec<([f64; 2], f64)> {
        // The étendue varies over it too, and so may the wall's BRDF.
        let n = match self.ball.radius {
            0.0 => 1,
            _ => nodes_a_side(self.distance, level).max(level + 1),
        };
        let ([u, v], side) = (self.from, self.side);
        let placed = |([a, b], w): ([f64; 2], f64)| ([u + side * a, v + side * b], w * side * side);
        if self.triangles.is_empty() {
            return plane_nodes(n).map(placed).collect();
        }
        let rule = folded(n, &plane_nodes(n).collect::<Vec<_>>());
        let nodes = self.triangles.iter().flat_map(|triangle| {
            let node = |(at, w): &([f64; 3], f64)| (within(triangle, *at), w * area_of(triangle));
            rule.iter().map(node)
        });
        nodes.map(placed).collect()
    }
}

/// Parts of a footprint, far for their size from every hidden surface.
pub(in crate::model) fn footprint_parts(scene: &Scene, pixel: usize) -> Vec<FootprintPart> {
    let footprint = scene.camera.footprint(pixel);
    let (camera, edges) = (scene.camera.position, edges(scene));
    let part = |from @ [a, b]: [f64; 2], side: f64| {
        let middle = footprint.at([a + 0.5 * side, b + 0.5 * side]);
        let radius = 0.5 * side * (footprint.u.length() + footprint.v.length());
        let from_surface = |(_, surface): (usize, &Surface)| {
            (surface.shape.at_position(middle).position - middle).length() / radius
        };
        FootprintPart {
            from,
            side,
            ball: Ball { middle, radius },
            distance: scene
                .hidden()
                .map(from_surface)
                .fold(f64::INFINITY, f64::min),
            triangles: Vec::new(),
        }
    };
    let (mut done, mut open) = (Vec::new(), vec![part([0.0; 2], 1.0)]);
    for cuts in 0..=MOST_FOOTPRINT_CUTS {
        let mut next = Vec::new();
        for own in open {
            let full = done.len() + next.len() + 4 > MOST_FOOTPRINT_PARTS;
            if cuts == MOST_FOOTPRINT_CUTS || full || own.distance >= FAR {
                done.push(own);
            } else {
                let ([a, b], half) = (own.from, 0.5 * own.side);
                let corners = [[a, b], [a + half, b], [a, b + half], [a + half, b + half]];
                next.extend(corners.map(|from| part(from, half)));
            }
        }
        open = next;
    }
    for part in &mut done {
        part.triangles = triangles(part, &edges, |at| footprint.at(at) - camera);
    }
    done
}

/// Normals of planes through the camera along which the light of what it sees of flat walls may
/// jump or bend: through each edge of each, where what it sees jumps, and through the line in which
/// the planes of two walls, or of a wall and a flat hidden surface, meet, n·w = d and m·w = e: n (e
/// − m·o) − m (d − n·o), o the camera. Beyond the latter a hidden surface shows its back.
fn edges(scene: &Scene) -> Vec<DVec3> {
    let camera = scene.camera.position;
    let plane = |(_, surface): (usize, &Surface)| match &surface.shape {
        Shape::Parallelogram(p) => Some((p.normal(), p.normal().dot(p.corner() - camera))),
        Shape::Disc(d) => Some((d.normal(), d.normal().dot(d.centre() - camera))),
        _ => None,
    };
    let walls: Vec<(DVec3, f64)> = scene.relays().filter_map(plane).collect();
    let hidden: Vec<(DVec3, f64)> = scene.hidden().filter_map(plane).collect();
    let sides = |(_, wall): (usize, &Surface)| {
        let Shape::Parallelogram(p) = &wall.shape else {
            return Vec::new();
        };
        let corners = p.corners().map(|c| c - camera);
        let side = |k: usize| corners[k].cross(corners[(k + 1) % 4]);
        (0..4).map(side).collect()
    };
    let mut found: Vec<DVec3> = scene.relays().flat_map(sides).collect();
    for (i, (n, d)) in walls.iter().enumerate() {
        for (m, e) in walls[..i].iter().chain(&hidden) {
            let normal = *n * *e - *m * *d;
            // Parallel planes meet nowhere.
            if normal.length() > ON_EDGE * (d.abs() + e.abs()) {
                found.push(normal);
            }
        }
    }
    found
}

/// [`FootprintPart::triangles`]: its square in convex figures between the edges that cross it, of
/// points of the footprint `from` the camera.
fn triangles(
    part: &FootprintPart,
    edges: &[DVec3],
    from: impl Fn([f64; 2]) -> DVec3,
) -> Vec<[[f64; 2]; 3]> {
    let mut figures = vec![CORNERS.to_vec()];
    for normal in edges {
        let height = |[a, b]: [f64; 2]| {
            let at = [part.from[0] + a * part.side, part.from[1] + b * part.side];
            normal.dot(from(at))
        };
        // The height is linear over the square.
        let corners = CORNERS.map(height);
        let size = corners.into_iter().map(f64::abs).fold(0.0, f64::max);
        let slack = ON_EDGE * size;
        if corners.iter().any(|h| *h > slack) && corners.iter().any(|h| *h < -slack) {
            let snapped = |at| match height(at) {
                h if h.abs() <= slack => 0.0,
                h => h,
            };
            let halves = figures.iter().flat_map(|f| halved(f, snapped));
            figures = halves.filter(|f| f.len() > 2).collect();
        }
    }
    if figures.len() == 1 {
        return Vec::new();
    }
    let fan = |f: &Vec<[f64; 2]>| {
        let pairs = f[1..].windows(2);
        let all = pairs.map(|pair| [f[0], pair[0], pair[1]]);
        all.collect::<Vec<_>>()
    };
    figures.iter().flat_map(fan).collect()
}
