//! The significance of many numbers together: of the largest (Šidák), and of their squares with it.

use std::f64::consts::LN_2;

use super::normal::from_log_upper_tail;
use super::{chi_square_sf, normal_two_sided};

/// Probability that the smallest of n independent p-values is at most `p` by chance: 1 − (1 − p)ⁿ,
/// without cancellation. NaN where p is not in [0, 1].
pub fn sidak_p(p: f64, n: u64) -> f64 {
    if !(0.0..=1.0).contains(&p) {
        return f64::NAN;
    }
    if n == 0 {
        0.0
    } else {
        -libm::expm1(n as f64 * libm::log1p(-p))
    }
}

/// The |z| that the largest of n independent standard normal numbers exceeds with probability
/// `alpha`:
///
/// > erfc(z/√2) = 1 − (1 − α)^(1/n)
///
/// Infinite for alpha = 0, 0 for alpha = 1 or n = 0. NaN where alpha is not in [0, 1].
pub fn sidak_threshold(alpha: f64, n: u64) -> f64 {
    if !(0.0..=1.0).contains(&alpha) {
        return f64::NAN;
    }
    if n == 0 {
        return 0.0;
    }
    let each = -libm::expm1(libm::log1p(-alpha) / n as f64);
    from_log_upper_tail(libm::log(each) - LN_2)
}

/// Probability that as many standard normal numbers as `freedom` have as large a sum of squares or
/// as large a largest: twice the smaller of that of χ² and of Šidák's (Bonferroni).
pub fn squares_or_largest(chi2: f64, largest: f64, freedom: f64) -> f64 {
    let whole = chi_square_sf(chi2, freedom);
    let one = sidak_p(normal_two_sided(largest), freedom.ceil() as u64);
    (2.0 * whole.min(one)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_test_is_the_ordinary_threshold() {
        // Two-sided 5 % and 1 % points of the normal distribution.
        assert!((sidak_threshold(0.05, 1) - 1.959_963_984_540_054).abs() < 1e-14);
        assert!((sidak_threshold(0.01, 1) - 2.575_829_303_548_901).abs() < 1e-14);
    }

    #[test]
    fn probability_and_threshold_are_inverse() {
        for alpha in [1e-12, 1e-3, 0.05, 0.5, 0.999] {
            for n in [1, 2, 120, 30_720, 1_000_000_007] {
                let p = sidak_p(normal_two_sided(sidak_threshold(alpha, n)), n);
                assert!((p / alpha - 1.0).abs() < 1e-12, "{alpha} {n}: {p}");
            }
        }
    }

    #[test]
    fn small_probabilities_do_not_cancel() {
        // 1 − (1 − p)ⁿ = n p − n(n − 1)/2 p² + …; a naive 1 − (1 − 1e-20)³ is 0.
        assert!((sidak_p(1e-20, 3) / 3e-20 - 1.0).abs() < 1e-15);
        assert!((sidak_p(0.5, 2) - 0.75).abs() < 1e-15);
    }

    #[test]
    fn edges() {
        assert_eq!(
            (sidak_p(0.0, 9), sidak_p(1.0, 9), sidak_p(0.3, 0)),
            (0.0, 1.0, 0.0)
        );
        assert_eq!(
            (sidak_threshold(0.0, 5), sidak_threshold(0.5, 0)),
            (f64::INFINITY, 0.0)
        );
        assert!(sidak_threshold(1.0, 5).abs() < 1e-15);
        for bad in [-0.1, 1.1, f64::NAN] {
            assert!(sidak_p(bad, 2).is_nan() && sidak_threshold(bad, 2).is_nan());
        }
    }
}
