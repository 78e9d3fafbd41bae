//! Floor `metrics`.
