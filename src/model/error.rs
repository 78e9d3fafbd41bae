//! Why a scene has no matrix model.

use crate::num::linalg::LinalgError;

/// Why a scene has no matrix model.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
pub enum ModelError {
    /// Nothing is hidden.
    #[error(
        "the scene has no hidden surface, so there is no matrix model (give one surface role = \"hidden\")"
    )]
    NothingHidden,
    /// The matrices would be absurdly large.
    #[error(
        "{elements} elements make matrices of {entries:e} entries (use fewer elements, pixels or spots)"
    )]
    TooLarge {
        /// Elements asked for.
        elements: usize,
        /// Entries of all matrices.
        entries: f64,
    },
    /// Matrices given in place of a scene's do not belong together.
    #[error(
        "the camera side has {columns} columns, the laser side {rows} rows, and {} × {} elements were asked for: one is needed of each for every element",
        count[0],
        count[1]
    )]
    Sides {
        /// Columns of C.
        columns: usize,
        /// Rows of D.
        rows: usize,
        /// Elements along u and v.
        count: [usize; 2],
    },
    /// The terms of an element cannot be found.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}
