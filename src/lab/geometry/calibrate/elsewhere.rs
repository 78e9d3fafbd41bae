//! Other places that explain the photographs.
//!
//! Spots and view on an axis of symmetry of the hidden surface make the same photographs of it
//! turned to the left as to the right, each with a picture of its own, and starts near one place
//! end there. So from the likeliest place one parameter at a time is moved farther and farther to
//! both sides of the scene, and to −θ_k, the others staying, at the noise of the first stage, where
//! valleys are wide, and at the last one; where the cost is less than beside, a search goes down
//! from that noise. Where it ends is not told from the likeliest place, at 1 %, where
//!
//! > ln p − ln p′ ≤ ½ χ²₁ · max(1, (σ′/σ)²),   χ²₁ = 6.63,
//!
//! σ the error of a parameter by the curvature, σ′ by what is left of frames and blocks.

use serde::Serialize;

use super::descent::{Problem, State};
use super::field::End;
use super::{Calibrated, CalibrationPlan, Stage};
use crate::lab::error::LabError;
use crate::lab::geometry::located::NOT_TOLD;
use crate::num::linalg::Cholesky;
use crate::transport::Control;

/// Values of a parameter to each side of the scene's, in typical sizes: valleys are as wide as they
/// are far apart.
pub(super) const STEPS: [f64; 10] = [1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 14.0, 20.0, 30.0, 45.0];
pub(super) const FARTHEST: f64 = STEPS[STEPS.len() - 1];
/// Parameters above which only the starts look for other places.
const MOST: usize = 12;
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
        if !problem.is_looked_around() {
            return Ok(ends);
        }
        // A field of errors is found from noise of single pixels on.
        let last = (!self.error_field).then_some(best.state.factor);
        let step = |(k, size): (usize, &f64)| self.spread * problem.priors[k].unwrap_or(*size);
        let steps: Vec<f64> = sizes.iter().enumerate().take(count).map(step).collect();
        // A whole turn leads to the same place.
        let is_near = |end: &End| {
            let pairs = end.state.values.iter().zip(&best.state.values);
            let mut each = pairs.zip(&steps);
            each.all(|((a, b), step)| (a - b).abs() <= 2.0 * FARTHEST * step)
        };
        for noise in [Some(problem.first), last].into_iter().flatten() {
            for (k, &step) in steps.iter().enumerate() {
                for start in problem.valleys((&best.state, noise), k, step, control)? {
                    match self.other_end(problem, (&start, noise), best, control) {
                        Ok(Some(end)) => {
                            let is_same = |other: &End| problem.are_same(other, &end);
                            if is_near(&end) && !ends.iter().any(is_same) {
                                ends.push(end);
                            }
                        }
                        Err(LabError::Stopped(stopped)) => return Err(stopped.into()),
                        // Where there is no light there is no place.
                        _ => {}
                    }
                }
            }
        }
        Ok(ends)
    }

    /// Where a search from `start` at such a noise ends; none where that is where `best` is.
    fn other_end(
        &self,
        problem: &Problem<'_>,
        (start, noise): (&[f64], f64),
        best: &End,
        control: Control<'_>,
    ) -> Result<Option<End>, LabError> {
        let (first, _) = problem.stage(start, noise, control)?;
        let errors = problem.errors(&first)?;
        let same = |stage: &Stage| {
            stage.noise == noise && gap(&stage.values, &first.values, &errors) < SAME
        };
        if best.stages.iter().any(same) {
            return Ok(None);
        }
        let end = End {
            is_of_start: false,
            ..self.end(problem, &first.values, noise, control)?
        };
        Ok((!problem.are_same(best, &end)).then_some(end))
    }
}

impl Problem<'_> {
    /// Whether other places and sizes are looked for: past what stands in the way, and of many
    /// parameters, that takes several times as long as all starts.
    pub(super) fn is_looked_around(&self) -> bool {
        self.geometry.parameters.len() <= MOST && !self.geometry.is_obstructed()
    }

    /// The unknowns where, along parameter `k` alone, the cost is less than at the values beside,
    /// but for those of `best`.
    fn valleys(
        &self,
        (best, noise): (&State, f64),
        k: usize,
        step: f64,
        control: Control<'_>,
    ) -> Result<Vec<Vec<f64>>, LabError> {
        let own = best.values[k];
        let sides = STEPS.iter().flat_map(|far| [far * step, -far * step]);
        let mut places: Vec<f64> = sides.chain([0.0, own, -own]).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let at = |place: f64| {
            let mut values = best.values.clone();
            values[k] = place;
            values
        };
        let cost = |place: &f64| match self.cost(&at(*place), noise, &best.prior) {
            Err(LabError::Stopped(stopped)) => Err(LabError::from(stopped)),
            // Where there is no light there is no place.
            found => control
                .check()
                .map_err(LabError::from)
                .map(|()| found.ok().flatten()),
        };
        let costs = places.iter().map(cost);
        let costs: Vec<Option<f64>> = costs.collect::<Result<_, _>>()?;
        let costs: Vec<f64> = costs.iter().map(|c| c.unwrap_or(f64::INFINITY)).collect();
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
        let variances = information.inverse().diagonal();
        Ok(variances.iter().map(|v| v.sqrt()).collect())
    }

    /// Whether two ends are one place, by the errors of the first.
    fn are_same(&self, a: &End, b: &End) -> bool {
        let errors = self.errors(&a.state);
        errors.is_ok_and(|errors| gap(&a.state.values, &b.state.values, &errors) < APART)
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
