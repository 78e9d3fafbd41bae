//! Triangles cut into facets.

use super::area_map::AreaMap;
use super::{Mesh, is_proper, nearest};
use crate::geometry::{DVec3, Interaction};

/// A facet of a triangle of a mesh: a triangle within it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// The triangle.
    pub triangle: u32,
    /// At its corners the weights of the triangle's second and third corner.
    pub corners: [[f64; 2]; 3],
    /// What it belongs to: facets of one cell lie side by side in the equal-area map.
    pub cell: u32,
}

impl Facet {
    /// The point at these weights of its second and third corner: weights of the triangle's.
    pub(super) fn at(&self, [v, w]: [f64; 2]) -> [f64; 2] {
        let [a, b, c] = self.corners;
        let at = |d: usize| a[d] + (b[d] - a[d]) * v + (c[d] - a[d]) * w;
        [at(0), at(1)]
    }

    /// The weights of its second and third corner at a point of the triangle.
    fn weights(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [a, b, c] = self.corners;
        let [p, q, r] = [b, c, [x, y]].map(|c| [c[0] - a[0], c[1] - a[1]]);
        let whole = p[0] * q[1] - p[1] * q[0];
        [
            (r[0] * q[1] - r[1] * q[0]) / whole,
            (p[0] * r[1] - p[1] * r[0]) / whole,
        ]
    }

    /// Its share of the triangle's area.
    fn share(&self) -> f64 {
        let [a, b, c] = self.corners;
        let [p, q] = [b, c].map(|c| [c[0] - a[0], c[1] - a[1]]);
        (p[0] * q[1] - p[1] * q[0]).abs()
    }
}

/// The facets of all triangles of a mesh, and the equal-area map that takes them cell after cell.
#[derive(Clone, Debug)]
pub struct Facets {
    /// By triangle.
    facets: Vec<Facet>,
    /// By triangle: its first facet, and the end.
    first: Vec<u32>,
    /// Of triangles with many facets: a grid over their weights, by triangle.
    finders: Vec<Option<Finder>>,
    pub(super) map: AreaMap,
    /// Cells that have an area, as they follow each other along u.
    cells: Vec<u32>,
    /// Where they begin along u, and the end.
    edges: Vec<f64>,
}

/// More facets than this in one triangle are looked for in a grid.
const FEW: usize = 16;

impl Facets {
    /// Of a mesh whose triangles have these areas. `facets` make up its triangles, each of which is
    /// covered once, in the order of the triangles; `middle` is as in [`AreaMap::new`], of facets.
    pub(super) fn new(facets: Vec<Facet>, areas: &[f64], middle: impl Fn(&Facet) -> DVec3) -> Self {
        let own: Vec<f64> = facets
            .iter()
            .map(|p| p.share() * areas[p.triangle as usize])
            .collect();
        let map = AreaMap::in_cells(&own, |i| {
            let facet = &facets[i as usize];
            (facet.cell, middle(facet))
        });
        let mut first = vec![0; areas.len() + 1];
        for facet in &facets {
            first[facet.triangle as usize + 1] += 1;
        }
        for t in 0..areas.len() {
            first[t + 1] += first[t];
        }
        let of = |t: usize| &facets[first[t] as usize..first[t + 1] as usize];
        let finders = (0..areas.len())
            .map(|t| (of(t).len() > FEW).then(|| Finder::new(of(t))))
            .collect();
        let (mut cells, mut edges) = (Vec::new(), Vec::new());
        for (place, sum) in map.sums.iter().enumerate() {
            let cell = facets[map.order[place] as usize].cell;
            if *sum > map.before(place) && cells.last() != Some(&cell) {
                cells.push(cell);
                edges.push(map.before(place) / map.area());
            }
        }
        edges.push(1.0);
        Self {
            facets,
            first,
            finders,
            map,
            cells,
            edges,
        }
    }

    /// All of them, by triangle.
    pub fn all(&self) -> &[Facet] {
        &self.facets
    }

    /// The cells that have an area, as they follow each other along u.
    pub fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// Where these cells begin along u, and the end.
    pub fn edges(&self) -> &[f64] {
        &self.edges
    }

    /// The triangle at (u, v), and the weights of its second and third corner.
    pub(super) fn point(&self, uv: [f64; 2]) -> (u32, [f64; 2]) {
        let (facet, weights) = self.map.point(uv);
        self.on(facet, weights)
    }

    /// The same at a place of a facet.
    pub(super) fn on(&self, facet: u32, weights: [f64; 2]) -> (u32, [f64; 2]) {
        let facet = &self.facets[facet as usize];
        (facet.triangle, facet.at(weights))
    }

    /// Where the map takes the point of a triangle with these weights from.
    pub(super) fn inverse(&self, triangle: u32, at: [f64; 2]) -> [f64; 2] {
        let t = triangle as usize;
        let range = self.first[t]..self.first[t + 1];
        // Rounding may leave a point outside all facets: the one it is least outside of counts.
        let within = |i: u32| {
            let [v, w] = self.facets[i as usize].weights(at);
            let least = v.min(w).min(1.0 - v - w);
            if least.is_nan() {
                f64::NEG_INFINITY
            } else {
                least
            }
        };
        let deepest = |found: (f64, u32), i: u32| {
            let depth = within(i);
            if depth > found.0 { (depth, i) } else { found }
        };
        let start = (f64::NEG_INFINITY, range.start);
        let (_, facet) = match &self.finders[t] {
            None => range.fold(start, deepest),
            Some(finder) => {
                let near = finder.near(at).iter().map(|k| range.start + k);
                near.fold(start, deepest)
            }
        };
        let [v, w] = self.facets[facet as usize]
            .weights(at)
            .map(|x| x.clamp(0.0, 1.0));
        let over = (v + w).max(1.0);
        self.map.inverse(facet, [v / over, w / over])
    }
}

impl Mesh {
    /// The mesh's triangles cut into facets, which make up each triangle once and stand in the
    /// order of the triangles.
    pub fn cut(&self, facets: Vec<Facet>) -> Facets {
        let areas: Vec<f64> = (0..self.triangles.len() as u32)
            .map(|t| {
                if is_proper(self.corners(t)) {
                    self.triangle_area(t)
                } else {
                    0.0
                }
            })
            .collect();
        let (low, high) = self.bounds;
        let side = (high - low).max_element();
        Facets::new(facets, &areas, |facet| {
            let corners = facet.corners.map(|w| self.place(facet.triangle, w) - low);
            (corners[0] + corners[1] + corners[2]) / side
        })
    }

    /// [`Mesh::at`] by the map of `facets`.
    pub fn at_facet(&self, facets: &Facets, uv: [f64; 2]) -> Interaction {
        let (triangle, weights) = facets.point(uv);
        self.point(triangle, weights)
    }

    /// [`Mesh::parameters`] by the map of `facets`.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn parameters_in(&self, facets: &Facets, triangle: u32, p: DVec3) -> [f64; 2] {
        let (_, weights) = nearest::on_triangle(self.corners(triangle), p);
        facets.inverse(triangle, weights)
    }

    /// [`Mesh::edges`] by the map of `facets`; the edges of its cells are among them.
    pub fn edges_in(&self, facets: &Facets, parts: usize) -> Vec<f64> {
        let count = facets.all().len();
        if count <= parts {
            return facets.map.edges(parts, parts.div_ceil(count));
        }
        let even = (0..=parts).map(|k| k as f64 / parts as f64);
        let mut edges: Vec<f64> = even.chain(facets.edges().iter().copied()).collect();
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        edges
    }

    /// [`Mesh::hull`] by the map of `facets`.
    pub fn hull_in(
        &self,
        facets: &Facets,
        low: [f64; 2],
        high: [f64; 2],
    ) -> impl Iterator<Item = DVec3> {
        let points = facets.map.hull(low, high);
        points.map(|(facet, weights)| {
            let (triangle, weights) = facets.on(facet, weights);
            self.place(triangle, weights)
        })
    }
}

/// Which facets of a triangle may lie at a place: a grid over the square around its weights.
#[derive(Clone, Debug)]
struct Finder {
    side: usize,
    /// By cell of the grid: its first entry of `facets`, and the end.
    first: Vec<u32>,
    /// Facets, from the triangle's first.
    facets: Vec<u32>,
}

impl Finder {
    fn new(facets: &[Facet]) -> Self {
        let side = (facets.len() as f64).sqrt().ceil() as usize;
        let mut lists = vec![Vec::new(); side * side];
        for (k, facet) in facets.iter().enumerate() {
            // A hair wider: a point may lie outside by rounding.
            let range = |d: usize| {
                let ends = facet.corners.map(|c| c[d]);
                let low = ends.iter().copied().fold(1.0, f64::min) - 1e-9;
                let high = ends.iter().copied().fold(0.0, f64::max) + 1e-9;
                cell(low, side)..=cell(high, side)
            };
            for j in range(1) {
                for i in range(0) {
                    lists[i + j * side].push(k as u32);
                }
            }
        }
        let mut first = vec![0];
        for list in &lists {
            first.push(first[first.len() - 1] + list.len() as u32);
        }
        Self {
            side,
            first,
            facets: lists.concat(),
        }
    }

    fn near(&self, [x, y]: [f64; 2]) -> &[u32] {
        let at = cell(x, self.side) + cell(y, self.side) * self.side;
        &self.facets[self.first[at] as usize..self.first[at + 1] as usize]
    }
}

fn cell(x: f64, side: usize) -> usize {
    ((x * side as f64).max(0.0) as usize).min(side - 1)
}
