//! Student's t on the scale of standard deviations of a normal number.

use std::f64::consts::{LN_2, PI};

use statrs::function::gamma::ln_gamma;

use super::normal::from_log_upper_tail;

/// From here on the expansion in 1/dof is exact to rounding (its next term is below 1e-11), and the
/// continued fraction slow.
const MANY: f64 = 1e4;

/// The z that a standard normal number exceeds as often as Student's t with `dof` > 0 degrees of
/// freedom exceeds `t`.
///
/// Odd and increasing in t; for |t| = 40 it is as good as for 4 (the tail is followed in its
/// logarithm). Infinite dof returns t. NaN where t is NaN or dof is not positive.
pub fn student_to_normal(t: f64, dof: f64) -> f64 {
    if t.is_nan() || dof.is_nan() || dof <= 0.0 {
        return f64::NAN;
    }
    let size = t.abs();
    let z = if t == 0.0 || dof == f64::INFINITY || size == f64::INFINITY {
        size
    } else if dof >= MANY {
        hill(size, dof)
    } else {
        from_log_upper_tail(log_upper_tail(size, dof).min(-LN_2))
    };
    z.copysign(t)
}

/// The t that Student's t with `dof` > 0 degrees of freedom exceeds as often as a standard normal
/// number exceeds `z` ≥ 0: the inverse of [`student_to_normal`], by bisection to rounding.
pub fn student_threshold(z: f64, dof: f64) -> f64 {
    if z == 0.0 || z.is_infinite() || dof == f64::INFINITY {
        return z;
    }
    let mut high = z;
    while student_to_normal(high, dof) < z {
        high *= 2.0;
    }
    let mut low = 0.0;
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break high;
        }
        if student_to_normal(middle, dof) < z {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Hill (1970), Algorithm 395: with a = ν − ½, b = 48 a², y = a ln(1 + t²/ν),
///
/// > z = √y (1 + (y + 3 + (−0.4 y³ − 3.3 y² − 24 y − 85.5)/(0.8 y² + 100 + b))/b)
fn hill(t: f64, dof: f64) -> f64 {
    let a = dof - 0.5;
    let b = 48.0 * a * a;
    let y = a * log_one_plus_square(t / dof.sqrt());
    let second = (((-0.4 * y - 3.3) * y - 24.0) * y - 85.5) / (0.8 * y * y + 100.0 + b);
    (1.0 + (second + y + 3.0) / b) * y.sqrt()
}

/// ln(1 + r²) without overflow.
fn log_one_plus_square(r: f64) -> f64 {
    if r < 1e8 {
        libm::log1p(r * r)
    } else {
        2.0 * libm::log(r)
    }
}

/// ln of the upper tail, S(t) = ½ I_x(ν/2, ½), x = ν/(ν + t²), t > 0.
fn log_upper_tail(t: f64, dof: f64) -> f64 {
    let (a, b) = (0.5 * dof, 0.5);
    let r = t / dof.sqrt();
    let x = 1.0 / (1.0 + r * r);
    let rest = if r < 1e8 { r * r * x } else { 1.0 };
    // x^a (1 − x)^b/B(a, b)
    let log_one_minus_x = if r < 1e8 {
        libm::log(r * r) - libm::log1p(r * r)
    } else {
        0.0
    };
    let log_front =
        log_gamma_ratio(a) - 0.5 * libm::log(PI) - a * log_one_plus_square(r) + b * log_one_minus_x;
    if x < (a + 1.0) / (a + b + 2.0) {
        -LN_2 + log_front + libm::log(beta_fraction(a, b, x) / a)
    } else {
        -LN_2 + libm::log1p(-libm::exp(log_front) * beta_fraction(b, a, rest) / b)
    }
}

/// ln Γ(a + ½) − ln Γ(a), by its expansion where the difference would cancel.
fn log_gamma_ratio(a: f64) -> f64 {
    if a < 50.0 {
        return ln_gamma(a + 0.5) - ln_gamma(a);
    }
    let w = 1.0 / (a * a);
    0.5 * libm::log(a) + (-1.0 / 8.0 + w * (1.0 / 192.0 - w / 640.0)) / a
}

/// The continued fraction of the incomplete beta function by Lentz's method: I_x(a, b) = x^a (1 −
/// x)^b/(a B(a, b)) times this, for x < (a + 1)/(a + b + 2). It needs some √max(a, b) terms.
fn beta_fraction(a: f64, b: f64, x: f64) -> f64 {
    let guard = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };
    let mut c = 1.0;
    let mut d = 1.0 / guard(1.0 - (a + b) * x / (a + 1.0));
    let mut product = d;
    for m in 1..20_000 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut change = 1.0;
        for term in [even, odd] {
            d = 1.0 / guard(1.0 + term * d);
            c = guard(1.0 + term / c);
            change = c * d;
            product *= change;
        }
        if (change - 1.0).abs() < 1e-16 {
            break;
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By 40-digit arithmetic from the definition of both tails.
    const TABLE: [(f64, f64, f64); 17] = [
        (1.0, 15.0, 0.967_748_207_272_001_8),
        (3.0, 15.0, 2.613_091_125_397_055),
        (40.0, 15.0, 8.286_217_802_796_098),
        (0.5, 63.0, 0.497_527_536_047_275_2),
        (5.0, 63.0, 4.570_880_256_325_387),
        (40.0, 63.0, 14.317_660_072_013_2),
        (2.0, 1000.0, 1.997_505_049_346_283),
        (40.0, 1000.0, 30.904_232_123_729_01),
        (1.0, 9999.0, 0.999_949_997_499_895_8),
        (6.0, 9999.0, 5.994_460_133_123_722),
        (40.0, 9999.0, 38.524_229_571_428_4),
        (1.0, 10_001.0, 0.999_950_007_498_896),
        (6.0, 10_001.0, 5.994_461_238_854_468),
        (40.0, 10_001.0, 38.524_502_014_495_66),
        (2.5, 1e6, 2.499_995_468_764_604),
        (40.0, 1e6, 39.984_003_857_066_69),
        (8.0, 1e8, 7.999_998_700_000_448),
    ];

    #[test]
    fn table_values() {
        for (t, dof, exact) in TABLE {
            // Rounding of ln S, up to some hundred, over the slope z; and the next term of Hill's
            // expansion.
            let z = student_to_normal(t, dof);
            assert!((z / exact - 1.0).abs() < 2e-12, "{t} {dof}: {z} {exact}");
            assert_eq!(student_to_normal(-t, dof), -z);
        }
    }

    #[test]
    fn the_threshold_is_the_tabulated_one() {
        for (t, dof, z) in TABLE {
            assert!(
                (student_threshold(z, dof) / t - 1.0).abs() < 1e-11,
                "{t} {dof}"
            );
        }
        assert_eq!(student_threshold(0.0, 5.0), 0.0);
        assert_eq!(student_threshold(f64::INFINITY, 5.0), f64::INFINITY);
        assert_eq!(student_threshold(2.0, f64::INFINITY), 2.0);
    }

    #[test]
    fn one_and_two_degrees_have_closed_tails() {
        for t in [0.01, 1.0, 7.0, 40.0, 1e6, 1e120, 1e200] {
            // ν = 1: S = atan(1/t)/π. ν = 2: S = 1/(√(2 + t²) (√(2 + t²) + t)).
            let one = from_log_upper_tail(libm::log(libm::atan(1.0 / t) / PI));
            let root = libm::hypot(t, 2f64.sqrt());
            let two = from_log_upper_tail(-libm::log(root) - libm::log(root + t));
            for (dof, exact) in [(1.0, one), (2.0, two)] {
                let z = student_to_normal(t, dof);
                assert!(
                    (z - exact).abs() < 1e-13 * (1.0 + exact),
                    "{t} {dof}: {z} {exact}"
                );
            }
        }
    }

    #[test]
    fn it_is_increasing_and_finite_across_every_seam() {
        for dof in [0.5, 1.0, 3.0, 15.0, 99.0, 101.0, 9999.0, 10_001.0, 1e8] {
            let mut last = 0.0;
            for step in 1..4000 {
                let z = student_to_normal(0.01 * f64::from(step), dof);
                assert!(z.is_finite() && z > last, "{dof} {step}: {z} {last}");
                last = z;
            }
            assert!(student_to_normal(40.0, dof) <= 40.0);
        }
    }

    #[test]
    fn edges() {
        assert_eq!(student_to_normal(0.0, 5.0), 0.0);
        assert_eq!(student_to_normal(-3.0, f64::INFINITY), -3.0);
        assert_eq!(student_to_normal(f64::NEG_INFINITY, 3.0), f64::NEG_INFINITY);
        for (t, dof) in [(f64::NAN, 3.0), (1.0, 0.0), (1.0, -1.0), (1.0, f64::NAN)] {
            assert!(student_to_normal(t, dof).is_nan());
        }
    }
}
