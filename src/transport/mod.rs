//! Floor `transport`.
