//! The published reduction with D's small singular values left out.

use super::{decompose, invert};
use crate::num::linalg::{Tolerance, cut};
use crate::recovery::rule::discrepancy::{Discrepancy, truncated};
use crate::recovery::{Choice, Method, Options, Parameter, Problem, Recovered, RecoveryError};

pub(in crate::recovery) fn recover(
    problem: &Problem<'_>,
    options: &Options,
) -> Result<Recovered, RecoveryError> {
    let method = Method::Tsvd;
    let laser = decompose(method, problem)?;
    let (shape, sigma) = (problem.d.shape(), laser.sigma.as_slice());
    let (rank, choice) = match options.rank {
        Some(rank) => (
            cut(sigma, shape.0, shape.1, Tolerance::Rank(rank))?.0,
            Choice::Given,
        ),
        None => {
            let (most, _) = cut(sigma, shape.0, shape.1, Tolerance::Auto)?;
            let rule = Discrepancy::new(method, "rank", problem, &laser, most)?;
            let level = |kept| rule.level(&truncated(kept, most));
            let kept = (1..=most)
                .find(|&kept| level(kept).accepted())
                .ok_or_else(|| rule.understated(level(most)))?;
            (kept, level(kept).choice())
        }
    };
    let mut found = invert(
        method,
        problem,
        &laser,
        &vec![1.0; rank],
        Parameter::Rank(rank),
    );
    found.choice = choice;
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::bench::{Bench, normal_stream};
    use crate::recovery::recover;

    #[test]
    fn the_chosen_rank_leaves_the_noise_and_no_more() {
        let bench = Bench::new(3.0, 8, 16);
        let exact = bench.phi(&bench.board(2));
        for (seed, noise) in [(1, 1e-2), (2, 1e-4), (3, 1e-6)] {
            let mut normal = normal_stream(seed);
            let stderr = &exact * noise;
            let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
            let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
            let found = recover(Method::Tsvd, &problem, &Options::default()).unwrap();
            let Choice::Discrepancy {
                residual,
                target,
                limit,
            } = found.choice
            else {
                panic!("{:?}", found.choice)
            };
            // Within the scatter allowed above; below by the same few standard deviations (1.2 % of the square each).
            assert!(
                residual <= limit && residual > target * 0.97,
                "{noise}: {residual:e} {target:e}"
            );
            // The residual is ‖Φ P − Φ‖ by its definition.
            let laser = crate::num::linalg::svd(&bench.d).unwrap();
            let vt = laser.vt.rows(0, found.rank);
            assert!(((&phi * vt.transpose() * vt - &phi).norm() / residual - 1.0).abs() < 1e-9);
            let options = Options {
                rank: Some(found.rank),
                ..Options::default()
            };
            let given = recover(Method::Tsvd, &problem, &options).unwrap();
            assert_eq!(
                (given.reflectance, given.choice),
                (found.reflectance, Choice::Given)
            );
        }
    }

    #[test]
    fn less_noise_keeps_more_directions() {
        let bench = Bench::new(3.0, 8, 8);
        let exact = bench.phi(&bench.board(2));
        let ranks: Vec<usize> = [1e-1, 1e-3, 1e-5, 1e-7]
            .into_iter()
            .map(|noise| {
                let mut normal = normal_stream(4);
                let stderr = &exact * noise;
                let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
                recover(
                    Method::Tsvd,
                    &Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap(),
                    &Options::default(),
                )
                .unwrap()
                .rank
            })
            .collect();
        assert!(ranks.is_sorted() && ranks[0] < ranks[3], "{ranks:?}");
    }

    #[test]
    fn what_the_rule_cannot_decide_is_said() {
        let bench = Bench::new(3.0, 4, 4);
        let exact = bench.phi(&bench.board(2));
        let try_with = |phi: &nalgebra::DMatrix<f64>,
                        stderr: Option<&nalgebra::DMatrix<f64>>,
                        options: Options| {
            recover(
                Method::Tsvd,
                &Problem::new(phi, &bench.c, &bench.d, stderr).unwrap(),
                &options,
            )
            .unwrap_err()
        };
        let error = try_with(&exact, None, Options::default());
        assert!(
            matches!(error, RecoveryError::NoNoiseModel { .. })
                && error.to_string().contains("phi.stderr.npy"),
            "{error}"
        );
        assert!(matches!(
            try_with(&exact, Some(&(&exact * 0.0)), Options::default()),
            RecoveryError::NoNoiseModel { .. }
        ));
        assert!(matches!(
            try_with(&exact, Some(&(&exact * 10.0)), Options::default()),
            RecoveryError::NoSignal { .. }
        ));
        let mut normal = normal_stream(8);
        let noisy = exact.map(|x| x * (1.0 + 1e-2 * normal()));
        assert!(matches!(
            try_with(&noisy, Some(&(&exact * 1e-3)), Options::default()),
            RecoveryError::NoiseUnderstated { .. }
        ));
        for rank in [0, 17] {
            let options = Options {
                rank: Some(rank),
                ..Options::default()
            };
            assert!(
                try_with(&exact, None, options)
                    .to_string()
                    .contains("choose 1 to 16")
            );
        }
    }
}
