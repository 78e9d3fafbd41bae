//! Recovered surfaces: every method on one Φcam, which to believe, and what speaks against it.

pub(super) mod chosen;
pub(super) mod doubt;
pub(super) mod fit;
pub(super) mod gallery;
pub(super) mod inversion;
mod likelier;
pub(super) mod measures;
pub(super) mod objects;
mod picard;
#[cfg(test)]
mod pictures;
pub(super) mod recoveries;
pub(super) mod trust;
