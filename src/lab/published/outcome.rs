//! What comes of an inversion.

use serde::{Deserialize, Serialize};

use crate::metrics::{mtf_normalized, mtf_raw};

/// Recovered reflectances, and how well they show the board.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Outcome {
    /// Relative noise of the Φ that they were recovered from.
    pub(super) noise: f64,
    /// Recovered values of the elements, before any stretch.
    pub(super) values: Vec<f64>,
    /// Raw MTF.
    pub(super) raw: Option<f64>,
    /// Normalized MTF.
    pub(super) normalized: Option<f64>,
    /// 1 − raw MTF with all digits of the computation.
    pub(super) shortfall: f64,
}

impl Outcome {
    /// Of noiseless values in doubles.
    pub(super) fn new(values: Vec<f64>, board: &[f64]) -> Self {
        let raw = mtf_raw(&values, board);
        Self {
            noise: 0.0,
            raw,
            normalized: mtf_normalized(&values, board),
            shortfall: raw.map_or(f64::NAN, |raw| 1.0 - raw),
            values,
        }
    }

    /// The smallest of the values.
    pub(super) fn smallest(&self) -> f64 {
        self.values.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// Values stretched to \[0, 1\] by their own ends, as the published pictures are.
pub(super) fn stretched(values: &[f64]) -> Vec<f64> {
    let ends = |f: fn(f64, f64) -> f64| values.iter().copied().reduce(f).unwrap_or(0.0);
    let (low, high) = (ends(f64::min), ends(f64::max));
    values.iter().map(|x| (x - low) / (high - low)).collect()
}

/// One inverse, and what it recovers.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Trial {
    /// Singular directions that the inverse keeps.
    pub(super) rank: usize,
    /// The last singular value that is kept, and the first that is not, over the cut.
    pub(super) around: [f64; 2],
    /// σ1 over the last singular value that is kept.
    pub(super) condition: f64,
    /// ‖traced mean − modelled‖/‖modelled‖ of Φ; 0 where nothing is traced.
    pub(super) difference: f64,
    /// Decimal digits of the arithmetic; 0 where that is not told.
    pub(super) digits: u32,
    /// One outcome for each board, or for each Φ.
    pub(super) found: Vec<Outcome>,
}

impl Trial {
    /// Of an inverse that keeps `rank` of the singular values `sigma`, those above `cutoff`.
    pub(super) fn new(sigma: &[f64], rank: usize, cutoff: f64, found: Vec<Outcome>) -> Self {
        let at = |k: usize| sigma.get(k).copied().unwrap_or(0.0);
        let last = at(rank.saturating_sub(1));
        Self {
            rank,
            around: [last, at(rank)].map(|s| s / cutoff),
            condition: at(0) / last,
            found,
            ..Self::default()
        }
    }
}
