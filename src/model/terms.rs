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

/// Both sides of an element's light from its cells, and the variance of all of it together by the
/// choice of viewpoints. The camera's side is known at a cell's viewpoint x, with nothing in the
/// way (c₀) and past what is (c), the laser's as the mean d̄ over the cell and as d′ at x. Of a
/// cell that pixel and spot both see a part of, c d̄ is not the mean of c d, but
///
/// > Σ_q c d̄ + (α c₀ − c)(d̄ − d′) = Σ_q c d′ + α c₀ (d̄ − d′)
///
/// has that mean over x whatever α is. For each pixel the α that adds least, by squares: α = Σ_q w
/// c₀ c / Σ_q w c₀², w = Σ_l (d̄ − d′)². Where a pixel sees all of the cells that spots see a part
/// of, or nothing of them, α is 1 or 0, and nothing is added.
pub(super) fn averaged(
    [all, seen]: [Matrix; 2],
    [mean, at_viewpoint]: [Matrix; 2],
) -> (Matrix, Matrix, f64) {
    let apart = &mean - at_viewpoint;
    let weights: Vec<f64> = apart.row_iter().map(|r| r.norm_squared()).collect();
    if weights.iter().all(|w| *w == 0.0) {
        return (seen, mean, 0.0);
    }
    let mut more = -&seen;
    for (p, mut row) in more.row_iter_mut().enumerate() {
        let sum = |side: &Matrix| {
            let each = weights.iter().enumerate();
            each.map(|(q, w)| w * all[(p, q)] * side[(p, q)])
                .sum::<f64>()
        };
        let (part, whole) = (sum(&seen), sum(&all));
        if part > 0.0 {
            row += all.row(p) * (part / whole);
        }
    }
    let added = |q: &usize| weights[*q] > 0.0 && more.column(*q).amax() > 0.0;
    let parted: Vec<usize> = (0..weights.len()).filter(added).collect();
    if parted.is_empty() {
        return (seen, mean, 0.0);
    }
    let variance = |q: &usize| weights[*q] * more.column(*q).norm_squared();
    let variance = parted.iter().map(variance).sum();
    let columns = seen
        .column_iter()
        .chain(parted.iter().map(|q| more.column(*q)));
    let rows = mean.row_iter().chain(parted.iter().map(|q| apart.row(*q)));
    let camera = Matrix::from_columns(&columns.collect::<Vec<_>>());
    let laser = Matrix::from_rows(&rows.collect::<Vec<_>>());
    (camera, laser, variance)
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
