//! Sampling of points on surfaces by area.

use rayon::prelude::*;

use super::importance::Importance;
use super::vertex::Oriented;
use crate::geometry::{Hit, Interaction, Ray, Shape, ShapeId};
use crate::scene::Scene;

/// Density proportional to the mean albedo of each smooth texture cell (a mesh is one cell),
/// uniform in area within it. Dark cells are never sampled, which is exact; light ones are
/// stratified by their edges. Guided by an [`Importance`], cells are divided, and each part has a
/// density in proportion to its albedo times importance, besides a tenth of that by albedo alone.
#[derive(Clone, Debug)]
pub(super) struct AreaSampler {
    surfaces: Vec<Sampled>,
    /// Position in `surfaces` of each shape that is sampled.
    of_shape: Vec<Option<usize>>,
}

#[derive(Clone, Debug)]
struct Sampled {
    shape: ShapeId,
    /// Cells along u and v.
    count: [usize; 2],
    /// Probability of this surface among all.
    share: f64,
    /// Cumulative probability over surfaces, before this one.
    before: f64,
    /// Over rows of cells.
    rows: PiecewiseConstant,
    /// For each row, over its cells.
    columns: Vec<PiecewiseConstant>,
    /// Of each cell, per unit area.
    density: Vec<f64>,
}

/// A point of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfacePoint {
    pub shape: ShapeId,
    pub point: Interaction,
    /// The parameters for which the shape's equal-area map gives it.
    parameters: [f64; 2],
}

impl SurfacePoint {
    /// The point of `shape` with these parameters.
    pub(super) fn at(scene: &Scene, shape: ShapeId, parameters: [f64; 2]) -> Self {
        Self {
            shape,
            point: scene.surfaces[shape as usize].shape.at(parameters),
            parameters,
        }
    }

    /// Where the ray hits a shape.
    pub(super) fn hit(scene: &Scene, ray: &Ray, hit: Hit) -> Self {
        let point = scene.bvh().point(ray, hit);
        let parameters = match &scene.surfaces[hit.shape as usize].shape {
            Shape::Instance(body) => body.parameters(hit.triangle, point.position),
            _ => point.uv,
        };
        Self {
            shape: hit.shape,
            point,
            parameters,
        }
    }

    /// Which of count\[0\] × count\[1\] cells of its shape it lies in.
    pub(super) fn cell(&self, count: [usize; 2]) -> usize {
        cell_at(count, self.parameters)
    }

    pub(super) fn oriented(&self) -> Oriented {
        (self.point.position, self.point.normal)
    }
}

/// Weights of the cells of one shape, in rows: count\[0\] × count\[1\].
struct Weights {
    shape: ShapeId,
    count: [usize; 2],
    of_cell: Vec<f64>,
}

impl Weights {
    /// The albedo of each smooth cell.
    fn by_albedo(scene: &Scene, shape: ShapeId) -> Self {
        let surface = &scene.surfaces[shape as usize];
        let count = surface.smooth_cells();
        let cells = 0..count[0] * count[1];
        Self {
            shape,
            count,
            of_cell: cells.map(|cell| surface.cell_weight(cell)).collect(),
        }
    }

    /// The same for parts of the cells, at least [`PARTS`] along each side; as many of a mesh, in
    /// the order of its triangles.
    fn divided(self, scene: &Scene) -> Self {
        let [nu, _] = self.count;
        let by = match scene.surfaces[self.shape as usize].shape {
            Shape::Instance(_) => [PARTS * PARTS, 1],
            _ => self.count.map(|n| PARTS.div_ceil(n)),
        };
        let count = [self.count[0] * by[0], self.count[1] * by[1]];
        let parent = |part: usize| part % count[0] / by[0] + part / count[0] / by[1] * nu;
        Self {
            of_cell: (0..count[0] * count[1])
                .map(|part| self.of_cell[parent(part)])
                .collect(),
            count,
            ..self
        }
    }

    /// Each weight times the importance of the place.
    fn guided(&self, importance: &Importance<'_>) -> Vec<f64> {
        let grid = if self.count[1] == 1 {
            self.count
        } else {
            self.count.map(|n| n.min(PARTS))
        };
        let width = grid.map(|n| 1.0 / n as f64);
        let place = |k: usize| {
            [
                (k % grid[0]) as f64 * width[0],
                (k / grid[0]) as f64 * width[1],
            ]
        };
        let of_place = (0..grid[0] * grid[1]).into_par_iter();
        let of_place: Vec<f64> = of_place
            .map(|k| importance.mean(self.shape, place(k), width))
            .collect();
        let cell = |(i, weight): (usize, &f64)| {
            let centre = |i: usize, d: usize| (i as f64 + 0.5) / self.count[d] as f64;
            let uv = [centre(i % self.count[0], 0), centre(i / self.count[0], 1)];
            weight * of_place[cell_at(grid, uv)]
        };
        self.of_cell.iter().enumerate().map(cell).collect()
    }

    /// Area of a cell.
    fn area(&self, scene: &Scene) -> f64 {
        scene.surfaces[self.shape as usize].shape.area() / self.of_cell.len() as f64
    }
}

/// Parts of a side of a guided surface, at least.
const PARTS: usize = 16;
/// The share of the density that no guess takes away.
const UNGUIDED: f64 = 0.1;

impl AreaSampler {
    pub(super) fn new(scene: &Scene, shapes: &[ShapeId]) -> Self {
        let weights = shapes.iter().map(|s| Weights::by_albedo(scene, *s));
        Self::of_weights(scene, weights.collect())
    }

    /// A sampler of `shapes` that follows the importance.
    pub(super) fn guided(scene: &Scene, shapes: &[ShapeId], importance: &Importance<'_>) -> Self {
        let weights = shapes.iter().map(|s| Weights::by_albedo(scene, *s));
        let mut weights: Vec<Weights> = weights.map(|w| w.divided(scene)).collect();
        let guided: Vec<Vec<f64>> = weights.iter().map(|w| w.guided(importance)).collect();
        let all = |cells: &dyn Fn(usize) -> f64| {
            let shape = |(k, w): (usize, &Weights)| cells(k) * w.area(scene);
            weights.iter().enumerate().map(shape).sum::<f64>()
        };
        let plain = all(&|k| weights[k].of_cell.iter().sum());
        let total = all(&|k| guided[k].iter().sum());
        if total > 0.0 {
            for (own, guided) in weights.iter_mut().zip(guided) {
                for (w, g) in own.of_cell.iter_mut().zip(guided) {
                    *w = UNGUIDED * *w / plain + (1.0 - UNGUIDED) * g / total;
                }
            }
        }
        Self::of_weights(scene, weights)
    }

    fn of_weights(scene: &Scene, weights: Vec<Weights>) -> Self {
        let mut surfaces = Vec::new();
        let mut of_shape = vec![None; scene.surfaces.len()];
        let mut total = 0.0;
        for Weights {
            shape,
            count: [nu, nv],
            of_cell,
        } in weights
        {
            let surface = &scene.surfaces[shape as usize];
            let row = |j: usize| of_cell[j * nu..][..nu].iter().copied();
            let row_sum = |j: usize| row(j).sum::<f64>();
            let weight: f64 = (0..nv).map(row_sum).sum();
            if weight <= 0.0 {
                continue;
            }
            let share = weight / (nu * nv) as f64 * surface.shape.area();
            of_shape[shape as usize] = Some(surfaces.len());
            surfaces.push(Sampled {
                shape,
                count: [nu, nv],
                share,
                before: total,
                rows: PiecewiseConstant::new((0..nv).map(row_sum)),
                columns: (0..nv).map(|j| PiecewiseConstant::new(row(j))).collect(),
                density: Vec::new(),
            });
            total += share;
        }
        for s in &mut surfaces {
            s.share /= total;
            s.before /= total;
            let [nu, nv] = s.count;
            let per_cell = (nu * nv) as f64 / scene.surfaces[s.shape as usize].shape.area();
            let share =
                |cell: usize| s.rows.share(cell / nu) * s.columns[cell / nu].share(cell % nu);
            s.density = (0..nu * nv)
                .map(|c| s.share * share(c) * per_cell)
                .collect();
        }
        Self { surfaces, of_shape }
    }

    /// Whether nothing is sampled because all shapes are black.
    pub(super) fn is_empty(&self) -> bool {
        self.surfaces.is_empty()
    }

    /// Whether `shape` is sampled.
    pub(super) fn contains(&self, shape: ShapeId) -> bool {
        self.of_shape[shape as usize].is_some()
    }

    /// A point for u ∈ [0, 1)², with its density per unit area.
    pub(super) fn sample(&self, scene: &Scene, [mut a, b]: [f64; 2]) -> (SurfacePoint, f64) {
        let last = self.surfaces.len() - 1;
        let after = self.surfaces[1..].iter().take_while(|s| a >= s.before);
        let s = &self.surfaces[after.count().min(last)];
        a = ((a - s.before) / s.share).clamp(0.0, 1.0 - f64::EPSILON);
        let (row, v) = s.rows.invert(b);
        let (column, u) = s.columns[row].invert(a);
        let point = SurfacePoint::at(scene, s.shape, [u, v]);
        (point, s.density[column + row * s.count[0]])
    }

    /// Density of [`AreaSampler::sample`] at a point, per unit area.
    pub(super) fn density(&self, at: &SurfacePoint) -> f64 {
        let surface = self.of_shape[at.shape as usize].map(|i| &self.surfaces[i]);
        surface.map_or(0.0, |s| s.density[at.cell(s.count)])
    }

    /// Whether all cells of one surface are unions of the boxes into which a net of `points` is
    /// stratified: then the net is stratified by the cells too, and better than nets of their own.
    pub(super) fn is_dyadic(&self, points: u32) -> bool {
        let most = points.max(1).ilog2();
        let [s] = self.surfaces.as_slice() else {
            return false;
        };
        let lit_rows = (0..s.count[1]).filter(|j| s.rows.share(*j) > 0.0);
        let columns = lit_rows
            .map(|j| s.columns[j].digits(most))
            .try_fold(0, |m, d| d.map(|d| d.max(m)));
        let rows = s.rows.digits(most);
        rows.zip(columns).is_some_and(|(r, c)| r + c <= most)
    }
}

/// Which of count\[0\] × count\[1\] cells the parameters `uv` lie in.
fn cell_at(count: [usize; 2], uv: [f64; 2]) -> usize {
    let cell = |d: usize| ((uv[d] * count[d] as f64) as usize).min(count[d] - 1);
    cell(0) + cell(1) * count[0]
}

/// A distribution on [0, 1) that is constant on steps of equal width, and its inverse distribution
/// function.
#[derive(Clone, Debug)]
struct PiecewiseConstant {
    /// Cumulative probability, from 0 to exactly 1; steps + 1 entries.
    sums: Vec<f64>,
    /// 1/probability of each step.
    inverse: Vec<f64>,
    /// By k of as many equal parts of [0, 1): the step in which k/n falls.
    guide: Vec<u32>,
}

impl PiecewiseConstant {
    /// Probabilities in proportion to `weights`, uniform if all of them vanish.
    fn new(weights: impl Iterator<Item = f64>) -> Self {
        let mut sums = vec![0.0];
        for w in weights {
            sums.push(sums[sums.len() - 1] + w);
        }
        let n = sums.len() - 1;
        let total = sums[n];
        if total > 0.0 {
            sums.iter_mut().for_each(|s| *s /= total);
            sums[n] = 1.0;
        } else {
            sums = (0..=n).map(|i| i as f64 / n as f64).collect();
        }
        let inverse = sums.windows(2).map(|s| 1.0 / (s[1] - s[0])).collect();
        let step = |k: usize| sums.partition_point(|s| *s <= k as f64 / n as f64) - 1;
        let guide = (0..n).map(|k| step(k).min(n - 1) as u32).collect();
        Self {
            sums,
            inverse,
            guide,
        }
    }

    /// Probability of a step.
    fn share(&self, step: usize) -> f64 {
        self.sums[step + 1] - self.sums[step]
    }

    /// The step and the place in [0, 1) at which the distribution function is x ∈ [0, 1).
    fn invert(&self, x: f64) -> (usize, f64) {
        let n = self.guide.len();
        let part = ((x * n as f64) as usize).min(n - 1);
        let mut i = self.guide[part] as usize;
        // The guide may be one rounding too far: x·n ≥ k does not prove x ≥ k/n.
        while i > 0 && self.sums[i] > x {
            i -= 1;
        }
        while self.sums[i + 1] <= x {
            i += 1;
        }
        let t = ((x - self.sums[i]) * self.inverse[i]).clamp(0.0, 1.0 - f64::EPSILON);
        (i, (i as f64 + t) / n as f64)
    }

    /// Smallest m for which every edge of a step is a multiple of 2⁻ᵐ, if there is one up to
    /// `most`.
    fn digits(&self, most: u32) -> Option<u32> {
        let whole = |m: u32| {
            let scale = f64::from(1u32 << m);
            self.sums
                .iter()
                .all(|s| ((s * scale).round() - s * scale).abs() < 1e-9)
        };
        (0..=most.min(30)).find(|m| whole(*m))
    }
}

#[cfg(test)]
mod tests;
