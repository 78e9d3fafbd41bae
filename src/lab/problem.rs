//! The inverse problem of a matrix model.

use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::recovery::{Problem, RecoveryError, Terms};

/// Photographs Φ, pixels × spots, W, with their standard errors where these are known, to be
/// inverted by `model`: with the terms of its elements where something stands in the way.
///
/// # Errors
/// Those of [`Problem::new`].
pub(crate) fn problem<'a>(
    model: &'a MatrixModel,
    phi: &'a Matrix,
    stderr: Option<&'a Matrix>,
) -> Result<Problem<'a>, RecoveryError> {
    let product = Problem::new(phi, &model.camera_side, &model.laser_side, stderr)?;
    match &model.factors {
        None => Ok(product),
        Some(factors) => product.with_terms(Terms {
            c: &factors.camera,
            d: &factors.laser,
            element: &factors.element,
        }),
    }
}
