use super::*;
use crate::num::linalg::kernel::{bench_g12, hilbert};

#[test]
fn the_triangle_keeps_every_distance() {
    for a in [hilbert(30, 8), bench_g12(3.0).transpose(), hilbert(5, 9)] {
        let b = DVector::from_fn(a.nrows(), |i, _| ((i * 5) % 7) as f64 - 3.0);
        let t = triangle(&a, &b).unwrap();
        for seed in 0..3 {
            let x = DVector::from_fn(a.ncols(), |j, _| ((j * 3 + seed) % 5) as f64 - 2.0);
            let direct = (&a * &x - &b).norm();
            let reduced = libm::hypot((&t.r * &x - &t.d).norm(), t.rest);
            assert!((direct / reduced - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn both_reductions_are_the_same_problem() {
    // Rᵀ R = Aᵀ A and Rᵀ d = Aᵀ b whichever way R was found.
    let a = hilbert(30, 4);
    let b = DVector::from_fn(30, |i, _| ((i * 5) % 7) as f64 - 3.0);
    let (gram, moment) = (a.transpose() * &a, a.transpose() * &b);
    let normal = normal_triangle(&gram, &moment, b.norm_squared()).unwrap();
    for t in [triangle(&a, &b).unwrap(), normal] {
        assert!((t.r.transpose() * &t.r - &gram).amax() < 1e-14 * gram.amax());
        assert!((t.r.transpose() * &t.d - &moment).amax() < 1e-13 * moment.amax());
        assert!((t.d.norm_squared() + t.rest * t.rest - b.norm_squared()).abs() < 1e-11);
    }
}

#[test]
fn substitution_solves_what_has_one_solution() {
    // Planted x; two parallel columns have no unique one.
    let a = hilbert(30, 5);
    let x = DVector::from_row_slice(&[1.0, -2.0, 3.0, 0.5, 0.0]);
    let found = triangle(&a, &(&a * &x)).unwrap().substitute(1e-12);
    assert!((found.unwrap() - x).amax() < 1e-9);
    // Columns t and t/3, parallel but for some roundings.
    let off = |i: usize, j: usize| 1.0 + 1e-14 * (i * j % 2) as f64;
    let twice = DMatrix::from_fn(4, 2, |i, j| {
        off(i, j) * (1.1 + i as f64).sqrt() / (1 + 2 * j) as f64
    });
    let b = DVector::from_element(4, 1.0);
    assert_eq!(triangle(&twice, &b).unwrap().substitute(1e-12), None);
    let wide = triangle(
        &DMatrix::from_element(1, 3, 1.0),
        &DVector::from_element(1, 1.0),
    );
    assert_eq!(wide.unwrap().substitute(1e-12), None);
}

#[test]
fn bad_input_is_refused() {
    let a = DMatrix::from_element(3, 2, 1.0);
    assert!(matches!(
        triangle(&a, &DVector::zeros(2)),
        Err(LinalgError::Shape { .. })
    ));
    assert!(triangle(&(a * f64::NAN), &DVector::zeros(3)).is_err());
    assert!(normal_triangle(&DMatrix::zeros(2, 3), &DVector::zeros(2), 0.0).is_err());
}

/// Hilbert's matrix is positive definite with a trace that falls by a decade or more a row: few
/// rows leave what is asked for, and no more is lost of any x; data in the range come back.
#[test]
fn few_rows_stand_for_a_smooth_gram_matrix() {
    let n = 12;
    let gram = DMatrix::from_fn(n, n, |i, j| 1.0 / (i + j + 1) as f64);
    let x = DVector::from_fn(n, |i, _| libm::sin(i as f64 * 0.7));
    let (moment, square) = (&gram * &x, x.dot(&(&gram * &x)));
    let at_most = |most: usize, lost: f64| {
        let gram = Gram {
            diagonal: gram.diagonal(),
            column: |j| Some(gram.column(j).into_owned()),
            most,
        };
        pivoted_triangle(gram, &moment, square, lost).unwrap()
    };
    let mut rows = 0;
    for lost in [1e-2, 1e-5, 1e-8] {
        let found = at_most(n, lost).unwrap();
        let left = &gram - found.r.tr_mul(&found.r);
        let least = left.clone().symmetric_eigen().eigenvalues.min();
        assert!(left.trace() <= lost && least > -1e-14, "{lost}: {least}");
        assert!(found.r.nrows() > rows && found.r.nrows() < n);
        rows = found.r.nrows();
        let off = (&found.r * &x - &found.d).norm_squared() + found.rest.powi(2);
        assert!(off <= 2.0 * lost * x.norm_squared(), "{lost}: {off}");
    }
    assert!(at_most(n, 1e-16).is_none());
    // Fewer columns than it takes.
    assert!(at_most(rows, 1e-8).is_some() && at_most(rows - 1, 1e-8).is_none());
}
