//! The published reduction with D's small singular values damped: D^# = V diag(σ/(σ² + λ²)) Uᵀ.

use super::{Inverse, damping, decompose};
use crate::num::linalg::Tolerance;
use crate::recovery::{Method, Options, Parameter, Problem, RecoveryError, Spectrum};

pub(super) fn inverse(problem: &Problem<'_>, options: &Options) -> Result<Inverse, RecoveryError> {
    let method = Method::Tikhonov;
    let laser = decompose(method, problem, Tolerance::Auto)?;
    let (rank, _) = laser.cut(Tolerance::Auto)?;
    let spectrum = Spectrum::of(&laser, rank);
    let (damping, choice) = damping::choose(method, problem, options, &spectrum)?;
    let filter = spectrum.damped(damping * spectrum.sigma[0]);
    let why = (Parameter::Damping(damping), choice);
    Ok(Inverse::filtered(options, &spectrum, &filter, why))
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::recovery::bench::{Bench, discrepancy, relative_noise};
    use crate::recovery::{Choice, recover};

    #[test]
    fn the_chosen_damping_leaves_exactly_the_limit() {
        let bench = Bench::new(3.0, 8, 16);
        let exact = bench.phi(&bench.board(2));
        for (seed, noise) in [(1, 1e-2), (2, 1e-4), (3, 1e-6)] {
            let (phi, stderr) = relative_noise(&exact, noise, seed);
            let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
            let found = recover(Method::Tikhonov, &problem, &Options::default()).unwrap();
            let [residual, target, limit] = discrepancy(&found);
            assert!(
                (residual / limit - 1.0).abs() < 1e-9 && target < limit && limit < 1.03 * target,
                "{residual:e} {limit:e} {target:e}"
            );
            assert!(found.effective_rank < found.rank as f64 && found.effective_rank > 1.0);
        }
    }

    /// Noise so small beside the signal in every direction that even σ_last/1000 damps too much:
    /// what is left of the signal is (λ/σ)⁴ of its square.
    #[test]
    fn the_damping_is_as_small_as_the_noise_asks_for() {
        let bench = Bench::new(6.0, 2, 8);
        let exact = bench.phi(&bench.board(2));
        for (seed, noise) in [(1, 1e-8), (2, 1e-10), (3, 1e-12)] {
            let (phi, stderr) = relative_noise(&exact, noise, seed);
            let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
            let found = recover(Method::Tikhonov, &problem, &Options::default()).unwrap();
            let Choice::Discrepancy {
                residual, limit, ..
            } = found.choice
            else {
                panic!("{:?}", found.choice)
            };
            assert!(
                residual <= limit && residual > 0.98 * limit,
                "{noise:e}: {residual:e} {limit:e}"
            );
        }
    }

    #[test]
    fn it_solves_the_damped_normal_equations() {
        // X (D Dᵀ + λ² 1) = Φ Dᵀ, the definition of Tikhonov's estimate.
        let bench = Bench::new(6.0, 2, 3);
        let (phi, _) = relative_noise(&bench.phi(&bench.board(2)), 0.1, 2);
        let options = Options {
            damping: Some(0.02),
            ..Options::default()
        };
        let found = recover(
            Method::Tikhonov,
            &Problem::new(&phi, &bench.c, &bench.d, None).unwrap(),
            &options,
        )
        .unwrap();
        let lambda = 0.02 * found.sigma[0];
        let system = &bench.d * bench.d.transpose() + DMatrix::identity(4, 4) * (lambda * lambda);
        let x = system
            .lu()
            .solve(&(&bench.d * phi.transpose()))
            .unwrap()
            .transpose();
        for j in 0..4 {
            let mean = (0..9).map(|p| x[(p, j)] / bench.c[(p, j)]).sum::<f64>() / 9.0;
            assert!((found.reflectance[j] - mean).abs() < 1e-9);
        }
        assert_eq!(
            (found.choice, found.parameter),
            (Choice::Given, Parameter::Damping(0.02))
        );
    }

    #[test]
    fn no_damping_is_the_pseudo_inverse() {
        let bench = Bench::new(6.0, 2, 3);
        let phi = bench.phi(&bench.board(2));
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        let none = Options {
            damping: Some(0.0),
            ..Options::default()
        };
        let plain = recover(Method::Pinv, &problem, &none).unwrap();
        assert_eq!(
            recover(Method::Tikhonov, &problem, &none)
                .unwrap()
                .reflectance,
            plain.reflectance
        );
    }

    #[test]
    fn bad_or_missing_parameters_are_refused() {
        let bench = Bench::new(3.0, 2, 2);
        let phi = bench.phi(&bench.board(2));
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        assert!(matches!(
            recover(Method::Tikhonov, &problem, &Options::default()),
            Err(RecoveryError::NoNoiseModel { .. })
        ));
        for damping in [-1.0, f64::NAN, f64::INFINITY] {
            let options = Options {
                damping: Some(damping),
                ..Options::default()
            };
            assert!(matches!(
                recover(Method::Tikhonov, &problem, &options),
                Err(RecoveryError::BadParameter { .. })
            ));
        }
    }
}
