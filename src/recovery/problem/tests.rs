//! What is refused of a problem, and what is taken.

use super::*;

fn matrices() -> [DMatrix<f64>; 4] {
    [(2, 3), (2, 4), (4, 3), (2, 3)]
        .map(|(rows, columns)| DMatrix::from_element(rows, columns, 1.0))
}

#[test]
fn good_matrices_pass() {
    let [phi, c, d, stderr] = matrices();
    assert!(Problem::new(&phi, &c, &d, Some(&stderr)).is_ok());
}

#[test]
fn each_bad_entry_is_refused_by_place() {
    for which in 0..4 {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut all = matrices();
            all[which][(1, 2)] = value;
            let [phi, c, d, stderr] = &all;
            let error = Problem::new(phi, c, d, Some(stderr)).unwrap_err();
            assert!(
                matches!(
                    error,
                    RecoveryError::NotFinite {
                        row: 1,
                        column: 2,
                        ..
                    }
                ),
                "{error}"
            );
        }
    }
    let [phi, c, d, mut stderr] = matrices();
    stderr[(1, 0)] = -1e-20;
    let error = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap_err();
    assert!(matches!(
        error,
        RecoveryError::NegativeStandardError {
            pixel: 1,
            spot: 0,
            ..
        }
    ));
}

/// Squares of such numbers overflow or vanish: residuals became NaN, and limits zero.
#[test]
fn numbers_whose_squares_leave_f64_are_refused() {
    for which in 0..4 {
        for factor in [1e300, 1e160, 1e-160, 1e-310] {
            let mut all = matrices();
            all[which] *= factor;
            let [phi, c, d, stderr] = &all;
            let error = Problem::new(phi, c, d, Some(stderr)).unwrap_err();
            assert!(matches!(error, RecoveryError::OutOfScale { .. }), "{error}");
        }
    }
    let [phi, c, d, mut stderr] = matrices();
    stderr[(1, 2)] = 1e-300;
    let error = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap_err();
    assert!(matches!(
        error,
        RecoveryError::OutOfScale { name: "stderr", .. }
    ));
    let pattern = &phi * 1e200;
    let nuisance = Nuisance {
        glare: Some(&pattern),
        ..Nuisance::default()
    };
    let problem = Problem::new(&phi, &c, &d, None).unwrap();
    assert!(problem.with_nuisance(nuisance).is_err());
    assert!(Problem::new(&(phi * 0.0), &c, &d, Some(&(stderr * 0.0))).is_ok());
}

#[test]
fn grids_must_make_up_the_elements() {
    let [phi, c, d, stderr] = matrices();
    let problem = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap();
    assert!(problem.with_grids(&[[2, 2]]).is_ok());
    assert!(problem.with_grids(&[[3, 1], [1, 1]]).is_ok());
    let wrong: [&[[usize; 2]]; 5] = [
        &[],
        &[[2, 1]],
        &[[2, 3]],
        &[[2, 2], [0, 5]],
        &[[usize::MAX, 2]],
    ];
    for grids in wrong {
        let error = problem.with_grids(grids).unwrap_err();
        assert!(
            matches!(error, RecoveryError::Grids { elements: 4, .. }),
            "{error}"
        );
    }
}

#[test]
fn shapes_must_fit() {
    let [phi, c, d, stderr] = matrices();
    for (phi, c, d, stderr) in [
        (&phi.transpose(), &c, &d, &stderr),
        (&phi, &d, &c, &stderr),
        (&phi, &c, &d.transpose(), &stderr),
        (&phi, &c, &d, &stderr.transpose()),
        (
            &DMatrix::zeros(0, 0),
            &DMatrix::zeros(0, 0),
            &DMatrix::zeros(0, 0),
            &stderr,
        ),
    ] {
        assert!(matches!(
            Problem::new(phi, c, d, Some(stderr)),
            Err(RecoveryError::Shape { .. })
        ));
    }
}
