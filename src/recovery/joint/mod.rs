//! Methods over all pixels and spots at once.

pub(super) mod bounded;
mod coordinates;
mod cramer_rao;
mod determined;
pub(super) mod gauss_newton;
mod operator;
pub(super) mod patterns;
mod picard;
pub(super) mod process;
pub(super) mod total_variation;
pub(super) mod unbounded;

pub use cramer_rao::{CramerRao, cramer_rao};
pub use determined::{Determined, determined, unseen};
pub(super) use operator::scale::refuse_no_light;
pub use patterns::two_valued::two_valued_bytes;
pub use picard::picard_joint;
pub use process::exponential::Exponential;
