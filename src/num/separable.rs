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
        let (mut in_row, mut in_column) = (vec![false; m], vec![false; n]);
        for at in at {
            in_row[at % m] = true;
            in_column[at / m] = true;
        }
        let any = |lines: &[bool]| lines.iter().filter(|any| **any).count();
        let fitted = (any(&in_row) + any(&in_column)).saturating_sub(1);
        let (mut rows, mut columns) = (vec![1.0; m], vec![1.0; n]);
        for _ in 0..ROUNDS {
            let of = |at: usize| (at / m, values[at], rows[at % m]);
            let last = std::mem::take(&mut columns);
            columns = means(n, at.iter().map(|at| of(*at)));
            let of = |at: usize| (at % m, values[at], columns[at / m]);
            rows = means(m, at.iter().map(|at| of(*at)));
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

/// Means of x/y over the entries of each of `count` lines, given as line, x and y; those of a y of
/// 0, whose line holds nothing, are passed over. 1 of a line without entries.
fn means(count: usize, entries: impl Iterator<Item = (usize, f64, f64)>) -> Vec<f64> {
    let mut sums = vec![(0.0, 0u32); count];
    for (line, x, y) in entries.filter(|(_, _, y)| *y > 0.0) {
        let (sum, n) = &mut sums[line];
        *sum += x / y;
        *n += 1;
    }
    let mean = |(sum, n): (f64, u32)| if n > 0 { sum / f64::from(n) } else { 1.0 };
    sums.into_iter().map(mean).collect()
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
                (found.at(at) - product[at]).abs() <= 1e-5 * product[at],
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
