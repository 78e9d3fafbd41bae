//! The matrix.
/// Pixels × spots, W.
pub type Matrix = nalgebra::DMatrix<f64>;
