//! Sizes of the terms, and whether they add up.

use super::results::{Closure, Term};
use crate::lab::ensemble::{Ensemble, Estimate};
use crate::matrix::Matrix;

/// Sizes of matrices relative to Φ.
pub(super) struct Sizes<'a> {
    pub(super) reference: &'a Matrix,
    pub(super) norm: f64,
    pub(super) signal: f64,
}

impl Sizes<'_> {
    /// Without its part along Φ.
    fn scaled_off(&self, m: &Matrix) -> Matrix {
        m - self.reference * (m.dot(self.reference) / (self.norm * self.norm))
    }

    fn term(&self, name: &str, size: Estimate, after_scale: Estimate) -> Term {
        let (size, after_scale) = (size.per(self.norm), after_scale.per(self.norm));
        let of_signal = if self.signal > 0.0 {
            size.value / self.signal
        } else {
            0.0
        };
        Term {
            name: name.to_owned(),
            size,
            after_scale,
            of_signal,
            in_sum: true,
        }
    }

    /// A step between two integrals, each with its bound; its error is what the last refinement of
    /// either end changed.
    pub(super) fn exact(&self, name: &str, to: &[Matrix], from: &[Matrix]) -> Term {
        let step = &to[0] - &from[0];
        let stderr = (&to[1] + &from[1]).norm();
        let estimate = |m: &Matrix| Estimate {
            value: m.norm(),
            stderr,
        };
        self.term(name, estimate(&step), estimate(&self.scaled_off(&step)))
    }

    pub(super) fn traced(&self, name: &str, ensemble: &Ensemble) -> Term {
        let off = ensemble.map(|m| self.scaled_off(m)).norm();
        self.term(name, ensemble.norm(), off)
    }

    /// The expected norm of independent noise; the mean square of n estimated variances scatters by
    /// √(2/n) and less.
    pub(super) fn noise(&self, name: &str, stderr: &Matrix) -> Term {
        let value = stderr.norm();
        let estimate = Estimate {
            value,
            stderr: value / (2.0 * stderr.len() as f64).sqrt(),
        };
        self.term(name, estimate, estimate)
    }
}

/// Part of the flux below which a remainder is rounding of sums, whatever its z: of a scene without
/// light of the model noise is no larger.
const ROUNDING: f64 = 1e-12;

/// ‖total − sum‖² against the variances of both, row by row: rows are independent.
pub(super) fn closure(total: &Matrix, sum: &Ensemble, run_stderr: &Matrix, norm: f64) -> Closure {
    let rest = total - sum.mean();
    let expected = run_stderr.map(|x| x * x) + sum.variance();
    let excess: Vec<f64> = (0..rest.nrows())
        .map(|p| rest.row(p).norm_squared() - expected.row(p).sum())
        .collect();
    let scatter = excess.iter().map(|x| x * x).sum::<f64>().sqrt();
    let z = if scatter > 0.0 {
        excess.iter().sum::<f64>() / scatter
    } else {
        0.0
    };
    let noise = run_stderr.norm();
    let size = total.norm();
    Closure {
        // The run's own noise adds to the norm of the total; its scatter is that of a sum along the
        // total's direction.
        total: Estimate {
            value: size,
            stderr: run_stderr.component_mul(total).norm() / size.max(f64::MIN_POSITIVE),
        }
        .per(norm),
        sum: Estimate {
            value: (sum.norm().value * sum.norm().value + noise * noise).sqrt(),
            stderr: sum.norm().stderr,
        }
        .per(norm),
        rest: rest.norm() / norm,
        expected: expected.sum().sqrt() / norm,
        z,
        closes: z.abs() <= 3.0 || rest.norm() <= ROUNDING * norm,
    }
}
