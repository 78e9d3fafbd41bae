//! Parts of a pixel's footprint.

use super::edges::{Across, Edges, Outline, figures};
use super::{
    Ball, FAR, MOST_FOOTPRINT_CUTS, MOST_FOOTPRINT_PARTS, folded, nodes_a_side, plane_nodes,
};
use crate::model::place::{CORNERS, area_of, within};
use crate::scene::{Scene, Surface};

/// Figures into which a square is cut, at most: along facets, and along cells of a texture too.
const MOST_FACETS: usize = 64;
const MOST_CELLS: usize = 2048;

/// A part of a footprint: corner and side in its coordinates, the ball around what is seen there,
/// and its distance from the hidden surfaces in radii.
pub(in crate::model) struct FootprintPart {
    pub from: [f64; 2],
    pub side: f64,
    pub ball: Ball,
    distance: f64,
    /// Where [`Edges`] cross it, triangles of its unit square in each of which the camera sees one
    /// facet of a wall, or none, and the front of a flat hidden surface, or its back: the integrand
    /// is smooth. None where it is whole, and where too many edges cross it.
    triangles: Vec<[[f64; 2]; 3]>,
    /// Whether the albedo may jump within it, so many cells of a texture lie there.
    pub is_motley: bool,
}

/// A convex piece of a footprint, in its coordinates.
pub(in crate::model) struct Figure {
    pub corners: Vec<[f64; 2]>,
    pub middle: [f64; 2],
    /// Of the footprint's area.
    pub share: f64,
    pub crossed: Crossed,
}

/// Whether edges of walls cross a square of a footprint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::model) enum Crossed {
    /// None does: the figure is the square.
    Not,
    /// They cut it into such figures.
    Cut,
    /// So many that it was left whole.
    TooOften,
}

impl Figure {
    /// A point so near to corner `k` that it is this figure's alone.
    pub(in crate::model) fn within(&self, k: usize) -> [f64; 2] {
        const OFF: f64 = 1e-6;
        [0, 1].map(|i| self.corners[k][i] + OFF * (self.middle[i] - self.corners[k][i]))
    }
}

/// The footprints of a scene's camera, and the edges of walls that cross them.
pub(in crate::model) struct Footprints<'a> {
    pub scene: &'a Scene,
    edges: Edges,
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
            is_motley: false,
        }
    }

    /// Coordinates in the footprint with shares of it.
    pub(in crate::model) fn nodes(&self, level: usize) -> Vec<([f64; 2], f64)> {
        // The étendue varies over it too, and so may the wall's BRDF; over many figures less.
        let finer = (0.5 * self.triangles.len() as f64).sqrt().max(1.0);
        let n = match self.ball.radius {
            0.0 => 1,
            _ => nodes_a_side(finer * self.distance, level).max(level + 1),
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

impl<'a> Footprints<'a> {
    pub(in crate::model) fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            edges: Edges::new(scene),
        }
    }

    /// Parts of a footprint, far for their size from every hidden surface.
    pub(in crate::model) fn parts(&self, pixel: usize) -> Vec<FootprintPart> {
        let scene = self.scene;
        let footprint = scene.camera.footprint(pixel);
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
                is_motley: false,
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
            let square = (part.from, part.side);
            let cut = self.cut(pixel, square, MOST_CELLS, |_| true);
            part.is_motley = cut.is_none();
            let plain = |across| across != Across::Albedo;
            let cut = cut.or_else(|| self.cut(pixel, square, MOST_FACETS, plain));
            part.triangles = cut.map_or_else(Vec::new, |figures| triangles(&figures));
        }
        done
    }

    /// A square of a footprint, a corner and a side in its coordinates, along the edges where what
    /// the camera sees jumps.
    pub(in crate::model) fn figures(
        &self,
        pixel: usize,
        square @ ([a, b], side): ([f64; 2], f64),
    ) -> Vec<Figure> {
        let placed = |[x, y]: [f64; 2]| [a + x * side, b + y * side];
        let whole = |crossed| Figure {
            corners: CORNERS.map(placed).to_vec(),
            middle: placed([0.5; 2]),
            share: side * side,
            crossed,
        };
        let cut = self.cut(pixel, square, MOST_FACETS, |across| across != Across::Side);
        let facets = || self.cut(pixel, square, MOST_FACETS, |across| across == Across::Facet);
        let cut = cut.or_else(facets);
        let Some(figures) = cut else {
            return vec![whole(Crossed::TooOften)];
        };
        if figures.len() == 1 {
            return vec![whole(Crossed::Not)];
        }
        let piece = |figure: &Outline| {
            let (area, middle) = centroid(figure);
            Figure {
                corners: figure.iter().copied().map(placed).collect(),
                middle: placed(middle),
                share: area * side * side,
                crossed: Crossed::Cut,
            }
        };
        figures.iter().map(piece).collect()
    }

    /// The figures of a square, in its own coordinates, along the edges that `counts`; none where
    /// they are more than `most`.
    fn cut(
        &self,
        pixel: usize,
        ([u, v], side): ([f64; 2], f64),
        most: usize,
        counts: impl Fn(Across) -> bool,
    ) -> Option<Vec<Outline>> {
        let (footprint, camera) = (
            self.scene.camera.footprint(pixel),
            self.scene.camera.position,
        );
        let edges = self.edges.of(pixel).filter(|edge| counts(edge.across));
        figures(edges, most, |[a, b]| {
            footprint.at([u + a * side, v + b * side]) - camera
        })
    }
}

/// Figures in triangles; none where the only one is the square.
fn triangles(figures: &[Outline]) -> Vec<[[f64; 2]; 3]> {
    if figures.len() == 1 {
        return Vec::new();
    }
    figures.iter().flat_map(|f| fan(f)).collect()
}

/// A convex figure in triangles.
fn fan(figure: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 3]> {
    let pairs = figure[1..].windows(2);
    pairs.map(|pair| [figure[0], pair[0], pair[1]])
}

/// Area and centroid of a convex figure.
fn centroid(figure: &[[f64; 2]]) -> (f64, [f64; 2]) {
    let whole: f64 = fan(figure).map(|t| area_of(&t)).sum();
    let along = |i: usize| {
        let moment = |t: [[f64; 2]; 3]| area_of(&t) * within(&t, [1.0 / 3.0; 3])[i];
        fan(figure).map(moment).sum::<f64>() / whole
    };
    (whole, [along(0), along(1)])
}
