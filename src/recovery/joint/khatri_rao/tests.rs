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
