//! Independent renders of one matrix, and the norms of what they estimate.

use crate::matrix::Matrix;
use crate::num::summation::tree_sum;

/// A figure with its standard error.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
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
    /// E‖X̄‖² = ‖E X‖² + Σ Var X̄, so that is taken off; a square that comes out negative counts as norm 0. The square's
    /// standard error s is the jackknife's over the members; the norm's is s/(2·norm), or √s where the square is not above s.
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
mod tests {
    use super::*;
    use crate::num::stream::{Key, Sampling, Stream};

    /// Members with independent uniform noise of standard deviation σ around `truth`.
    fn noisy(truth: &Matrix, sigma: f64, seed: u64) -> Ensemble {
        let member = |block| {
            let key = Key {
                seed,
                spot: 0,
                pixel: 0,
                block,
            };
            let mut stream = Stream::new(Sampling::Pcg, key);
            truth.map(|x| x + sigma * 12f64.sqrt() * (stream.uniform() - 0.5))
        };
        Ensemble::new((0..8).map(member).collect())
    }

    /// The norm of a small matrix under noise four times as large: unbiased within its own standard error, over 200 trials.
    #[test]
    fn the_norm_is_freed_of_noise_and_its_error_is_honest() {
        let truth = Matrix::from_fn(30, 20, |i, j| 0.1 * f64::from((i * 7 + j * 3) as u32 % 5));
        let want = truth.norm();
        let mut z = Vec::new();
        for seed in 0..200 {
            let found = noisy(&truth, 0.8, seed).norm();
            z.push((found.value - want) / found.stderr);
        }
        let n = z.len() as f64;
        let centre = z.iter().sum::<f64>() / n;
        let spread = (z.iter().map(|x| x * x).sum::<f64>() / n).sqrt();
        // Student-like with 7 degrees of freedom: standard deviation 1.18, of the mean 0.084.
        assert!(centre.abs() < 0.4, "biased: mean z {centre}");
        assert!((0.8..1.7).contains(&spread), "dishonest: rms z {spread}");
    }

    #[test]
    fn nothing_is_zero_within_its_error() {
        let found = noisy(&Matrix::zeros(30, 20), 1.0, 1).norm();
        assert!(found.value < 3.0 * found.stderr, "{found:?}");
    }
}
