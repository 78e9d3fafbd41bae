//! Photographs that are tested against a model.

use crate::matrix::Matrix;
use crate::model::ModelError;
use crate::num::linalg::LinalgError;
use crate::recovery::{Nuisance, RecoveryError};

/// What is tested: Φcam as it was traced or measured, pixels × spots.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// Φcam, W, or any unit where the scale is free.
    pub phi: &'a Matrix,
    /// Its standard error, the same unit.
    pub stderr: &'a Matrix,
    /// What is fitted to it first, and which entries do not count, their error not being trusted.
    pub beside: Nuisance<'a>,
}

impl<'a> Measured<'a> {
    /// Light in W with nothing beside the model's.
    pub fn new(phi: &'a Matrix, stderr: &'a Matrix, left_out: Option<&'a Matrix>) -> Self {
        Self {
            phi,
            stderr,
            beside: Nuisance {
                left_out,
                ..Nuisance::default()
            },
        }
    }
}

/// Why nothing can be validated.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum ValidationError {
    /// The scene has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Traced and modelled matrices differ in shape.
    #[error(
        "the traced matrix is {found_rows} × {found_columns}, but the scene has {rows} pixels and {columns} spots \
         (give the scene that was rendered)"
    )]
    Shape {
        /// Pixels of the scene.
        rows: usize,
        /// Spots of the scene.
        columns: usize,
        /// Rows given.
        found_rows: usize,
        /// Columns given.
        found_columns: usize,
    },
    /// What is beside the model does not fit it.
    #[error(transparent)]
    Beside(#[from] RecoveryError),
    /// Patterns of other light cannot be decomposed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}
