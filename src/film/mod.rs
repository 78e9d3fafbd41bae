//! Floor `film`.
