//! Floor `matrix`.
