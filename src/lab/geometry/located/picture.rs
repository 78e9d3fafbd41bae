//! The picture at one place, as smooth as predicts photographs best.

use nalgebra::DVector;

use super::Bright;
use super::frames::Frames;
use super::likelihood::{Spectrum, log_ratios};
use super::place::jackknifed;
use crate::matrix::Matrix;
use crate::model::{ElementGrid, MatrixModel};
use crate::num::linalg::LinalgError;

/// Posterior mean of the reflectances. The prior's λ and length are chosen by how well each frame
/// is predicted from the others:
///
/// > e_l = ‖√w (Φ_l − C diag(d_l) ρ_(l))‖²,   ρ_(l) from all frames but l.
///
/// At the length of the least Σ e_l, the largest λ that is worse by less than one standard error of
/// that difference, Σ (e_l − e_l,least) ≤ √m s (Breiman et al., Classification and Regression Trees
/// (1984), 3.4.3, in pairs). Where the model lacks something, neighbouring pixels err alike; a
/// likelihood that takes them for independent would keep directions of the picture that no other
/// frame confirms.
pub(super) struct Pictured {
    /// ρ.
    pub rho: DVector<f64>,
    /// ρ_(l), by frames.
    pub without: Vec<DVector<f64>>,
    /// Directions above the noise: how many μ_i exceed λ.
    pub directions: usize,
    /// ‖what is not explained‖/‖what other light leaves‖.
    pub misfit: f64,
    /// The same of each frame as the others predict it.
    pub predicted: f64,
}

impl Pictured {
    /// From at least 3 frames, with each K^½ of `roots`; none of fewer, and without light.
    pub(super) fn new(frames: &Frames, roots: &[Matrix]) -> Result<Option<Self>, LinalgError> {
        let each = &frames.each;
        if each.len() < 3 {
            return Ok(None);
        }
        let all = frames.all();
        let square: f64 = each.iter().map(|frame| frame.square).sum();
        let mut best: Option<(Vec<Trial>, f64)> = None;
        for root in roots {
            let Some(whole) = Spectrum::new(&all, root)? else {
                return Ok(None);
            };
            let parts = frames.all_but_one().map(|rest| Spectrum::new(&rest, root));
            let parts: Option<Vec<Spectrum<'_>>> = parts.collect::<Result<_, _>>()?;
            let Some(parts) = parts else {
                return Ok(None);
            };
            let trial = |log_ratio: f64| {
                let lambda = whole.lambda(log_ratio);
                let without: Vec<_> = parts.iter().map(|part| part.rho(lambda)).collect();
                let left = each
                    .iter()
                    .zip(&without)
                    .map(|(frame, rho)| frame.left(rho));
                Trial {
                    errors: left.collect(),
                    found: Self {
                        rho: whole.rho(lambda),
                        directions: whole.mu.iter().filter(|mu| **mu > lambda).count(),
                        misfit: whole.misfit(lambda),
                        predicted: 0.0,
                        without,
                    },
                }
            };
            let trials: Vec<Trial> = log_ratios().map(trial).collect();
            let least = trials.iter().map(Trial::sum).fold(f64::INFINITY, f64::min);
            if best.as_ref().is_none_or(|(_, other)| least < *other) {
                best = Some((trials, least));
            }
        }
        let chosen = best.and_then(|(trials, _)| smoothest(trials));
        Ok(chosen.map(|trial| Self {
            predicted: (trial.sum().max(0.0) / square).sqrt(),
            ..trial.found
        }))
    }

    /// Standard error of each ρ, by leaving frames out.
    pub(super) fn stderr(&self) -> Vec<f64> {
        let of = |j: usize| {
            let values: Vec<f64> = self.without.iter().map(|rho| rho[j]).collect();
            jackknifed(&values).unwrap_or(0.0)
        };
        (0..self.rho.len()).map(of).collect()
    }

    /// The bright part of the picture of elements at `places`: of those that are above twice their
    /// standard error, those of at least half the largest reflectance. None where there are none.
    pub(super) fn bright(&self, model: &MatrixModel) -> Option<Bright> {
        let places = &model.places;
        let stderr = self.stderr();
        let is_seen = |j: &usize| self.rho[*j] > 2.0 * stderr[*j];
        let seen: Vec<usize> = (0..places.len()).filter(is_seen).collect();
        let (own, elements) = middle(&self.rho, places, &seen)?;
        let pieces = pieces(&model.grids, &elements);
        let sides = mean_sides(model, &self.rho, &seen);
        let without = self.without.iter();
        let without: Option<Vec<[f64; 3]>> = without
            .map(|rho| middle(rho, places, &seen).map(|(middle, _)| middle))
            .collect();
        let spread = |k: usize| {
            let values: Vec<f64> = without.as_ref()?.iter().map(|m| m[k]).collect();
            Some(libm::hypot(
                jackknifed(&values)?,
                (sides.as_ref()?[k] / 12.0).sqrt(),
            ))
        };
        let stderr = match [0, 1, 2].map(spread) {
            [Some(x), Some(y), Some(z)] => Some([x, y, z]),
            _ => None,
        };
        Some(Bright {
            middle: own,
            stderr,
            elements: elements.len(),
            pieces,
        })
    }
}

/// The mean square of the sides of the bright elements along x, y and z, weighted like their
/// places, by how far neighbours of the grid are: none of a surface that is one element wide.
fn mean_sides(model: &MatrixModel, rho: &DVector<f64>, seen: &[usize]) -> Option<[f64; 3]> {
    let narrow = |g: &ElementGrid| g.count.contains(&1);
    if model.grids.iter().any(narrow) {
        return None;
    }
    let squares = |j: usize| -> [f64; 3] {
        let grid = model
            .grids
            .iter()
            .find(|g| (g.first..g.first + g.len()).contains(&j));
        let square = |k: usize, grid: &ElementGrid| {
            let [nu, nv] = grid.count;
            let (iu, iv) = ((j - grid.first) % nu, (j - grid.first) / nu);
            let [u, v] = [
                if iu + 1 < nu { j + 1 } else { j - 1 },
                if iv + 1 < nv { j + nu } else { j - nu },
            ];
            let to = |other: usize| (model.places[other][k] - model.places[j][k]).powi(2);
            to(u) + to(v)
        };
        grid.map_or([0.0; 3], |grid| [0, 1, 2].map(|k| square(k, grid)))
    };
    let sides: Vec<[f64; 3]> = (0..rho.len()).map(squares).collect();
    middle(rho, &sides, seen).map(|(mean, _)| mean)
}

/// The mean place of the elements of `seen` with at least half the largest reflectance of those,
/// weighted by it, and these elements; none where none is above 0.
fn middle(
    rho: &DVector<f64>,
    places: &[[f64; 3]],
    seen: &[usize],
) -> Option<([f64; 3], Vec<usize>)> {
    let largest = seen.iter().map(|j| rho[*j]).fold(0.0, f64::max);
    let is_bright = |j: &usize| largest > 0.0 && rho[*j] >= 0.5 * largest;
    let bright: Vec<usize> = seen.iter().copied().filter(is_bright).collect();
    let sum: f64 = bright.iter().map(|j| rho[*j]).sum();
    let mean = |k: usize| bright.iter().map(|j| rho[*j] * places[*j][k]).sum::<f64>() / sum;
    let mean = [0, 1, 2].map(mean);
    (sum > 0.0).then_some((mean, bright))
}

/// Of how many pieces these elements are, those of one grid that share an edge or a corner being
/// of one.
fn pieces(grids: &[ElementGrid], elements: &[usize]) -> usize {
    let place = |j: usize| {
        let of = |g: &ElementGrid| (g.first..g.first + g.len()).contains(&j);
        let grid = grids.iter().position(of).unwrap_or(0);
        let own = j - grids[grid].first;
        (grid, own % grids[grid].count[0], own / grids[grid].count[0])
    };
    let touch = |a: usize, b: usize| {
        let (a, b) = (place(a), place(b));
        a.0 == b.0 && a.1.abs_diff(b.1) <= 1 && a.2.abs_diff(b.2) <= 1
    };
    let (mut left, mut count) = (elements.to_vec(), 0);
    while let Some(first) = left.pop() {
        count += 1;
        let mut piece = vec![first];
        while let Some(own) = piece.pop() {
            let (near, rest) = left.iter().partition(|other| touch(own, **other));
            left = rest;
            piece.extend::<Vec<usize>>(near);
        }
    }
    count
}

/// One λ.
struct Trial {
    /// e_l.
    errors: Vec<f64>,
    found: Pictured,
}

impl Trial {
    fn sum(&self) -> f64 {
        self.errors.iter().sum()
    }
}

/// Of `trials` by falling λ the first that is not worse than the best by more than one standard
/// error of the difference.
fn smoothest(mut trials: Vec<Trial>) -> Option<Trial> {
    let least = trials.iter().min_by(|a, b| a.sum().total_cmp(&b.sum()))?;
    let best = least.errors.clone();
    let m = best.len() as f64;
    let is_as_good = |trial: &Trial| {
        let worse = trial.errors.iter().zip(&best).map(|(a, b)| a - b);
        let (sum, squares) = worse.fold((0.0, 0.0), |(s, q), d| (s + d, q + d * d));
        let variance = (squares - sum * sum / m) / (m - 1.0);
        sum <= (m * variance.max(0.0)).sqrt()
    };
    let k = trials.iter().position(is_as_good)?;
    Some(trials.swap_remove(k))
}
