//! Floor `study`.
