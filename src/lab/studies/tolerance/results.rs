//! What the study of misplaced things found.

use serde::{Deserialize, Serialize};

/// What a misplacement of one size does: to the side to which it does more.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Misplacement {
    /// Degrees, percent, or the scene's unit of length.
    pub size: f64,
    /// ‖Φ(misplaced) − Φ‖/‖Φ‖.
    pub change: f64,
    /// The same after the best single scale.
    pub after_scale: f64,
    /// Mean raw MTF of the recovery with the misplaced model; absent where the object has no
    /// contrast.
    pub mtf: Option<f64>,
}

impl Misplacement {
    /// What is worse of this and the same to the other side, each by itself.
    #[must_use]
    pub(super) fn or_worse(self, other: &Self) -> Self {
        Self {
            size: self.size,
            change: self.change.max(other.change),
            after_scale: self.after_scale.max(other.after_scale),
            mtf: self.mtf.zip(other.mtf).map(|(a, b)| a.min(b)),
        }
    }
}

/// One thing that is assumed wrongly.
#[derive(Clone, Debug, Serialize)]
pub struct Sensitivity {
    /// What.
    pub name: String,
    /// Unit of the sizes: `deg` or the scene's.
    pub unit: String,
    /// By growing size. Sizes that the scene does not allow (a spot off the wall) are left out.
    pub rows: Vec<Misplacement>,
    /// ‖∂Φ‖/‖Φ‖ a unit by the model's derivative, and what the best scale leaves of it; absent of
    /// what has none.
    pub by_derivative: Option<[f64; 2]>,
    /// The largest size with which the MTF stays at what is wished for, what is lost of it being
    /// interpolated as a power of the size; absent where every size that was tried allows it, or
    /// none.
    pub needed: Option<f64>,
    /// The size at which the MTF falls to half of that without error; absent if it does not, or was
    /// lost before.
    pub lost_at: Option<f64>,
}

/// The study of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Tolerance {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Noise of the photographs, relative to each entry.
    pub noise: f64,
    /// Draws of it, over which each MTF is the mean.
    pub draws: u64,
    /// MTF that is wished for, of the picture's own.
    pub wished: f64,
    /// Raw MTF of the picture itself; absent where it has no contrast.
    pub own: Option<f64>,
    /// Raw MTF with the right geometry.
    pub mtf: Option<f64>,
    /// Each thing.
    pub parameters: Vec<Sensitivity>,
}

impl Tolerance {
    /// Part of the picture's own MTF below which an MTF shows no pattern.
    const PATTERN: f64 = 0.5;

    /// Whether the right geometry shows the pattern, so that it can be lost.
    pub(super) fn shows_pattern(&self) -> bool {
        let both = self.mtf.zip(self.own);
        both.is_some_and(|(mtf, own)| mtf >= Self::PATTERN * own)
    }

    /// The raw MTF that is wished for.
    pub(super) fn limit(&self) -> Option<f64> {
        self.own.map(|own| own * self.wished)
    }
}
