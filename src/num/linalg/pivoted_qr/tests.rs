use super::*;
use crate::num::linalg::kernel::{bench_g12, hilbert, kahan};
use crate::num::linalg::{pinv, svd};

#[test]
fn the_diagonal_falls_and_the_factors_return_the_matrix() {
    for a in [
        hilbert(12, 12),
        hilbert(40, 9),
        hilbert(9, 40),
        bench_g12(3.0),
        bench_g12(3.0).transpose(),
        bench_g12(6.0),
        kahan(90, 1.2),
        DMatrix::from_element(64, 120, 1.0),
        DMatrix::zeros(3, 5),
    ] {
        let qr = pivoted_qr(&a).unwrap();
        let diagonal = qr.diagonal();
        assert!(
            diagonal
                .windows(2)
                .all(|d| d[1] <= d[0] * (1.0 + 8.0 * f64::EPSILON)),
            "{diagonal:?}"
        );
        let mut order = qr.order.clone();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..a.ncols()));
        assert!((0..qr.r.nrows()).all(|i| (0..i).all(|j| qr.r[(i, j)] == 0.0)));
        // |R₁₁| is the largest column norm.
        let longest = a.column_iter().map(|c| c.norm()).fold(0.0, f64::max);
        assert!((diagonal[0] - longest).abs() <= 1e-14 * longest);
    }
}

/// Kahan's matrix is triangular, its columns fall by a hair in norm, and its last singular
/// value lies far below its last diagonal entry: with pivoting nothing moves, so R is the
/// matrix itself. The diagonal therefore overstates: |R_nn| ≥ σ_n, known from theory.
#[test]
fn kahans_matrix_is_its_own_factor() {
    let a = kahan(60, 1.2);
    let qr = pivoted_qr(&a).unwrap();
    assert_eq!(qr.order, (0..60).collect::<Vec<_>>());
    for (i, d) in qr.diagonal().into_iter().enumerate() {
        assert!((d / a[(i, i)] - 1.0).abs() < 1e-12);
    }
    let last = svd(&a).unwrap().sigma[59];
    assert!(qr.diagonal()[59] > 100.0 * last, "{last:e}");
}

#[test]
fn both_solutions_of_a_hand_made_system() {
    // 2 x₁ + x₂ + 0 x₃ = 4 twice: the first column is the longest, so the basic solution is (2,
    // 0, 0); least norm is 4 (2, 1, 0)/5.
    let a = DMatrix::from_row_slice(2, 3, &[2.0, 1.0, 0.0, 2.0, 1.0, 0.0]);
    let b = DMatrix::from_element(2, 1, 4.0);
    let qr = pivoted_qr(&a).unwrap();
    assert_eq!(qr.rank(Tolerance::Auto).unwrap().0, 1);
    let basic = qr.basic(1, &b).unwrap();
    assert!((basic - DMatrix::from_row_slice(3, 1, &[2.0, 0.0, 0.0])).amax() < 1e-15);
    let least = qr.minimum_norm(1, &b).unwrap();
    assert!((least - DMatrix::from_row_slice(3, 1, &[1.6, 0.8, 0.0])).amax() < 1e-15);
}

#[test]
fn the_two_solutions_have_one_residual() {
    for a in [bench_g12(3.0).transpose(), bench_g12(6.0), hilbert(30, 12)] {
        let qr = pivoted_qr(&a).unwrap();
        let (rank, cutoff) = qr.rank(Tolerance::Relative(1e-8)).unwrap();
        assert!(cutoff > 0.0 && rank < a.ncols());
        let b = DMatrix::from_fn(a.nrows(), 2, |i, j| ((i * 7 + j * 3) % 5) as f64 - 2.0);
        let (basic, least) = (
            qr.basic(rank, &b).unwrap(),
            qr.minimum_norm(rank, &b).unwrap(),
        );
        let used = basic.row_iter().filter(|row| row.amax() > 0.0).count();
        assert!(used <= rank && least.norm() < basic.norm());
        // What the cut leaves of A enters by the solution's size.
        let [one, other] = [&basic, &least].map(|x| (&a * x - &b).norm());
        assert!(
            (one - other).abs() <= 100.0 * cutoff * basic.norm(),
            "{one} {other}"
        );
    }
}

#[test]
fn least_norm_is_the_moore_penrose_inverse() {
    // Where the rank is plain both decompositions see the same.
    for a in [
        hilbert(6, 9),
        hilbert(9, 6),
        DMatrix::from_element(5, 7, 2.0),
    ] {
        let qr = pivoted_qr(&a).unwrap();
        let (rank, _) = qr.rank(Tolerance::Auto).unwrap();
        let known = pinv(&a, Tolerance::Auto).unwrap();
        assert_eq!(rank, known.rank);
        let identity = DMatrix::identity(a.nrows(), a.nrows());
        let found = qr.minimum_norm(rank, &identity).unwrap();
        let condition = known.sigma[0] / known.sigma[rank - 1];
        let error = (found - &known.matrix).norm() / known.matrix.norm();
        assert!(error < 100.0 * f64::EPSILON * condition, "{error:e}");
    }
}

#[test]
fn scale_does_not_matter() {
    let a = hilbert(9, 6);
    let b = &a * DMatrix::from_element(6, 1, 1.0);
    for factor in [1e300, 1e-300] {
        let qr = pivoted_qr(&(&a * factor)).unwrap();
        assert_eq!(qr.order, pivoted_qr(&a).unwrap().order);
        for x in [
            qr.basic(6, &(&b * factor)).unwrap(),
            qr.minimum_norm(6, &(&b * factor)).unwrap(),
        ] {
            assert!((x - DMatrix::from_element(6, 1, 1.0)).amax() < 1e-8);
        }
    }
}

#[test]
fn bad_input_and_wrong_factors_are_noticed() {
    let mut a = bench_g12(3.0);
    let qr = pivoted_qr(&a).unwrap();
    let (scaled, _) = scaled(&a).unwrap();
    let mut wrong = qr.clone();
    wrong.r[(0, 5)] *= 1.0 + 1e-9;
    assert!(matches!(
        check(&scaled, &wrong),
        Err(LinalgError::Inaccurate { .. })
    ));
    let mut wrong = qr.clone();
    wrong.q[(3, 0)] += 1e-9;
    assert!(matches!(
        check(&scaled, &wrong),
        Err(LinalgError::Inaccurate { .. })
    ));
    assert!(matches!(
        qr.basic(1, &DMatrix::zeros(3, 1)),
        Err(LinalgError::Shape { .. })
    ));
    for rank in [0, 65] {
        let refused = qr.minimum_norm(rank, &DMatrix::zeros(64, 1));
        assert!(matches!(refused, Err(LinalgError::Rank { .. })));
    }
    a[(1, 2)] = f64::NAN;
    assert!(matches!(pivoted_qr(&a), Err(LinalgError::NotFinite { .. })));
    assert!(pivoted_qr(&DMatrix::zeros(0, 2)).is_err());
}
