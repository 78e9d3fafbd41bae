//! Methods over all pixels and spots at once.

pub(super) mod bounded;
mod branch;
mod cramer_rao;
mod determined;
mod elimination;
mod exponential;
pub(super) mod gaussian_process;
mod gram;
mod khatri_rao;
mod picard;
mod reduced;
mod stacked;
pub(super) mod total_variation;
pub(super) mod two_valued;
pub(super) mod unbounded;
mod weights;

pub use cramer_rao::{CramerRao, cramer_rao};
pub use determined::{Determined, determined};
pub use picard::picard_joint;
