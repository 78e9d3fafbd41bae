//! Light from elsewhere, which varies smoothly over the wall.

use crate::matrix::Matrix;

/// The polynomials P_a(x) P_b(y), a + b ≤ `degree`, at the middles of the pixels, pixels ×
/// (degree + 1)(degree + 2)/2: P are Legendre's, x and y run from −1 to 1 over the photograph's
/// columns and rows, pixel column + row·columns. The first is 1.
pub fn polynomials([columns, rows]: [usize; 2], degree: usize) -> Matrix {
    let powers: Vec<[usize; 2]> = (0..=degree)
        .flat_map(|total| (0..=total).map(move |b| [total - b, b]))
        .collect();
    let middle = |k: usize, n: usize| (2 * k + 1) as f64 / n as f64 - 1.0;
    Matrix::from_fn(columns * rows, powers.len(), |p, k| {
        let [a, b] = powers[k];
        legendre(a, middle(p % columns, columns)) * legendre(b, middle(p / columns, rows))
    })
}

/// P_n(x) by (n + 1) P_n+1 = (2 n + 1) x P_n − n P_n−1.
fn legendre(n: usize, x: f64) -> f64 {
    let (mut before, mut own) = (0.0, 1.0);
    for k in 0..n {
        let k = k as f64;
        (before, own) = (own, ((2.0 * k + 1.0) * x * own - k * before) / (k + 1.0));
    }
    own
}

#[cfg(test)]
mod tests {
    use super::*;

    /// P_2 = (3 x² − 1)/2, P_3 = (5 x³ − 3 x)/2; six polynomials of degree 2.
    #[test]
    fn polynomials_by_hand() {
        for x in [-1.0, -0.3, 0.0, 0.8] {
            assert!((legendre(2, x) - (3.0 * x * x - 1.0) / 2.0).abs() < 1e-15);
            assert!((legendre(3, x) - (5.0 * x * x * x - 3.0 * x) / 2.0).abs() < 1e-15);
        }
        let found = polynomials([4, 2], 2);
        assert_eq!(found.shape(), (8, 6));
        // Pixel 6 is column 2 of row 1: x = 1/4, y = 1/2.
        let (x, y) = (0.25, 0.5);
        let expected = [
            1.0,
            x,
            y,
            (3.0 * x * x - 1.0) / 2.0,
            x * y,
            (3.0 * y * y - 1.0) / 2.0,
        ];
        for (k, expected) in expected.into_iter().enumerate() {
            assert!((found[(6, k)] - expected).abs() < 1e-15, "{k}");
        }
    }
}
