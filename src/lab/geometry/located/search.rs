//! Peaks of the likelihood over the sizes of what is looked for.
//!
//! Evenly spaced sizes show in which stretches the likelihood has a peak, and finer ones find it.
//! Another peak is not told from the likeliest, at 1 %, where
//!
//! > ln p − ln p′ ≤ ½ χ²₁ · max(1, (σ_J/σ_L)²),   χ²₁ = 6.63,
//!
//! σ_J the error by leaving frames out, σ_L that by the curvature: where what is not explained is
//! no independent noise, logarithms of likelihoods say too much by the square of their ratio.

use super::place::{self, Peak, Place};
use crate::lab::error::LabError;

/// Sizes of the second search, ± 1½ steps of the first, and of each further one, until a step is no
/// more than the error by the curvature: the parabola is the likelihood's within its width only.
pub(super) const FINE: usize = 9;
const AROUND: f64 = 1.5;
/// Searches at most: the last step is 1e-5 of the first.
const SEARCHES: usize = 12;
/// Peaks that are looked at, at most.
const MOST_PEAKS: usize = 4;
/// ½ χ² of one degree of freedom that chance exceeds in 1 of 100.
pub(in crate::lab::geometry) const NOT_TOLD: f64 = 0.5 * 6.634_896_601;

/// The fits at so many sizes evenly between two, each without each frame too if asked for.
type Places<'a> = dyn Fn([f64; 2], usize, bool) -> Result<Vec<Place>, LabError> + 'a;

/// What is looked for between two sizes.
pub(super) struct Search<'a> {
    pub range: [f64; 2],
    /// Of the sizes tried first.
    pub step: f64,
    pub places: &'a Places<'a>,
}

/// The search about one peak.
pub(super) struct Stretch {
    pub searches: Vec<Vec<Place>>,
    /// None where the likelihood grows up to an end of the range.
    pub peak: Option<Peak>,
    /// Of the last search but one.
    pub step: f64,
}

impl Stretch {
    /// The likeliest size tried.
    fn likeliest(&self) -> Option<&Place> {
        let all = self.searches.iter().flatten();
        all.max_by(|a, b| a.log_likelihood().total_cmp(&b.log_likelihood()))
    }
}

impl Search<'_> {
    /// About the likeliest peak, and the likeliest place of each other one.
    ///
    /// # Errors
    /// [`LabError`]: no light, or it was stopped.
    pub(super) fn likeliest(&self, coarse: &[Place]) -> Result<(Stretch, Vec<Place>), LabError> {
        let tops = tops(coarse);
        let mut first = *tops.first().ok_or(LabError::DARK)?;
        let mut others = Vec::new();
        if tops.len() > 1 {
            let mut rough = Vec::new();
            for &k in &tops {
                rough.push((k, self.about(coarse[k].size, false)?));
            }
            let height = |of: &Stretch| of.likeliest().map(Place::log_likelihood);
            let heights = rough.iter().map(|(_, of)| height(of));
            let best = place::best(heights.map(|h| h.unwrap_or(f64::NEG_INFINITY)));
            first = rough[best.ok_or(LabError::DARK)?].0;
            rough.retain(|(k, _)| *k != first);
            let all = rough.into_iter().map(|(_, of)| of.searches);
            let top = |a: Place, b: Place| {
                if b.log_likelihood() > a.log_likelihood() {
                    b
                } else {
                    a
                }
            };
            others.extend(all.filter_map(|of| of.into_iter().flatten().reduce(top)));
        }
        let found = self.about(coarse[first].size, true)?;
        let own = found.likeliest().map_or(f64::NAN, |at| at.size);
        others.retain(|at| (at.size - own).abs() > self.step);
        Ok((found, others))
    }

    /// Finer and finer about a size.
    fn about(&self, mut middle: f64, each_out: bool) -> Result<Stretch, LabError> {
        let mut step = self.step;
        let mut searches: Vec<Vec<Place>> = Vec::new();
        loop {
            let around = [middle - AROUND * step, middle + AROUND * step];
            let within = around.map(|t| t.clamp(self.range[0], self.range[1]));
            let fine = (self.places)(within, FINE, each_out)?;
            let at = place::best(fine.iter().map(Place::log_likelihood)).ok_or(LabError::DARK)?;
            let peak = place::parabola(&fine, Place::log_likelihood);
            let own = (within[1] - within[0]) / (FINE - 1) as f64;
            let is_fine = peak.is_some_and(|peak| own <= peak.stderr);
            middle = fine[at].size;
            searches.push(fine);
            // At an end of the range there is no peak.
            let is_end = self.range.contains(&middle);
            if is_fine || is_end || searches.len() == SEARCHES {
                return Ok(Stretch {
                    searches,
                    peak,
                    step,
                });
            }
            // Where the likeliest is the last of these, those beyond it are next.
            step = peak.map_or(step, |_| own);
        }
    }
}

/// Those of `others` that are not told from the likeliest, of errors σ_L and σ_J where known.
pub(super) fn not_told(
    likeliest: f64,
    others: &[Place],
    errors: [Option<f64>; 2],
) -> impl Iterator<Item = &Place> {
    let most = NOT_TOLD * scatter(errors);
    others
        .iter()
        .filter(move |at| likeliest - at.log_likelihood() <= most)
}

/// max(1, (σ_J/σ_L)²) of σ_L and σ_J; 1 where one is not known.
pub(super) fn scatter(errors: [Option<f64>; 2]) -> f64 {
    let ratio = match errors {
        [Some(curvature), Some(frames)] => (frames / curvature).max(1.0),
        _ => 1.0,
    };
    ratio * ratio
}

/// Those of evenly spaced sizes that are likelier than their neighbours, likeliest first.
fn tops(coarse: &[Place]) -> Vec<usize> {
    let of = |k: usize| coarse[k].log_likelihood();
    let is_top = |k: &usize| {
        let before = k.checked_sub(1).is_none_or(|b| of(b) < of(*k));
        before && (k + 1 == coarse.len() || of(k + 1) <= of(*k))
    };
    let mut tops: Vec<usize> = (0..coarse.len()).filter(is_top).collect();
    tops.sort_by(|a, b| of(*b).total_cmp(&of(*a)));
    tops.truncate(MOST_PEAKS);
    tops
}
