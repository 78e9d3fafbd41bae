//! Methods over all pixels and spots at once.

pub(super) mod bounded;
mod branch;
mod conditional;
mod coordinates;
mod correlated;
mod cramer_rao;
mod determined;
mod elimination;
mod enumerated;
mod exponential;
pub(super) mod gauss_newton;
pub(super) mod gaussian_process;
mod gram;
mod ground;
mod khatri_rao;
mod levels;
mod linear;
mod neighbours;
mod pattern_lattice;
mod pattern_search;
mod picard;
mod reduced;
mod sampled;
mod sampler;
mod scale;
mod sides;
mod spread;
mod stacked;
pub(super) mod total_variation;
pub(super) mod two_valued;
pub(super) mod unbounded;
mod weights;

pub use cramer_rao::{CramerRao, cramer_rao};
pub use determined::{Determined, determined};
pub use exponential::Exponential;
pub use picard::picard_joint;
