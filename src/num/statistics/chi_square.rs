//! The upper tail of χ².

use std::f64::consts::PI;

use libm::erfc;
use statrs::function::gamma::gamma_ur;

/// From here on Temme's expansion is exact to about 1e-10 of the p-value, and the series of the
/// incomplete gamma function long.
const MANY: f64 = 1e4;

/// Probability that χ² with `dof` > 0 degrees of freedom exceeds `x`: Q(dof/2, x/2), the
/// regularised upper incomplete gamma function.
///
/// Good to about 1e-10 (relative) from 1 to 1e8 degrees of freedom and beyond, in both tails, until
/// it underflows to 0. 1 for x ≤ 0; NaN where x is NaN or dof is not positive and finite.
pub fn chi_square_sf(x: f64, dof: f64) -> f64 {
    if x.is_nan() || !dof.is_finite() || dof <= 0.0 {
        return f64::NAN;
    }
    if x <= 0.0 {
        return 1.0;
    }
    if x == f64::INFINITY {
        return 0.0;
    }
    let tail = if dof < MANY {
        gamma_ur(0.5 * dof, 0.5 * x)
    } else {
        temme(0.5 * dof, 0.5 * x)
    };
    tail.clamp(0.0, 1.0)
}

/// The x that χ² with `dof` > 0 degrees of freedom does not exceed with probability `p`, by
/// bisection to the last bit of [`chi_square_sf`]. NaN where p is not in (0, 1) or dof not positive
/// and finite.
pub fn chi_square_quantile(p: f64, dof: f64) -> f64 {
    if !(p > 0.0 && p < 1.0 && dof > 0.0 && dof.is_finite()) {
        return f64::NAN;
    }
    let beyond = |x: f64| chi_square_sf(x, dof) > 1.0 - p;
    let (mut low, mut high) = (0.0, dof.max(1.0));
    while beyond(high) {
        (low, high) = (high, 2.0 * high);
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        if beyond(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Temme (1979): with λ = x/a, μ = λ − 1, η²/2 = μ − ln(1 + μ), sign η = sign μ,
///
/// > Q(a, x) = ½ erfc(η √(a/2)) + e^(−aη²/2)/√(2πa) (c₀ + c₁/a + …),
/// > c₀ = 1/μ − 1/η,   c₁ = 1/η³ − 1/μ³ − 1/μ² − 1/(12 μ)
fn temme(a: f64, x: f64) -> f64 {
    let mu = (x - a) / a;
    let half_square = excess(mu);
    let eta = (2.0 * half_square).sqrt().copysign(mu);
    let (c0, c1) = if eta.abs() < 0.05 {
        series(eta)
    } else {
        closed(eta, mu)
    };
    let front = libm::exp(-a * half_square) / (2.0 * PI * a).sqrt();
    0.5 * erfc(eta * (0.5 * a).sqrt()) + front * (c0 + c1 / a)
}

/// μ − ln(1 + μ), without cancellation near 0.
pub(in crate::num) fn excess(mu: f64) -> f64 {
    if mu.abs() > 0.1 {
        return mu - libm::log1p(mu);
    }
    // Σ_{k≥2} (−μ)^k/k; 0.1²⁰ is below eps.
    (2..22)
        .rev()
        .fold(0.0, |sum, k| sum * -mu + 1.0 / f64::from(k))
        * mu
        * mu
}

fn closed(eta: f64, mu: f64) -> (f64, f64) {
    let c1 = 1.0 / (eta * eta * eta) - 1.0 / (mu * mu * mu) - 1.0 / (mu * mu) - 1.0 / (12.0 * mu);
    (1.0 / mu - 1.0 / eta, c1)
}

/// The two coefficients by their Taylor series (Temme 1979; DLMF 8.12).
fn series(eta: f64) -> (f64, f64) {
    let polynomial = |terms: &[f64]| terms.iter().rev().fold(0.0, |sum, c| sum * eta + c);
    let c0 = [
        -1.0 / 3.0,
        1.0 / 12.0,
        -2.0 / 135.0,
        1.0 / 864.0,
        1.0 / 2835.0,
        -139.0 / 777_600.0,
        1.0 / 25_515.0,
    ];
    let c1 = [-1.0 / 540.0, -1.0 / 288.0, 1.0 / 378.0, -77.0 / 77_760.0];
    (polynomial(&c0), polynomial(&c1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_values() {
        // By 40-digit quadrature of the density; the first two are the table's 5 % points of 20
        // and 100.
        for (x, dof, exact) in [
            (31.41, 20.0, 0.050_005_239_202_315_17),
            (124.342, 100.0, 0.050_000_715_769_971_77),
            (1000.0, 1000.0, 0.494_052_853_829_239_6),
            (1100.0, 1000.0, 0.014_614_408_126_295_19),
            (10_233.7, 1e4, 0.050_035_125_174_432_46),
            (10_600.0, 1e4, 1.554_511_578_551_757e-5),
            (9000.0, 1e4, 0.999_999_999_999_873),
            (31_000.0, 30_720.0, 0.129_471_316_481_046_4),
            (33_792.0, 30_720.0, 1.659_486_231_313_325e-33),
            (1_003_000.0, 1e6, 0.017_016_772_933_266_32),
            (1e8, 1e8, 0.499_981_193_680_546_3),
            (100_030_000.0, 1e8, 0.016_954_364_065_124_82),
            (99_970_000.0, 1e8, 0.983_059_511_135_086_9),
        ] {
            let p = chi_square_sf(x, dof);
            assert!((p / exact - 1.0).abs() < 2e-10, "{x} {dof}: {p} {exact}");
        }
    }

    #[test]
    fn two_degrees_are_an_exponential() {
        for x in [1e-9, 0.5, 3.0, 50.0, 700.0] {
            assert!((chi_square_sf(x, 2.0) / libm::exp(-0.5 * x) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn both_forms_of_every_seam_agree() {
        for x in [9000.0, 9700.0, 10_000.0, 10_300.0, 11_000.0] {
            let (by_fraction, by_expansion) = (gamma_ur(5000.0, 0.5 * x), temme(5000.0, 0.5 * x));
            assert!(
                (by_fraction / by_expansion - 1.0).abs() < 1e-9,
                "{x}: {by_fraction} {by_expansion}"
            );
        }
        for mu in [-0.05, 0.05] {
            let eta = (2.0 * excess(mu)).sqrt().copysign(mu);
            let ((a0, a1), (b0, b1)) = (series(eta), closed(eta, mu));
            // The series leave out terms of 1e-5·η⁷ and 1e-4·η⁴.
            assert!(
                (a0 - b0).abs() < 1e-13 && (a1 - b1).abs() < 1e-8,
                "{a0} {b0} {a1} {b1}"
            );
        }
        for mu in [-0.1, 0.1f64] {
            assert!((excess(mu) / (mu - libm::log1p(mu)) - 1.0).abs() < 1e-14);
        }
    }

    /// Points of the printed tables (5 %, 1 %, 95 %), and of 2 degrees −2 ln(1 − p).
    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (p, dof, x) in [
            (0.95, 1.0, 3.841_459),
            (0.95, 4.0, 9.487_729),
            (0.95, 20.0, 31.410_433),
            (0.99, 10.0, 23.209_251),
            (0.05, 10.0, 3.940_299),
            (0.95, 100.0, 124.342_113),
        ] {
            let found = chi_square_quantile(p, dof);
            assert!((found / x - 1.0).abs() < 1e-6, "{p} {dof}: {found}");
        }
        for p in [1e-6, 0.3, 0.999] {
            let exact = -2.0 * libm::log1p(-p);
            assert!((chi_square_quantile(p, 2.0) / exact - 1.0).abs() < 1e-9);
        }
        assert!(chi_square_quantile(1.0, 2.0).is_nan() && chi_square_quantile(0.5, 0.0).is_nan());
    }

    #[test]
    fn edges() {
        assert_eq!(
            (chi_square_sf(0.0, 5.0), chi_square_sf(-1.0, 5.0)),
            (1.0, 1.0)
        );
        assert_eq!(
            (chi_square_sf(f64::INFINITY, 5.0), chi_square_sf(1e12, 1e5)),
            (0.0, 0.0)
        );
        assert_eq!(chi_square_sf(1.0, 1e5), 1.0);
        for (x, dof) in [
            (f64::NAN, 1.0),
            (1.0, 0.0),
            (1.0, -2.0),
            (1.0, f64::INFINITY),
            (1.0, f64::NAN),
        ] {
            assert!(chi_square_sf(x, dof).is_nan());
        }
    }
}
