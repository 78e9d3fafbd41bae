//! What is refused for the size of its entries.

use nalgebra::DMatrix;

use crate::recovery::RecoveryError;

/// Sizes whose squares, and products of squares of two matrices, stay well within f64.
const SCALE: std::ops::RangeInclusive<f64> = 1e-60..=1e60;

/// Refuses entries that are not finite, or whose squares are not.
pub(super) fn finite(name: &'static str, matrix: &DMatrix<f64>) -> Result<(), RecoveryError> {
    match matrix.iter().position(|x| !x.is_finite()) {
        Some(at) => Err(RecoveryError::NotFinite {
            name,
            row: at % matrix.nrows(),
            column: at / matrix.nrows(),
            value: matrix[at],
        }),
        None => refuse_scale(name, matrix.amax()),
    }
}

/// Refuses a matrix by the size of an entry that decides its scale; zero has none.
pub(super) fn refuse_scale(name: &'static str, value: f64) -> Result<(), RecoveryError> {
    if value == 0.0 || SCALE.contains(&value) {
        Ok(())
    } else {
        Err(RecoveryError::OutOfScale { name, value })
    }
}

/// The lesser of two numbers, where 0 stands for none yet.
pub(super) fn least(least: f64, x: f64) -> f64 {
    if least > 0.0 { least.min(x) } else { x }
}
