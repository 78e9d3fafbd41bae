//! What several recoveries of one problem need, found once.

use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};

use super::{Options, RecoveryError, WeightRule};

/// What was found for a [`Problem`](super::Problem), by weighting and budget: its operator, which
/// methods, Picard plot and the share that is determined all decompose.
#[derive(Debug, Default)]
pub struct Shared(Mutex<Vec<(Key, Arc<dyn Any + Send + Sync>)>>);

type Key = (WeightRule, usize);

impl Shared {
    /// What an earlier call has found for these options, or what `find` finds.
    pub(super) fn get<T: Any + Send + Sync>(
        &self,
        options: &Options,
        find: impl FnOnce() -> Result<T, RecoveryError>,
    ) -> Result<Arc<T>, RecoveryError> {
        let key = (options.weighting, options.budget);
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = lock().iter().find_map(|(of, known)| {
            let own = (*of == key).then(|| Arc::clone(known))?;
            own.downcast::<T>().ok()
        });
        if let Some(known) = known {
            return Ok(known);
        }
        let found = Arc::new(find()?);
        lock().push((key, Arc::clone(&found) as Arc<dyn Any + Send + Sync>));
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::bench::Bench;
    use crate::recovery::{Method, Nuisance, Problem, determined, picard_joint, recover};

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
        // What is determined goes by the noise of each entry, which is of no form here.
        assert_eq!(shared.0.lock().unwrap().len(), 2);
        let unweighted = Options {
            weighting: WeightRule::Unweighted,
            ..options
        };
        recover(Method::Joint, &sharing, &unweighted).unwrap();
        assert_eq!(shared.0.lock().unwrap().len(), 3);
        let nuisance = Nuisance {
            background: true,
            ..Nuisance::default()
        };
        let other = sharing.with_nuisance(nuisance).unwrap();
        recover(Method::Joint, &other, &options).unwrap();
        assert_eq!(shared.0.lock().unwrap().len(), 3);
    }
}
