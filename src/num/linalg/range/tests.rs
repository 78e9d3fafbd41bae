use super::*;
use crate::num::linalg::kernel::leaning;
use crate::num::linalg::{
    Tolerance, cut, pinv, pivoted_qr, pivoted_qr_to, svd, svd_of_range, svd_to,
};

/// U diag(σ) Vᵀ with orthonormal U and V from random numbers.
fn planted(m: usize, n: usize, sigma: &[f64]) -> DMatrix<f64> {
    let basis = |rows: usize, spot: u32| {
        let mut stream = Stream::new(
            Sampling::Pcg,
            Key {
                seed: 7,
                spot,
                pixel: 0,
                block: 0,
            },
        );
        orthonormal(DMatrix::from_fn(rows, sigma.len(), |_, _| stream.normal()))
    };
    let mut left = basis(m, 1);
    for (mut column, s) in left.column_iter_mut().zip(sigma) {
        column *= *s;
    }
    product(&left, &basis(n, 2).transpose())
}

fn rank(sigma: &[f64], (m, n): (usize, usize)) -> usize {
    cut(sigma, m, n, Tolerance::Auto).unwrap().0
}

/// What the range holds and what it says of the rest, against the matrix itself.
#[test]
fn the_range_is_orthonormal_and_misses_what_it_says() {
    let a = leaning(24, 200, 6.0);
    for factor in [1.0, 1e300, 1e-160] {
        let scaled = &a * factor;
        let found = range(&scaled).unwrap().unwrap();
        let k = found.q.ncols();
        assert!(k <= 192 && found.b.nrows() == k);
        assert!((tr_product(&found.q, &found.q) - DMatrix::identity(k, k)).norm() < 1e-13);
        let missed = (&scaled - product(&found.q, &found.b))
            .map(|x| x / factor)
            .norm();
        assert!(found.rest / factor <= 32.0 * f64::EPSILON * a.norm());
        // Both are sums of roundings, in another order.
        assert!(
            missed < 4.0 * found.rest / factor,
            "{missed:e} {:e}",
            found.rest
        );
    }
}

/// Rank, singular values, projectors and the inverse of the full decomposition; too small a matrix
/// takes that itself.
#[test]
#[ignore = "slow"]
fn the_directions_are_those_of_the_full_decomposition() {
    for (side, per_side, half_width, ranged) in [
        (8, 30, 3.0, false),
        (16, 100, 6.0, false),
        (24, 200, 6.0, true),
        (24, 200, 3.0, true),
    ] {
        let a = leaning(side, per_side, half_width);
        for a in [a.transpose(), a] {
            let full = svd(&a).unwrap();
            let found = svd_to(&a, Tolerance::Auto).unwrap();
            assert_eq!(found.sigma.len() < full.sigma.len(), ranged);
            assert_eq!(found.rest > 0.0, ranged);
            let k = rank(full.sigma.as_slice(), a.shape());
            assert_eq!(rank(found.sigma.as_slice(), a.shape()), k);
            for (i, s) in found.sigma.iter().enumerate() {
                assert!((s - full.sigma[i]).abs() < 1e-14 * full.sigma[0]);
            }
            let k_found = found.sigma.len();
            // Beyond them both know only what rounding left.
            let beyond = full.sigma.rows(k_found, full.sigma.len() - k_found).amax();
            assert!(beyond <= found.rest + 16.0 * f64::EPSILON * full.sigma[0]);
            // To rounding over σ_k: at the very last direction about 1e-3, ten times above it
            // better by as much.
            for above in [1.0, 1e3, 1e6] {
                let k = full
                    .sigma
                    .iter()
                    .filter(|s| **s > above * full.sigma[k - 1] * 0.999)
                    .count();
                let project = |vt: &DMatrix<f64>| {
                    let v = vt.rows(0, k).into_owned();
                    tr_product(&v, &v)
                };
                let gap = (full.sigma[k - 1] - full.sigma[k]) / full.sigma[0];
                let off = (project(&found.vt) - project(&full.vt)).norm();
                assert!(
                    off < 100.0 * f64::EPSILON / gap,
                    "{side} {k}: {off:e} {gap:e}"
                );
            }
        }
    }
}

/// The pseudo-inverse by few directions and by all, cut well above rounding, where it is known.
#[test]
fn the_inverse_is_the_full_one() {
    let a = leaning(24, 200, 6.0);
    let tolerance = Tolerance::Relative(1e-9);
    let found = pinv(&a, tolerance).unwrap();
    let full = svd(&a).unwrap();
    let (k, _) = cut(full.sigma.as_slice(), 576, 800, tolerance).unwrap();
    let mut known = DMatrix::zeros(800, 576);
    for i in 0..k {
        known += full.vt.row(i).transpose() * full.u.column(i).transpose() / full.sigma[i];
    }
    assert_eq!(found.rank, k);
    assert!(found.sigma.len() < 200);
    assert!((found.matrix - &known).norm() < 1e-5 * known.norm());
}

/// Spectra with known answers. `true`: few directions are enough.
#[test]
fn planted_spectra_are_found_or_left_to_the_full_decomposition() {
    let geometric = |ratio: f64, count: usize| -> Vec<f64> {
        (0..count).map(|i| libm::pow(ratio, i as f64)).collect()
    };
    let with_tail =
        |tail: f64| -> Vec<f64> { (0..300).map(|i| if i < 40 { 1.0 } else { tail }).collect() };
    let cases: [(&str, Vec<f64>, bool); 6] = [
        ("of rank 1", vec![3.0], true),
        ("of rank 40, all alike", geometric(1.0, 40), true),
        ("falling by a factor 0.5", geometric(0.5, 60), true),
        ("falling slowly", geometric(0.97, 300), false),
        ("with a tail just below the cut", with_tail(5e-14), false),
        ("with a tail just above it", with_tail(2e-13), false),
    ];
    for (name, sigma, ranged) in cases {
        let a = planted(300, 400, &sigma);
        let found = svd_of_range(&a, Tolerance::Auto).unwrap();
        assert_eq!(found.is_some(), ranged, "{name}");
        let found = svd_to(&a, Tolerance::Auto).unwrap();
        for (i, s) in found.sigma.iter().enumerate() {
            let planted = sigma.get(i).copied().unwrap_or(0.0);
            assert!(
                (s - planted).abs() < 20.0 * f64::EPSILON * sigma[0],
                "{name} {i}: {s:e}"
            );
        }
        let cutoff = 400.0 * f64::EPSILON * sigma[0];
        let known = sigma.iter().filter(|s| **s > cutoff).count();
        assert_eq!(rank(found.sigma.as_slice(), (300, 400)), known, "{name}");
    }
    let ones = svd_of_range(&DMatrix::from_element(300, 400, 1.0), Tolerance::Auto);
    let ones = ones.unwrap().unwrap();
    assert_eq!(rank(ones.sigma.as_slice(), (300, 400)), 1);
    assert!((ones.sigma[0] / 120_000f64.sqrt() - 1.0).abs() < 1e-14);
}

/// A cut that what is missed could move, and a rank below rounding, are left to the full
/// decomposition; all others are not.
#[test]
fn a_cut_in_doubt_is_left_to_the_full_decomposition() {
    let sigma: Vec<f64> = (0..60).map(|i| libm::pow(0.5, f64::from(i))).collect();
    let a = planted(300, 400, &sigma);
    let ranged = |tolerance| svd_of_range(&a, tolerance).unwrap().is_some();
    for tolerance in [
        Tolerance::Auto,
        Tolerance::Spacing,
        Tolerance::Relative(1e-3),
        Tolerance::Relative(1e-13),
        Tolerance::Rank(1),
        Tolerance::Rank(40),
    ] {
        assert!(ranged(tolerance), "{tolerance:?}");
    }
    for tolerance in [
        Tolerance::Relative(0.0),
        Tolerance::Relative(1e-17),
        Tolerance::Rank(50),
        Tolerance::Rank(200),
        Tolerance::Rank(0),
    ] {
        assert!(!ranged(tolerance), "{tolerance:?}");
    }
    assert!(svd_to(&a, Tolerance::Relative(1.0)).is_err());
    // A cluster within what is missed of the cut: certain on neither side.
    let at = svd::certain;
    let cluster = [1.0, 1e-3 * (1.0 - 1e-12), 1e-3 * (1.0 - 2e-12)];
    let tolerance = Tolerance::Relative(1e-3);
    assert_eq!(at(&cluster, 1e-8, (9, 9), tolerance), Ok(false));
    assert_eq!(at(&cluster, 1e-10, (9, 9), tolerance), Ok(true));
    assert_eq!(at(&cluster, 2e-3, (9, 9), tolerance), Ok(false));
}

/// The first pivots, the diagonal and the rank are those of the reduction of all of A.
#[test]
fn pivots_of_the_range_are_those_of_the_matrix() {
    let a = leaning(24, 150, 6.0).transpose();
    let full = pivoted_qr(&a).unwrap();
    for tolerance in [Tolerance::Auto, Tolerance::Relative(1e-6)] {
        let found = pivoted_qr_to(&a, tolerance).unwrap();
        assert!(found.q.ncols() < 200);
        let (k, _) = full.rank(tolerance).unwrap();
        assert_eq!(found.rank(tolerance).unwrap().0, k);
        let (d, e) = (found.diagonal(), full.diagonal());
        assert!((0..k).all(|i| (d[i] - e[i]).abs() < 1e-13 * e[0]));
        let (q, p) = (found.q.columns(0, 20), full.q.columns(0, 20));
        assert_eq!(found.order[..20], full.order[..20]);
        // The same directions; a reflection leaves their signs open.
        let along = tr_product(&q.into_owned(), &p.into_owned());
        assert!((along.abs() - DMatrix::identity(20, 20)).amax() < 1e-9);
    }
}

#[test]
fn bad_input_is_refused_and_small_input_left_alone() {
    assert!(range(&DMatrix::zeros(0, 0)).unwrap().is_none());
    assert!(
        range(&DMatrix::from_element(191, 900, 1.0))
            .unwrap()
            .is_none()
    );
    assert!(range(&DMatrix::zeros(300, 400)).unwrap().is_none());
    let mut a = DMatrix::from_element(300, 400, 1.0);
    a[(7, 9)] = f64::NAN;
    assert!(matches!(
        range(&a),
        Err(LinalgError::NotFinite {
            row: 7,
            column: 9,
            ..
        })
    ));
}
