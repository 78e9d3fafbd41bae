//! Floor `recovery`.
