//! Standard errors made better by what the photographs themselves say of them.
//!
//! Errors that follow from the noisy entries, σ² = a + b x + c x² of every entry x (√n of counts n,
//! a share of each entry), make entries too certain that noise has made darker, and the picture too
//! dark. That law is exact, which errors of any other origin do not follow, and of the light that
//! is [`expected`] of each entry it holds for the noise itself, counts of none included. Errors
//! from few replicates are [`Pooled`].

use std::borrow::Cow;

use nalgebra::DVector;

use super::certainty::Certainty;
use super::counted::Counted;
use super::pooled::Pooled;
use crate::matrix::{Matrix, expected};
use crate::num::linalg::Cholesky;
use crate::num::separable::Separable;

/// Powers of x of which σ² may be a sum, the fewest first.
const LAWS: [&[i32]; 5] = [&[1], &[2], &[0, 1], &[1, 2], &[0, 1, 2]];
/// How far a law may be off σ², relative: single precision.
const EXACT: f64 = 1e-5;
/// Entries that follow it at least, as a share and in number: those without light may have an
/// error of their own.
const MOST: f64 = 0.8;
const FEWEST: usize = 16;
/// A constant up to this share of the largest σ² is no law of the light.
const CONSTANT: f64 = 1e-3;

/// Standard errors, W, and what is known of them.
#[derive(Debug)]
pub(super) struct Refined<'a> {
    /// Pixels × spots.
    pub(super) stderr: Cow<'a, Matrix>,
    /// What is known of them.
    pub(super) certainty: Certainty,
}

impl<'a> Refined<'a> {
    /// Those of the entries of `phi` that are not `left_out`, where entries are weighed by them one
    /// by one.
    pub(super) fn of(
        phi: &Matrix,
        stderr: &'a Matrix,
        certainty: Certainty,
        left_out: Option<&Matrix>,
    ) -> Self {
        if let Some(law) = Law::of(phi, stderr, left_out) {
            let light = expected(phi, &stderr.map(|s| s * s), left_out);
            let light = light.ok().flatten();
            let follows_entries = light.is_none();
            let stderr = match light {
                Some(light) => Cow::Owned(law.at(&light, (phi, stderr))),
                None => law.of_counts_of_none((phi, stderr), left_out),
            };
            let at = stderr.iter().enumerate();
            let counts = at.filter(|(at, _)| left_out.is_none_or(|out| out[*at] == 0.0));
            let counted = Counted::new(law.powers(), counts.map(|(_, s)| s));
            // Over errors of the noisy entries deviates are skewed the other way.
            let counted = counted.filter(|_| !follows_entries);
            return Self {
                stderr,
                certainty: Certainty {
                    follows_entries: follows_entries || certainty.follows_entries,
                    counted,
                    ..certainty
                },
            };
        }
        Self::of_replicates(stderr, certainty, left_out)
    }

    /// The same whatever the entries, of methods that work pixel by pixel: they weigh none.
    pub(super) fn of_replicates(
        stderr: &'a Matrix,
        certainty: Certainty,
        left_out: Option<&Matrix>,
    ) -> Self {
        match Pooled::of(stderr, certainty, left_out) {
            Some(own) => Self {
                stderr: Cow::Owned(own.stderr),
                certainty: own.certainty,
            },
            None => Self {
                stderr: Cow::Borrowed(stderr),
                certainty,
            },
        }
    }
}

/// σ² as a sum of powers of an entry.
#[derive(Debug)]
struct Law {
    /// Powers of x over `unit`, with their factors.
    terms: Vec<(i32, f64)>,
    unit: f64,
}

impl Law {
    /// The one that the entries follow which have errors and are not `left_out`; none where none
    /// does, or it is of no light.
    fn of(phi: &Matrix, stderr: &Matrix, left_out: Option<&Matrix>) -> Option<Self> {
        if phi.shape() != stderr.shape() {
            return None;
        }
        let counts = |at: &usize| stderr[*at] > 0.0 && left_out.is_none_or(|out| out[*at] == 0.0);
        let mut at: Vec<usize> = (0..phi.len()).filter(counts).collect();
        at.sort_by(|a, b| phi[*b].total_cmp(&phi[*a]));
        let brighter = &at[..at.len().div_ceil(2)];
        let unit = phi[*at.first()?];
        if at.len() < FEWEST || unit <= 0.0 {
            return None;
        }
        let law = |powers: &&[i32]| Self::fitted(powers, (phi, stderr), (brighter, unit));
        let found = LAWS.iter().filter_map(law).find(|law| {
            let follows = |at: &&usize| {
                let variance = stderr[**at] * stderr[**at];
                (law.variance(phi[**at]) - variance).abs() < EXACT * variance
            };
            let share = at.iter().filter(follows).count() as f64 / at.len() as f64;
            share >= MOST
        })?;
        // A sum of powers with a negative one is no noise; a constant alone has nothing of light.
        let whole = found.variance(unit);
        let of_light = found.terms.iter().filter(|(power, _)| *power > 0);
        let of_light: f64 = of_light.map(|(_, factor)| factor).sum();
        let is_noise = found
            .terms
            .iter()
            .all(|(_, factor)| *factor > -EXACT * whole);
        (is_noise && of_light > CONSTANT * whole).then_some(found)
    }

    /// By least squares of relative differences.
    fn fitted(
        powers: &[i32],
        (phi, stderr): (&Matrix, &Matrix),
        (at, unit): (&[usize], f64),
    ) -> Option<Self> {
        let n = powers.len();
        let (mut gram, mut side) = (Matrix::zeros(n, n), DVector::zeros(n));
        for at in at {
            let x = phi[*at] / unit;
            let row = powers
                .iter()
                .map(|k| x.powi(*k) / (stderr[*at] * stderr[*at]));
            let row = DVector::from_iterator(n, row);
            gram += &row * row.transpose();
            side += row;
        }
        // Columns of size 1: variances are of any unit.
        let size: DVector<f64> = gram.diagonal().map(|x| x.sqrt());
        let scaled = Matrix::from_fn(n, n, |i, j| gram[(i, j)] / (size[i] * size[j]));
        let factors = Cholesky::new(&scaled)?.solve(&side.component_div(&size));
        let factors = factors.component_div(&size);
        Some(Self {
            terms: powers
                .iter()
                .copied()
                .zip(factors.iter().copied())
                .collect(),
            unit,
        })
    }

    fn variance(&self, x: f64) -> f64 {
        let terms = self.terms.iter();
        terms
            .map(|(power, factor)| factor * (x / self.unit).powi(*power))
            .sum()
    }

    /// The factors of 1, x and x².
    fn powers(&self) -> [f64; 3] {
        let mut all = [0.0; 3];
        for (power, factor) in &self.terms {
            all[*power as usize] += factor / self.unit.powi(*power);
        }
        all
    }

    /// The errors of this light; those given where it says nothing.
    fn at(&self, light: &Matrix, (phi, given): (&Matrix, &Matrix)) -> Matrix {
        Matrix::from_fn(phi.nrows(), phi.ncols(), |p, l| {
            let (variance, own) = (self.variance(light[(p, l)]), given[(p, l)]);
            let is_told = own > 0.0 || self.is_count_of_none(phi[(p, l)], own);
            if is_told && variance > 0.0 {
                variance.sqrt()
            } else {
                own
            }
        })
    }

    /// Whether nothing was counted: that has the error of what is expected, not of 0.
    fn is_count_of_none(&self, x: f64, stderr: f64) -> bool {
        let of_counts = |(power, factor): &(i32, f64)| *power == 1 && *factor > 0.0;
        x == 0.0 && stderr == 0.0 && self.terms.iter().any(of_counts)
    }

    /// The errors given, of counts of none those of the light that pixel and spot have.
    fn of_counts_of_none<'a>(
        &self,
        (phi, given): (&Matrix, &'a Matrix),
        left_out: Option<&Matrix>,
    ) -> Cow<'a, Matrix> {
        let counts = |at: usize| left_out.is_none_or(|out| out[at] == 0.0);
        let is_none = |at: usize| counts(at) && self.is_count_of_none(phi[at], given[at]);
        if !(0..phi.len()).any(is_none) {
            return Cow::Borrowed(given);
        }
        let at: Vec<usize> = (0..phi.len()).filter(|at| counts(*at)).collect();
        let light = Separable::of(phi, &at);
        let mut own = given.clone();
        for at in (0..phi.len()).filter(|at| is_none(*at)) {
            own[at] = self.variance(light.at(at)).max(0.0).sqrt();
        }
        Cow::Owned(own)
    }
}

#[cfg(test)]
pub(super) mod tests;
