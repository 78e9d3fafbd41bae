//! Light as a sum of few products of a camera's and a laser's side.

use super::error::ModelError;
use crate::matrix::Matrix;
use crate::num::linalg::{rows_times, svd};

/// Terms less than this share of an element's largest are left out, past what stands in the way and
/// with nothing there: less than what cells leave out.
pub(super) const NEGLIGIBLE: f64 = 1e-6;
pub(super) const NEGLIGIBLE_SMOOTH: f64 = 1e-9;

/// The light of elements with albedo 1 as products.
#[derive(Clone, Debug)]
pub struct Terms {
    /// Pixels × terms.
    pub camera: Matrix,
    /// Terms × spots; with `camera` W.
    pub laser: Matrix,
    /// The element of each term, ascending.
    pub element: Vec<usize>,
}

/// ∂ of both sides of [`Terms`] by a parameter; none where it does not move a side.
#[derive(Clone, Debug)]
pub struct TermsRate {
    /// Pixels × terms.
    pub camera: Option<Matrix>,
    /// Terms × spots.
    pub laser: Option<Matrix>,
}

impl Terms {
    /// Those of the elements, each a product, one behind the other.
    pub(super) fn stacked(all: &[(&Matrix, &Matrix)], (pixels, spots): (usize, usize)) -> Self {
        let element: Vec<usize> = (0..all.len())
            .flat_map(|j| std::iter::repeat_n(j, all[j].1.nrows()))
            .collect();
        let mut camera = Matrix::zeros(pixels, element.len());
        let mut laser = Matrix::zeros(element.len(), spots);
        let mut at = 0;
        for (c, d) in all {
            let count = d.nrows();
            camera.columns_mut(at, count).copy_from(c);
            laser.rows_mut(at, count).copy_from(d);
            at += count;
        }
        Self {
            camera,
            laser,
            element,
        }
    }

    /// Σ_j ρ_j A_j, pixels × spots, W.
    pub fn phi(&self, albedo: &[f64]) -> Matrix {
        let of_terms: Vec<f64> = self.element.iter().map(|j| albedo[*j]).collect();
        &self.camera * rows_times(self.laser.clone(), &of_terms)
    }

    /// What frame `spot` shows of each element at albedo 1, pixels × elements, W.
    pub fn frame(&self, spot: usize, elements: usize) -> Matrix {
        summed(&self.element, elements, (&self.camera, &self.laser, spot))
    }

    /// Σ_l w_pl of what frame l shows of each element at albedo 1: pixels × elements by the
    /// weights' pixels × spots.
    pub fn mean(&self, weights: &Matrix, elements: usize) -> Matrix {
        let lit = weights * self.laser.transpose();
        let mut all = Matrix::zeros(self.camera.nrows(), elements);
        for (s, j) in self.element.iter().enumerate() {
            let own = self.camera.column(s).component_mul(&lit.column(s));
            all.column_mut(*j).axpy(1.0, &own, 1.0);
        }
        all
    }

    /// Its rate of change.
    pub fn frame_rate(&self, rate: &TermsRate, spot: usize, elements: usize) -> Matrix {
        let of = |camera, laser| summed(&self.element, elements, (camera, laser, spot));
        match (&rate.camera, &rate.laser) {
            (Some(camera), Some(laser)) => of(camera, &self.laser) + of(&self.camera, laser),
            (Some(camera), None) => of(camera, &self.laser),
            (None, Some(laser)) => of(&self.camera, laser),
            (None, None) => Matrix::zeros(self.camera.nrows(), elements),
        }
    }
}

/// Σ_s camera\[·,s\] laser\[s,spot\], summed into the column of each term's element.
fn summed(
    element: &[usize],
    elements: usize,
    (camera, laser, spot): (&Matrix, &Matrix, usize),
) -> Matrix {
    let mut all = Matrix::zeros(camera.nrows(), elements);
    for (s, j) in element.iter().enumerate() {
        let lit = laser[(s, spot)];
        if lit != 0.0 {
            all.column_mut(*j).axpy(lit, &camera.column(s), 1.0);
        }
    }
    all
}

/// C D with as few terms as carry it but for this share: D = U Σ Vᵀ, C U Σ = U′ Σ′ V′ᵀ, C D = (U′
/// Σ′)(V′ᵀ Vᵀ).
pub(super) fn compressed(
    (c, d): (&Matrix, &Matrix),
    negligible: f64,
) -> Result<(Matrix, Matrix), ModelError> {
    let nothing = (Matrix::zeros(c.nrows(), 0), Matrix::zeros(0, d.ncols()));
    if c.amax() == 0.0 || d.amax() == 0.0 {
        return Ok(nothing);
    }
    let kept = |sigma: &[f64]| {
        sigma
            .iter()
            .take_while(|s| **s > negligible * sigma[0])
            .count()
    };
    let right = svd(d)?;
    let n = kept(right.sigma.as_slice());
    let scaled = Matrix::from_fn(d.nrows(), n, |q, k| right.u[(q, k)] * right.sigma[k]);
    let left = svd(&(c * scaled))?;
    if left.sigma[0] == 0.0 {
        return Ok(nothing);
    }
    let r = kept(left.sigma.as_slice());
    let camera = Matrix::from_fn(c.nrows(), r, |p, k| left.u[(p, k)] * left.sigma[k]);
    Ok((camera, left.vt.rows(0, r) * right.vt.rows(0, n)))
}
