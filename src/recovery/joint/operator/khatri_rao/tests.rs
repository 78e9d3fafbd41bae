use super::*;
use crate::recovery::bench::{Bench, normal_stream};

fn with(budget: usize) -> Options {
    Options {
        budget,
        ..Options::default()
    }
}

/// The objective of the compressed problem and of the full sum differ by a constant: compare
/// differences from ρ = 0.
#[test]
fn the_compressed_objective_is_the_full_one() {
    let bench = Bench::new(3.0, 3, 3);
    let mut normal = normal_stream(5);
    let phi = bench
        .phi(&bench.board(3))
        .map(|x| x * (1.0 + 0.3 * normal()));
    let stderr = DMatrix::from_fn(9, 120, |p, l| {
        1e-13 * (1.0 + p as f64) * (1.0 + (l % 5) as f64)
    });
    let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
    let full = |rho: &DVector<f64>| {
        (phi.clone() - bench.phi(rho))
            .component_div(&stderr)
            .norm_squared()
    };
    for budget in [usize::MAX, 0] {
        let operator = Operator::new(&problem, &with(budget)).unwrap();
        let directions = operator.directions().unwrap();
        let (found, data) = &*directions;
        let along = DMatrix::from_diagonal(&found.sigma) * &found.vt;
        let small = |rho: &DVector<f64>| (&along * rho - data).norm_squared();
        let zero = DVector::zeros(9);
        for _ in 0..4 {
            let rho = DVector::from_fn(9, |_, _| normal());
            let (full, small) = (full(&rho) - full(&zero), small(&rho) - small(&zero));
            assert!((full / small - 1.0).abs() < 1e-9, "{full} {small}");
        }
    }
}

/// A budget one entry short leaves pairs of weak directions out: many, and without a trace in the
/// operator.
#[test]
fn pairs_lost_in_rounding_are_not_missed() {
    let bench = Bench::new(3.0, 8, 16);
    let phi = bench.phi(&bench.board(2));
    let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
    let form = |budget| match Operator::new(&problem, &with(budget)).unwrap().form {
        Form::Small { a, b, rows } => (a, b, rows),
        _ => panic!("not the product"),
    };
    let (whole, data, rows) = form(usize::MAX);
    let (a, b, same) = form(whole.len() - 1);
    assert_eq!((whole.nrows(), same), (rows, rows));
    assert!(4 * a.nrows() < 3 * rows, "{} of {rows}", a.nrows());
    let gram = |m: &DMatrix<f64>| tr_product(m, m);
    let off = (gram(&whole) - gram(&a)).norm() / gram(&whole).norm();
    assert!(off < 4.0 * f64::EPSILON, "{off:e}");
    // Φ of the model's own has nothing where the model has nothing.
    assert!((data.norm_squared() / b.norm_squared() - 1.0).abs() < 4.0 * f64::EPSILON);
}

#[test]
fn both_routes_solve_a_well_conditioned_problem_alike() {
    let bench = Bench::new(6.0, 2, 4);
    let mut normal = normal_stream(6);
    let phi = bench
        .phi(&bench.board(2))
        .map(|x| x * (1.0 + 0.1 * normal()));
    let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
    let small = Operator::new(&problem, &with(usize::MAX))
        .unwrap()
        .solve(Tolerance::Auto)
        .unwrap();
    let normal = Operator::new(&problem, &with(0))
        .unwrap()
        .solve(Tolerance::Auto)
        .unwrap();
    assert_eq!((small.route, normal.route), (Route::Qr, Route::Normal));
    let condition = small.sigma[0] / small.sigma[3];
    assert!(
        (&small.solution - &normal.solution).norm() < 100.0 * f64::EPSILON * condition * condition
    );
}

/// One photograph of 1100 pixels: the objective, the covariance and the rank are those of its rows
/// by hand, however the noise is known and with a constant of the frame, and C is not compressed.
#[test]
fn one_tall_photograph_is_its_rows() {
    let mut normal = normal_stream(8);
    let c = DMatrix::from_fn(1100, 6, |_, _| 1.0 + 0.3 * normal());
    // The last element is seen as the first two together.
    let c = DMatrix::from_fn(1100, 7, |p, j| {
        if j < 6 {
            c[(p, j)]
        } else {
            c[(p, 0)] + c[(p, 1)]
        }
    });
    let d = DMatrix::from_fn(7, 1, |j, _| 0.5 + 0.1 * j as f64);
    let truth = DVector::from_fn(7, |j, _| 0.1 * (j + 1) as f64);
    let lit = DMatrix::from_fn(7, 1, |j, _| d[j] * truth[j]);
    let phi = &c * lit + DMatrix::from_fn(1100, 1, |_, _| 0.7 + 0.01 * normal());
    let stderr = DMatrix::from_fn(1100, 1, |p, _| 0.01 * (1.0 + (p % 3) as f64));
    for (noise, frame_constant) in [(None, false), (Some(&stderr), false), (Some(&stderr), true)] {
        let nuisance = crate::recovery::Nuisance {
            frame_constant,
            ..Default::default()
        };
        let problem = Problem::new(&phi, &c, &d, noise).unwrap();
        let problem = problem.with_nuisance(nuisance).unwrap();
        let operator = Operator::new(&problem, &Options::default()).unwrap();
        assert!(matches!(operator.form, Form::Stacked { .. }) && operator.rows() == 1100);
        // The weighted rows, the constant's part taken out as a regression does it.
        let root = |p: usize| noise.map_or(1.0, |s| 1.0 / s[p]);
        let total: f64 = (0..1100).map(|p| root(p) * root(p)).sum();
        let rows = DMatrix::from_fn(1100, 8, |p, k| match k {
            7 => phi[p],
            j => c[(p, j)] * d[j],
        });
        let rows = DMatrix::from_fn(1100, 8, |p, k| {
            let mean = |k| {
                (0..1100)
                    .map(|q| root(q) * root(q) * rows[(q, k)])
                    .sum::<f64>()
                    / total
            };
            let mean = if frame_constant { mean(k) } else { 0.0 };
            root(p) * (rows[(p, k)] - mean)
        });
        let (k, data) = (rows.columns(0, 7).into_owned(), rows.column(7).into_owned());
        let directions = operator.directions().unwrap();
        let (found, along) = &*directions;
        let small = |x: &DVector<f64>| {
            (DMatrix::from_diagonal(&found.sigma) * &found.vt * x - along).norm_squared()
        };
        let whole = |x: &DVector<f64>| (&k * x - &data).norm_squared();
        let zero = DVector::zeros(7);
        for _ in 0..3 {
            let x = DVector::from_fn(7, |_, _| normal());
            let (small, whole) = (small(&x) - small(&zero), whole(&x) - whole(&zero));
            assert!((small / whole - 1.0).abs() < 1e-9, "{small} {whole}");
        }
        let solved = operator.solve(Tolerance::Auto).unwrap();
        assert_eq!(solved.rank, 6, "{:?}", solved.sigma);
        let covariance = operator.covariance(&problem, &solved);
        assert_eq!(covariance.is_some(), noise.is_some());
        if let Some(covariance) = covariance {
            // (KᵀK)⁺ by the conditions of Penrose: G P G = G, P G P = P, G P symmetric.
            let (p, gram) = (&covariance, k.transpose() * &k);
            let shadow = &gram * p;
            assert!((&shadow * &gram - &gram).amax() < 1e-6 * gram.amax());
            assert!((p * &shadow - p).amax() < 1e-6 * p.amax());
            assert!((&shadow - shadow.transpose()).amax() < 1e-6 * shadow.amax());
        }
    }
    // Errors that are no weights need the left singular vectors.
    let unweighted = Options {
        weighting: WeightRule::Unweighted,
        ..Options::default()
    };
    let problem = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap();
    let operator = Operator::new(&problem, &unweighted).unwrap();
    let solved = operator.solve(Tolerance::Auto).unwrap();
    assert!(operator.covariance(&problem, &solved).is_some());
}

/// Errors that are no product of one by pixel and one by spot, and less than the rounding of the
/// normal equations that are kept: the solution of all rows, each over its own error, written out.
#[test]
fn errors_of_any_form_are_weighed_as_they_are() {
    let mut normal = normal_stream(9);
    let c = DMatrix::from_fn(40, 9, |_, _| normal().abs());
    let d = DMatrix::from_fn(9, 15, |_, _| normal().abs());
    let x = DVector::from_fn(9, |j, _| 0.1 * (j + 1) as f64);
    let exact = &c * DMatrix::from_diagonal(&x) * &d;
    let of_few = |at: usize| if at % 31 == 7 { 3e-7 } else { 1e-5 };
    let few = DMatrix::from_fn(40, 15, |p, l| of_few(p * 15 + l));
    let spread = exact.map(|_| 1e-5 * libm::exp(1.5 * normal()));
    for stderr in [few, spread] {
        let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
        let rows = DMatrix::from_fn(600, 9, |row, j| {
            let (p, l) = (row % 40, row / 40);
            c[(p, j)] * d[(j, l)] / stderr[(p, l)]
        });
        let data = DVector::from_fn(600, |row, _| phi[row] / stderr[row]);
        let errors = (rows.transpose() * &rows).try_inverse().unwrap();
        let best = &errors * rows.tr_mul(&data);
        let problem = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap();
        for weighting in [WeightRule::Noise, WeightRule::Entries] {
            let options = Options {
                weighting,
                ..Options::default()
            };
            let operator = Operator::new(&problem, &options).unwrap();
            assert_eq!(operator.weighting, Weighting::EntryByEntry);
            let found = operator.solve(Tolerance::Auto).unwrap();
            for j in 0..9 {
                let off = (found.solution[j] - best[j]) / errors[(j, j)].sqrt();
                assert!(off.abs() < 1e-3, "{weighting:?} {j}: {off}");
            }
        }
    }
}
