//! Sampling of points on the hidden surfaces by area.

use crate::geometry::{ShapeId, SurfacePoint};
use crate::scene::Scene;

/// Density ∝ the mean albedo of each smooth texture cell, uniform in area within it: dark cells are never sampled, which
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
    /// Cumulative distribution over rows of cells: count[1] + 1 entries from 0 to 1.
    rows: Vec<f64>,
    /// For each row the cumulative distribution over its cells, count[0] + 1 entries.
    columns: Vec<Vec<f64>>,
    area: f64,
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
            let count = surface.albedo.smooth_cells();
            let mean = |i: usize, j: usize| surface.albedo.cell_mean(i + j * count[0]);
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
                rows: cumulative((0..count[1]).map(row_sum)),
                columns: (0..count[1])
                    .map(|j| cumulative((0..count[0]).map(|i| mean(i, j))))
                    .collect(),
                area,
            });
            total += share;
        }
        for s in &mut surfaces {
            s.share /= total;
            s.before /= total;
        }
        Self { surfaces, of_shape }
    }

    /// Whether `shape` is sampled.
    pub(super) fn contains(&self, shape: ShapeId) -> bool {
        self.of_shape[shape as usize].is_some()
    }

    /// A point for u ∈ [0, 1)², with its shape.
    pub(super) fn sample(&self, scene: &Scene, [mut a, b]: [f64; 2]) -> (ShapeId, SurfacePoint) {
        let last = self.surfaces.len() - 1;
        let chosen = self.surfaces[1..]
            .iter()
            .take_while(|s| a >= s.before)
            .count()
            .min(last);
        let s = &self.surfaces[chosen];
        a = ((a - s.before) / s.share).clamp(0.0, 1.0 - f64::EPSILON);
        let (row, v) = invert(&s.rows, b);
        let (_, u) = invert(&s.columns[row], a);
        (s.shape, scene.surfaces[s.shape as usize].shape.at([u, v]))
    }

    /// Density of [`HiddenArea::sample`] at a point of `shape` with parameters `uv`, per unit area.
    pub(super) fn density(&self, shape: ShapeId, uv: [f64; 2]) -> f64 {
        let Some(s) = self.of_shape[shape as usize].map(|i| &self.surfaces[i]) else {
            return 0.0;
        };
        let cell = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
        let [i, j] = [cell(uv[0], s.count[0]), cell(uv[1], s.count[1])];
        let row = s.rows[j + 1] - s.rows[j];
        let column = s.columns[j][i + 1] - s.columns[j][i];
        s.share * row * column * (s.count[0] * s.count[1]) as f64 / s.area
    }
}

/// Cumulative distribution of weights, from 0 to exactly 1; uniform if all weights vanish.
fn cumulative(weights: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sums = vec![0.0];
    for w in weights {
        sums.push(sums[sums.len() - 1] + w);
    }
    let n = sums.len() - 1;
    let total = sums[n];
    if total <= 0.0 {
        return (0..=n).map(|i| i as f64 / n as f64).collect();
    }
    sums.iter_mut().for_each(|s| *s /= total);
    sums[n] = 1.0;
    sums
}

/// Inverse of a piecewise linear distribution function with equal steps: the step and the position in [0, 1).
fn invert(cdf: &[f64], x: f64) -> (usize, f64) {
    let n = cdf.len() - 1;
    // The last step that starts at or below x and is not empty.
    let mut i = cdf.partition_point(|c| *c <= x).clamp(1, n) - 1;
    while cdf[i + 1] <= cdf[i] && i > 0 {
        i -= 1;
    }
    let t = ((x - cdf[i]) / (cdf[i + 1] - cdf[i])).clamp(0.0, 1.0 - f64::EPSILON);
    (i, (i as f64 + t) / n as f64)
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
            let (shape, p) = hidden.sample(&scene, [u[0], u[1]]);
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
        let along = |cdf: &[f64], x: f64| {
            let n = (cdf.len() - 1) as f64;
            let i = ((x * n) as usize).min(cdf.len() - 2);
            cdf[i] + (x * n - i as f64) * (cdf[i + 1] - cdf[i])
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
            let (shape, p) = hidden.sample(&scene, [u[0], u[1]]);
            let s = &hidden.surfaces[hidden.of_shape[shape as usize].unwrap()];
            let row = ((p.uv[1] * s.count[1] as f64) as usize).min(s.count[1] - 1);
            let back = [
                s.before + s.share * along(&s.columns[row], p.uv[0]),
                along(&s.rows, p.uv[1]),
            ];
            for d in 0..2 {
                assert!((back[d] - u[d]).abs() < 1e-12, "{u:?} -> {back:?}");
            }
        }
    }

    /// The map is continuous and onto: equal steps in u give points whose cell index never falls, and the ends of the
    /// unit interval stay inside.
    #[test]
    fn distribution_functions_invert() {
        let cdf = cumulative([0.0, 2.0, 0.0, 1.0, 0.0].into_iter());
        let mut last = 0.0;
        for k in 0..=1000 {
            let (i, x) = invert(&cdf, f64::from(k) / 1000.0);
            assert!(i == 1 || i == 3, "an empty step was chosen");
            assert!(x >= last && x < 1.0);
            last = x;
        }
        // Two thirds of the weight lie in step 1: u = 1/3 is its middle.
        assert!((invert(&cdf, 1.0 / 3.0).1 - 0.3).abs() < 1e-12);
    }
}
