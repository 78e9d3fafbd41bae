//! The Poisson distribution: its probabilities, and numbers drawn from it.
//!
//! Crate `rand_distr` has a Poisson distribution too. It takes exp and ln from `num-traits`, which
//! calls the system's C library as soon as any crate of the build asks for its feature `std` (the
//! matrix crates do), and then the bits depend on the machine. So the two algorithms stand here,
//! over `libm`.

use std::f64::consts::PI;

use super::statistics::excess;

/// Below it by inversion, from it on by transformed rejection.
const FEW: f64 = 10.0;
/// Up to here whole numbers are told apart with a bit to spare, and numbers are drawn from the
/// exact distribution. Beyond it from the normal one of the same mean and variance, rounded: its
/// skewness is wrong by 1/√mean < 1.5e-8.
pub const LARGEST_EXACT_MEAN: f64 = (1u64 << 52) as f64;

/// ln of the probability of `count` (a whole number, 0 or more) where `mean` > 0 is expected.
///
/// By the saddle-point form (Loader, *Fast and accurate computation of binomial probabilities*,
/// 2000), which has no cancellation between large terms:
///
/// > ln p = −s(k) − k·h((μ − k)/k) − ½ ln 2πk,   h(x) = x − ln(1 + x),   s(k) = ln k! − ½ ln 2πk − k ln k + k
pub fn log_probability(count: f64, mean: f64) -> f64 {
    if count == 0.0 {
        return -mean;
    }
    -stirling_error(count)
        - count * excess((mean - count) / count)
        - 0.5 * libm::log(2.0 * PI * count)
}

/// ln k! minus Stirling's formula, for k ≥ 1.
fn stirling_error(k: f64) -> f64 {
    if k < 16.0 {
        return libm::lgamma(k + 1.0) - (k + 0.5) * libm::log(k) + k - 0.5 * libm::log(2.0 * PI);
    }
    // The next term is below 1/(1188 k⁹) = 1.2e-14.
    let w = 1.0 / (k * k);
    (1.0 / 12.0 - w * (1.0 / 360.0 - w * (1.0 / 1260.0 - w / 1680.0))) / k
}

/// A number with the Poisson distribution of `mean` ≥ 0 from numbers that are uniform in [0, 1).
pub(super) fn draw(mean: f64, uniform: &mut impl FnMut() -> f64) -> f64 {
    if mean <= 0.0 {
        0.0
    } else if mean < FEW {
        by_inversion(mean, uniform())
    } else {
        by_rejection(mean, uniform)
    }
}

/// The smallest count whose cumulative probability exceeds `u`.
fn by_inversion(mean: f64, u: f64) -> f64 {
    let mut probability = libm::exp(-mean);
    let mut cumulative = probability;
    let mut count = 0.0;
    while u >= cumulative && probability > 0.0 {
        count += 1.0;
        probability *= mean / count;
        cumulative += probability;
    }
    count
}

/// Hörmann's transformed rejection with squeeze (PTRS), *Insurance: Mathematics and Economics* 12,
/// 39–45 (1993); exact for means of 10 or more.
fn by_rejection(mean: f64, uniform: &mut impl FnMut() -> f64) -> f64 {
    let b = 0.931 + 2.53 * mean.sqrt();
    let a = -0.059 + 0.024_83 * b;
    let inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
    let squeeze = 0.9277 - 3.6224 / (b - 2.0);
    loop {
        let u = uniform() - 0.5;
        let v = uniform();
        let edge = 0.5 - u.abs();
        let count = ((2.0 * a / edge + b) * u + mean + 0.43).floor();
        if edge >= 0.07 && v <= squeeze {
            return count;
        }
        if count < 0.0 || !count.is_finite() || (edge < 0.013 && v > edge) {
            continue;
        }
        let height = libm::log(v * inverse_alpha / (a / (edge * edge) + b));
        if height <= log_probability(count, mean) {
            return count;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// p(0) = e^(−μ), p(k) = p(k − 1)·μ/k, carried in logarithms.
    fn by_recurrence(count: u32, mean: f64) -> f64 {
        (1..=count).fold(-mean, |log, k| log + libm::log(mean / f64::from(k)))
    }

    #[test]
    fn probabilities_follow_the_recurrence() {
        for mean in [0.01, 0.7, 9.99, 10.0, 42.5, 1000.0] {
            for count in [0, 1, 2, 5, 15, 16, 17, 40, 200, 1000, 1100] {
                let log = log_probability(f64::from(count), mean);
                let exact = by_recurrence(count, mean);
                assert!(
                    (log - exact).abs() < 1e-12 * (1.0 + exact.abs()),
                    "{count} of {mean}: {log} {exact}"
                );
            }
        }
    }

    /// At a large mean the probability of the mean itself is 1/√(2πμ)·(1 − 1/(12μ) + …).
    #[test]
    fn large_means_do_not_cancel() {
        for mean in [1e6, 1e12, 4e15] {
            let exact = -0.5 * libm::log(2.0 * PI * mean) - 1.0 / (12.0 * mean);
            assert!((log_probability(mean, mean) - exact).abs() < 1e-13 * exact.abs());
            // One standard deviation above: e^(−1/2) of it, but for terms of 1/√μ.
            let above = (mean + mean.sqrt()).floor();
            let ratio = log_probability(above, mean) - log_probability(mean, mean);
            assert!((ratio + 0.5).abs() < 2.0 / mean.sqrt(), "{mean}: {ratio}");
        }
    }

    #[test]
    fn inversion_takes_the_whole_interval() {
        assert_eq!(by_inversion(2.0, 0.0), 0.0);
        assert_eq!(by_inversion(2.0, libm::exp(-2.0)), 1.0);
        assert!(by_inversion(9.9, 1.0 - f64::EPSILON / 2.0) < 200.0);
        assert_eq!(draw(0.0, &mut || 0.999), 0.0);
    }

    /// u = 0 is the edge of the transformation, where it is not finite.
    #[test]
    fn rejection_survives_the_edge() {
        let mut uniforms = [0.0, 0.0, 0.5, 0.5].into_iter();
        let count = by_rejection(100.0, &mut || uniforms.next().unwrap_or(0.5));
        assert_eq!(count, 100.0);
    }
}
