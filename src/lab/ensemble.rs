//! Repetitions: draws of the noise with what is recovered from them, and independent renders of one
//! matrix.

use crate::lab::problem::problem;
use serde::{Deserialize, Serialize};

use crate::lab::deviate::normal_deviates;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::num::summation::{mean_and_stderr, tree_sum};
use crate::recovery::{Method, Nuisance, Options, Recovered, RecoveryError, recover};

/// A noisy Φcam and the standard errors that a recovery is told, pixels × spots, W.
#[derive(Debug)]
pub(super) struct Photographs {
    pub(super) phi: Matrix,
    pub(super) stderr: Matrix,
    /// The relative error of their scale, which joint methods are told.
    pub(super) scale_error: Option<f64>,
}

impl Photographs {
    /// Photographs of a scale that is known.
    pub(super) fn told(phi: Matrix, stderr: Matrix) -> Self {
        Self {
            phi,
            stderr,
            scale_error: None,
        }
    }

    /// The same of a scale that is known to this relative error.
    pub(super) fn of_scale(self, error: f64) -> Self {
        Self {
            scale_error: Some(error),
            ..self
        }
    }

    /// Φcam with each entry times 1 + σ·N(0, 1), σ = `noise`. One seed gives the same deviates at
    /// every σ, so that methods, levels and objects are compared under the same draw.
    pub(super) fn relative(exact: &Matrix, noise: f64, seed: u64) -> Self {
        Self::drawn(exact, exact.map(|x| noise * x.abs()), seed)
    }

    /// Φcam with a normal deviate of each entry's standard error added.
    pub(super) fn drawn(exact: &Matrix, stderr: Matrix, seed: u64) -> Self {
        let deviates = normal_deviates(seed, exact.nrows(), exact.ncols());
        Self::of_deviates(exact, stderr, &deviates)
    }

    /// The same of deviates that were drawn before.
    pub(super) fn of_deviates(exact: &Matrix, stderr: Matrix, deviates: &Matrix) -> Self {
        Self::told(exact + deviates.component_mul(&stderr), stderr)
    }

    /// What `method` recovers from them with the matrices of `model`.
    pub(super) fn recover(
        &self,
        model: &MatrixModel,
        method: Method,
        options: &Options,
    ) -> Result<Recovered, RecoveryError> {
        let grids: Vec<[usize; 2]> = model.grids.iter().map(|grid| grid.count).collect();
        let problem = problem(model, &self.phi, Some(&self.stderr))?.with_grids(&grids)?;
        let nuisance = Nuisance {
            scale_error: self.scale_error.filter(|_| method.is_joint()),
            ..Nuisance::default()
        };
        recover(method, &problem.with_nuisance(nuisance)?, options)
    }
}

/// Relative spread of a denominator above which a ratio has no mean to speak of: the next terms of
/// the mean's expansion are then some 3·0.1⁴ of it.
pub(super) const MOST_SPREAD: f64 = 0.1;

/// What one method made of all draws: results, and why it gave nothing in the others.
pub(super) struct Draws<'a, T> {
    pub(super) found: Vec<&'a T>,
    pub(super) failures: Vec<&'a str>,
}

impl<'a, T> Draws<'a, T> {
    /// The outcomes in their order, told apart.
    pub(super) fn of(outcomes: impl IntoIterator<Item = &'a Result<T, String>>) -> Self {
        let (mut found, mut failures) = (Vec::new(), Vec::new());
        for outcome in outcomes {
            match outcome {
                Ok(result) => found.push(result),
                Err(why) => failures.push(why.as_str()),
            }
        }
        Self { found, failures }
    }

    /// Mean and spread of a measure over the results for which it is defined.
    pub(super) fn spread(&self, measure: impl Fn(&T) -> Option<f64>) -> Option<Spread> {
        let values: Vec<f64> = self.found.iter().filter_map(|r| measure(r)).collect();
        Spread::of(&values)
    }
}

/// Mean and spread of a measure over the draws in which it is defined.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Draws.
    pub draws: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation of a draw, √(Σ(x − x̄)²/(n − 1)); absent for a single one.
    pub deviation: Option<f64>,
    /// Standard error of the mean; absent for a single draw.
    pub stderr: Option<f64>,
}

impl Spread {
    /// Of `values`; `None` if there are none.
    pub(super) fn of(values: &[f64]) -> Option<Self> {
        if values.is_empty() {
            return None;
        }
        let (mean, stderr) = mean_and_stderr(values);
        let squares: Vec<f64> = values.iter().map(|x| (x - mean) * (x - mean)).collect();
        let n = values.len();
        let several = |x: f64| (n > 1).then_some(x);
        Some(Self {
            draws: n,
            mean,
            deviation: several((tree_sum(&squares) / (n as f64 - 1.0)).sqrt()),
            stderr: several(stderr),
        })
    }
}

/// A figure with its standard error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The figure.
    pub value: f64,
    /// Its standard error.
    pub stderr: f64,
}

impl Estimate {
    /// Both divided by `unit`.
    pub(super) fn per(self, unit: f64) -> Self {
        Self {
            value: self.value / unit,
            stderr: self.stderr / unit,
        }
    }
}

/// K ≥ 3 independent, equally distributed, unbiased estimates of one matrix.
#[derive(Clone, Debug)]
pub(super) struct Ensemble {
    members: Vec<Matrix>,
}

impl Ensemble {
    pub(super) fn new(members: Vec<Matrix>) -> Self {
        assert!(
            members.len() >= 3,
            "an ensemble needs three members for its standard error"
        );
        Self { members }
    }

    /// Every member under the same map.
    pub(super) fn map(&self, f: impl Fn(&Matrix) -> Matrix) -> Self {
        Self {
            members: self.members.iter().map(f).collect(),
        }
    }

    /// Mean over the members.
    pub(super) fn mean(&self) -> Matrix {
        mean(self.members.iter())
    }

    /// Variance of each entry of the mean.
    pub(super) fn variance(&self) -> Matrix {
        let (mean, n) = (self.mean(), self.members.len() as f64);
        let mut sum = Matrix::zeros(mean.nrows(), mean.ncols());
        for m in &self.members {
            sum += (m - &mean).map(|x| x * x);
        }
        sum / (n * (n - 1.0))
    }

    /// Frobenius norm of the expectation. The norm of the mean is too large by the noise in it,
    /// E‖X̄‖² = ‖E X‖² + Σ Var X̄, so that is taken off; a square that comes out negative counts as
    /// norm 0. The square's standard error s is the jackknife's over the members; the norm's is
    /// s/(2·norm), or √s where the square is not above s.
    pub(super) fn norm(&self) -> Estimate {
        let k = self.members.len();
        let square = debiased(&self.members.iter().collect::<Vec<_>>());
        let left_out: Vec<f64> = (0..k)
            .map(|i| {
                let others = self.members.iter().enumerate().filter(|(j, _)| *j != i);
                debiased(&others.map(|(_, m)| m).collect::<Vec<_>>())
            })
            .collect();
        let centre = tree_sum(&left_out) / k as f64;
        let squares: Vec<f64> = left_out
            .iter()
            .map(|x| (x - centre) * (x - centre))
            .collect();
        let error = (tree_sum(&squares) * (k as f64 - 1.0) / k as f64).sqrt();
        let value = square.max(0.0).sqrt();
        let stderr = if square > error {
            error / (2.0 * value)
        } else {
            error.sqrt()
        };
        Estimate { value, stderr }
    }
}

fn mean<'a>(members: impl ExactSizeIterator<Item = &'a Matrix>) -> Matrix {
    let n = members.len() as f64;
    let sum = members.fold(None, |sum: Option<Matrix>, m| {
        Some(match sum {
            None => m.clone(),
            Some(s) => s + m,
        })
    });
    sum.unwrap_or_else(|| Matrix::zeros(0, 0)) / n
}

/// ‖X̄‖² − Σ Var X̄.
fn debiased(members: &[&Matrix]) -> f64 {
    let n = members.len() as f64;
    let centre = mean(members.iter().copied());
    let spread: f64 = members.iter().map(|m| (*m - &centre).norm_squared()).sum();
    centre.norm_squared() - spread / (n * (n - 1.0))
}

#[cfg(test)]
mod tests;
