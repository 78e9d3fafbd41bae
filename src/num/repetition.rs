//! What is in a list again.

use std::collections::BTreeSet;

/// The first value that was there before.
pub(crate) fn first_repeated<T: Ord + Copy>(values: impl IntoIterator<Item = T>) -> Option<T> {
    let mut seen = BTreeSet::new();
    values.into_iter().find(|value| !seen.insert(*value))
}
