//! Ill-conditioned matrices for the tests.

use nalgebra::DMatrix;

/// Hilbert's matrix 1/(i + j + 1).
pub(super) fn hilbert(m: usize, n: usize) -> DMatrix<f64> {
    DMatrix::from_fn(m, n, |i, j| 1.0 / (i + j + 1) as f64)
}

/// Kahan's n × n matrix diag(1, s, s², …) (1 on the diagonal, −c above), s = sin θ, c = cos θ; its
/// columns are made to fall in norm by a factor 1 − 25 eps each, so that rounding does not decide
/// the pivots.
pub(super) fn kahan(n: usize, theta: f64) -> DMatrix<f64> {
    let (s, c) = (libm::sin(theta), libm::cos(theta));
    DMatrix::from_fn(n, n, |i, j| {
        let entry = match i.cmp(&j) {
            std::cmp::Ordering::Less => -c,
            std::cmp::Ordering::Equal => 1.0,
            std::cmp::Ordering::Greater => 0.0,
        };
        entry * s.powi(i as i32) * (1.0 - 25.0 * f64::EPSILON * j as f64)
    })
}

/// The kernel cosθs·cosθd/R² of a bench with 120 spots on a square of the given half-width (lengths
/// in inches) and 8 × 8 elements on a plane leaning 45° over the wall: 64 × 120, smooth and so
/// numerically rank deficient.
pub(super) fn bench_g12(half_width: f64) -> DMatrix<f64> {
    leaning(8, 30, half_width)
}

/// The same with `side`² elements and `per_side` spots on each side of the square.
pub(super) fn leaning(side: usize, per_side: usize, half_width: f64) -> DMatrix<f64> {
    let (cx, cy) = (5.0, 15.5 - 7.86764 * 2f64.sqrt());
    let h = half_width;
    let centre = |k: usize| 4.0 * (k as f64 + 0.5) / side as f64;
    DMatrix::from_fn(side * side, 4 * per_side, |j, l| {
        let d = 5.86764 + centre(j / side);
        let (x2, y2, z2) = (
            3.0 + centre(j % side),
            15.5 - d / 2f64.sqrt(),
            d / 2f64.sqrt(),
        );
        let (along, across) = (
            2.0 * h * (l % per_side) as f64 / (per_side - 1) as f64 - h,
            h + [-1.0, 1.0, 0.0][l % 3],
        );
        let (x1, y1) = match l / per_side {
            0 => (cx + along, cy - across),
            1 => (cx + across, cy + along),
            2 => (cx - along, cy + across),
            _ => (cx - across, cy - along),
        };
        let r2 = (x2 - x1) * (x2 - x1) + (y2 - y1) * (y2 - y1) + z2 * z2;
        z2 * (15.5 - y1) / (2f64.sqrt() * r2 * r2)
    })
}
