//! One surface, divided into parts.

use super::{POINTS, Part, smooth_edges};
use crate::geometry::{DVec3, Interaction, Shape, ShapeId};
use crate::scene::Scene;
use crate::transport::steps::{digits, invert};

/// One surface, its cells in rows of u.
#[derive(Debug)]
pub(in crate::transport) struct Divided {
    pub shape: ShapeId,
    area: f64,
    /// Parameters u and v before each cell, and behind the last.
    edges: [Vec<f64>; 2],
    /// Parts along u and v.
    pub grid: [usize; 2],
    /// Along u and v: the first cell of each part, and the one behind the last.
    bounds: [Vec<usize>; 2],
    /// Its first part.
    pub first: usize,
    /// By row of cells: ∫ρ du before each cell of it, and over all.
    along: Vec<f64>,
    /// By column of parts: ∫∫ρ du dv before each row of cells, and over all.
    down: Vec<f64>,
    /// Albedo times area of each part.
    weights: Vec<f64>,
    /// By row of cells: the density of the light in each, ρ over ∫ρ dA of its part.
    light: Vec<f64>,
}

impl Divided {
    pub(super) fn new(
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
            bounds: [(nu, 0), (nv, 1)].map(|(count, d)| {
                let bound = |i: usize| (i * count).div_ceil(grid[d]);
                (0..=grid[d]).map(bound).collect()
            }),
            edges,
            grid,
            first,
            along,
            down: Vec::new(),
            weights: Vec::new(),
            light: Vec::new(),
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
        own.weights = (0..own.parts()).map(|part| own.weight(part)).collect();
        let light = |cell: usize| {
            let (i, j) = (cell % nu, cell / nu);
            let along = &own.along[j * (nu + 1)..];
            (along[i + 1] - along[i]) / own.width(0, i) / own.weights[own.part_of([i, j])]
        };
        own.light = (0..nu * nv).map(light).collect();
        own
    }

    /// Number of parts.
    pub(in crate::transport) fn parts(&self) -> usize {
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
        [self.bounds[d][i], self.bounds[d][i + 1]]
    }

    /// Albedo times area of a part.
    fn weight(&self, part: usize) -> f64 {
        let i = part % self.grid[0];
        let [from, to] = self.cells(1, part / self.grid[0]);
        let down = &self.down[i * (self.count(1) + 1)..];
        self.area * (down[to] - down[from])
    }

    pub(super) fn part(&self, scene: &Scene, part: usize) -> Part {
        let [low, high] = [[0.0; 2], [1.0; 2]].map(|place| self.inside(part, place));
        let (centre, radius) = self.ball(scene, part);
        Part {
            shape: self.shape,
            area: self.area * (high[0] - low[0]) * (high[1] - low[1]),
            weight: self.weights[part],
            centre,
            radius,
            points: self.points(scene, part),
        }
    }

    /// The part in which the parameters lie, and the density of the light there: ρ over ∫ρ dA of
    /// the part.
    pub(in crate::transport) fn locate(&self, uv: [f64; 2]) -> (usize, f64) {
        let cell = |d: usize| {
            let inner = &self.edges[d][1..self.count(d)];
            inner.partition_point(|edge| *edge <= uv[d])
        };
        let [i, j] = [cell(0), cell(1)];
        let part = self.first + self.part_of([i, j]);
        (part, self.light[i + j * self.count(0)])
    }

    /// The part that holds a cell.
    fn part_of(&self, cell: [usize; 2]) -> usize {
        let along = |d: usize| cell[d] * self.grid[d] / self.count(d);
        along(0) + along(1) * self.grid[0]
    }

    /// The parameters in a part for u ∈ [0, 1)², rows of cells by their weight, then cells by
    /// theirs, with the density of the light there.
    pub(in crate::transport) fn place(&self, part: usize, [a, b]: [f64; 2]) -> ([f64; 2], f64) {
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
        (
            [at(0, i, u), at(1, j, v)],
            self.light[i + j * self.count(0)],
        )
    }

    /// Whether all edges of cells that are lit are multiples of 2⁻ᵐ along u and of 2⁻ⁿ along v, of
    /// the weight before them, m + n ≤ `most`. Of a surface that is one part.
    pub(in crate::transport) fn is_dyadic(&self, most: u32) -> bool {
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
        let at = |d: usize| {
            let [from, to] = self.cells(d, index[d]);
            let from = self.edges[d][from];
            from + place[d] * (self.edges[d][to] - from)
        };
        [at(0), at(1)]
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
