//! What photographs hold beside the light of the hidden surface, of known form and unknown size.
//!
//! > Φ\[p,l\] = (1 + ε)(1 + ε_l) s Σ_j C\[p,j\] ρ_j D\[j,l\]
//! >          + b_l + Σ_k f_kl F\[p,k\] + a_p + g_l P\[p,l\] + noise

use nalgebra::{DMatrix, DVector};

use super::Gains;

/// What is estimated with the reflectances, by every joint method. Nothing unless asked for.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Nuisance<'a> {
    /// A constant of each frame, b_l: an offset of the sensor, light that fills the view evenly.
    pub frame_constant: bool,
    /// Patterns F\[p,k\] (pixels × patterns, any unit) each of which is in each frame with an
    /// unknown strength f_kl: light from elsewhere that varies smoothly over the wall, a photograph
    /// without the laser.
    pub frame_patterns: Option<&'a DMatrix<f64>>,
    /// An image that is the same in all frames, a_p: ambient light.
    pub background: bool,
    /// A pattern P\[p,l\] (pixels × spots, any unit) whose strength g_l in each frame is unknown:
    /// glare of the spot.
    pub glare: Option<&'a DMatrix<f64>>,
    /// One unknown factor s of the whole model. Only s ρ is seen, so by convention **the brightest
    /// element has ρ = 1**; a surface without a white element is recovered relative to its
    /// brightest. Bounds from above mean nothing then: `joint` keeps ρ ≥ 0 alone.
    pub free_scale: bool,
    /// σ_g: the light of each frame has a factor 1 + ε_l of its own, ε_l ~ N(0, σ_g²), as of a
    /// laser whose power drifts; above 0, at most 1.
    pub frame_gain: Option<f64>,
    /// σ_s: the light of all frames has one factor 1 + ε, ε ~ N(0, σ_s²), as of a calibration that
    /// is known to so much; above 0, at most 1. Not with `free_scale`.
    pub scale_error: Option<f64>,
    /// Entries that do not count, pixels × spots: those that are not 0. Each holds an unknown light
    /// of its own, so that its value says nothing; it must be finite.
    pub left_out: Option<&'a DMatrix<f64>>,
}

impl Nuisance<'_> {
    /// Whether anything is asked for.
    pub(super) fn is_some(&self) -> bool {
        *self != Nuisance::default()
    }

    /// Whether anything is estimated.
    pub fn estimates(&self) -> bool {
        let of_all = Nuisance {
            left_out: None,
            ..*self
        };
        of_all.is_some()
    }

    /// Whether an entry counts.
    pub(super) fn counts(&self, p: usize, l: usize) -> bool {
        self.left_out.is_none_or(|flags| flags[(p, l)] == 0.0)
    }

    /// Whether a factor is known only roughly.
    pub(super) fn has_gains(&self) -> bool {
        self.frame_gain.is_some() || self.scale_error.is_some()
    }

    /// The patterns whose strength in each frame is unknown, pixels × patterns: 1 for a constant,
    /// then the others.
    pub(crate) fn of_frames(&self, pixels: usize) -> DMatrix<f64> {
        let ones = usize::from(self.frame_constant);
        let others = self.frame_patterns.map_or(0, DMatrix::ncols);
        DMatrix::from_fn(pixels, ones + others, |p, k| match self.frame_patterns {
            Some(patterns) if k >= ones => patterns[(p, k - ones)],
            _ => 1.0,
        })
    }

    /// The same of frame l with its glare last.
    pub(crate) fn of_frame(&self, of_frames: &DMatrix<f64>, l: usize) -> DMatrix<f64> {
        let Some(glare) = self.glare else {
            return of_frames.clone();
        };
        let at = of_frames.ncols();
        let mut own = of_frames.clone().insert_column(at, 0.0);
        own.set_column(at, &glare.column(l));
        own
    }
}

/// The estimated sizes; each is there if it was asked for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Estimated {
    /// b_l, W. Where a background is estimated too, the common level of all entries is counted
    /// here: Σ_p w_p a_p = 0.
    pub frame_constant: Option<DVector<f64>>,
    /// f_kl, patterns × spots, W per unit of the pattern.
    pub frame_patterns: Option<DMatrix<f64>>,
    /// a_p, W.
    pub background: Option<DVector<f64>>,
    /// g_l, W per unit of the pattern; zero for a frame whose pattern the other terms contain.
    pub glare: Option<DVector<f64>>,
    /// s, the unit of Φ per W.
    pub scale: Option<f64>,
    /// ε_l and ε.
    pub gains: Option<Gains>,
    /// Directions of Φ that all these take up, but for s and the factors 1 + ε: less than their
    /// numbers where some are the same, and where nothing counts.
    pub freedom: usize,
}

impl Estimated {
    /// Their light without the factor s, pixels × spots, W.
    pub(super) fn light(
        &self,
        nuisance: &Nuisance<'_>,
        pixels: usize,
        spots: usize,
    ) -> DMatrix<f64> {
        let entry =
            |values: &Option<DVector<f64>>, at: usize| values.as_ref().map_or(0.0, |v| v[at]);
        let own = DMatrix::from_fn(pixels, spots, |p, l| {
            let pattern = nuisance.glare.map_or(0.0, |pattern| pattern[(p, l)]);
            entry(&self.frame_constant, l)
                + entry(&self.background, p)
                + entry(&self.glare, l) * pattern
        });
        match (nuisance.frame_patterns, &self.frame_patterns) {
            (Some(patterns), Some(strengths)) => own + patterns * strengths,
            _ => own,
        }
    }
}
