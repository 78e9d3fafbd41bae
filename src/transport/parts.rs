//! The surfaces that light meets between the walls, in parts, and what each part sends to a point.

use super::steps::{digits, even, invert};
use super::vertex::{Vertex, geometry_term};
use super::visibility::hide;
use crate::geometry::{Blockers, DVec3, Interaction, Shape, ShapeId};
use crate::scene::{Scene, Surface};

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

/// One surface, its cells in rows of u.
#[derive(Debug)]
pub(super) struct Divided {
    pub shape: ShapeId,
    area: f64,
    /// Parameters u and v before each cell, and behind the last.
    edges: [Vec<f64>; 2],
    /// Parts along u and v.
    pub grid: [usize; 2],
    /// Its first part.
    pub first: usize,
    /// By row of cells: ∫ρ du before each cell of it, and over all.
    along: Vec<f64>,
    /// By column of parts: ∫∫ρ du dv before each row of cells, and over all.
    down: Vec<f64>,
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
        let clear: Vec<f64> = self.parts.iter().flat_map(|p| p.clear_from(end)).collect();
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
                let rows = beside(k / nu, nv);
                let near = rows.flat_map(|j| beside(k % nu, nu).map(move |i| seen(i, j)));
                let k = s.first + k;
                known[k].max(EDGE * near.fold(0.0, f64::max)) + UNSEEN * mean(&clear, k)
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
        self.points.map(|point| {
            let y = (point.position, point.normal);
            let term = geometry_term(y, end.oriented()).map_or(0.0, |(term, _)| term);
            term.min(1.0 / self.area)
        })
    }
}

impl Divided {
    fn new(
        scene: &Scene,
        shape: ShapeId,
        (edges, grid): ([Vec<f64>; 2], [usize; 2]),
        first: usize,
    ) -> Self {
        let surface = &scene.surfaces[shape as usize];
        let [nu, nv] = edges.each_ref().map(|e| e.len() - 1);
        let smooth = smooth_edges(surface);
        let parent = |d: usize, i: usize| {
            let middle = 0.5 * (edges[d][i] + edges[d][i + 1]);
            let inner = &smooth[d][1..smooth[d].len() - 1];
            inner.partition_point(|edge| *edge <= middle)
        };
        let mut along = Vec::with_capacity((nu + 1) * nv);
        for j in 0..nv {
            let mut before = 0.0;
            along.push(before);
            for i in 0..nu {
                let cell = parent(0, i) + parent(1, j) * (smooth[0].len() - 1);
                before += surface.cell_weight(cell) * (edges[0][i + 1] - edges[0][i]);
                along.push(before);
            }
        }
        let mut own = Self {
            shape,
            area: surface.shape.area(),
            edges,
            grid,
            first,
            along,
            down: Vec::new(),
        };
        for i in 0..grid[0] {
            let mut before = 0.0;
            own.down.push(before);
            for j in 0..nv {
                let [from, to] = own.cells(0, i).map(|c| own.along[j * (nu + 1) + c]);
                before += (to - from) * own.width(1, j);
                own.down.push(before);
            }
        }
        own
    }

    /// Number of parts.
    pub(super) fn parts(&self) -> usize {
        self.grid[0] * self.grid[1]
    }

    /// Number of cells along u (0) or v (1).
    fn count(&self, d: usize) -> usize {
        self.edges[d].len() - 1
    }

    /// Width of a cell.
    fn width(&self, d: usize, cell: usize) -> f64 {
        self.edges[d][cell + 1] - self.edges[d][cell]
    }

    /// The cells of part i: the first, and the one behind the last.
    fn cells(&self, d: usize, i: usize) -> [usize; 2] {
        [i, i + 1].map(|i| (i * self.count(d)).div_ceil(self.grid[d]))
    }

    /// Albedo times area of a part.
    fn weight(&self, part: usize) -> f64 {
        let i = part % self.grid[0];
        let [from, to] = self.cells(1, part / self.grid[0]);
        let down = &self.down[i * (self.count(1) + 1)..];
        self.area * (down[to] - down[from])
    }

    fn part(&self, scene: &Scene, part: usize) -> Part {
        let [low, high] = [[0.0; 2], [1.0; 2]].map(|place| self.inside(part, place));
        let (centre, radius) = self.ball(scene, part);
        Part {
            shape: self.shape,
            area: self.area * (high[0] - low[0]) * (high[1] - low[1]),
            weight: self.weight(part),
            centre,
            radius,
            points: self.points(scene, part),
        }
    }

    /// The part in which the parameters lie, and the density of the light there: ρ over ∫ρ dA of
    /// the part.
    pub(super) fn locate(&self, uv: [f64; 2]) -> (usize, f64) {
        let cell = |d: usize| {
            let inner = &self.edges[d][1..self.count(d)];
            inner.partition_point(|edge| *edge <= uv[d])
        };
        let [i, j] = [cell(0), cell(1)];
        let part = |d: usize, cell: usize| cell * self.grid[d] / self.count(d);
        let part = part(0, i) + part(1, j) * self.grid[0];
        let along = &self.along[j * (self.count(0) + 1)..];
        let light = (along[i + 1] - along[i]) / self.width(0, i);
        (self.first + part, light / self.weight(part))
    }

    /// The parameters in a part for u ∈ [0, 1)², rows of cells by their weight, then cells by
    /// theirs, with the density of the light there.
    pub(super) fn place(&self, part: usize, [a, b]: [f64; 2]) -> ([f64; 2], f64) {
        let i = part % self.grid[0];
        let [top, bottom] = self.cells(1, part / self.grid[0]);
        let [left, right] = self.cells(0, i);
        let down = &self.down[i * (self.count(1) + 1) + top..];
        let (row, v) = invert(bottom - top, |j| down[j], b);
        let along = &self.along[(top + row) * (self.count(0) + 1) + left..];
        let (column, u) = invert(right - left, |i| along[i], a);
        let (i, j) = (left + column, top + row);
        let at =
            |d: usize, cell: usize, rest: f64| self.edges[d][cell] + rest * self.width(d, cell);
        let light = (along[column + 1] - along[column]) / self.width(0, i);
        ([at(0, i, u), at(1, j, v)], light / self.weight(part))
    }

    /// Whether all edges of cells that are lit are multiples of 2⁻ᵐ along u and of 2⁻ⁿ along v, of
    /// the weight before them, m + n ≤ `most`. Of a surface that is one part.
    pub(super) fn is_dyadic(&self, most: u32) -> bool {
        let [nu, nv] = [self.count(0), self.count(1)];
        let lit_rows = (0..nv).filter(|j| self.down[j + 1] > self.down[*j]);
        let columns = lit_rows
            .map(|j| digits(&self.along[j * (nu + 1)..][..=nu], most))
            .try_fold(0, |m, d| d.map(|d| d.max(m)));
        let rows = digits(&self.down[..=nv], most);
        rows.zip(columns).is_some_and(|(r, c)| r + c <= most)
    }

    /// Points spread over a part: some of the R2 sequence (Roberts, *The unreasonable effectiveness
    /// of quasirandom sequences*, 2018).
    fn points(&self, scene: &Scene, part: usize) -> [Interaction; POINTS] {
        /// 1/φ₂ and 1/φ₂², φ₂³ = φ₂ + 1.
        const STEP: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
        let shape = &scene.surfaces[self.shape as usize].shape;
        let place = |k: usize| STEP.map(|s| (0.5 + k as f64 * s).fract());
        std::array::from_fn(|k| shape.at(self.inside(part, place(k))))
    }

    /// The parameters at a place in [0, 1]² of a part.
    fn inside(&self, part: usize, place: [f64; 2]) -> [f64; 2] {
        let index = [part % self.grid[0], part / self.grid[0]];
        std::array::from_fn(|d| {
            let [from, to] = self.cells(d, index[d]).map(|c| self.edges[d][c]);
            from + place[d] * (to - from)
        })
    }

    /// A ball around a part: around all of a sphere or a disc.
    fn ball(&self, scene: &Scene, part: usize) -> (DVec3, f64) {
        let shape = &scene.surfaces[self.shape as usize].shape;
        let [low, high] = [[0.0; 2], [1.0; 2]].map(|place| self.inside(part, place));
        match shape {
            Shape::Parallelogram(patch) => {
                let at = |place: [f64; 2]| patch.at(self.inside(part, place)).position;
                let centre = at([0.5; 2]);
                let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
                let reach = corners.map(|c| (at(c) - centre).length());
                (centre, reach.into_iter().fold(0.0, f64::max))
            }
            Shape::Instance(body) => {
                let (low, high) = body.bounds_between(low, high);
                ((low + high) * 0.5, (high - low).length() * 0.5)
            }
            Shape::Sphere(_) | Shape::Disc(_) => shape.circumsphere(),
        }
    }
}
