//! The elements as the laser lights them.

use nalgebra::{DMatrix, DVector};

use crate::num::linalg::{Range, range, rows_times};
use crate::recovery::RecoveryError;

/// diag(ρ) D, where D is large and of few directions as the product of two thin factors, which is D
/// to rounding.
pub(in crate::recovery) struct LitElements {
    /// diag(ρ) D or diag(ρ) Q, r rows.
    pub(super) elements: DMatrix<f64>,
    /// B of D = Q B.
    pub(super) along: Option<DMatrix<f64>>,
}

impl LitElements {
    pub(in crate::recovery) fn new(
        d: &DMatrix<f64>,
        reflectance: &DVector<f64>,
    ) -> Result<Self, RecoveryError> {
        let (elements, along) = match range(d)? {
            Some(Range { q, b, .. }) => (q, Some(b)),
            None => (d.clone(), None),
        };
        Ok(LitElements {
            elements: rows_times(elements, reflectance),
            along,
        })
    }
}
