//! Sums whose bits depend on the terms alone.

/// Σ terms along the fixed binary tree over their positions: neighbours (0, 1), (2, 3), … first,
/// then pairs of pairs.
///
/// Any aligned part of the terms can be summed elsewhere without changing a bit of the result; the
/// rounding error grows with log₂ of their number.
pub fn tree_sum(terms: &[f64]) -> f64 {
    let mut level = terms.to_vec();
    while level.len() > 1 {
        level = level.chunks(2).map(|pair| pair.iter().sum()).collect();
    }
    level.first().copied().unwrap_or(0.0)
}

/// Mean of independent replicates and the standard error of that mean, √(Σ(x − x̄)²/(n(n − 1))).
///
/// A single replicate has no known error: it is infinite.
pub fn mean_and_stderr(replicates: &[f64]) -> (f64, f64) {
    let n = replicates.len() as f64;
    let mean = tree_sum(replicates) / n;
    if replicates.len() < 2 {
        return (mean, f64::INFINITY);
    }
    let squares: Vec<f64> = replicates.iter().map(|x| (x - mean) * (x - mean)).collect();
    (mean, (tree_sum(&squares) / (n * (n - 1.0))).sqrt())
}

/// ln Σ exp of the terms; −∞ of none.
pub fn log_sum_exp(logs: &[f64]) -> f64 {
    let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if top == f64::NEG_INFINITY {
        return top;
    }
    top + libm::log(logs.iter().map(|log| libm::exp(log - top)).sum())
}

/// √(Σx²/n); NaN of no values.
pub fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of terms that overflow by themselves, of none, and of zeros alone.
    #[test]
    fn logarithms_of_sums_by_hand() {
        let three = log_sum_exp(&[1e4, 1e4, 1e4]) - 1e4;
        assert!((three - libm::log(3.0)).abs() < 1e-11, "{three}");
        assert_eq!(log_sum_exp(&[]), f64::NEG_INFINITY);
        assert_eq!(log_sum_exp(&[f64::NEG_INFINITY; 2]), f64::NEG_INFINITY);
        assert_eq!(root_mean_square(&[1.0, -7.0]), 5.0);
    }

    #[test]
    fn aligned_parts_can_be_summed_elsewhere() {
        let terms: Vec<f64> = (0..37)
            .map(|i| libm::sin(f64::from(i) * 7.3) * 1e3)
            .collect();
        for aligned in [1, 2, 4, 8, 16, 32] {
            let parts: Vec<f64> = terms.chunks(aligned).map(tree_sum).collect();
            assert_eq!(tree_sum(&parts).to_bits(), tree_sum(&terms).to_bits());
        }
        assert_eq!(tree_sum(&[]), 0.0);
    }

    #[test]
    fn the_standard_error_is_the_textbook_one() {
        // 1, 2, 3, 4: mean 2.5, sample variance 5/3, standard error √(5/12).
        let (mean, error) = mean_and_stderr(&[1.0, 2.0, 3.0, 4.0]);
        assert_eq!(mean, 2.5);
        assert!((error - (5.0f64 / 12.0).sqrt()).abs() < 1e-15);
        assert_eq!(mean_and_stderr(&[3.0]), (3.0, f64::INFINITY));
    }
}
