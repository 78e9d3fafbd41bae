//! The published method: Φ D⁺ ÷ C, mean over pixels.

use super::{Inverse, decompose};
use crate::num::linalg::Tolerance;
use crate::recovery::{Choice, Method, Options, Parameter, Problem, RecoveryError, Spectrum};

pub(super) fn inverse(problem: &Problem<'_>, options: &Options) -> Result<Inverse, RecoveryError> {
    let laser = decompose(Method::Pinv, problem, options.tolerance)?;
    let (rank, cutoff) = laser.cut(options.tolerance)?;
    let choice = match options.tolerance {
        Tolerance::Rank(_) => Choice::Given,
        _ => Choice::Tolerance { cutoff },
    };
    let spectrum = Spectrum::of(&laser, rank);
    let why = (Parameter::Rank(rank), choice);
    Ok(Inverse::filtered(options, &spectrum, &vec![1.0; rank], why))
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use crate::num::linalg::{Tolerance, pinv};
    use crate::recovery::bench::{Bench, normal_stream};
    use crate::recovery::{Method, Options, Problem, RecoveryError, recover};

    #[test]
    fn a_planted_board_is_recovered_exactly_without_noise() {
        // 3 × 3 elements on the bench: D is well enough conditioned that eps·cond stays below 1e-9.
        let bench = Bench::new(6.0, 3, 8);
        let board = bench.board(3);
        let phi = bench.phi(&board);
        let found = recover(
            Method::Pinv,
            &Problem::new(&phi, &bench.c, &bench.d, None).unwrap(),
            &Options::default(),
        )
        .unwrap();
        let condition = found.sigma[0] / found.sigma[8];
        assert_eq!(found.rank, 9);
        assert!(
            (&found.reflectance - &board).amax() < 100.0 * f64::EPSILON * condition,
            "{condition:e}"
        );
        assert!(found.relative_residual < 1e-12 && found.standard_error.is_none());
    }

    #[test]
    fn it_is_the_published_formula() {
        let bench = Bench::new(3.0, 4, 3);
        let mut normal = normal_stream(7);
        let phi = bench
            .phi(&bench.board(2))
            .map(|x| x * (1.0 + 0.1 * normal()));
        let options = Options {
            tolerance: Tolerance::Relative(1e-4),
            ..Options::default()
        };
        let found = recover(
            Method::Pinv,
            &Problem::new(&phi, &bench.c, &bench.d, None).unwrap(),
            &options,
        )
        .unwrap();
        let x = &phi * pinv(&bench.d, Tolerance::Relative(1e-4)).unwrap().matrix;
        for j in 0..16 {
            let mean = (0..9).map(|p| x[(p, j)] / bench.c[(p, j)]).sum::<f64>() / 9.0;
            assert!((found.reflectance[j] - mean).abs() < 1e-10 * (1.0 + mean.abs()));
        }
    }

    #[test]
    fn its_standard_error_is_the_spread_over_noise() {
        let bench = Bench::new(6.0, 2, 3);
        let board = bench.board(2);
        let exact = bench.phi(&board);
        let stderr = &exact * 1e-3;
        let mut normal = normal_stream(11);
        let trials = 2000;
        let mut z = DVector::zeros(4);
        for _ in 0..trials {
            let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
            let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
            let found = recover(Method::Pinv, &problem, &Options::default()).unwrap();
            z += (found.reflectance - &board)
                .component_div(&found.standard_error.unwrap())
                .map(|z| z * z)
                / f64::from(trials);
        }
        // The mean of z² has standard deviation √(2/2000) = 0.032: five of them.
        assert!(z.iter().all(|z| (z - 1.0).abs() < 0.16), "{z}");
    }

    #[test]
    fn what_cannot_be_divided_or_inverted_is_refused() {
        let bench = Bench::new(3.0, 2, 2);
        let phi = bench.phi(&bench.board(2));
        let mut c = bench.c.clone();
        c[(3, 1)] = 0.0;
        let error = recover(
            Method::Pinv,
            &Problem::new(&phi, &c, &bench.d, None).unwrap(),
            &Options::default(),
        )
        .unwrap_err();
        assert!(matches!(
            error,
            RecoveryError::Unseen {
                pixel: 3,
                element: 1,
                ..
            }
        ));
        let dark = DMatrix::zeros(4, 120);
        for method in Method::ALL {
            let options = Options {
                rank: Some(1),
                damping: Some(0.1),
                ..Options::default()
            };
            let error = recover(
                method,
                &Problem::new(&phi, &bench.c, &dark, None).unwrap(),
                &options,
            )
            .unwrap_err();
            assert!(
                matches!(error, RecoveryError::RankZero { .. }),
                "{method}: {error}"
            );
        }
    }
}
