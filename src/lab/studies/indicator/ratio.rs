//! The modulation of a recovery under noise, in closed form.
//!
//! MTF = N/D with N = W − B and D = W + B, both linear in the recovered values: for a linear method
//! under normal noise they are jointly normal.

use crate::lab::ensemble::MOST_SPREAD;
use crate::matrix::Matrix;

/// Mean and standard deviation of N/D.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Modulation {
    pub(super) mean: f64,
    pub(super) deviation: f64,
}

/// N and D: their means, variances and covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pair {
    pub(super) means: [f64; 2],
    pub(super) variances: [f64; 2],
    pub(super) covariance: f64,
}

impl Pair {
    /// From the mean and the covariance of the recovered values; light elements are those of albedo
    /// above ½. `None` if there are none or only such.
    pub(super) fn of(mean: &[f64], covariance: &Matrix, truth: &[f64]) -> Option<Self> {
        let light = truth.iter().filter(|t| **t > 0.5).count() as f64;
        let dark = truth.len() as f64 - light;
        if light == 0.0 || dark == 0.0 {
            return None;
        }
        let weights = |sign: f64| {
            let weight = move |t: &f64| if *t > 0.5 { 1.0 / light } else { sign / dark };
            nalgebra::DVector::from_iterator(truth.len(), truth.iter().map(weight))
        };
        let (n, d) = (weights(-1.0), weights(1.0));
        let dot = |w: &nalgebra::DVector<f64>| w.iter().zip(mean).map(|(w, x)| w * x).sum::<f64>();
        let form =
            |a: &nalgebra::DVector<f64>, b: &nalgebra::DVector<f64>| a.dot(&(covariance * b));
        Some(Self {
            means: [dot(&n), dot(&d)],
            variances: [form(&n, &n), form(&d, &d)],
            covariance: form(&n, &d),
        })
    }

    /// σ_D/|E D|.
    pub(super) fn spread(&self) -> f64 {
        self.variances[1].sqrt() / self.means[1].abs()
    }

    /// To second order,
    ///
    /// > E N/D ≈ n/d − cov/d² + n·var D/d³,   Var N/D ≈ var N/d² − 2 n·cov/d³ + n²·var D/d⁴,   n = E N, d = E D.
    ///
    /// A ratio of normal numbers has no mean, for D comes near 0 now and then. Where D's relative
    /// spread is small that is so rare that no experiment meets it, and the expansion is what is
    /// measured; beyond [`MOST_SPREAD`] there is `None`.
    pub(super) fn modulation(&self) -> Option<Modulation> {
        // Not a number is no small spread either.
        if self.spread() > MOST_SPREAD || self.spread().is_nan() {
            return None;
        }
        let [n, d] = self.means;
        let [vn, vd] = self.variances;
        let cov = self.covariance;
        let variance = vn / (d * d) - 2.0 * n * cov / (d * d * d) + n * n * vd / (d * d * d * d);
        Some(Modulation {
            mean: n / d - cov / (d * d) + n * vd / (d * d * d),
            deviation: variance.max(0.0).sqrt(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::deviate::normal_deviates;

    /// Brute force: four correlated normal values ρ = m + L·z, a million draws, MTF by its
    /// definition. Values are chosen so that the second-order terms of the mean are many of its
    /// standard errors.
    #[test]
    fn mean_and_deviation_are_those_of_a_million_draws() {
        let truth = [0.0, 1.0, 1.0, 0.0];
        let mean = [0.1, 0.9, 1.2, 0.2];
        let factor = Matrix::from_row_slice(
            4,
            4,
            &[
                0.10, 0.0, 0.0, 0.0, //
                0.05, 0.08, 0.0, 0.0, //
                0.02, 0.06, 0.09, 0.0, //
                0.07, -0.03, 0.04, 0.05,
            ],
        ) * 0.7;
        let pair = Pair::of(&mean, &(&factor * factor.transpose()), &truth).unwrap();
        assert!(
            (0.06..MOST_SPREAD).contains(&pair.spread()),
            "{}",
            pair.spread()
        );
        let found = pair.modulation().unwrap();
        let draws = 1_000_000;
        let values = factor * normal_deviates(1, 4, draws);
        let (mut sum, mut squares) = (0.0, 0.0);
        for column in values.column_iter() {
            let rho = [0, 1, 2, 3].map(|j| mean[j] + column[j]);
            let mtf = crate::metrics::mtf_raw(&rho, &truth).unwrap();
            sum += mtf;
            squares += mtf * mtf;
        }
        let n = draws as f64;
        let measured = sum / n;
        let deviation = (squares / n - measured * measured).sqrt();
        let stderr = deviation / n.sqrt();
        let first_order = pair.means[0] / pair.means[1];
        assert!(
            (found.mean - first_order).abs() > 10.0 * stderr,
            "a test of nothing"
        );
        // Fourth-order terms: 3 δ⁴ of the mean (δ = 0.087), 10 δ² of the variance.
        assert!(
            (found.mean - measured).abs() < 4.0 * stderr + 2e-4,
            "{found:?} {measured} {stderr}"
        );
        assert!(
            (found.deviation / deviation - 1.0).abs() < 0.03,
            "{found:?} {deviation}"
        );
    }

    #[test]
    fn a_wide_denominator_has_no_answer() {
        let pair = |spread: f64| Pair {
            means: [1.0, 1.0],
            variances: [0.0, spread * spread],
            covariance: 0.0,
        };
        assert_eq!(pair(0.11).modulation(), None);
        assert_eq!(pair(f64::NAN).modulation(), None);
        let found = pair(0.05).modulation().unwrap();
        assert!((found.mean - 1.0025).abs() < 1e-15 && (found.deviation - 0.05).abs() < 1e-15);
        assert_eq!(Pair::of(&[1.0], &Matrix::zeros(1, 1), &[1.0]), None);
    }
}
