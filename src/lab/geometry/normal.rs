//! Normal equations of reflectances.

use nalgebra::{DMatrix, DVector};

use crate::matrix::Matrix;
use crate::num::linalg::tr_product;

/// What photographs y say of the reflectances ρ by their light A, both in units of the noise:
/// ‖y − Aρ‖² = s − 2 hᵀρ + ρᵀHρ.
#[derive(Clone, Debug)]
pub(super) struct Normal {
    /// H, elements × elements.
    pub h: Matrix,
    /// h.
    pub side: DVector<f64>,
    /// s.
    pub square: f64,
    /// Entries that count, less the directions of other light.
    pub count: f64,
}

impl Normal {
    /// Of `columns`, the light of each element and the photograph, in units of the noise, of which
    /// `count` entries count.
    pub(super) fn of(columns: &Matrix, count: f64) -> Self {
        let n = columns.ncols() - 1;
        let all = tr_product(columns, columns);
        Self {
            h: all.view((0, 0), (n, n)).into_owned(),
            side: all.view((0, n), (n, 1)).column(0).into_owned(),
            square: all[(n, n)],
            count,
        }
    }

    /// All of `frames` together.
    pub(super) fn sum<'a>(frames: impl Iterator<Item = &'a Self>, elements: usize) -> Self {
        let nothing = Self {
            h: DMatrix::zeros(elements, elements),
            side: DVector::zeros(elements),
            square: 0.0,
            count: 0.0,
        };
        frames.fold(nothing, |mut all, frame| {
            all.h += &frame.h;
            all.side += &frame.side;
            all.square += frame.square;
            all.count += frame.count;
            all
        })
    }

    /// What these reflectances do not explain.
    pub(super) fn left(&self, rho: &DVector<f64>) -> f64 {
        self.square - 2.0 * self.side.dot(rho) + rho.dot(&(&self.h * rho))
    }
}
