//! The normal distribution and its far tail.
//!
//! erfc is `libm`'s, exact to the last digit or so; that of `statrs` 0.19 is off by up to 9e-11.

use std::f64::consts::{PI, SQRT_2};

use libm::erfc;
use statrs::function::erf::erfc_inv;

/// Probability that a standard normal number lies at least |z| from zero: erfc(|z|/√2). NaN for
/// NaN.
pub fn normal_two_sided(z: f64) -> f64 {
    erfc(z.abs() / SQRT_2)
}

/// ln Q(z), Q the upper tail, for z ≥ 0; finite as long as z² is.
pub(super) fn log_upper_tail(z: f64) -> f64 {
    if z < 20.0 {
        return libm::log(0.5 * erfc(z / SQRT_2));
    }
    // Q = φ(z)/z (1 − 1/z² + 3/z⁴ − 15/z⁶ + …); the term left out is below 2e6/20¹⁶ = 3e-15.
    let w = 1.0 / (z * z);
    let series = [1.0, 3.0, 5.0, 7.0, 9.0, 11.0, 13.0]
        .iter()
        .rev()
        .fold(1.0, |sum, odd| 1.0 - odd * w * sum);
    -0.5 * z * z - libm::log(z) - 0.5 * libm::log(2.0 * PI) + libm::log(series)
}

/// The z ≥ 0 with ln Q(z) = `log_tail`, for log_tail ≤ ln ½. Newton's method on the concave ln Q,
/// which cannot overshoot twice.
pub(super) fn from_log_upper_tail(log_tail: f64) -> f64 {
    if log_tail == f64::NEG_INFINITY {
        return f64::INFINITY;
    }
    let mut z = if log_tail > -600.0 {
        SQRT_2 * erfc_inv(2.0 * libm::exp(log_tail))
    } else {
        (-2.0 * log_tail).sqrt()
    };
    for _ in 0..50 {
        let log_q = log_upper_tail(z);
        let hazard = libm::exp(-0.5 * z * z - 0.5 * libm::log(2.0 * PI) - log_q);
        let step = (log_q - log_tail) / hazard;
        z = (z + step).max(0.0);
        if step.is_nan() || step.abs() <= 1e-15 * (1.0 + z) {
            break;
        }
    }
    z
}

/// The standard normal number as improbable as a deviate t of a law of this skewness γ ≥ 0: that of
/// a gamma law of shape α = 4/γ², by the cube root of Wilson and Hilferty (1931),
///
/// > z = 3√α ((1 + t/√α)^⅓ − 1 + 1/(9α)),
///
/// which tends to t − γ (t² − 1)/6. Tails of Poisson's law are no heavier beyond it.
pub fn unskewed(t: f64, skewness: f64) -> f64 {
    // Below, what rounding leaves of the difference is larger than what the series leaves out.
    if skewness < 1e-4 {
        return t - skewness / 6.0 * (t * t - 1.0);
    }
    let root = 2.0 / skewness;
    3.0 * root * (libm::cbrt(1.0 + t / root) - 1.0 + 1.0 / (9.0 * root * root))
}

#[cfg(test)]
mod tests {
    use super::super::chi_square_sf;
    use super::*;

    #[test]
    fn two_sided_table_values() {
        // 1, 2, 3, 5 standard deviations.
        for (z, p) in [
            (1.0, 0.317_310_507_862_914_1),
            (-2.0, 0.045_500_263_896_358_4),
            (3.0, 2.699_796_063_260_189e-3),
            (5.0, 5.733_031_437_583_88e-7),
        ] {
            assert!((normal_two_sided(z) / p - 1.0).abs() < 1e-13, "{z}");
        }
        assert_eq!(normal_two_sided(0.0), 1.0);
        assert!(normal_two_sided(f64::NAN).is_nan());
    }

    #[test]
    fn the_tail_is_continuous_and_inverts() {
        // d ln Q/dz = −(z + 1/z − 2/z³ …) at z = 20, so the two branches may differ by rounding
        // only.
        let (below, above) = (log_upper_tail(20.0 - 1e-9), log_upper_tail(20.0));
        assert!(
            (below - above - 20.0499 * 1e-9).abs() < 1e-12,
            "{below} {above}"
        );
        for z in [0.0, 1e-6, 0.3, 1.0, 4.0, 19.9, 20.1, 34.0, 38.0, 100.0, 1e6] {
            let back = from_log_upper_tail(log_upper_tail(z));
            assert!((back - z).abs() < 1e-14 * (1.0 + z), "{z} {back}");
        }
    }

    /// Of gamma laws z has their own tail, to a fifth where that is 1e-3 and a third where it is
    /// 1e-6; of no skewness t itself, and both forms meet.
    #[test]
    fn skewed_tails_are_normal_ones() {
        for (shape, least) in [(4.0, 1e-6), (40.0, 1e-6), (4000.0, 1e-6), (1.0, 1e-4)] {
            let skewness = 2.0 / f64::sqrt(shape);
            for t in [2.0, 3.0, 4.0, 5.0] {
                // Of twice a gamma variable χ² of 2α tells.
                let tail = chi_square_sf(2.0 * (shape + t * shape.sqrt()), 2.0 * shape);
                let found = 0.5 * normal_two_sided(unskewed(t, skewness));
                let off = (found / tail - 1.0).abs();
                assert!(tail < least || off < 0.33, "{shape} {t}: {found} {tail}");
                assert!(tail < 1e-3 || off < 0.2, "{shape} {t}: {found} {tail}");
            }
        }
        assert_eq!(unskewed(3.7, 0.0), 3.7);
        let [below, above] = [0.999_999e-4, 1.000_001e-4].map(|g| unskewed(5.0, g));
        assert!((below - above).abs() < 1e-6, "{below} {above}");
    }

    /// Poisson's law of mean μ, counted out: the mean of z² is 1 at most, and no tail is heavier
    /// than the normal one. Without it the one beyond 4 is up to 70 times as heavy.
    #[test]
    fn counts_are_no_heavier_than_normal() {
        for mu in [0.1f64, 0.3, 1.0, 3.0, 10.0, 100.0] {
            let mut p = libm::exp(-mu);
            let (mut square, mut tails, mut heaviest) = (0.0, [0.0; 3], 0.0);
            for n in 0..400 {
                let t = (f64::from(n) - mu) / mu.sqrt();
                let z = unskewed(t, 1.0 / mu.sqrt());
                square += p * z * z;
                for (k, tail) in tails.iter_mut().enumerate() {
                    *tail += if z.abs() > k as f64 + 3.0 { p } else { 0.0 };
                }
                heaviest += if t.abs() > 4.0 { p } else { 0.0 };
                p *= mu / f64::from(n + 1);
            }
            assert!(square <= 1.0 + 1e-3, "{mu}: {square}");
            for (k, tail) in tails.iter().enumerate() {
                assert!(
                    *tail <= 1.02 * normal_two_sided(k as f64 + 3.0),
                    "{mu}: {tail}"
                );
            }
            assert!(
                mu > 10.0 || heaviest > 4.0 * normal_two_sided(4.0),
                "{mu}: {heaviest}"
            );
        }
    }
}
