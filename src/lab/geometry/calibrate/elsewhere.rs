//! Other places that explain the photographs.
//!
//! Spots and view on an axis of symmetry of the hidden surface make the same photographs of it
//! turned to the left as to the right, each with a picture of its own, and starts near one place
//! end there. So from the likeliest place one parameter at a time is moved over evenly spaced values
//! and to −θ_k, the others staying, at the noise of the first stage, where valleys are wide, and at
//! the last one; where the cost is less than beside, a search goes down from that noise. Where it
//! ends is not told from the likeliest place, at 1 %, where
//!
//! > ln p − ln p′ ≤ ½ χ²₁ · max(1, (σ′/σ)²),   χ²₁ = 6.63,
//!
//! σ the error of a parameter by the curvature, σ′ by what is left of frames and blocks.

use serde::Serialize;

use super::descent::{Problem, State};
use super::field::End;
use super::{Calibrated, CalibrationPlan};
use crate::lab::error::LabError;
use crate::lab::geometry::located::NOT_TOLD;
use crate::num::linalg::Cholesky;
use crate::transport::Control;

/// Values of a parameter to each side of the scene's, and typical sizes from one to the next.
pub(super) const SIDE: i32 = 6;
/// Parameters above which only the starts look for other places.
pub(super) const MOST: usize = 12;
/// Standard errors of a parameter between what the searches at one noise lead to, below which they
/// go on alike.
const SAME: f64 = 0.1;
/// Standard errors of a parameter between two places.
pub(super) const APART: f64 = 3.0;

/// A place that the photographs do not tell from the likeliest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Elsewhere {
    /// The unknowns there.
    pub values: Vec<f64>,
    /// ln of how much less likely the photographs are.
    pub less_likely: f64,
}

impl CalibrationPlan {
    /// Ends of searches from where the cost has a least value away from `best`.
    ///
    /// # Errors
    /// [`LabError`]: no light, or it was stopped.
    pub(super) fn other_places(
        &self,
        problem: &Problem<'_>,
        best: &End,
        sizes: &[f64],
        control: Control<'_>,
    ) -> Result<Vec<End>, LabError> {
        let count = problem.geometry.parameters.len();
        let mut ends: Vec<End> = Vec::new();
        if count > MOST {
            return Ok(ends);
        }
        let errors = problem.errors(&best.state)?;
        for (k, size) in sizes.iter().enumerate().take(count) {
            let step = self.spread * problem.priors[k].unwrap_or(*size);
            for noise in [problem.first, best.state.factor] {
                for start in problem.valleys((&best.state, noise), k, step, control)? {
                    let (first, _) = problem.stage(&start, noise, control)?;
                    let mut passed = best.stages.iter();
                    let errors_there = problem.errors(&first)?;
                    let is_passed =
                        |values: &[f64]| gap(values, &first.values, &errors_there) < SAME;
                    if passed.any(|stage| stage.noise == noise && is_passed(&stage.values)) {
                        continue;
                    }
                    let end = self.end(problem, &first.values, noise, control)?;
                    let is_known =
                        |other: &End| gap(&other.state.values, &end.state.values, &errors) < APART;
                    if !ends.iter().chain([best]).any(is_known) {
                        ends.push(End {
                            is_of_start: false,
                            ..end
                        });
                    }
                }
            }
        }
        Ok(ends)
    }
}

impl Problem<'_> {
    /// The unknowns where, along parameter `k` alone, the cost is less than at the values beside and
    /// that are not those of `best`.
    fn valleys(
        &self,
        (best, noise): (&State, f64),
        k: usize,
        step: f64,
        control: Control<'_>,
    ) -> Result<Vec<Vec<f64>>, LabError> {
        let own = best.values[k];
        let mut places: Vec<f64> = (-SIDE..=SIDE).map(|j| f64::from(j) * step).collect();
        places.extend([own, -own]);
        places.sort_by(f64::total_cmp);
        places.dedup();
        let at = |place: f64| {
            let mut values = best.values.clone();
            values[k] = place;
            values
        };
        let mut costs = Vec::new();
        for place in &places {
            control.check()?;
            costs.push(
                self.cost(&at(*place), noise, &best.prior)?
                    .unwrap_or(f64::INFINITY),
            );
        }
        let is_least = |j: &usize| {
            let before = j.checked_sub(1).is_none_or(|b| costs[*j] < costs[b]);
            let after = costs.get(j + 1).is_none_or(|c| costs[*j] <= *c);
            costs[*j].is_finite() && before && after && places[*j] != own
        };
        Ok((0..places.len())
            .filter(is_least)
            .map(|j| at(places[j]))
            .collect())
    }

    /// Standard errors of the unknowns by the curvature.
    fn errors(&self, state: &State) -> Result<Vec<f64>, LabError> {
        let information = Cholesky::new(&self.information(&state.slope)).ok_or(LabError::DARK)?;
        Ok(information
            .inverse()
            .diagonal()
            .iter()
            .map(|v| v.sqrt())
            .collect())
    }
}

/// The largest difference of an unknown, over its error.
fn gap(a: &[f64], b: &[f64], errors: &[f64]) -> f64 {
    let each = a
        .iter()
        .zip(b)
        .zip(errors)
        .map(|((a, b), error)| (a - b).abs() / error);
    each.fold(0.0, f64::max)
}

/// max(1, (σ′/σ)²), the largest of all parameters.
pub(super) fn scatter(found: &[Calibrated]) -> f64 {
    let ratio = |f: &Calibrated| {
        let by_left = f.by_frames.into_iter().chain(f.by_blocks);
        by_left.fold(0.0, f64::max) / f.by_curvature
    };
    let ratio = found.iter().map(ratio).fold(1.0, f64::max);
    ratio * ratio
}

/// Those of `ends`, the likeliest first, that are not told from that.
pub(super) fn not_told(ends: &[End], found: &[Calibrated]) -> Vec<Elsewhere> {
    let most = NOT_TOLD * scatter(found);
    let errors: Vec<f64> = found.iter().map(|f| f.stderr).collect();
    let mut known = vec![&ends[0].state.values];
    let mut told = Vec::new();
    for end in &ends[1..] {
        let less_likely = end.total - ends[0].total;
        let values = &end.state.values;
        let is_apart = known
            .iter()
            .all(|other| gap(values, other, &errors) > APART);
        if end.state.is_settled && is_apart && less_likely <= most {
            known.push(values);
            told.push(Elsewhere {
                values: values.clone(),
                less_likely,
            });
        }
    }
    told
}
