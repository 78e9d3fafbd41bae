//! Least squares over all pixels and spots with reflectances that a surface can have, 0 ≤ ρ ≤ 1.

use nalgebra::DVector;

use super::khatri_rao::Operator;
use super::{Choice, Method, Options, Parameter, Problem, Recovered, RecoveryError, Solver};
use crate::num::linalg::{Tolerance, cut, svd};
use crate::num::quadratic::box_least_squares;

pub(super) fn recover(
    problem: &Problem<'_>,
    options: &Options,
) -> Result<Recovered, RecoveryError> {
    let operator = Operator::new(problem, options.budget)?;
    let reduced = operator.reduced()?;
    let sigma: DVector<f64> = svd(&reduced.r)?.sigma;
    let tolerance = operator.tolerance(Tolerance::Auto);
    let (rank, cutoff) = cut(
        sigma.as_slice(),
        operator.rows(),
        problem.c.ncols(),
        tolerance,
    )?;
    if rank == 0 {
        return Err(RecoveryError::RankZero {
            side: "model C, D as a whole",
        });
    }
    let solved = box_least_squares(&reduced.r, &reduced.d)?;
    let mut found = Recovered::plain(Method::JointBounded, problem, solved.solution, sigma, rank);
    if rank < problem.c.ncols() {
        (found.parameter, found.choice) = (Parameter::Rank(rank), Choice::Tolerance { cutoff });
    }
    found.weighting = operator.weighting;
    found.solver = Some(Solver {
        status: solved.status,
        iterations: solved.iterations,
        refinements: solved.refinements,
        objective: solved.objective,
        gap: solved.gap,
    });
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, modulation, normal_stream};
    use super::*;
    use crate::recovery::recover;

    #[test]
    fn planted_boards_are_recovered_exactly_without_noise() {
        let bench = Bench::new(3.0, 8, 16);
        for checks in [2, 4, 8] {
            let board = bench.board(checks);
            let phi = bench.phi(&board);
            let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
            let found = recover(Method::JointBounded, &problem, &Options::default()).unwrap();
            // Rounding of Φ, one eps of its norm, reaches the weakest direction divided by its singular value.
            let condition = found.sigma[0] / found.sigma[63];
            let error = (&found.reflectance - &board).amax();
            assert!(
                error < 10.0 * f64::EPSILON * condition,
                "{checks}: {error:e} {:?}",
                found.solver
            );
            assert!((modulation(&found.reflectance, &board) - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn a_board_of_two_checks_survives_one_percent_of_noise() {
        let bench = Bench::new(3.0, 8, 16);
        let board = bench.board(2);
        let exact = bench.phi(&board);
        let stderr = &exact * 1e-2;
        for seed in 0..5 {
            let mut normal = normal_stream(seed);
            let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
            for noise in [Some(&stderr), None] {
                let problem = Problem::new(&phi, &bench.c, &bench.d, noise).unwrap();
                let found = recover(Method::JointBounded, &problem, &Options::default()).unwrap();
                let mtf = modulation(&found.reflectance, &board);
                let solver = found.solver.unwrap();
                assert!(mtf >= 0.95, "seed {seed}: {mtf}");
                assert!(
                    solver.gap <= 1e-9 * solver.objective.max(solver.gap),
                    "{solver:?}"
                );
                assert!(found.reflectance.iter().all(|x| (0.0..=1.0).contains(x)));
            }
        }
    }

    #[test]
    fn inactive_bounds_change_nothing() {
        let bench = Bench::new(6.0, 2, 4);
        let grey = bench.board(2).map(|x| 0.3 + 0.4 * x);
        let mut normal = normal_stream(9);
        let phi = bench.phi(&grey).map(|x| x * (1.0 + 1e-4 * normal()));
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        let free = recover(Method::Joint, &problem, &Options::default()).unwrap();
        let bounded = recover(Method::JointBounded, &problem, &Options::default()).unwrap();
        assert!(free.reflectance.iter().all(|x| (0.0..=1.0).contains(x)));
        assert!((free.reflectance - bounded.reflectance).amax() < 1e-10);
    }
}
