//! Least squares over all pixels and spots at once.
//!
//! ρ̂ = argmin Σ w_p v_l (Φ − C diag(ρ) D)², of minimum norm where that is not unique. Unbiased
//! wherever the model has full rank; its covariance under the noise model Σ is (KᵀWK)⁻¹ KᵀWΣWK
//! (KᵀWK)⁻¹, K the Khatri–Rao product, and (KᵀWK)⁻¹ where W = Σ⁻¹. Where directions are dropped as
//! rounding, elements that they may move by more than the noise have no finite standard error.

use crate::num::linalg::{Tolerance, tr_product};
use crate::recovery::joint::operator::khatri_rao::operator;
use crate::recovery::joint::operator::reduced::{finish, over_brightest};
use crate::recovery::{Choice, Method, Options, Parameter, Problem, Recovered, RecoveryError};

pub(in crate::recovery) fn recover(
    problem: &Problem<'_>,
    options: &Options,
) -> Result<Recovered, RecoveryError> {
    let operator = operator(problem, options)?;
    let solved = operator.solve(options.tolerance)?;
    let elements = problem.c.ncols();
    let mut covariance = operator.covariance(problem, &solved);
    let resolution = tr_product(&solved.vt, &solved.vt);
    // A projector's rows have the norm² of its diagonal; what is below its rounding is none.
    let rounding = f64::EPSILON * elements as f64;
    let lost = resolution.diagonal().map(|r| (1.0 - r - rounding).max(0.0));
    let mut found = finish(
        Method::JointUnbounded,
        problem,
        options,
        &operator,
        solved.solution.clone(),
        solved.sigma.clone(),
        solved.rank,
    )?;
    if let Some(gains) = found.nuisance.as_mut().and_then(|n| n.gains.as_mut()) {
        operator.add_errors(problem, gains, covariance.as_ref());
    }
    if let (true, Some(of_x)) = (problem.nuisance.free_scale, covariance.as_mut()) {
        *of_x = over_brightest(of_x, &solved.solution);
    }
    (found.parameter, found.choice) = match options.tolerance {
        Tolerance::Rank(rank) => (Parameter::Rank(rank), Choice::Given),
        _ if solved.rank < elements => (
            Parameter::Rank(solved.rank),
            Choice::Tolerance {
                cutoff: solved.cutoff,
            },
        ),
        _ => (Parameter::None, Choice::None),
    };
    found.standard_error = covariance
        .as_ref()
        .map(|c| c.diagonal().map(|x| x.max(0.0).sqrt()));
    found.covariance = covariance;
    found.resolution = Some(resolution);
    Ok(found.without_errors_of_the_unseen(|| lost))
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::recovery::bench::{Bench, modulation, normal_stream};
    use crate::recovery::{Weighting, recover};

    #[test]
    fn planted_boards_are_recovered_exactly_without_noise() {
        let bench = Bench::new(3.0, 6, 16);
        for checks in [2, 3, 6] {
            let board = bench.board(checks);
            let phi = bench.phi(&board);
            let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
            let found = recover(Method::JointUnbounded, &problem, &Options::default()).unwrap();
            assert_eq!((found.rank, found.choice), (36, Choice::None));
            // Rounding of Φ, one eps of its norm, reaches the weakest direction divided by its
            // singular value.
            let condition = found.sigma[0] / found.sigma[35];
            let error = (&found.reflectance - &board).amax();
            assert!(
                error < 10.0 * f64::EPSILON * condition,
                "{error:e} {condition:e}"
            );
        }
    }

    #[test]
    fn the_bench_at_full_resolution_keeps_its_board() {
        // 8 × 8 elements are numerically deficient by a direction or so; what is lost is its share
        // of the board.
        let bench = Bench::new(3.0, 8, 16);
        let board = bench.board(2);
        let phi = bench.phi(&board);
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        let found = recover(Method::JointUnbounded, &problem, &Options::default()).unwrap();
        assert!(found.rank >= 62, "{}", found.rank);
        assert!(modulation(&found.reflectance, &board) > 0.95);
        assert!(found.relative_residual < 1e-12);
    }

    /// z = L⁻¹(ρ̂ − ρ) with the reported covariance LLᵀ is standard normal: over T trials of r
    /// elements the mean of z² is 1 with standard deviation √(2/(T r)), and each element's mean
    /// error lies within its standard error over √T.
    #[test]
    fn the_estimate_is_unbiased_within_its_covariance() {
        let bench = Bench::new(3.0, 4, 8);
        let board = bench.board(2);
        let exact = bench.phi(&board);
        let stderr = DMatrix::from_fn(64, 120, |p, l| {
            1e-15 * (1.0 + (p % 7) as f64) * (1.0 + (l % 11) as f64)
        });
        let mut normal = normal_stream(3);
        let trials = 300;
        let (mut mean, mut chi2) = (DVector::zeros(16), 0.0);
        let (mut sd, mut spread) = (DVector::zeros(16), DVector::zeros(16));
        for _ in 0..trials {
            let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
            let found = recover(
                Method::JointUnbounded,
                &Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap(),
                &Options::default(),
            )
            .unwrap();
            assert!(matches!(found.weighting, Weighting::Separable { misfit } if misfit < 1e-10));
            let error = &found.reflectance - &board;
            let covariance = found.covariance.unwrap();
            sd = found.standard_error.unwrap();
            mean += &error / f64::from(trials);
            spread += error.component_div(&sd).map(|z| z * z) / f64::from(trials);
            // Scaled to a correlation matrix: the covariance itself is badly scaled for Cholesky.
            let correlation = DMatrix::from_fn(16, 16, |i, j| covariance[(i, j)] / (sd[i] * sd[j]));
            let z = error.component_div(&sd);
            chi2 += z.dot(&correlation.lu().solve(&z).unwrap()) / (16.0 * f64::from(trials));
        }
        // Five standard deviations each; the largest of 16 beyond 5 happens once in 1e5.
        assert!(
            (chi2 - 1.0).abs() < 5.0 * (2.0f64 / (300.0 * 16.0)).sqrt(),
            "{chi2}"
        );
        assert!(
            spread
                .iter()
                .all(|s| (s - 1.0).abs() < 5.0 * (2.0f64 / 300.0).sqrt()),
            "{spread}"
        );
        assert!(mean.component_div(&sd).amax() * 300f64.sqrt() < 5.0);
    }

    #[test]
    fn the_gram_route_keeps_to_what_a_gram_matrix_knows() {
        let bench = Bench::new(3.0, 8, 8);
        let board = bench.board(2);
        let phi = bench.phi(&board);
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        let gram = Options {
            budget: 0,
            ..Options::default()
        };
        let found = recover(Method::JointUnbounded, &problem, &gram).unwrap();
        // Kept directions lie above √(64 eps) = 1.2e-7 of σ₁, where rounding of Gram matrix and
        // moment stays small.
        assert!(found.sigma[found.rank - 1] > 1.1e-7 * found.sigma[0] && found.rank < 63);
        assert!(
            found.reflectance.amax() < 3.0 && found.relative_residual < 1e-6,
            "{:e}",
            found.relative_residual
        );
    }

    #[test]
    fn a_deficient_model_has_its_minimum_norm_answer() {
        // Two identical elements: only ρ₁ + ρ₂ is seen, so each gets half.
        let c = DMatrix::from_fn(3, 2, |p, _| 1.0 + p as f64);
        let d = DMatrix::from_fn(2, 4, |_, l| 2.0 + l as f64);
        let phi = &c * &d;
        let found = recover(
            Method::JointUnbounded,
            &Problem::new(&phi, &c, &d, None).unwrap(),
            &Options::default(),
        )
        .unwrap();
        assert_eq!(found.rank, 1);
        assert!(matches!(
            (found.parameter, found.choice),
            (Parameter::Rank(1), Choice::Tolerance { .. })
        ));
        assert!((found.reflectance - DVector::from_element(2, 1.0)).amax() < 1e-13);
        let gram = Options {
            budget: 0,
            ..Options::default()
        };
        let found = recover(
            Method::JointUnbounded,
            &Problem::new(&phi, &c, &d, None).unwrap(),
            &gram,
        )
        .unwrap();
        assert!(
            found.rank == 1 && (found.reflectance - DVector::from_element(2, 1.0)).amax() < 1e-7
        );
    }

    /// Of two elements of equal columns only the sum is known, each may be off by ½ and more: no
    /// finite error. The third, seen apart, keeps that of the noise, and noise that is larger than
    /// what is lost is the error of all three.
    #[test]
    fn what_is_not_determined_has_no_finite_error() {
        let c = DMatrix::from_fn(5, 3, |p, j| if j < 2 { 1.0 } else { p as f64 });
        let d = DMatrix::from_fn(3, 4, |j, l| {
            1.0 + if j < 2 {
                l as f64
            } else {
                0.1 * (l * l) as f64
            }
        });
        let phi = &c * DMatrix::from_diagonal(&DVector::from_column_slice(&[0.2, 0.6, 0.5])) * &d;
        for (noise, unknown) in [(1e-3, true), (1e2, false)] {
            let stderr = DMatrix::from_element(5, 4, noise);
            let problem = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap();
            let found = recover(Method::JointUnbounded, &problem, &Options::default()).unwrap();
            assert_eq!(found.rank, 2);
            let errors = found.standard_error.unwrap();
            for j in 0..3 {
                assert_eq!(errors[j].is_infinite(), unknown && j < 2, "{errors}");
            }
            // By hand: (FᵀF)⁻¹ of the two columns that differ, the sum of the equal ones one.
            let column = |j: usize| DVector::from_fn(20, |i, _| c[(i % 5, j)] * d[(j, i / 5)]);
            let f = DMatrix::from_columns(&[column(0), column(2)]);
            let variance = (f.tr_mul(&f)).try_inverse().unwrap()[(1, 1)];
            assert!((errors[2] / (noise * variance.sqrt()) - 1.0).abs() < 1e-9);
        }
    }
}
