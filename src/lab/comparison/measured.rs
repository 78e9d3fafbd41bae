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

impl Measured<'_> {
    /// Refuses entries with light of which nothing says how exact it is.
    ///
    /// # Errors
    /// [`ValidationError::Exact`].
    pub(super) fn check_errors(&self) -> Result<(), ValidationError> {
        let out = self.beside.left_out;
        let counts = |at: &usize| out.is_none_or(|flags| flags[*at] == 0.0);
        let exact = |at: &usize| self.phi[*at] != 0.0 && self.stderr[*at] == 0.0;
        let counted = || (0..self.phi.len()).filter(counts);
        match counted().filter(exact).count() {
            0 => Ok(()),
            count => Err(ValidationError::Exact {
                count,
                entries: counted().count(),
            }),
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
    /// Measured light has errors.
    #[error(
        "{count} of {entries} entries hold light and have a standard error of 0, which no measurement has: any model \
         is infinitely far from them (leave them out (--left-out), or give their errors)"
    )]
    Exact {
        /// Such entries.
        count: usize,
        /// All entries that count.
        entries: usize,
    },
    /// What is beside the model does not fit it.
    #[error(transparent)]
    Beside(#[from] RecoveryError),
    /// Patterns of other light cannot be decomposed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}
