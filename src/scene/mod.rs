//! Floor `scene`.
