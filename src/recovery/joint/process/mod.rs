//! Gaussian processes: of reflectances over the surface, and of errors that neighbours share.

pub(super) mod correlated;
mod error_field;
pub(super) mod exponential;
pub(super) mod gaussian_process;
pub(in crate::recovery) mod unknown_noise;
