//! Correlation of ranks.

use super::correlation;

/// Spearman's correlation: Pearson's of the ranks, equal values sharing their mean rank. 1 for any
/// growing relation.
///
/// `None` where [`correlation`] is.
pub fn rank_correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let finite = a.iter().chain(b).all(|x| x.is_finite());
    if !finite {
        return None;
    }
    correlation(&ranks(a), &ranks(b))
}

/// The rank of each value from 1, the mean of the ranks where values are equal.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|i, j| values[*i].total_cmp(&values[*j]));
    let mut ranks = vec![0.0; values.len()];
    let mut first = 0;
    for group in order.chunk_by(|i, j| values[*i] == values[*j]) {
        let mean = first as f64 + 0.5 * (group.len() as f64 + 1.0);
        for i in group {
            ranks[*i] = mean;
        }
        first += group.len();
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_by_hand() {
        assert_eq!(
            ranks(&[3.0, -1.0, 3.0, 7.0, 3.0]),
            [3.0, 1.0, 3.0, 5.0, 3.0]
        );
        assert_eq!(ranks(&[0.0, -0.0]), [1.5, 1.5]);
        // Σd² = 1 + 1 + 0: 1 − 6·2/(3·8) = ½.
        let found = rank_correlation(&[1.0, 2.0, 30.0], &[5.0, 4.0, 6.0]).unwrap();
        assert!((found - 0.5).abs() < 1e-15);
    }

    #[test]
    fn a_growing_relation_is_perfect_however_bent() {
        let a: Vec<f64> = (0..20).map(f64::from).collect();
        let b: Vec<f64> = a.iter().map(|x| libm::exp(*x)).collect();
        assert!((rank_correlation(&a, &b).unwrap() - 1.0).abs() < 1e-15);
        assert_eq!(rank_correlation(&a, &[1.0; 20]), None);
        assert_eq!(rank_correlation(&[1.0, f64::NAN], &[1.0, 2.0]), None);
        assert_eq!(rank_correlation(&[1.0], &[1.0, 2.0]), None);
    }
}
