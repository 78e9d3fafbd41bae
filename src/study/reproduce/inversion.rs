//! The published inversion without noise, by its projector.
//!
//! X = Φ·G12⁺ with Φ = (B ∘ G23)·G12 is (B ∘ G23)·P, P = G12·G12⁺ = U_k U_kᵀ over the k singular directions that the tolerance keeps. Computing it so leaves out
//! the rounding of Φ that G12⁺ multiplies by the condition, and costs r·k numbers in place of r².

use serde::{Deserialize, Serialize};

use crate::matrix::Matrix;
use crate::metrics::{mtf_normalized, mtf_raw};
use crate::model::{Kernel, PixelGrid, Published, Stagger};
use crate::num::linalg::{LinalgError, Tolerance, cut, svd};
use crate::study::inversion::noiseless;

/// Pixels a side of the camera in every item.
pub(super) const PIXELS: usize = 16;

/// The published simulation with `elements` and 4·`per_side` spots.
pub(super) fn published(
    kernel: Kernel,
    elements: usize,
    per_side: usize,
    half_width: f64,
    stagger: Stagger,
) -> Published {
    Published {
        kernel,
        elements,
        pixels: PIXELS,
        grid: PixelGrid::Edges,
        per_side,
        half_width,
        stagger,
    }
}

/// G12 decomposed.
pub(super) struct Inversion {
    g23: Matrix,
    /// U, elements × min(elements, spots).
    u: Matrix,
    /// Singular values, descending, in.⁻².
    pub(super) sigma: Vec<f64>,
    spots: usize,
}

/// What comes out of an inversion.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Outcome {
    /// Recovered values of the elements, before any stretch.
    pub(super) values: Vec<f64>,
    /// Raw MTF.
    pub(super) raw: Option<f64>,
    /// Normalized MTF.
    pub(super) normalized: Option<f64>,
}

impl Outcome {
    pub(super) fn new(values: Vec<f64>, board: &[f64]) -> Self {
        Self {
            raw: mtf_raw(&values, board),
            normalized: mtf_normalized(&values, board),
            values,
        }
    }

    /// The values stretched to \[0, 1\] by their own ends, as the published pictures are.
    pub(super) fn stretched(&self) -> Vec<f64> {
        stretched(&self.values)
    }
}

/// Values stretched to \[0, 1\] by their own ends.
pub(super) fn stretched(values: &[f64]) -> Vec<f64> {
    let ends = |f: fn(f64, f64) -> f64| values.iter().copied().reduce(f).unwrap_or(0.0);
    let (low, high) = (ends(f64::min), ends(f64::max));
    values.iter().map(|x| (x - low) / (high - low)).collect()
}

impl Inversion {
    pub(super) fn new(case: &Published) -> Result<Self, LinalgError> {
        let g12 = case.g12();
        let found = svd(&g12)?;
        Ok(Self {
            g23: case.g23(),
            spots: g12.ncols(),
            sigma: found.sigma.as_slice().to_vec(),
            u: found.u,
        })
    }

    /// How many singular values `tolerance` keeps.
    pub(super) fn rank(&self, tolerance: Tolerance) -> Result<usize, LinalgError> {
        Ok(self.cut(tolerance)?.0)
    }

    /// The same, and the value at or below which singular values are cut, in.⁻².
    pub(super) fn cut(&self, tolerance: Tolerance) -> Result<(usize, f64), LinalgError> {
        cut(&self.sigma, self.u.nrows(), self.spots, tolerance)
    }

    /// The recovery of `board` over the first `rank` directions: (B ∘ G23)·P ⊘ G23, mean over the pixels.
    pub(super) fn noiseless(&self, board: &[f64], rank: usize) -> Outcome {
        let kept = self.u.columns(0, rank).into_owned();
        Outcome::new(noiseless(&self.g23, board, &kept), board)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::{Method, Options, Problem, recover};

    /// Far from the cut the rounding of Φ, multiplied by the condition, is all that parts projector and recovery.
    #[test]
    fn it_is_the_recovery_by_the_pseudo_inverse() {
        for (elements, kernel) in [(2, Kernel::Physical), (4, Kernel::Published)] {
            let case = published(kernel, elements, 10, 3.0, Stagger::OneInch);
            let board = case.board(2);
            let inversion = Inversion::new(&case).unwrap();
            let rank = inversion.rank(Tolerance::Spacing).unwrap();
            let (phi, c, d) = (case.phi(&board), case.g23(), case.g12());
            let problem = Problem::new(&phi, &c, &d, None).unwrap();
            let options = Options {
                tolerance: Tolerance::Spacing,
                ..Options::default()
            };
            let found = recover(Method::Pinv, &problem, &options).unwrap();
            assert_eq!(found.rank, rank);
            let bound = 100.0 * f64::EPSILON * inversion.sigma[0] / inversion.sigma[rank - 1];
            assert!(bound < 1e-3, "{bound:e}");
            let own = inversion.noiseless(&board, rank).values;
            for (a, b) in own.iter().zip(found.reflectance.iter()) {
                assert!((a - b).abs() < bound, "{elements}: {a} for {b}, {bound:e}");
            }
        }
    }
}
