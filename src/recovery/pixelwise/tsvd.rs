//! The published reduction with D's small singular values left out.

use super::{Inverse, decompose};
use crate::num::linalg::Tolerance;
use crate::recovery::rule::{Data, discrepancy::Discrepancy};
use crate::recovery::{Choice, Method, Options, Parameter, Problem, RecoveryError, Rule, Spectrum};

const METHOD: Method = Method::Tsvd;

pub(super) fn inverse(problem: &Problem<'_>, options: &Options) -> Result<Inverse, RecoveryError> {
    let needed = options.rank.map_or(Tolerance::Auto, Tolerance::Rank);
    let laser = decompose(METHOD, problem, needed)?;
    let (spectrum, rank, choice) = match options.rank {
        Some(rank) => {
            let (rank, _) = laser.cut(Tolerance::Rank(rank))?;
            (Spectrum::of(&laser, rank), rank, Choice::Given)
        }
        None => {
            let spectrum = Spectrum::of(&laser, laser.cut(Tolerance::Auto)?.0);
            let (rank, choice) = choose(problem, options.rule, &spectrum)?;
            (spectrum, rank, choice)
        }
    };
    let why = (Parameter::Rank(rank), choice);
    Ok(Inverse::filtered(options, &spectrum, &vec![1.0; rank], why))
}

/// How many directions the rule keeps, and why.
pub(super) fn choose(
    problem: &Problem<'_>,
    rule: Rule,
    spectrum: &Spectrum,
) -> Result<(usize, Choice), RecoveryError> {
    let undecided = RecoveryError::Undecided {
        method: METHOD,
        rule,
        parameter: "rank",
    };
    match rule {
        Rule::Discrepancy => {
            let rule = Discrepancy::new(METHOD, "rank", problem, spectrum)?;
            let level = |kept| rule.level(&spectrum.truncated(kept));
            let accepted = (1..=spectrum.len()).find(|&kept| level(kept).accepted());
            match accepted {
                Some(kept) => Ok((kept, level(kept).choice())),
                None => Ok((spectrum.len(), rule.weakest(level(spectrum.len()))?)),
            }
        }
        Rule::Gcv => Data::new(problem, spectrum).kept_by_gcv().ok_or(undecided),
        Rule::LCurve => Data::new(problem, spectrum)
            .kept_by_l_curve()
            .ok_or(undecided),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::bench::{Bench, discrepancy, relative_noise};
    use crate::recovery::recover;

    #[test]
    fn the_chosen_rank_leaves_the_noise_and_no_more() {
        let bench = Bench::new(3.0, 8, 16);
        let exact = bench.phi(&bench.board(2));
        for (seed, noise) in [(1, 1e-2), (2, 1e-4), (3, 1e-6)] {
            let (phi, stderr) = relative_noise(&exact, noise, seed);
            let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
            let found = recover(Method::Tsvd, &problem, &Options::default()).unwrap();
            let [residual, target, limit] = discrepancy(&found);
            // Within the scatter allowed above; below by the same few standard deviations (1.2 % of
            // the square each).
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
                let (phi, stderr) = relative_noise(&exact, noise, 4);
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
            RecoveryError::NoNoise { .. }
        ));
        assert!(matches!(
            try_with(&exact, Some(&(&exact * 10.0)), Options::default()),
            RecoveryError::NoSignal { .. }
        ));
        let (noisy, _) = relative_noise(&exact, 1e-2, 8);
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
