//! Methods over all pixels and spots at once.

pub(super) mod bounded;
mod khatri_rao;
pub(super) mod unbounded;
mod weights;

pub use weights::Weighting;
