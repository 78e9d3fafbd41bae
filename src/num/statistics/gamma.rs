//! The spread of the logarithm of a variance that was estimated.

use statrs::function::gamma::digamma;

/// The step of the difference quotient, over x: its error is 1e-6/6 x² ψ⁗/ψ″ < 1e-6, that of
/// rounding less.
const STEP: f64 = 1e-3;

/// ψ′(x), x > 0: the variance of ln of a number of gamma distribution of shape x. That of ln s²,
/// s² a variance estimated with ν degrees of freedom, is ψ′(ν/2). To 2e-6 of itself.
pub fn trigamma(x: f64) -> f64 {
    let h = STEP * x;
    (digamma(x + h) - digamma(x - h)) / (2.0 * h)
}

/// ψ‴(x) = Σ 6/(x + k)⁴, x > 0: the fourth cumulant of the same logarithm. Its terms from k = 16 on
/// by their integral (Euler and Maclaurin), to 1e-7 of itself.
pub fn pentagamma(x: f64) -> f64 {
    let own: f64 = (0..16).map(|k| 6.0 / (x + f64::from(k)).powi(4)).sum();
    let y = x + 16.0;
    own + 2.0 / y.powi(3) + 3.0 / y.powi(4) + 2.0 / y.powi(5)
}

/// The ν of ψ′(ν/2) = `variance`, by bisection of ln ν; infinite where the variance is not more
/// than that of 1e6 degrees of freedom.
pub fn freedom_of_log_variance(variance: f64) -> f64 {
    let [mut low, mut high] = [1e-6f64, 1e6].map(libm::log);
    if variance <= trigamma(0.5 * libm::exp(high)) {
        return f64::INFINITY;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if trigamma(0.5 * libm::exp(middle)) > variance {
            low = middle;
        } else {
            high = middle;
        }
    }
    libm::exp(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Abramowitz and Stegun 6.4.4, 6.4.5 and 6.4.12, and ψ′(x + 1) = ψ′(x) − 1/x².
    #[test]
    fn known_values() {
        let near = |x: f64, exact: f64| {
            let found = trigamma(x);
            assert!((found / exact - 1.0).abs() < 2e-6, "{x}: {found} {exact}");
        };
        near(0.5, PI * PI / 2.0);
        near(1.0, PI * PI / 6.0);
        near(1.5, PI * PI / 2.0 - 4.0);
        near(2.0, PI * PI / 6.0 - 1.0);
        let x: f64 = 500.0;
        near(x, 1.0 / x + 0.5 / (x * x) + 1.0 / (6.0 * x.powi(3)));
        // ψ‴(1) = π⁴/15, ψ‴(1/2) = π⁴, and ψ‴(x + 1) = ψ‴(x) − 6/x⁴.
        let pi4 = PI.powi(4);
        for (x, exact) in [(1.0, pi4 / 15.0), (0.5, pi4), (1.5, pi4 - 96.0)] {
            let found = pentagamma(x);
            assert!((found / exact - 1.0).abs() < 1e-7, "{x}: {found} {exact}");
        }
    }

    #[test]
    fn the_freedom_has_that_variance() {
        for freedom in [0.1, 1.0, 2.0, 7.5, 300.0] {
            let found = freedom_of_log_variance(trigamma(0.5 * freedom));
            assert!((found / freedom - 1.0).abs() < 1e-9, "{freedom}: {found}");
        }
        assert_eq!(freedom_of_log_variance(0.0), f64::INFINITY);
        assert_eq!(freedom_of_log_variance(-1.0), f64::INFINITY);
    }
}
