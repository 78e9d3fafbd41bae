//! Floor 5: how far two things are apart. Recovered reflectances against the true object, one
//! matrix against another.

mod distance;
mod modulation;
mod rank;

pub use distance::{correlation, relative_frobenius, rmse};
pub use modulation::{light_and_dark, mtf_normalized, mtf_raw};
pub use rank::rank_correlation;
