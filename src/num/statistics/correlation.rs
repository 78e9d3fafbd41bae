//! Significance of a correlation.

use super::{normal_two_sided, student_to_normal};

/// Probability that `n` pairs of independent numbers are correlated by at least |r|, by the law of
/// t = r·√((n − 2)/(1 − r²)), Student's with n − 2 degrees of freedom.
///
/// Exact for Pearson's correlation of normal numbers; for ranks (Spearman) the usual approximation,
/// good from 10 pairs on. NaN where n < 3, or r is not in \[−1, 1\].
pub fn correlation_two_sided(r: f64, n: usize) -> f64 {
    if n < 3 || !(-1.0..=1.0).contains(&r) {
        return f64::NAN;
    }
    let dof = (n - 2) as f64;
    let t = r * (dof / ((1.0 - r) * (1.0 + r))).sqrt();
    normal_two_sided(student_to_normal(t, dof))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The density of r is (1 − r²)^(n/2 − 2) but for a factor: for 3, 4 and 6 pairs its integral
    /// is elementary.
    #[test]
    fn few_pairs_have_closed_tails() {
        for r in [0.0, 0.1, 0.5, 0.9, 0.999, 1.0f64] {
            let three = 1.0 - 2.0 / std::f64::consts::PI * libm::asin(r);
            let six = 1.0 - 1.5 * r + 0.5 * r * r * r;
            for (n, want) in [(3, three), (4, 1.0 - r), (6, six)] {
                for r in [r, -r] {
                    let p = correlation_two_sided(r, n);
                    assert!((p - want).abs() < 1e-12, "{r} {n}: {p} for {want}");
                }
            }
        }
    }

    /// Exact two-sided 5 % and 1 % points of Spearman's coefficient for 16 pairs (J. H. Zar,
    /// Biostatistical Analysis).
    #[test]
    fn ranks_are_near_their_exact_table() {
        for (r, level) in [(0.503, 0.05), (0.635, 0.01)] {
            let p = correlation_two_sided(r, 16);
            assert!((p / level - 1.0).abs() < 0.25, "{r}: {p}");
        }
    }

    #[test]
    fn edges() {
        for (r, n) in [(0.5, 2), (1.1, 9), (f64::NAN, 9)] {
            assert!(correlation_two_sided(r, n).is_nan());
        }
    }
}
