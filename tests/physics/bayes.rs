//! `joint-two-valued` against the Bayes-optimal recovery of the published boards.
//!
//! Every pattern being as likely beforehand and the reflectances 0 and 1 known, P(s | Φ) ∝
//! exp(−½ ‖(Φ − C diag(s) D)/σ‖²). The pattern whose elements are light where P(s_j = 1 | Φ) > ½
//! is expected to have the most elements right of all recoveries, thus the largest normalized MTF.

use nalgebra::DVector;
use rayon::prelude::*;

use crate::counts::normal_numbers;
use phicam::matrix::Matrix;
use phicam::metrics::mtf_normalized;
use phicam::model::{Kernel, MatrixModel};
use phicam::recovery::{Method, Nuisance, Options, Problem, Recovered, Uncertainty, recover};
use phicam::scene::Scene;

/// Draws at each level of the noise.
const DRAWS: u64 = 200;
/// The modulation that is held.
const HELD: f64 = 0.9;

/// Normal deviates: of the scale, and of every entry.
struct Draw {
    scale: f64,
    entries: Matrix,
}

impl Draw {
    fn new([pixels, spots]: [usize; 2], seed: u64) -> Self {
        let mut normal = normal_numbers(seed);
        Self {
            scale: normal(),
            entries: Matrix::from_fn(pixels, spots, |_, _| normal()),
        }
    }
}

/// A board and the model that photographs and inverts it.
struct Board {
    model: MatrixModel,
    exact: Matrix,
    /// G_ij = Σ A_i A_j of all entries, A_i the light of an element over that of the board.
    gram: Matrix,
}

/// What is known beforehand.
#[derive(Clone, Copy, Debug)]
struct Known {
    levels: bool,
    /// Standard deviation of the scale, of which every draw has its own.
    scale_error: Option<f64>,
}

impl Board {
    fn new(checks: usize, elements: usize) -> Self {
        let scene = Scene::load("bench").unwrap().with_checkerboard(checks);
        let model = MatrixModel::new(&scene, Kernel::Physical, Some([elements; 2])).unwrap();
        let exact = model.phi();
        let (c, d) = (&model.camera_side, &model.laser_side);
        let weight = exact.map(|x| (x * x).recip());
        let pair = |i: usize, j: usize| {
            let left = c.column(i).component_mul(&c.column(j)).transpose() * &weight;
            (left * d.row(i).component_mul(&d.row(j)).transpose())[0]
        };
        let n = model.albedo.len();
        let gram = Matrix::from_fn(n, n, |i, j| pair(i.min(j), i.max(j)));
        Self { model, exact, gram }
    }

    /// Photographs, each entry with noise of so much of itself.
    fn photographs(&self, noise: f64, scale_error: f64, draw: &Draw) -> [Matrix; 2] {
        let scale = (1.0 + scale_error * draw.scale).max(0.1);
        let stderr = self.exact.map(|x| noise * x);
        [
            &self.exact * scale + draw.entries.component_mul(&stderr),
            stderr,
        ]
    }

    /// The pattern of the largest marginals, by the sum over all patterns: about the true one s₀,
    /// χ²(s) − χ²(s₀) = (s − s₀)ᵀ G (s − s₀) − 2 (s − s₀)ᵀ b, G = AᵀA, b = Aᵀ(Φ − A s₀), A the
    /// light of each element over the standard errors.
    fn best(&self, noise: f64, draw: &Draw) -> Vec<f64> {
        let [phi, stderr] = &self.photographs(noise, 0.0, draw);
        let (c, d) = (&self.model.camera_side, &self.model.laser_side);
        let truth = &self.model.albedo;
        let n = truth.len();
        let weight = stderr.map(|s| (s * s).recip());
        let off = (phi - &self.exact).component_mul(&weight);
        let b: Vec<f64> = (0..n)
            .map(|j| (c.column(j).transpose() * &off * d.row(j).transpose())[0])
            .collect();
        let gram = &self.gram / (noise * noise);
        // In Gray's order one element changes at a time, which changes χ² by δ (2 (G x)_j + δ G_jj −
        // 2 b_j), x = s − s₀.
        let mut x: Vec<f64> = truth.iter().map(|own| -own).collect();
        let mut gx = &gram * DVector::from_column_slice(&x);
        let mut own: f64 = (0..n).map(|j| x[j] * (gx[j] - 2.0 * b[j])).sum();
        let mut all = vec![own; 1 << n];
        let mut set = 0;
        for step in 1usize..1 << n {
            let j = step.trailing_zeros() as usize;
            set ^= 1 << j;
            let delta = if set >> j & 1 == 1 { 1.0 } else { -1.0 };
            own += delta * (2.0 * gx[j] + delta * gram[(j, j)] - 2.0 * b[j]);
            x[j] += delta;
            gx.axpy(delta, &gram.column(j), 1.0);
            all[set] = own;
        }
        let least = all.iter().copied().fold(f64::INFINITY, f64::min);
        let (mut light, mut sum) = (vec![0.0; n], 0.0);
        for (set, chi2) in all.iter().enumerate() {
            let own = libm::exp(-0.5 * (chi2 - least));
            // As many as there are change no bit of the sum.
            if own > 1e-25 {
                sum += own;
                let lit = (0..n).filter(|j| set >> j & 1 == 1);
                lit.for_each(|j| light[j] += own);
            }
        }
        let lit = |p: &f64| f64::from(u8::from(*p > 0.5 * sum));
        light.iter().map(lit).collect()
    }

    fn recovered(&self, [phi, stderr]: &[Matrix; 2], known: Known) -> Recovered {
        let model = &self.model;
        let problem = Problem::new(phi, &model.camera_side, &model.laser_side, Some(stderr));
        let grids: Vec<[usize; 2]> = model.grids.iter().map(|grid| grid.count).collect();
        let nuisance = Nuisance {
            scale_error: known.scale_error,
            ..Nuisance::default()
        };
        let problem = problem.unwrap().with_grids(&grids).unwrap();
        let problem = problem.with_nuisance(nuisance).unwrap();
        let options = Options {
            levels: known.levels.then_some([0.0, 1.0]),
            uncertainty: Uncertainty::StandardError,
            spreads: false,
            ..Options::default()
        };
        recover(Method::JointTwoValued, &problem, &options).unwrap()
    }

    fn mtf(&self, found: &[f64]) -> f64 {
        // A picture of one level has no modulation.
        mtf_normalized(found, &self.model.albedo).unwrap_or(0.0)
    }
}

/// Where the mean falls to what is held, by interpolation in the logarithm.
fn lost(levels: &[f64], means: &[f64]) -> f64 {
    let falls = |k: &usize| means[*k] < HELD && means[k - 1] >= HELD;
    let at = (1..levels.len()).find(falls);
    let at = at.unwrap_or_else(|| panic!("{levels:?} {means:?}"));
    let t = (means[at - 1] - HELD) / (means[at - 1] - means[at]);
    let [a, b] = [levels[at - 1], levels[at]].map(libm::log);
    libm::exp(a + t * (b - a))
}

/// The noise at which the mean modulation falls to what is held, from `quiet` on in steps of √2.
fn borne(quiet: f64, draws: &[Draw], mtf: impl Fn(f64, &Draw) -> f64 + Sync) -> f64 {
    let (mut levels, mut means) = (Vec::new(), Vec::new());
    while means.last().is_none_or(|mean| *mean >= HELD) {
        let noise = quiet * 2f64.powf(0.5 * levels.len() as f64);
        let all: Vec<f64> = draws.par_iter().map(|draw| mtf(noise, draw)).collect();
        levels.push(noise);
        means.push(all.iter().sum::<f64>() / draws.len() as f64);
    }
    lost(&levels, &means)
}

/// The noise that each board bears at a modulation of 0.9: of the Bayes-optimal recovery, and of
/// `joint-two-valued` where levels and scale (to 10 %) are known and where they are not, of as many
/// draws as are asked for: with 4 × 4 elements a draw takes seconds.
#[test]
#[ignore = "slow"]
fn boards_are_recovered_at_the_bayes_limit() {
    let bench = Scene::load("bench").unwrap();
    let shape = [bench.camera.pixels(), bench.laser.spots.len()];
    let draws: Vec<Draw> = (0..DRAWS)
        .into_par_iter()
        .map(|seed| Draw::new(shape, seed))
        .collect();
    for (checks, elements, quiet, unknown) in [(2, 2, 0.5, 40), (2, 4, 0.1, 0), (4, 4, 0.02, 0)] {
        let board = Board::new(checks, elements);
        let best = borne(quiet, &draws, |noise, draw| {
            board.mtf(&board.best(noise, draw))
        });
        let found = |levels, scale_error: Option<f64>, draws: &[Draw]| {
            let known = Known {
                levels,
                scale_error,
            };
            borne(quiet, draws, |noise, draw| {
                let photographs = board.photographs(noise, scale_error.unwrap_or(0.0), draw);
                let found = board.recovered(&photographs, known);
                board.mtf(found.reflectance.as_slice())
            })
        };
        let told = found(true, None, &draws);
        println!("{checks} × {checks} on {elements} × {elements}: Bayes {best:.3}, told {told:.3}");
        assert!(told > best / 1.2, "{checks} {elements}: {told} {best}");
        if unknown > 0 {
            let others = [(true, Some(0.1)), (false, None), (false, Some(0.1))];
            let lost = others.map(|(levels, scale)| found(levels, scale, &draws[..unknown]));
            println!("unknown scale, levels, both: {lost:.3?}");
            // What is not known cannot help, but for the chance of the draws.
            assert!(lost.iter().all(|x| *x < 1.1 * best), "{lost:?} {best}");
        }
    }
}
