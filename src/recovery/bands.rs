//! Bands around recovered reflectances, and how often they cover.
//!
//! Linear estimates have ρ̂ ± z σ, each element alone. Estimates between bounds have no such law:
//! the χ² that an element costs where it is held at its true value follows χ² of one degree of
//! freedom only where no bound is near. A light element among eight dark ones, at the levels 1 and
//! 0 on the bench, is then covered by 95 % bands in 59 seeds of 100 (400 seeds; χ² of two degrees:
//! 79; quantiles by a bootstrap from ρ̂ do little better), because the columns of its neighbours
//! surround its own.
//!
//! So the bands of `joint` and `nnls` are the shadows of one region that holds all elements at
//! once: [`BandKind::Simultaneous`].
//!
//! The region promises no more than it must: in that case it covers in 95 seeds of 100.
//!
//! Regularised methods are biased by far more than their noise, and their bias is not known without
//! the truth: ρ̂ ± z σ of `tsvd` covered 0.8 % where it said 95 %. They have no bands.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Method, Options, Problem, RecoveryError, Setting, WeightRule};
use crate::num::control::{Control, Steps};
use crate::num::linalg::{rows_times, svd};
use crate::num::quadratic::{Bounds, Extents, box_least_squares};
use crate::num::statistics::{chi_square_quantile, sidak_threshold};

/// What a band is, and so what it promises of each element taken alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum BandKind {
    /// ρ̂ ± z σ of an unbiased linear estimate: covers with exactly its confidence under normal
    /// noise of the stated standard errors. With a scale that is known roughly as many deviations
    /// to both sides of what ρ̂ would be of ρ, which is no symmetric interval (Fieller 1954).
    Gaussian,
    /// The probability of ρ_j given the photographs and the method's assumption, as much beyond
    /// either limit: covers as often as it says **on average over pictures as the assumption
    /// describes them**, not for every picture.
    Posterior,
    /// The values of ρ_j among all reflectances within the bounds that are as near to the data as
    /// the truth is with the stated probability,
    ///
    /// > { ρ_j : l ≤ ρ ≤ u, ‖R ρ − d‖² ≤ q },   P(χ²_k ≤ q) = confidence,
    ///
    /// d the k directions of the data, in standard deviations, that reflectances between 0 and 1
    /// can move by more than one (Stark 1992). For any ρ within the bounds and normal noise of the
    /// stated errors **all elements together** are covered with at least that probability, so each
    /// alone is covered more often: how much more depends on the object. Limits are certified from
    /// outside: an inexact solver makes a band wider.
    Simultaneous,
}

/// An interval for each element.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bands {
    /// Probability that each alone covers, or all together, by `kind`.
    pub confidence: f64,
    /// \[lower, upper\] of each element.
    pub intervals: Vec<[f64; 2]>,
    /// What they are.
    pub kind: BandKind,
}

impl Bands {
    /// Why photographs that nothing explains have no bands: what the truth is not in.
    pub const REFUTED: &str = "has no bands: no reflectances within its bounds explain the photographs at this confidence";

    /// How many elements' `truth` lies within its interval. Elements beyond either list are not
    /// counted.
    pub fn covered(&self, truth: &[f64]) -> usize {
        let within = |([lower, upper], x): (&[f64; 2], &f64)| lower <= x && x <= upper;
        self.intervals
            .iter()
            .zip(truth)
            .filter(|&pair| within(pair))
            .count()
    }
}

/// The z with P(|N(0, 1)| ≤ z) = confidence.
fn deviate(confidence: f64) -> f64 {
    sidak_threshold(1.0 - confidence, 1)
}

/// Why methods without an error of their own have none.
const ASSUMED: &str = "has no bands: what its assumption adds is not known from the data";

/// Refuses a confidence without meaning.
pub(super) fn allowed(method: Method, confidence: f64) -> Result<(), RecoveryError> {
    if !(confidence > 0.0 && confidence < 1.0) {
        return Err(RecoveryError::BadParameter {
            method,
            name: "the confidence level of bands",
            value: confidence,
            cure: "give a probability between 0 and 1, e.g. 0.95",
        });
    }
    Ok(())
}

/// Why `method` never has bands, if so.
pub(super) fn never(method: Method) -> Option<&'static str> {
    (!Setting::Bands.means_something_to(method)).then_some(ASSUMED)
}

/// The refusal of bands without a noise model.
pub(super) fn without_noise(method: Method) -> RecoveryError {
    RecoveryError::NotForMethod {
        method,
        what: "needs to know the noise for its bands",
        cure: "give the standard error of phi (phi.stderr.npy)",
    }
}

/// `estimate` ± z σ.
pub(super) fn gaussian(estimate: &DVector<f64>, sigma: &DVector<f64>, confidence: f64) -> Bands {
    let z = deviate(confidence);
    let pairs = estimate.iter().zip(sigma.iter());
    Bands {
        confidence,
        intervals: pairs.map(|(x, s)| [x - z * s, x + z * s]).collect(),
        kind: BandKind::Gaussian,
    }
}

/// The same of (1 + ε) ρ, ε ~ N(0, S²), the errors `sigma` holding S about the estimate: with σ² =
/// `sigma`² − S² ρ̂² the ρ that
///
/// > (ρ̂ − ρ)² ≤ z² (σ² + S² ρ²),   ρ = (ρ̂ ± z √(S² ρ̂² + (1 − z² S²) σ²))/(1 − z² S²),
///
/// or why there are none: with z S ≥ 1 light of any size is as little as a factor near 0 may leave.
pub(super) fn scaled(
    (estimate, sigma): (&DVector<f64>, &DVector<f64>),
    known_to: f64,
    confidence: f64,
) -> Result<Bands, &'static str> {
    let z = deviate(confidence);
    let left = 1.0 - (z * known_to).powi(2);
    if left <= 0.0 {
        return Err(OPEN);
    }
    let pairs = estimate.iter().zip(sigma.iter());
    let ends = |(x, s): (&f64, &f64)| {
        let of_scale = (known_to * x).powi(2);
        let own = (s * s - of_scale).max(0.0);
        let room = z * (of_scale + left * own).sqrt();
        [(x - room) / left, (x + room) / left]
    };
    Ok(Bands {
        confidence,
        intervals: pairs.map(ends).collect(),
        kind: BandKind::Gaussian,
    })
}

/// What [`simultaneous`] needs: residuals in standard deviations.
pub(super) fn simultaneous_allowed<'a>(
    method: Method,
    problem: &Problem<'a>,
    options: &Options,
) -> Result<&'a DMatrix<f64>, RecoveryError> {
    let stderr = problem.noise().ok_or(without_noise(method))?;
    if options.weighting == WeightRule::Unweighted {
        return Err(RecoveryError::NotForMethod {
            method,
            what: "has bands only where entries are weighted by their noise",
            cure: "leave the weighting to the noise",
        });
    }
    Ok(stderr)
}

/// Why a computation that was stopped has none.
const STOPPED: &str = "has no bands: it was stopped before they were found";
/// Why an estimate between bounds has none that is known up to a factor.
pub(super) const UNSCALED: &str = "has no bands with a free scale: the picture is relative to its brightest \
                        element, whose own error they would leave out";
/// Why an estimate whose scale is known too roughly has none.
const OPEN: &str = "has no bands: of a scale known so roughly there is no upper end at this confidence; \
                    measure the scale, or ask for bands of less confidence";
/// Why a biased estimate has none.
pub(super) const BIASED: &str = "has no bands: regularisation, dropped directions or a free scale bias the picture \
                                 by an amount that the photographs do not tell";

/// The shadows of { l ≤ x ≤ u, ‖R x − d‖² ≤ q } on each axis, the covariance of d being the unit
/// matrix; where there is nothing in it, why.
pub(super) fn simultaneous(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    bounds: &Bounds,
    confidence: f64,
    control: Control<'_>,
) -> Result<Result<Bands, &'static str>, RecoveryError> {
    let decomposed = svd(r)?;
    let rows = rows_times(decomposed.vt, &decomposed.sigma);
    let data = decomposed.u.tr_mul(d);
    // Which directions count is a matter of R alone: any choice of them keeps the promise.
    let seen: Vec<usize> = (0..rows.nrows())
        .filter(|&i| rows.row(i).iter().map(|x| x.abs()).sum::<f64>() > 1.0)
        .collect();
    let (rows, data) = (rows.select_rows(&seen), data.select_rows(&seen));
    // An element below rounding can have any value, and changes no other.
    let rounding = f64::EPSILON * r.nrows().max(r.ncols()) as f64 * decomposed.sigma.amax();
    let lit: Vec<usize> = (0..r.ncols())
        .filter(|&j| rows.column(j).norm() > rounding)
        .collect();
    let whole = bounds.lower.iter().zip(&bounds.upper);
    let mut intervals: Vec<[f64; 2]> = whole.map(|(lower, upper)| [*lower, *upper]).collect();
    if !lit.is_empty() {
        let rows = rows.select_columns(&lit);
        let bounds = &Bounds {
            lower: bounds.lower.select_rows(&lit),
            upper: bounds.upper.select_rows(&lit),
        };
        let best = box_least_squares(&rows, &data, bounds)?;
        let room = chi_square_quantile(confidence, seen.len() as f64) - 2.0 * best.objective;
        if room < 0.0 {
            return Ok(Err(Bands::REFUTED));
        }
        let extents = Extents::new(&rows, &data, bounds, &best.solution, room)?;
        let steps = Steps::new(control, 90, lit.len());
        let each = (0..lit.len()).into_par_iter();
        let of = |j| {
            let goes_on = steps.done().is_ok();
            goes_on.then(|| extents.of(j)).transpose()
        };
        let Some(found) = each.map(of).collect::<Result<Option<Vec<_>>, _>>()? else {
            return Ok(Err(STOPPED));
        };
        for (j, found) in lit.into_iter().zip(found) {
            intervals[j] = found;
        }
    }
    Ok(Ok(Bands {
        confidence,
        intervals,
        kind: BandKind::Simultaneous,
    }))
}

#[cfg(test)]
mod tests;
