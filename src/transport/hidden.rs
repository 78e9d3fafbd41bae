//! Sampling of points on the hidden surfaces by area.

use super::steps::Steps;
use crate::geometry::{ShapeId, SurfacePoint};
use crate::scene::Scene;

/// Density ∝ the mean albedo of each smooth texture cell (a mesh is one cell), uniform in area within it: dark cells are never sampled, which
/// is exact, and light ones are stratified by their edges.
#[derive(Debug)]
pub(super) struct HiddenArea {
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
    rows: Steps,
    /// For each row, over its cells.
    columns: Vec<Steps>,
    /// Of each cell, per unit area.
    density: Vec<f64>,
}

impl HiddenArea {
    /// The hidden surfaces.
    pub(super) fn new(scene: &Scene) -> Self {
        let hidden: Vec<ShapeId> = scene.hidden().map(|(id, _)| id as ShapeId).collect();
        Self::of(scene, &hidden)
    }

    /// Any shapes.
    pub(super) fn of(scene: &Scene, shapes: &[ShapeId]) -> Self {
        let mut surfaces = Vec::new();
        let mut of_shape = vec![None; scene.surfaces.len()];
        let mut total = 0.0;
        for &shape in shapes {
            let id = shape as usize;
            let surface = &scene.surfaces[id];
            let count = surface.smooth_cells();
            let mean = |i: usize, j: usize| surface.cell_weight(i + j * count[0]);
            let row_sum = |j: usize| (0..count[0]).map(|i| mean(i, j)).sum::<f64>();
            let weight: f64 = (0..count[1]).map(row_sum).sum();
            if weight <= 0.0 {
                continue;
            }
            let area = surface.shape.area();
            let share = weight / (count[0] * count[1]) as f64 * area;
            of_shape[id] = Some(surfaces.len());
            surfaces.push(Sampled {
                shape,
                count,
                share,
                before: total,
                rows: Steps::new((0..count[1]).map(row_sum)),
                columns: (0..count[1])
                    .map(|j| Steps::new((0..count[0]).map(|i| mean(i, j))))
                    .collect(),
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

    /// Whether nothing is sampled: all is black.
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
    ) -> (ShapeId, SurfacePoint, f64) {
        let last = self.surfaces.len() - 1;
        let chosen = self.surfaces[1..]
            .iter()
            .take_while(|s| a >= s.before)
            .count()
            .min(last);
        let s = &self.surfaces[chosen];
        a = ((a - s.before) / s.share).clamp(0.0, 1.0 - f64::EPSILON);
        let (row, v) = s.rows.invert(b);
        let (column, u) = s.columns[row].invert(a);
        let point = scene.surfaces[s.shape as usize].shape.at([u, v]);
        (s.shape, point, s.density[column + row * s.count[0]])
    }

    /// Density of [`HiddenArea::sample`] at a point of `shape` with parameters `uv`, per unit area.
    pub(super) fn density(&self, shape: ShapeId, uv: [f64; 2]) -> f64 {
        let Some(s) = self.of_shape[shape as usize].map(|i| &self.surfaces[i]) else {
            return 0.0;
        };
        let cell = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
        let [i, j] = [cell(uv[0], s.count[0]), cell(uv[1], s.count[1])];
        s.density[i + j * s.count[0]]
    }

    /// Whether all cells of one surface are unions of the boxes into which a net of `points` is stratified: then it is stratified by the
    /// cells as well, and better between them than nets of their own.
    pub(super) fn is_dyadic(&self, points: u32) -> bool {
        let most = points.max(1).ilog2();
        let [s] = self.surfaces.as_slice() else {
            return false;
        };
        let rows = s.rows.digits(most);
        let own = |j: usize| match s.rows.share(j) > 0.0 {
            true => s.columns[j].digits(most),
            false => Some(0),
        };
        let columns = (0..s.count[1])
            .map(own)
            .try_fold(0, |m, d| d.map(|d| d.max(m)));
        rows.zip(columns).is_some_and(|(r, c)| r + c <= most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::statistics::chi_square_sf;
    use crate::num::stream::{Key, Sampling, Stream};

    const BENCH: &str = include_str!("../../scenes/bench.toml");

    fn scene() -> Scene {
        let board = "{ checkerboard = [2, 2], dark = 0.0, light = 1.0 }";
        let cells = "{ cells = [[0.0, 0.5, 0.2], [0.0, 0.0, 0.0], [1.0, 0.0, 0.1]] }";
        let second = "[[surface]]\nname = \"second\"\nrole = \"hidden\"\n\
            rectangle = { corner = [8, 11, 4], u = [1, 0, 0], v = [0, -1, 1] }\n\
            material = { lambertian = 0.3 }\nelements = [2, 2]\n";
        assert!(BENCH.contains(board));
        Scene::from_toml("two", &(BENCH.replace(board, cells) + second)).unwrap()
    }

    /// χ² of the sampled cells against density × cell area; the densities integrate to 1.
    #[test]
    fn points_follow_their_density() {
        let scene = scene();
        let hidden = HiddenArea::new(&scene);
        const SUB: usize = 6;
        let n = 200_000;
        let key = Key {
            seed: 3,
            spot: 0,
            pixel: 0,
            block: 0,
        };
        let mut stream = Stream::new(Sampling::Pcg, key);
        let mut counts = vec![[0.0; SUB * SUB]; 3];
        for _ in 0..n {
            let u = stream.next_four();
            let (shape, p, _) = hidden.sample(&scene, [u[0], u[1]]);
            assert!(
                scene.surfaces[shape as usize].albedo.albedo(p.uv) > 0.0,
                "a dark cell was sampled"
            );
            let cell = |x: f64| ((x * SUB as f64) as usize).min(SUB - 1);
            counts[shape as usize][cell(p.uv[0]) + cell(p.uv[1]) * SUB] += 1.0;
        }
        let (mut chi2, mut bins, mut total) = (0.0, 0.0, 0.0);
        for shape in [1u32, 2] {
            let area = scene.surfaces[shape as usize].shape.area() / (SUB * SUB) as f64;
            for (k, count) in counts[shape as usize].iter().enumerate() {
                let centre = |i: usize| (i as f64 + 0.5) / SUB as f64;
                let p = area * hidden.density(shape, [centre(k % SUB), centre(k / SUB)]);
                total += p;
                if p > 0.0 {
                    let expected = p * f64::from(n);
                    chi2 += (count - expected) * (count - expected) / expected;
                    bins += 1.0;
                } else {
                    assert_eq!(*count, 0.0);
                }
            }
        }
        assert!((total - 1.0).abs() < 1e-12, "{total}");
        assert!(
            chi_square_sf(chi2, bins - 1.0) > 1e-4,
            "chi2 {chi2} of {bins}"
        );
    }

    /// The way back from a point to the unit square, by the definition of the two distribution functions: the share of the
    /// surfaces, rows and cells before the point, and of its own as far as it lies in.
    #[test]
    fn points_return_to_their_place_in_the_square() {
        let scene = scene();
        let hidden = HiddenArea::new(&scene);
        let along = |steps: &Steps, n: usize, x: f64| {
            let i = ((x * n as f64) as usize).min(n - 1);
            let before: f64 = (0..i).map(|k| steps.share(k)).sum();
            before + (x * n as f64 - i as f64) * steps.share(i)
        };
        let key = Key {
            seed: 4,
            spot: 0,
            pixel: 0,
            block: 0,
        };
        let mut stream = Stream::new(Sampling::Pcg, key);
        for _ in 0..5000 {
            let u = stream.next_four();
            let (shape, p, _) = hidden.sample(&scene, [u[0], u[1]]);
            let s = &hidden.surfaces[hidden.of_shape[shape as usize].unwrap()];
            let row = ((p.uv[1] * s.count[1] as f64) as usize).min(s.count[1] - 1);
            let back = [
                s.before + s.share * along(&s.columns[row], s.count[0], p.uv[0]),
                along(&s.rows, s.count[1], p.uv[1]),
            ];
            for d in 0..2 {
                assert!((back[d] - u[d]).abs() < 1e-12, "{u:?} -> {back:?}");
            }
        }
    }
}
