//! Photographs against the scene as it would be with one size.

use crate::lab::geometry::normal::Normal;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::num::linalg::LinalgError;

use super::frames::{Frames, Seen, TermsOf, covariance_root};
use super::likelihood::Fit;

/// Lengths ℓ of the prior, parts of the largest distance between elements.
const PARTS: [f64; 4] = [0.0625, 0.125, 0.25, 0.5];
/// The one of the order's test.
const FIXED: f64 = 0.25;

/// Covariances of the prior that are tried.
pub(super) struct Lengths {
    /// K^½ of each.
    pub roots: Vec<Matrix>,
    /// ℓ of the order's test.
    pub fixed: f64,
}

impl Lengths {
    /// Of elements at `places`.
    pub(super) fn of(places: &[[f64; 3]]) -> Result<Self, LinalgError> {
        let side = |k: usize| {
            let ends = places
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| {
                    [a.min(x[k]), b.max(x[k])]
                });
            ends[1] - ends[0]
        };
        let extent = (0..3).map(|k| side(k) * side(k)).sum::<f64>().sqrt();
        // One element has no extent; whatever the length, its covariance is 1.
        let extent = if extent > 0.0 { extent } else { 1.0 };
        let roots = PARTS
            .iter()
            .map(|part| covariance_root(places, part * extent));
        Ok(Self {
            roots: roots.collect::<Result<_, _>>()?,
            fixed: FIXED * extent,
        })
    }
}

/// The photographs against the terms of the elements of `model`.
pub(super) fn frames_of(model: &MatrixModel, seen: Seen<'_>) -> Result<Frames, LinalgError> {
    let own: Vec<usize> = (0..model.albedo.len()).collect();
    Frames::new(seen, TermsOf::of(model, &own))
}

/// The fit to `all` photographs at the likeliest of these K^½, and that; none where there is no
/// light.
pub(super) fn likeliest_length<'a>(
    all: &Normal,
    roots: &'a [Matrix],
) -> Result<Option<(Fit, &'a Matrix)>, LinalgError> {
    let mut found: Option<(Fit, &Matrix)> = None;
    for root in roots {
        let Some(fit) = Fit::new(all, root)? else {
            continue;
        };
        if found
            .as_ref()
            .is_none_or(|(best, _)| fit.log_likelihood > best.log_likelihood)
        {
            found = Some((fit, root));
        }
    }
    Ok(found)
}

/// The fits at one size.
pub(super) struct Place {
    pub size: f64,
    /// To all frames, at the likeliest length.
    pub fit: Fit,
    /// To all frames but one each, at that length; empty unless asked for, and of fewer than 3.
    without: Vec<Fit>,
}

impl Place {
    /// The fits of `model` to the photographs, `each_out` also to all frames but one; none without
    /// light.
    pub(super) fn new(
        size: f64,
        model: &MatrixModel,
        seen: Seen<'_>,
        lengths: &Lengths,
        each_out: bool,
    ) -> Result<Option<Self>, LinalgError> {
        let frames = frames_of(model, seen)?;
        let Some((fit, root)) = likeliest_length(&frames.all(), &lengths.roots)? else {
            return Ok(None);
        };
        let mut without = Vec::new();
        if each_out && frames.each.len() > 2 {
            for rest in frames.all_but_one() {
                without.extend(Fit::new(&rest, root)?);
            }
        }
        Ok(Some(Self { size, fit, without }))
    }

    pub(super) fn log_likelihood(&self) -> f64 {
        self.fit.log_likelihood
    }
}

/// The index of the largest value.
pub(super) fn best(values: impl Iterator<Item = f64>) -> Option<usize> {
    let largest = values.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    largest.map(|(k, _)| k)
}

/// Where a likelihood is largest, and its error by the curvature.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peak {
    pub size: f64,
    pub stderr: f64,
}

/// The peak of the parabola through the largest of evenly spaced likelihoods and its neighbours;
/// none where that is the first or the last.
pub(super) fn parabola(places: &[Place], of: impl Fn(&Place) -> f64) -> Option<Peak> {
    let k = best(places.iter().map(&of))?;
    let [before, here, after] = [
        places.get(k.checked_sub(1)?)?,
        &places[k],
        places.get(k + 1)?,
    ];
    let step = 0.5 * (after.size - before.size);
    let [low, high] = [of(before) - of(here), of(after) - of(here)];
    let curvature = -(low + high);
    (curvature > 0.0).then(|| Peak {
        size: here.size + 0.5 * step * (high - low) / curvature,
        stderr: step / curvature.sqrt(),
    })
}

/// σ_J of the likeliest size; none of fewer than 3 frames, or where an end was reached without one.
pub(super) fn jackknife(places: &[Place]) -> Option<f64> {
    let frames = places.iter().map(|p| p.without.len()).min()?;
    let peak = |l: usize| parabola(places, |p| p.without[l].log_likelihood).map(|p| p.size);
    let sizes: Option<Vec<f64>> = (0..frames).map(peak).collect();
    jackknifed(&sizes?)
}

/// √((m − 1)/m Σ (t_l − t̄)²).
pub(super) fn jackknifed(values: &[f64]) -> Option<f64> {
    let m = values.len() as f64;
    if values.len() < 3 {
        return None;
    }
    let mean = values.iter().sum::<f64>() / m;
    let squares = values.iter().map(|t| (t - mean) * (t - mean)).sum::<f64>();
    Some(((m - 1.0) / m * squares).sqrt())
}
