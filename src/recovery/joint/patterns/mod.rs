//! Pictures of two levels: patterns, how likely each is, and their sums.

mod alike;
mod apart;
mod branch;
mod enumerated;
pub(super) mod factor;
pub(super) mod fields;
mod levels;
pub(super) mod neighbours;
pub(super) mod part;
pub(super) mod pattern_lattice;
mod pattern_likelihood;
mod pattern_search;
mod pattern_sums;
mod sampled;
mod sampler;
mod scaled;
mod spread;
pub(in crate::recovery) mod two_valued;
