//! statistics
/// Temporary.
pub fn chi_square_sf(x: f64, dof: f64) -> f64 {
    use statrs::distribution::{ChiSquared, ContinuousCDF};
    ChiSquared::new(dof).unwrap().sf(x)
}
