//! Sampling of points on surfaces by area.

use crate::geometry::{Interaction, ShapeId};
use crate::scene::Scene;

/// Density proportional to the mean albedo of each smooth texture cell (a mesh is one cell),
/// uniform in area within it. Dark cells are never sampled, which is exact; light ones are
/// stratified by their edges.
#[derive(Debug)]
pub(super) struct AreaSampler {
    surfaces: Vec<Sampled>,
    /// Position in `surfaces` of each shape that is sampled.
    of_shape: Vec<Option<usize>>,
}

#[derive(Debug)]
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

impl AreaSampler {
    pub(super) fn new(scene: &Scene, shapes: &[ShapeId]) -> Self {
        let mut surfaces = Vec::new();
        let mut of_shape = vec![None; scene.surfaces.len()];
        let mut total = 0.0;
        for &shape in shapes {
            let surface = &scene.surfaces[shape as usize];
            let [nu, nv] = surface.smooth_cells();
            let row = |j: usize| (0..nu).map(move |i| surface.cell_weight(i + j * nu));
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

    /// A point for u ∈ [0, 1)², with its shape and its density per unit area.
    pub(super) fn sample(
        &self,
        scene: &Scene,
        [mut a, b]: [f64; 2],
    ) -> (ShapeId, Interaction, f64) {
        let last = self.surfaces.len() - 1;
        let after = self.surfaces[1..].iter().take_while(|s| a >= s.before);
        let s = &self.surfaces[after.count().min(last)];
        a = ((a - s.before) / s.share).clamp(0.0, 1.0 - f64::EPSILON);
        let (row, v) = s.rows.invert(b);
        let (column, u) = s.columns[row].invert(a);
        let point = scene.surfaces[s.shape as usize].shape.at([u, v]);
        (s.shape, point, s.density[column + row * s.count[0]])
    }

    /// Density of [`AreaSampler::sample`] at a point of `shape` with parameters `uv`, per unit
    /// area.
    pub(super) fn density(&self, shape: ShapeId, uv: [f64; 2]) -> f64 {
        let surface = self.of_shape[shape as usize].map(|i| &self.surfaces[i]);
        surface.map_or(0.0, |s| s.density[cell_at(s.count, uv)])
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
pub(super) fn cell_at(count: [usize; 2], uv: [f64; 2]) -> usize {
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
