//! What the photographs say of elements that differ from two levels.
//!
//! Where each element differs from its level by a normal deviate of its own variance S_j,
//!
//! > x = ℓ + √S n,   n ~ N(0, 1),   d ~ N(R ℓ, L Lᵀ),   L Lᵀ = 1 + R S Rᵀ,
//!
//! ℓ the levels of a pattern, W = L⁻¹R and L⁻¹d are again those of two levels, the evidence is less
//! by ln det L, and given ℓ
//!
//! > x ~ N(ℓ + S Wᵀ L⁻¹(d − Rℓ), S − S WᵀW S).

use nalgebra::{DMatrix, DVector};

use super::fields::{self, Fields};
use super::levels::{LevelFit, possible};
use super::pattern_likelihood::PatternLikelihood;
use super::pattern_sums::Summed;
use crate::num::linalg::{columns_times, rows_times, svd};
use crate::num::stream::{Key, Sampling, Stream};
use crate::recovery::RecoveryError;

/// Patterns that are drawn for one of these.
pub(super) const DRAWS: usize = 16_000;
/// Patterns with their levels that are drawn from all that were met, and tries to draw possible
/// levels.
const DRAWN: usize = 200;
const TRIES: usize = 100;

/// Photographs by the noise that elements add to theirs.
pub(super) struct Whitened {
    /// S.
    variances: DVector<f64>,
    /// W and L⁻¹d, along some axes.
    r: DMatrix<f64>,
    d: DVector<f64>,
    /// ln det L, and half the square of what is beside these axes.
    less: f64,
}

impl Whitened {
    /// S positive in all elements: with R √S = U Σ Vᵀ along U, where L is √(1 + Σ²).
    pub(super) fn new(
        likelihood: &PatternLikelihood<'_>,
        variances: DVector<f64>,
    ) -> Result<Self, RecoveryError> {
        let root = variances.map(f64::sqrt);
        let axes = svd(&columns_times(likelihood.r.clone(), root.as_slice()))?;
        let s = &axes.sigma;
        let excess = s.map(|s| 1.0 + s * s);
        let along = axes.u.tr_mul(likelihood.d);
        let beside = (likelihood.d - &axes.u * &along).norm_squared();
        let scale = s.zip_map(&excess, |s, e| s / e.sqrt());
        let inverse: Vec<f64> = root.iter().map(|root| root.recip()).collect();
        let log_det: f64 = excess.iter().map(|e| libm::log(*e)).sum();
        Ok(Self {
            variances,
            r: columns_times(rows_times(axes.vt, scale.as_slice()), &inverse),
            d: along.zip_map(&excess, |d, e| d / e.sqrt()),
            less: 0.5 * (log_det + beside),
        })
    }

    /// Of one element alone, L⁻¹ = 1 − (1 − 1/√e) r rᵀ/‖r‖², e = 1 + S ‖r‖²; none where it is not
    /// seen.
    pub(super) fn of_one(
        likelihood: &PatternLikelihood<'_>,
        (element, variance): (usize, f64),
    ) -> Option<Self> {
        let column = likelihood.r.column(element);
        let length = column.norm();
        let excess = 1.0 + variance * length * length;
        let unit = (length > 0.0).then(|| column / length)?;
        let less = 1.0 - excess.sqrt().recip();
        let mut variances = DVector::zeros(likelihood.r.ncols());
        variances[element] = variance;
        Some(Self {
            variances,
            r: likelihood.r - &unit * (unit.tr_mul(likelihood.r) * less),
            d: likelihood.d - &unit * (unit.dot(likelihood.d) * less),
            less: 0.5 * libm::log(excess),
        })
    }

    /// Two levels by this noise.
    pub(super) fn likelihood<'a>(&'a self, of: &PatternLikelihood<'a>) -> PatternLikelihood<'a> {
        PatternLikelihood {
            control: of.control,
            ..PatternLikelihood::new(&self.r, &self.d, None)
        }
    }

    /// By how much the evidence is less than of these photographs without more noise.
    pub(super) fn less(&self) -> f64 {
        self.less
    }
}

/// What one S says.
pub(super) struct Part {
    pub(super) summed: Summed,
    pub(super) log_evidence: f64,
    /// E (x_j − shown_j)².
    pub(super) square: DVector<f64>,
}

impl Part {
    /// Of a picture of this pattern and values; none where no pattern is possible.
    pub(super) fn new(
        likelihood: &PatternLikelihood<'_>,
        sizes: &[Fields],
        white: &Whitened,
        (light, shown): (&[bool], &DVector<f64>),
    ) -> Result<Option<Self>, RecoveryError> {
        let own = white.likelihood(likelihood);
        let Some(summed) = fields::sum(&own, sizes, &[light.to_vec()], (DRAWS, None))? else {
            return Ok(None);
        };
        let told =
            DVector::from_iterator(light.len(), white.r.column_iter().map(|w| w.norm_squared()));
        let left = |s: f64, told: f64| s * (1.0 - s * told).max(0.0);
        let mut square = white.variances.zip_map(&told, left);
        let drawn = draw(&summed, &own);
        let each = 1.0 / drawn.len() as f64;
        for (light, levels) in drawn {
            let level = DVector::from_fn(light.len(), |j, _| levels[usize::from(light[j])]);
            let moved = white.r.tr_mul(&(&white.d - &white.r * &level));
            let mean = level + moved.component_mul(&white.variances);
            square += (mean - shown).map(|off| off * off * each);
        }
        Ok(Some(Self {
            log_evidence: summed.log_evidence - white.less,
            summed,
            square,
        }))
    }
}

/// Some patterns in proportion to their weights, with levels of each as likely as they are.
pub(super) fn draw<'a>(
    summed: &'a Summed,
    likelihood: &PatternLikelihood<'_>,
) -> Vec<(&'a Vec<bool>, [f64; 2])> {
    let key = Key {
        seed: 3,
        spot: 0,
        pixel: 0,
        block: 0,
    };
    let random = &mut Stream::new(Sampling::Pcg, key);
    let patterns = &summed.patterns;
    let step = patterns.moments.weight / DRAWN as f64;
    let mut next = random.uniform() * step;
    let mut drawn = Vec::with_capacity(DRAWN);
    for (light, weight) in patterns.in_order() {
        next -= weight;
        while next < 0.0 {
            drawn.extend(levels(likelihood, light, random).map(|levels| (light, levels)));
            next += step;
        }
    }
    drawn
}

/// Levels of a pattern, as likely as they are.
fn levels(
    likelihood: &PatternLikelihood<'_>,
    light: &[bool],
    random: &mut Stream,
) -> Option<[f64; 2]> {
    if likelihood.given.is_some() {
        return likelihood.given;
    }
    let lit = likelihood.lit(light);
    let fit = LevelFit::new(likelihood.d, &(&likelihood.all - &lit), &lit)?;
    let mut tries = (0..TRIES).map(|_| fit.draw([random.normal(), random.normal()]));
    tries.find(|levels| possible(*levels))
}
