//! Light that all frames share, unknown in each pixel, taken out of photographs and model exactly.
//!
//! Of Φ_pl = (Aρ)_pl + b_p with weights w the photographs tell of Aρ what is left of both beside
//!
//! > b̂_p = Σ_l w_pl (Φ − Aρ)_pl / Σ_l w_pl,
//!
//! Φ_pl − Φ̄_p and A_pl − Ā_p, by means over the frames with these weights: one direction of a
//! pixel.

use nalgebra::DVector;

use crate::lab::error::LabError;
use crate::lab::uncertainty::unexplained::Unexplained;
use crate::matrix::Matrix;

pub(super) const OTHER_LIGHT: LabError = LabError::Unsuited(
    "a background and other light in each frame are not taken out together; leave out --background, or --frame-polynomial",
);
pub(super) const FIELD: LabError = LabError::Unsuited(
    "a field of errors is not found beside a background; leave out --error-field, or --background",
);
const ALONE: LabError = LabError::Unsuited(
    "a background takes all that single photographs say, and no pixel counts in two; give more photographs, or leave out --background",
);

/// The means over the frames.
#[derive(Debug)]
pub(super) struct Common {
    /// w_pl/Σ_l w_pl, pixels × frames; 0 in pixels that do not count.
    shares: Matrix,
    /// √Σ_l w_pl.
    roots: DVector<f64>,
    /// Photographs less their means.
    pub(super) phi: Matrix,
}

impl Common {
    /// Of the photographs.
    pub(super) fn new(of: &Unexplained<'_>, has_field: bool) -> Result<Self, LabError> {
        if of.patterns.is_some() {
            return Err(OTHER_LIGHT);
        }
        if has_field {
            return Err(FIELD);
        }
        let frames: Vec<DVector<f64>> = (0..of.phi.ncols()).map(|l| of.roots(l)).collect();
        let mut shares = Matrix::from_columns(&frames).map(|q| q * q);
        let roots = shares.column_sum().map(f64::sqrt);
        for mut pixel in shares.row_iter_mut() {
            let all = pixel.sum();
            if all > 0.0 {
                pixel /= all;
            }
        }
        if !shares.iter().any(|share| *share > 0.0 && *share < 1.0) {
            return Err(ALONE);
        }
        let counted = |x: f64, share: f64| if share > 0.0 { x } else { 0.0 };
        let phi = of.phi.zip_map(&shares, counted);
        let mean = phi.component_mul(&shares).column_sum();
        let phi = Matrix::from_fn(phi.nrows(), phi.ncols(), |p, l| phi[(p, l)] - mean[p]);
        Ok(Self { shares, roots, phi })
    }

    /// Pixels that count: one direction each.
    pub(super) fn directions(&self) -> f64 {
        let counts = |pixel: &_| -> bool { nalgebra::Matrix::sum(pixel) > 0.0 };
        self.shares.row_iter().filter(counts).count() as f64
    }

    /// √Σ_l w_pl of each pixel.
    pub(super) fn roots(&self) -> &DVector<f64> {
        &self.roots
    }

    /// Weights of the frames in each pixel's mean, pixels × frames.
    pub(super) fn shares(&self) -> &Matrix {
        &self.shares
    }

    /// Takes the means out of whitened columns of all frames, pixels × unknowns: of x = √w·u it
    /// leaves √w (u − ū), ū_p = Σ_l √w x/Σ_l w.
    pub(super) fn take_out(&self, frames: &mut [&mut Matrix]) {
        let Some((rows, columns)) = frames.first().map(|m| m.shape()) else {
            return;
        };
        let roots = self.shares.map(f64::sqrt);
        let mut mean = Matrix::zeros(rows, columns);
        for (l, own) in frames.iter().enumerate() {
            for (mut sum, x) in mean.column_iter_mut().zip(own.column_iter()) {
                sum += roots.column(l).component_mul(&x);
            }
        }
        for (l, own) in frames.iter_mut().enumerate() {
            for (mut x, mean) in own.column_iter_mut().zip(mean.column_iter()) {
                x -= roots.column(l).component_mul(&mean);
            }
        }
    }
}
