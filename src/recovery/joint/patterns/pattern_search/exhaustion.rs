//! The best of all patterns of few elements.

use rayon::prelude::*;

use super::{Pattern, Search};

/// Most elements whose patterns are all tried.
const MOST: usize = 16;

impl Search<'_> {
    /// The pattern that fits best of all 2ⁿ, each with its best levels, possible ones first; none
    /// of more than 16 elements.
    pub(super) fn best_of_all(&self) -> Option<Pattern> {
        let n = self.r.ncols();
        let all = 0..if n <= MOST { 1usize << n } else { 0 };
        let patterns = all
            .into_par_iter()
            .map(|at| self.fit((0..n).map(|j| at >> j & 1 == 1).collect()));
        // Of two that fit alike the same one, whatever the threads.
        patterns.min_by(|a, b| {
            let first = self.can(b).cmp(&self.can(a));
            let better = first.then(a.misfit.total_cmp(&b.misfit));
            better.then_with(|| a.light.cmp(&b.light))
        })
    }
}
