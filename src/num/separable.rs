//! A matrix of numbers ≥ 0 as a product of one number for each row and one for each column.

use nalgebra::DMatrix;

/// Rounds of the alternation, and the change of the product at which it ends.
const ROUNDS: usize = 100;
const SETTLED: f64 = 1e-6;

/// a\[p\] b\[l\], by the equations of a gamma likelihood of the entries x,
///
/// > a\[p\] = mean over l of x/b\[l\],   b\[l\] = mean over p of x/a\[p\].
#[derive(Clone, Debug, PartialEq)]
pub struct Separable {
    rows: Vec<f64>,
    columns: Vec<f64>,
    /// Numbers among both that are fitted.
    pub fitted: usize,
}

impl Separable {
    /// Of the entries `at` of `values`, counted along the columns. Rows and columns of which none
    /// is among them have 1.
    pub fn of(values: &DMatrix<f64>, at: &[usize]) -> Self {
        let (m, n) = values.shape();
        let (mut in_row, mut in_column) = (vec![0.0f64; m], vec![0.0f64; n]);
        for at in at {
            in_row[at % m] += 1.0;
            in_column[at / m] += 1.0;
        }
        let any = |counts: &[f64]| counts.iter().filter(|n| **n > 0.0).count();
        let fitted = (any(&in_row) + any(&in_column)).saturating_sub(1);
        let (mut rows, mut columns) = (vec![1.0; m], vec![1.0; n]);
        for _ in 0..ROUNDS {
            let mut sums = vec![0.0; n];
            at.iter()
                .for_each(|at| sums[at / m] += over(values[*at], rows[at % m]));
            let last = std::mem::replace(&mut columns, means(&sums, &in_column));
            let mut sums = vec![0.0; m];
            at.iter()
                .for_each(|at| sums[at % m] += over(values[*at], columns[at / m]));
            rows = means(&sums, &in_row);
            let changes = columns.iter().zip(&last);
            let changes = changes.map(|(b, was)| (b - was).abs() / b.max(f64::MIN_POSITIVE));
            if changes.fold(0.0, f64::max) < SETTLED {
                break;
            }
        }
        Self {
            rows,
            columns,
            fitted,
        }
    }

    /// The product at the entry that is so far along the columns.
    pub fn at(&self, at: usize) -> f64 {
        let m = self.rows.len();
        self.rows[at % m] * self.columns[at / m]
    }
}

/// The ratio; 0 of what is 0 throughout.
fn over(x: f64, by: f64) -> f64 {
    if by > 0.0 { x / by } else { 0.0 }
}

/// Sums over their counts; 1 of none.
fn means(sums: &[f64], counts: &[f64]) -> Vec<f64> {
    let each = sums.iter().zip(counts);
    each.map(|(sum, n)| if *n > 0.0 { sum / n } else { 1.0 })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A product is found, with an entry missing and a row of zeros; of others the ratios have the
    /// mean 1 in each row and column.
    #[test]
    fn the_likelihood_is_stationary() {
        let product = DMatrix::from_fn(4, 3, |p, l| p as f64 * [1e-20, 3e-20, 2e-20][l]);
        let all: Vec<usize> = (0..12).filter(|at| *at != 7).collect();
        let found = Separable::of(&product, &all);
        assert_eq!(found.fitted, 6);
        for at in 0..12 {
            assert!(
                (found.at(at) - product[at]).abs() <= 1e-6 * product[at],
                "{at}"
            );
        }
        let other = DMatrix::from_fn(4, 3, |p, l| 1.0 + ((7 * p + 5 * l) % 4) as f64);
        let all: Vec<usize> = (0..12).collect();
        let found = Separable::of(&other, &all);
        let ratio = |p: usize, l: usize| other[(p, l)] / found.at(p + 4 * l);
        for p in 0..4 {
            let mean = (0..3).map(|l| ratio(p, l)).sum::<f64>() / 3.0;
            assert!((mean - 1.0).abs() < 1e-5, "{p}: {mean}");
        }
        for l in 0..3 {
            let mean = (0..4).map(|p| ratio(p, l)).sum::<f64>() / 4.0;
            assert!((mean - 1.0).abs() < 1e-5, "{l}: {mean}");
        }
    }
}
