//! Floor `geometry`.
