//! The upper tail of F.

use statrs::function::beta::beta_reg;

/// Probability that F with `over` and `under` > 0 degrees of freedom, the quotient of two means of
/// squares, exceeds `x`: the regularised incomplete beta function I_y(under/2, over/2), y =
/// under/(under + over·x). NaN where x is NaN or a number of degrees is not positive and finite.
pub fn fisher_sf(x: f64, over: f64, under: f64) -> f64 {
    let has_meaning = |dof: f64| dof > 0.0 && dof.is_finite();
    if x.is_nan() || !has_meaning(over) || !has_meaning(under) {
        return f64::NAN;
    }
    match under / (under + over * x) {
        y if x <= 0.0 || y >= 1.0 => 1.0,
        y if y <= 0.0 => 0.0,
        y => beta_reg(0.5 * under, 0.5 * over, y),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With two degrees above the tail is (1 + 2x/ν)^(−ν/2); with one above and one below that of
    /// the Cauchy law squared, 1 − 2/π·atan √x; tabulated 5 % points.
    #[test]
    fn tails_are_those_of_closed_forms_and_tables() {
        for (x, under) in [(0.5, 3.0), (3.0, 12.0), (40.0, 58.0)] {
            let exact = libm::pow(1.0 + 2.0 * x / under, -0.5 * under);
            assert!((fisher_sf(x, 2.0, under) / exact - 1.0).abs() < 1e-9, "{x}");
        }
        let cauchy = 1.0 - std::f64::consts::FRAC_2_PI * libm::atan(libm::sqrt(7.0));
        assert!((fisher_sf(7.0, 1.0, 1.0) - cauchy).abs() < 1e-12);
        // NIST/SEMATECH e-Handbook, 1.3.6.7.3: F(0.05; 5, 10), F(0.05; 10, 20).
        for (x, over, under) in [(3.326, 5.0, 10.0), (2.348, 10.0, 20.0)] {
            assert!((fisher_sf(x, over, under) - 0.05).abs() < 2e-5, "{x}");
        }
        assert_eq!(fisher_sf(-1.0, 2.0, 2.0), 1.0);
        assert_eq!(fisher_sf(f64::INFINITY, 2.0, 2.0), 0.0);
        assert!(fisher_sf(1.0, 0.0, 2.0).is_nan());
    }
}
