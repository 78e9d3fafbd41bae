//! What is varied: the axes of noise.

use super::super::deviate::normal_deviates;
use crate::matrix::Matrix;

/// What makes photographs noisy, and by how much it is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseAxis {
    /// Each entry of Φcam times 1 + σ·N(0, 1), independently. The recovery is told the standard error σ·|Φ| of the exact entry.
    Relative,
}

/// A noisy Φcam and what the recovery is told of it, pixels × spots, W.
pub(in super::super) struct Photographs {
    pub(in super::super) phi: Matrix,
    pub(in super::super) stderr: Matrix,
}

impl NoiseAxis {
    /// The name used in the files of a study.
    pub fn name(self) -> &'static str {
        match self {
            Self::Relative => "relative",
        }
    }

    /// What a level is, for tables and figures.
    pub fn title(self) -> &'static str {
        match self {
            Self::Relative => "relative noise of each entry of Φcam",
        }
    }

    /// The levels of a study that asks for none, from quiet to loud.
    pub fn levels(self) -> Vec<f64> {
        match self {
            Self::Relative => (-12..=0).map(|d| libm::exp10(f64::from(d))).collect(),
        }
    }

    /// Levels that have a meaning, in words, if `level` has none.
    pub fn refuses(self, level: f64) -> Option<&'static str> {
        match self {
            Self::Relative if level > 0.0 && level <= 1.0 => None,
            Self::Relative => {
                Some("a relative noise is a number above 0 and not above 1, e.g. 0.01")
            }
        }
    }

    /// Noisy photographs of `exact` at `level`. One seed gives the same deviates at every level, so that methods, levels and objects are compared
    /// under the same draw.
    pub(in super::super) fn photograph(self, exact: &Matrix, level: f64, seed: u64) -> Photographs {
        match self {
            Self::Relative => {
                let stderr = exact.map(|x| level * x.abs());
                let deviates = normal_deviates(seed, exact.nrows(), exact.ncols());
                Photographs {
                    phi: exact + deviates.component_mul(&stderr),
                    stderr,
                }
            }
        }
    }
}
