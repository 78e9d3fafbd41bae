//! Normal equations of reflectances.

use nalgebra::{DMatrix, DVector};

use crate::matrix::Matrix;

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

    /// All of `frames` but one, each left out in turn.
    pub(super) fn all_but_one(frames: &[Self], elements: usize) -> impl Iterator<Item = Self> + '_ {
        (0..frames.len()).map(move |out| {
            let others = frames.iter().enumerate().filter(move |(l, _)| *l != out);
            Self::sum(others.map(|(_, frame)| frame), elements)
        })
    }

    /// What these reflectances do not explain.
    pub(super) fn left(&self, rho: &DVector<f64>) -> f64 {
        self.square - 2.0 * self.side.dot(rho) + rho.dot(&(&self.h * rho))
    }
}
