//! The operator ρ ↦ C diag(ρ) D and its normal equations, in the forms that its structure gives.

pub(super) mod conditional;
pub(super) mod elimination;
mod gram;
pub(super) mod khatri_rao;
pub(super) mod linear;
pub(super) mod reduced;
pub(super) mod scale;
mod sides;
pub(super) mod stacked;
pub(super) mod weights;
