//! The operators of one problem, each found and decomposed once for all that ask.

use std::sync::{Arc, Mutex, PoisonError};

use super::khatri_rao::Operator;
use crate::recovery::{Options, Problem, RecoveryError, WeightRule};

/// Operators of a [`Problem`] by weighting and budget. Several methods, the Picard plot and the share
/// that is determined all need one and the same.
#[derive(Debug, Default)]
pub struct Shared(Mutex<Vec<(WeightRule, usize, Arc<Operator>)>>);

/// The operator of the problem, that of an earlier call where the problem shares them.
pub(super) fn operator(
    problem: &Problem<'_>,
    options: &Options,
) -> Result<Arc<Operator>, RecoveryError> {
    let Some(Shared(known)) = problem.shared else {
        return Ok(Arc::new(Operator::new(problem, options)?));
    };
    let lock = || known.lock().unwrap_or_else(PoisonError::into_inner);
    let same = |(rule, budget, _): &&(WeightRule, usize, Arc<Operator>)| {
        (*rule, *budget) == (options.weighting, options.budget)
    };
    if let Some((.., operator)) = lock().iter().find(same) {
        return Ok(Arc::clone(operator));
    }
    let operator = Arc::new(Operator::new(problem, options)?);
    lock().push((options.weighting, options.budget, Arc::clone(&operator)));
    Ok(operator)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::bench::Bench;
    use crate::recovery::{Method, Nuisance, determined, picard_joint, recover};

    /// What shares its operators has the same results bit by bit, and holds one for each weighting;
    /// another problem made from it shares nothing.
    #[test]
    fn shared_operators_change_nothing() {
        let bench = Bench::new(6.0, 4, 8);
        let exact = bench.phi(&bench.board(2));
        let stderr = &exact * 1e-2;
        let plain = Problem::new(&exact, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let shared = Shared::default();
        let sharing = plain.sharing(&shared);
        let options = Options::default();
        for method in [Method::Joint, Method::JointUnbounded, Method::Nnls] {
            let [a, b] = [plain, sharing].map(|p| recover(method, &p, &options).unwrap());
            assert_eq!(a, b);
        }
        let [a, b] = [plain, sharing].map(|p| picard_joint(&p, &options).unwrap());
        assert_eq!(a.sigma, b.sigma);
        let [a, b] = [plain, sharing].map(|p| determined(&p).unwrap());
        assert_eq!(a, b);
        assert_eq!(shared.0.lock().unwrap().len(), 1);
        let unweighted = Options {
            weighting: WeightRule::Unweighted,
            ..options
        };
        recover(Method::Joint, &sharing, &unweighted).unwrap();
        assert_eq!(shared.0.lock().unwrap().len(), 2);
        let nuisance = Nuisance {
            background: true,
            ..Nuisance::default()
        };
        let other = sharing.with_nuisance(nuisance).unwrap();
        recover(Method::Joint, &other, &options).unwrap();
        assert_eq!(shared.0.lock().unwrap().len(), 2);
    }
}
