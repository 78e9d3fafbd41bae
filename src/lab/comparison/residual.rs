//! The difference of traced and modelled light, and what a deviation of the model is fitted to it.
//!
//! With r = traced − model, d = ∂model/∂θ and fixed weights w the fitted deviation and its variance
//! are
//!
//! > θ̂ = Σ w d r / G, G = Σ w d², Var θ̂ = Var(Σ w d r) / G².
//!
//! The weights are 1/σ². Of a variance that was estimated it is one smoothed over pixels and spots,
//! so that an entry that is noisy by chance does not set its own weight: of the model's light m
//!
//! > ln σ²\[p,l\] ≈ α ln m\[p,l\] + a\[p\] + b\[l\],
//!
//! by least squares; α is 0 of noise alike everywhere, 1 of counts, 2 of noise that is a share of
//! the light. Where the variances scatter about that by far more than chance, each weighs its own.
//! The variance of Σ w d r is then estimated from what each [`Errors`] leaves independent:
//!
//! * `Independent`: Σ (w d s)², s the stated standard errors;
//! * `WithinRows`: from the scatter of the pixels' sums around their fit, each divided by what it
//!   does not pull the fit by itself (the jackknife's sandwich); with fewer than 16 pixels of
//!   weight Σ_p (Σ_l |w d| s)², which no correlation exceeds; of a single spot as if independent,
//!   for it has one entry in each row;
//! * `Everywhere`: (Σ |w d| s)², which no correlation exceeds. This is conservative by as much as
//!   the errors are not all one.
//!
//! θ̂ over its error is Student-distributed with the degrees of freedom of that variance
//! (Satterthwaite). What the model itself may be off by, Σ |w d| b, is taken off |Σ w d r| first.

use std::ops::Range;

use super::evidence::{Evidence, Test};
use crate::lab::uncertainty::certainty::Errors;
use crate::lab::uncertainty::smooth_noise::{BEYOND, SMOOTH, smoothed};
use crate::matrix::Matrix;
use crate::num::statistics::{student_threshold, student_to_normal, trigamma};

/// 95 % of a normal distribution lie below.
const POWER: f64 = 1.644_853_626_951_472_2;
/// Fewer independent rows than this do not tell their own scatter.
const ENOUGH_ROWS: f64 = 16.0;

/// Which weights a fit has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Weights {
    /// Those of the least variance, as far as that is known or smooth.
    Least,
    /// All alike.
    Alike,
}

/// A difference, ready to be fitted.
pub(super) struct Residual<'a> {
    pub evidence: Evidence<'a>,
    errors: Errors,
    freedom: f64,
    weights: Matrix,
    /// Estimated variance of each entry, W².
    variance: Matrix,
}

impl<'a> Residual<'a> {
    /// Weighs every entry that counts. One that was never lit, "0 ± 0", has no known error and
    /// no weight.
    pub(super) fn new(evidence: Evidence<'a>, test: Test, how: Weights) -> Self {
        let (rows, columns) = evidence.model.shape();
        let freedom = test.known.freedom();
        let known = |i: usize| {
            evidence.counts(i) && (evidence.stderr[i] > 0.0 || evidence.traced[i] != 0.0)
        };
        let square = |i: usize| evidence.stderr[i].max(evidence.rounding(i)).powi(2);
        let mut variance = Matrix::from_fn(rows, columns, |p, l| square(p + l * rows));
        let weights = match how {
            Weights::Alike => Matrix::from_fn(rows, columns, |p, l| {
                f64::from(u8::from(evidence.counts(p + l * rows)))
            }),
            Weights::Least => {
                let (smooth, scatter) = smoothed(&variance, evidence.model, &known);
                let is_estimated = test.known.replicates.is_some() || test.known.follows_entries;
                let by_chance = trigamma(0.5 * freedom);
                let beyond = if is_estimated && scatter - by_chance < SMOOTH {
                    BEYOND
                } else {
                    0.0
                };
                Matrix::from_fn(rows, columns, |p, l| {
                    let (at, own) = (p + l * rows, variance[(p, l)]);
                    if !known(at) || own == 0.0 {
                        return 0.0;
                    }
                    if own < beyond * smooth[at] || evidence.stderr[at] == 0.0 {
                        return 1.0 / smooth[at];
                    }
                    // Weighed by its own variance: E[σ²/s⁴] is ν/(ν − 4) times E[1/s²].
                    variance[(p, l)] *= freedom / (freedom - 4.0).max(1.0);
                    beyond.max(1.0) / own
                })
            }
        };
        Self {
            evidence,
            errors: test.known.errors,
            freedom,
            weights,
            variance,
        }
    }

    /// √w, pixels × spots; 0 of an entry without weight.
    pub(super) fn roots(&self) -> Matrix {
        self.weights.map(f64::sqrt)
    }

    fn difference(&self, at: usize) -> f64 {
        self.evidence.traced[at] - self.evidence.model[at]
    }

    /// Σ w r² of the columns.
    pub(super) fn squares(&self, columns: &Range<usize>) -> f64 {
        let rows = self.weights.nrows();
        let entries = columns.start * rows..columns.end * rows;
        let square = |at: usize| self.weights[at] * self.difference(at).powi(2);
        entries.map(square).sum()
    }

    /// Fits θ·d in the columns `columns`; `None` where that changes nothing.
    pub(super) fn fit(&self, d: &Matrix, columns: &Range<usize>) -> Option<Fit> {
        let rows = d.nrows();
        // Of each row: Σ w d r, Σ w d², Σ (w d s)², Σ (w d s)⁴, Σ |w d| s.
        let mut sums = vec![[0.0; 5]; rows];
        let mut bias = 0.0;
        for l in columns.clone() {
            for (p, sum) in sums.iter_mut().enumerate() {
                let at = p + l * rows;
                let wd = self.weights[at] * d[at];
                let square = wd * wd * self.variance[at];
                let terms = [
                    wd * self.difference(at),
                    wd * d[at],
                    square,
                    square * square,
                ];
                sum.iter_mut().zip(terms).for_each(|(s, x)| *s += x);
                sum[4] += square.sqrt();
                bias += wd.abs() * self.evidence.bound(at);
            }
        }
        let total = |k: usize| sums.iter().map(|s| s[k]).sum::<f64>();
        let g = total(1);
        if !(g > 0.0 && g.is_finite()) {
            return None;
        }
        let value = total(0) / g;
        // Rows that carry the fit: 1/Σ h², h the share of each.
        let effective = g * g / sums.iter().map(|s| s[1] * s[1]).sum::<f64>();
        let of_factors = match self.errors {
            // In the variance of the weights.
            Errors::Independent => 0.0,
            Errors::WithinRows | Errors::Everywhere => self.of_factors(d),
        };
        let (variance, freedom) = match self.errors {
            Errors::WithinRows if columns.len() > 1 && effective >= ENOUGH_ROWS => {
                let left = |s: &[f64; 5]| (s[0] - value * s[1]) / (1.0 - s[1] / g);
                let scatter = sums.iter().map(|s| left(s).powi(2)).sum::<f64>();
                (scatter, effective - 1.0)
            }
            Errors::WithinRows if columns.len() > 1 => {
                (sums.iter().map(|s| s[4] * s[4]).sum(), self.freedom)
            }
            Errors::Everywhere => (total(4).powi(2), self.freedom),
            Errors::Independent | Errors::WithinRows => {
                let freedom = self.freedom * total(2).powi(2) / total(3);
                (
                    total(2),
                    if freedom.is_finite() {
                        freedom
                    } else {
                        self.freedom
                    },
                )
            }
        };
        Some(Fit {
            value,
            stderr: (variance + of_factors).sqrt() / g,
            bias: bias / g,
            freedom,
        })
    }

    /// θ of θ·d that is fitted to light that changes by `change`, in all columns.
    pub(super) fn response(&self, d: &Matrix, change: &Matrix) -> f64 {
        self.dot(d, change) / self.dot(d, d)
    }

    /// Σ w a b.
    fn dot(&self, a: &Matrix, b: &Matrix) -> f64 {
        let terms = a.iter().zip(b).zip(&self.weights);
        terms.map(|((a, b), w)| w * a * b).sum()
    }

    /// What factors that are known only roughly add to the variance of Σ w d r: all rows of a frame
    /// share them, so that no scatter of rows shows them.
    fn of_factors(&self, d: &Matrix) -> f64 {
        let terms = self.evidence.eliminated;
        terms.map_or(0.0, |terms| {
            terms.variance_of_factors(&self.roots().component_mul(d))
        })
    }

    /// z of the deviation `d` after `other` was fitted: of its part that `other` does not have.
    pub(super) fn missed(&self, d: &Matrix, other: &Matrix) -> f64 {
        let own = d - other * (self.dot(d, other) / self.dot(other, other));
        // Below a millionth of it is rounding, and what derivatives are off by.
        if self.dot(&own, &own) < 1e-6 * self.dot(d, d) {
            return 0.0;
        }
        self.fit(&own, &(0..d.ncols())).map_or(0.0, |f| f.z())
    }
}

/// A deviation with its error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    pub value: f64,
    pub stderr: f64,
    pub bias: f64,
    /// Degrees of freedom of the error.
    pub freedom: f64,
}

impl Fit {
    /// Standard normal deviate of the value, the bias taken off.
    pub(super) fn z(&self) -> f64 {
        let beyond = (self.value.abs() - self.bias).max(0.0);
        if beyond == 0.0 {
            return 0.0;
        }
        student_to_normal(beyond / self.stderr, self.freedom).copysign(self.value)
    }

    /// The deviation that makes |z| > `limit` 95 times in 100, whatever the model's bound hides:
    /// the noncentrality δ with P(t_ν(δ) > c) = 0.95 by c(1 − 1/4ν) − δ = −1.645·√(1 + c²/2ν)
    /// (Johnson and Welch 1940).
    pub(super) fn detectable(&self, limit: f64) -> f64 {
        let c = student_threshold(limit, self.freedom);
        let nu = self.freedom;
        let delta = c * (1.0 - 0.25 / nu) + POWER * (1.0 + 0.5 * c * c / nu).sqrt();
        delta * self.stderr + 2.0 * self.bias
    }
}

#[cfg(test)]
#[path = "residual_tests.rs"]
mod tests;
