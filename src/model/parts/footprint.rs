//! Parts of a pixel's footprint.

use super::{
    Ball, FAR, MOST_FOOTPRINT_CUTS, MOST_FOOTPRINT_PARTS, folded, nodes_a_side, plane_nodes,
};
use crate::geometry::{DVec3, Parallelogram, Shape};
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
    /// Where a wall's edge crosses it, triangles of its unit square in each of which the camera
    /// sees one wall, or none: across a step the integrand jumps. None where it is whole.
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

/// Normals of planes through the camera along which what it sees may jump from one flat wall to
/// another: through each edge of each, and through the line in which two planes meet, n_i·w = d_i:
/// n_i (d_j − n_j·o) − n_j (d_i − n_i·o), o the camera.
fn edges(scene: &Scene) -> Vec<DVec3> {
    let camera = scene.camera.position;
    let flat: Vec<&Parallelogram> = scene
        .relays()
        .filter_map(|(_, wall)| match &wall.shape {
            Shape::Parallelogram(p) => Some(p),
            _ => None,
        })
        .collect();
    let own = flat.iter().flat_map(|wall| {
        let corners = wall.corners().map(|c| c - camera);
        (0..4).map(move |k| corners[k].cross(corners[(k + 1) % 4]))
    });
    let shared = (0..flat.len()).flat_map(|i| {
        let flat = &flat;
        (0..i).filter_map(move |j| {
            let [n, m] = [i, j].map(|k| flat[k].normal());
            let [d, e] = [i, j].map(|k| flat[k].normal().dot(flat[k].corner() - camera));
            let normal = n * e - m * d;
            // Walls in one plane meet nowhere.
            (normal.length() > ON_EDGE * (d.abs() + e.abs())).then_some(normal)
        })
    });
    own.chain(shared).collect()
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
