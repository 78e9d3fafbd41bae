use super::*;
use crate::recovery::bench::{Bench, normal_stream};
use crate::recovery::{Method, Options, Problem, cramer_rao, recover};

const JOINT: [Method; 5] = [
    Method::JointUnbounded,
    Method::Joint,
    Method::Nnls,
    Method::JointTv,
    Method::JointTwoValued,
];

fn terms(pattern: &DMatrix<f64>) -> Vec<Nuisance<'_>> {
    (0..8)
        .map(|set| Nuisance {
            frame_constant: set & 1 > 0,
            background: set & 2 > 0,
            glare: (set & 4 > 0).then_some(pattern),
            ..Nuisance::default()
        })
        .collect()
}

/// The same with neither, either and both of these.
fn with_and_without<'a>(
    nuisance: Nuisance<'a>,
    patterns: &'a DMatrix<f64>,
    left_out: &'a DMatrix<f64>,
) -> [Nuisance<'a>; 4] {
    [(false, false), (true, false), (false, true), (true, true)].map(|(with, without)| Nuisance {
        frame_patterns: with.then_some(patterns),
        left_out: without.then_some(left_out),
        ..nuisance
    })
}

/// All columns of the problem, nuisances last, every row over its σ; and the data.
fn whole(
    c: &DMatrix<f64>,
    d: &DMatrix<f64>,
    phi: &DMatrix<f64>,
    stderr: &DMatrix<f64>,
    terms: &Nuisance<'_>,
) -> (DMatrix<f64>, DVector<f64>) {
    let (pixels, spots) = phi.shape();
    let at = |row: usize| (row % pixels, row / pixels);
    let rows = pixels * spots;
    let mut columns: Vec<DVector<f64>> = (0..c.ncols())
        .map(|j| DVector::from_fn(rows, |row, _| c[(at(row).0, j)] * d[(j, at(row).1)]))
        .collect();
    let hot = |yes: bool| f64::from(u8::from(yes));
    for l in 0..spots {
        if terms.frame_constant {
            columns.push(DVector::from_fn(rows, |row, _| hot(at(row).1 == l)));
        }
        for pattern in terms.frame_patterns.iter().flat_map(|m| m.column_iter()) {
            columns.push(DVector::from_fn(rows, |row, _| {
                hot(at(row).1 == l) * pattern[at(row).0]
            }));
        }
        if let Some(pattern) = terms.glare {
            columns.push(DVector::from_fn(rows, |row, _| {
                hot(at(row).1 == l) * pattern[at(row)]
            }));
        }
    }
    for p in 0..pixels {
        if terms.background {
            columns.push(DVector::from_fn(rows, |row, _| hot(at(row).0 == p)));
        }
    }
    let mut all = DMatrix::from_columns(&columns);
    let mut data = DVector::from_fn(rows, |row, _| phi[at(row)]);
    for row in 0..rows {
        let mut line = all.row_mut(row);
        let flag = terms.left_out.map_or(0.0, |flags| flags[at(row)]);
        let root = hot(flag == 0.0) / stderr[at(row)];
        line *= root;
        data[row] *= root;
    }
    (all, data)
}

/// Every combination of terms against one dense least squares with all columns: ρ, the light of the
/// terms, the covariance, the bound.
#[test]
fn elimination_is_the_dense_least_squares_with_all_columns() {
    let mut normal = normal_stream(17);
    let mut random = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| 1.0 + 0.5 * normal());
    let (c, d, phi) = (random(9, 3), random(3, 6), random(9, 6));
    let (pattern, of_frames) = (random(9, 6), random(9, 2));
    let flags = DMatrix::from_fn(
        9,
        6,
        |p, l| if (p * 4 + l * 3) % 11 == 0 { 2.0 } else { 0.0 },
    );
    let separable = DMatrix::from_fn(9, 6, |p, l| (1.0 + p as f64) * (2.0 + l as f64) / 20.0);
    let other =
        separable.map_with_location(|p, l, s| s * (1.0 + 0.3 * ((p * 5 + l * 3) % 4) as f64));
    let more = |nuisance| with_and_without(nuisance, &of_frames, &flags);
    for nuisance in terms(&pattern).into_iter().flat_map(more) {
        // What does not count may be anything.
        let phi = match nuisance.left_out {
            Some(flags) => phi.zip_map(flags, |x, flag| x + 1e3 * flag),
            None => phi.clone(),
        };
        // With glare and holes each row has its own weight, without the weights are separable.
        let stderr = if nuisance.glare.is_some() || nuisance.left_out.is_some() {
            &other
        } else {
            &separable
        };
        let (all, data) = whole(&c, &d, &phi, stderr, &nuisance);
        let dense = least_squares(&all, &data, Tolerance::Relative(1e-11)).unwrap();
        let problem = Problem::new(&phi, &c, &d, Some(stderr))
            .unwrap()
            .with_nuisance(nuisance)
            .unwrap();
        let found = recover(Method::JointUnbounded, &problem, &Options::default()).unwrap();
        let error = (&found.reflectance - dense.solution.rows(0, 3)).amax();
        assert!(error < 1e-10, "{nuisance:?}: {error:e}");
        let covariance = dense.covariance().view((0, 0), (3, 3)).into_owned();
        let off = (found.covariance.unwrap() - &covariance).amax();
        assert!(off < 1e-9 * covariance.amax(), "{nuisance:?}: {off:e}");
        let bound = cramer_rao(&problem).unwrap();
        assert!((bound.covariance - &covariance).amax() < 1e-9 * covariance.amax());
        // Light beside the model: the sizes themselves are not unique where terms overlap, their
        // sum is.
        let taken = found.nuisance.as_ref().map_or(0, |n| n.freedom);
        assert_eq!(taken + 3, dense.rank, "{nuisance:?}");
        let light = found
            .nuisance
            .map_or(DMatrix::zeros(9, 6), |n| n.light(&nuisance, 9, 6));
        let mut weighted = DVector::from_column_slice(light.as_slice());
        weighted.component_div_assign(&DVector::from_column_slice(stderr.as_slice()));
        let holes = nuisance.left_out.map_or(&[][..], |m| m.as_slice());
        for (x, _) in weighted
            .iter_mut()
            .zip(holes)
            .filter(|(_, flag)| **flag != 0.0)
        {
            *x = 0.0;
        }
        let rest = all.columns(3, all.ncols() - 3) * dense.solution.rows(3, all.ncols() - 3);
        assert!((weighted - rest).amax() < 1e-9, "{nuisance:?}");
    }
}

/// With weights that are nearly those of the noise the covariance is A⁺ΣA⁺ᵀ, A⁺ the dense
/// pseudo-inverse, Σ the variances over the weights.
#[test]
fn the_covariance_is_exact_for_noise_that_is_not_separable() {
    let mut normal = normal_stream(3);
    let mut random = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| 1.0 + 0.5 * normal());
    let (c, d, phi) = (random(7, 3), random(3, 5), random(7, 5));
    let stderr = DMatrix::from_fn(7, 5, |p, l| 0.5 + 0.1 * ((p * 5 + l * 3) % 4) as f64);
    let fitted = super::super::weights::fit(Some(&stderr), 7, 5);
    let as_weighted = DMatrix::from_fn(7, 5, |p, l| 1.0 / (fitted.pixels[p] * fitted.spots[l]));
    for nuisance in terms(&phi).into_iter().take(4) {
        let (all, _) = whole(&c, &d, &phi, &as_weighted, &nuisance);
        let inverse = crate::num::linalg::pinv(&all, Tolerance::Relative(1e-11))
            .unwrap()
            .matrix;
        let variance = stderr.component_div(&as_weighted).map(|x| x * x);
        let sigma = DMatrix::from_diagonal(&DVector::from_column_slice(variance.as_slice()));
        let exact = (&inverse * sigma * inverse.transpose())
            .view((0, 0), (3, 3))
            .into_owned();
        let problem = Problem::new(&phi, &c, &d, Some(&stderr))
            .unwrap()
            .with_nuisance(nuisance)
            .unwrap();
        let found = recover(Method::JointUnbounded, &problem, &Options::default()).unwrap();
        let off = (found.covariance.unwrap() - &exact).amax();
        assert!(off < 1e-10 * exact.amax(), "{nuisance:?}: {off:e}");
        // No unbiased estimate is better than the bound; this one is not efficient.
        let bound = cramer_rao(&problem).unwrap().standard_error;
        assert!((0..3).all(|j| bound[j] < exact[(j, j)].sqrt()), "{bound}");
    }
}

/// Terms a million times the signal change each method's answer by no more than the rounding of
/// such photographs, eps · 1e6 · σ₁/σ_n.
#[test]
fn huge_terms_change_nothing() {
    let bench = Bench::new(6.0, 2, 6);
    let board = bench.board(2);
    let signal = bench.phi(&board);
    let huge = 1e6 * signal.amax();
    let pattern = DMatrix::from_fn(36, 120, |p, l| {
        1.0 / (1.0 + ((p % 6) as f64 - (l % 7) as f64).powi(2) + (p / 6) as f64)
    });
    let grids = [[2, 2]];
    let stderr = DMatrix::from_fn(36, 120, |p, l| {
        1e-13 * (1.0 + (p % 3) as f64) * (1.0 + (l % 2) as f64)
    });
    for nuisance in terms(&pattern) {
        let planted = Estimated {
            frame_constant: nuisance
                .frame_constant
                .then(|| DVector::from_fn(120, |l, _| huge * (l % 5) as f64)),
            background: nuisance
                .background
                .then(|| DVector::from_fn(36, |p, _| huge * (p % 4) as f64)),
            glare: nuisance
                .glare
                .map(|_| DVector::from_fn(120, |l, _| huge * (1.0 - (l % 3) as f64))),
            ..Estimated::default()
        };
        let phi = &signal + planted.light(&nuisance, 36, 120);
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr))
            .unwrap()
            .with_grids(&grids)
            .unwrap()
            .with_nuisance(nuisance)
            .unwrap();
        for method in JOINT {
            let options = Options {
                total_variation: Some(0.0),
                ..Options::default()
            };
            let found = recover(method, &problem, &options).unwrap();
            let condition = found.sigma[0] / found.sigma[3];
            let allowed =
                100.0 * f64::EPSILON * condition * if nuisance.is_some() { 1e6 } else { 1.0 };
            let error = (&found.reflectance - &board).amax();
            assert!(
                error < allowed.max(1e-12),
                "{method} {nuisance:?}: {error:e} {allowed:e}"
            );
        }
    }
}

#[test]
fn a_free_scale_makes_the_brightest_element_the_unit() {
    let bench = Bench::new(6.0, 2, 6);
    let grey = DVector::from_row_slice(&[0.1, 1.0, 0.4, 0.7]);
    let grids = [[2, 2]];
    let scale = |phi: &DMatrix<f64>, method| {
        let nuisance = Nuisance {
            free_scale: true,
            frame_constant: true,
            ..Nuisance::default()
        };
        let stderr = phi.map(|x| x.abs() * 1e-9);
        let problem = Problem::new(phi, &bench.c, &bench.d, Some(&stderr))
            .unwrap()
            .with_grids(&grids)
            .unwrap()
            .with_nuisance(nuisance)
            .unwrap();
        let options = Options {
            total_variation: Some(0.0),
            ..Options::default()
        };
        recover(method, &problem, &options)
    };
    let phi = (bench.phi(&grey) * 3.7).map(|x| x + 1e-12);
    for method in &JOINT[..4] {
        let found = scale(&phi, *method).unwrap();
        assert!(
            (&found.reflectance - &grey).amax() < 1e-8,
            "{method}: {}",
            found.reflectance
        );
        let nuisance = found.nuisance.unwrap();
        assert!((nuisance.scale.unwrap() / 3.7 - 1.0).abs() < 1e-8);
        assert!(
            nuisance
                .frame_constant
                .unwrap()
                .iter()
                .all(|b| (b / 1e-12 - 1.0).abs() < 1e-6)
        );
    }
    let two = (bench.phi(&bench.board(2)) * 3.7).map(|x| x + 1e-12);
    let found = scale(&two, Method::JointTwoValued).unwrap();
    assert!((found.reflectance - bench.board(2)).amax() < 1e-8);
    // Nothing bright: only an even light.
    let error = scale(&(bench.phi(&grey) * -1.0), Method::JointUnbounded).unwrap_err();
    assert!(matches!(error, RecoveryError::NoScale { .. }), "{error}");
}

#[test]
fn other_methods_refuse() {
    let bench = Bench::new(6.0, 2, 2);
    let phi = bench.phi(&bench.board(2));
    let nuisance = Nuisance {
        background: true,
        ..Nuisance::default()
    };
    let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
    let problem = problem.with_nuisance(nuisance).unwrap();
    let error = recover(Method::Pinv, &problem, &Options::default()).unwrap_err();
    assert!(matches!(error, RecoveryError::NotForMethod { .. }));
    let pattern = DMatrix::zeros(3, 120);
    let nuisance = Nuisance {
        glare: Some(&pattern),
        ..Nuisance::default()
    };
    assert!(matches!(
        problem.with_nuisance(nuisance),
        Err(RecoveryError::Shape { .. })
    ));
}
