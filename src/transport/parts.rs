//! The surfaces that light meets between the walls, in parts, and what each part sends to a point.

mod divided;

use super::steps::even;
use super::vertex::{Vertex, geometry_term};
use super::visibility::hide;
use crate::geometry::{Blockers, DVec3, Interaction, Shape, ShapeId};
use crate::scene::{Scene, Surface};
pub(super) use divided::Divided;

/// Some surfaces, each in a grid of parts that are whole cells of its texture.
#[derive(Debug)]
pub(super) struct Parts {
    pub surfaces: Vec<Divided>,
    /// Position in `surfaces` of each shape that is not black.
    of_shape: Vec<Option<usize>>,
    /// Surface after surface.
    parts: Vec<Part>,
}

/// A part of a surface.
#[derive(Debug)]
struct Part {
    shape: ShapeId,
    area: f64,
    /// Albedo times area.
    weight: f64,
    /// A ball around it.
    centre: DVec3,
    radius: f64,
    /// Some points on it.
    points: [Interaction; POINTS],
}

/// Parts along v of a mesh of large triangles.
const ACROSS: usize = 4;
/// Points of a part that are looked at.
const POINTS: usize = 4;
/// The share of what a neighbour has that a part has at least.
const EDGE: f64 = 0.3;
/// The share of G that is counted where nothing is seen.
const UNSEEN: f64 = 0.1;
/// A surface, or a part of one, this many of its circumradii away is sampled by area alone: the
/// kernel varies little over it.
pub(super) const FAR: f64 = 1.25;

impl Parts {
    /// Each surface is one part.
    pub(super) fn whole(scene: &Scene, shapes: &[ShapeId]) -> Self {
        Self::new(scene, shapes, |surface| (smooth_edges(surface), [1, 1]))
    }

    /// Each surface in about `side`² parts.
    pub(super) fn divided(scene: &Scene, shapes: &[ShapeId], side: usize) -> Self {
        Self::new(scene, shapes, |surface| match &surface.shape {
            Shape::Instance(body) if !body.is_patch() => {
                // Large triangles are divided along v too.
                let across = if body.facet_count() < side * side / ACROSS {
                    ACROSS
                } else {
                    1
                };
                let edges = [body.edges(side * side / across), even(across)];
                let grid = edges.each_ref().map(|e| e.len() - 1);
                (edges, grid)
            }
            _ => {
                let count = surface.smooth_cells().map(|n| n * side.div_ceil(n));
                (count.map(even), count.map(|n| n.min(side)))
            }
        })
    }

    fn new(
        scene: &Scene,
        shapes: &[ShapeId],
        division: impl Fn(&Surface) -> ([Vec<f64>; 2], [usize; 2]),
    ) -> Self {
        let mut all = Self {
            surfaces: Vec::new(),
            of_shape: vec![None; scene.surfaces.len()],
            parts: Vec::new(),
        };
        for &shape in shapes {
            let (edges, grid) = division(&scene.surfaces[shape as usize]);
            let own = Divided::new(scene, shape, (edges, grid), all.parts.len());
            let parts: Vec<Part> = (0..own.parts()).map(|k| own.part(scene, k)).collect();
            if parts.iter().map(|p| p.weight).sum::<f64>() <= 0.0 {
                continue;
            }
            all.of_shape[shape as usize] = Some(all.surfaces.len());
            all.parts.extend(parts);
            all.surfaces.push(own);
        }
        all
    }

    /// By part: albedo times area.
    pub(super) fn weights(&self) -> impl Iterator<Item = f64> {
        self.parts.iter().map(|p| p.weight)
    }

    /// The surface of a shape that is not black.
    pub(super) fn of(&self, shape: ShapeId) -> Option<&Divided> {
        Some(&self.surfaces[self.of_shape[shape as usize]?])
    }

    /// What arrives at each part from `end`, or at `end` from it, per area and light: G·V averaged
    /// over its points, and a share of G and of what its neighbours have, so that those at the edge
    /// of a shadow are not missed.
    pub(super) fn seen_from(&self, scene: &Scene, end: &Vertex) -> Vec<f64> {
        let mut clear = Vec::with_capacity(self.parts.len() * POINTS);
        for part in &self.parts {
            clear.extend_from_slice(&part.clear_from(end));
        }
        let mut seen = clear.clone();
        let ends = |k: usize| {
            let part = &self.parts[k / POINTS];
            let at = part.points[k % POINTS].position;
            [(at, part.shape), (end.position, end.shape)]
        };
        hide(scene.bvh(), &mut seen, |_| Some(&Blockers::Any), ends);
        let mean = |terms: &[f64], k: usize| {
            terms[k * POINTS..][..POINTS].iter().sum::<f64>() / POINTS as f64
        };
        let known: Vec<f64> = (0..self.parts.len()).map(|k| mean(&seen, k)).collect();
        let mut all = Vec::with_capacity(known.len());
        for s in &self.surfaces {
            let [nu, nv] = s.grid;
            let seen = |i: usize, j: usize| known[s.first + i + j * nu];
            let beside = |i: usize, n: usize| i.saturating_sub(1)..n.min(i + 2);
            all.extend((0..s.parts()).map(|k| {
                let mut near = 0.0_f64;
                for j in beside(k / nu, nv) {
                    for i in beside(k % nu, nu) {
                        near = near.max(seen(i, j));
                    }
                }
                let k = s.first + k;
                known[k].max(EDGE * near) + UNSEEN * mean(&clear, k)
            }));
        }
        all
    }

    /// Whether all parts are far from everything within `reach` of `x`.
    pub(super) fn are_far_from(&self, x: DVec3, reach: f64) -> bool {
        let far = |p: &Part| (p.centre - x).length() - reach > FAR * p.radius;
        self.parts.iter().all(far)
    }
}

/// Edges along u and v of the cells within which a surface's albedo is smooth.
fn smooth_edges(surface: &Surface) -> [Vec<f64>; 2] {
    match &surface.shape {
        Shape::Instance(body) if !body.is_patch() => {
            let along = body.facets().map_or(even(1), |f| f.edges().to_vec());
            [along, even(1)]
        }
        _ => surface.smooth_cells().map(even),
    }
}

impl Part {
    /// G of each of its points, what stands between left out; G·(its area) is at most 1.
    fn clear_from(&self, end: &Vertex) -> [f64; POINTS] {
        let mut terms = [0.0; POINTS];
        for (out, point) in terms.iter_mut().zip(&self.points) {
            let y = (point.position, point.normal);
            let term = geometry_term(y, end.oriented()).map_or(0.0, |(term, _)| term);
            *out = term.min(1.0 / self.area);
        }
        terms
    }
}
