//! Light that a model leaves out and that would explain what is left over.

use std::ops::Range;

use serde::Serialize;

use super::evidence::FIT_LEVEL;
use crate::matrix::Matrix;
use crate::num::digits::figure;
use crate::num::linalg::Cholesky;

/// What of a pattern must be left by other light, picture and geometry, over all of it.
const LEFT: f64 = 1e-6;
/// More than this share of a misfit is most of it.
const MOST: f64 = 0.5;

/// The patterns of [`over_view`](super::over_view::over_view), of the light that is found.
const KINDS: [(&str, &str, Range<usize>); 2] = [
    (
        "light that all frames share (even, or a slope over the view)",
        "estimate it (--background, --frame-polynomial), or take dark frames",
        0..3,
    ),
    (
        "a falloff of the camera over its view",
        "divide by a flat field",
        3..6,
    ),
];

/// Patterns that would explain what is left over.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LightLeftOut {
    /// What they are.
    pub what: &'static str,
    /// What helps against it.
    #[serde(skip)]
    pub cure: &'static str,
    /// gᵀF⁻¹g.
    pub chi2: f64,
    /// How many of them the photographs tell from picture and geometry.
    pub directions: usize,
    /// Probability of as large a sum by noise alone.
    pub p: f64,
}

impl LightLeftOut {
    /// Of each kind, by F and g of the patterns, in units of the noise, the squares of the patterns
    /// before anything took a part of them, and the probability of χ² of so many directions.
    pub(super) fn of(
        (f, score, whole): (&Matrix, &Matrix, &[f64]),
        by_noise: impl Fn(f64, f64) -> f64,
    ) -> Vec<Self> {
        let of = |(what, cure, kind): &(&'static str, &'static str, Range<usize>)| {
            let told = kind.clone().filter(|k| f[(*k, *k)] > LEFT * whole[*k]);
            let told: Vec<usize> = told.collect();
            let own = f.select_rows(&told).select_columns(&told);
            let factor = Cholesky::new(&own).filter(|_| !told.is_empty())?;
            let chi2 = factor.forward(score.select_rows(&told)).norm_squared();
            let directions = told.len();
            Some(Self {
                what,
                cure,
                chi2,
                directions,
                p: by_noise(chi2, directions as f64),
            })
        };
        KINDS.iter().filter_map(of).collect()
    }

    /// Of kinds that explain much the likeliest and what is hardly less so, and only what explains
    /// most of a `misfit`, χ² beyond that of noise: anything explains a little of one.
    pub(super) fn likely(all: &[Self], misfit: f64) -> impl Iterator<Item = &Self> {
        let most = all.iter().map(|light| light.chi2).fold(misfit, f64::max);
        all.iter()
            .filter(move |light| light.p < FIT_LEVEL && light.chi2 > MOST * most)
    }

    /// What is said of it where `found` was found without.
    pub(super) fn beware(&self, found: &str) -> String {
        format!(
            "Beware: {} would explain what is left over better than the {found} that was found does (χ² {} of {} \
             directions, P {}): the {found} takes it up, and may be OFF BY MANY OF ITS ERRORS. If there may be \
             such light, {}; else something is wrong that is not free.",
            self.what,
            figure(self.chi2, 3),
            self.directions,
            figure(self.p, 1),
            self.cure
        )
    }
}
