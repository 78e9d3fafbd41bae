//! How the likelihood falls from its top along one unknown, the others following.

use nalgebra::DVector;
use serde::Serialize;

use super::descent::{Problem, State};
use crate::lab::error::LabError;
use crate::matrix::Matrix;
use crate::num::linalg::Cholesky;

/// Distances from the top, standard errors by the curvature.
const PLACES: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];
/// Parameters above which there are no profiles: each takes eight models.
const MOST: usize = 12;

/// ln p(Φ) less its largest, along one unknown.
#[derive(Clone, Debug, Serialize)]
pub struct Profile {
    /// Value of the unknown and the likelihood there, by growing value; none where the scene does
    /// not allow it.
    pub points: Vec<(f64, f64)>,
    /// How far below and above the top it has fallen by ½.
    pub reach: [f64; 2],
}

impl Profile {
    /// The larger reach.
    pub fn stderr(&self) -> f64 {
        self.reach[0].max(self.reach[1])
    }
}

/// Of unknown `k`; none of a gain, and of many parameters.
pub(super) fn profile(
    problem: &Problem<'_>,
    best: &State,
    covariance: &Matrix,
    k: usize,
) -> Result<Option<Profile>, LabError> {
    let count = problem.geometry.parameters.len();
    if count > MOST || k >= count {
        return Ok(None);
    }
    let sigma = covariance[(k, k)].sqrt();
    let along = covariance.column(k) / sigma;
    let top = problem.cost(&best.values, best.factor, &best.prior)?;
    let Some(top) = top else { return Ok(None) };
    let mut points = vec![(best.values[k], 0.0)];
    let mut falls = Vec::new();
    for place in PLACES {
        let values: Vec<f64> = best
            .values
            .iter()
            .zip(&along)
            .map(|(x, a)| x + place * a)
            .collect();
        let Some(cost) = lowest(problem, best, &values, k)? else {
            continue;
        };
        points.push((values[k], top - cost));
        falls.push((place, cost - top));
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Δ = c·t²: a side on which the scene ends has the other's.
    let reach = |sign: f64| {
        let own = falls
            .iter()
            .filter(|(t, fall)| t * sign > 0.0 && *fall > 0.0);
        let each = own.map(|(t, fall)| t.abs() / (2.0 * fall).sqrt());
        each.reduce(f64::max).map(|t| t * sigma)
    };
    let [below, above] = [reach(-1.0), reach(1.0)];
    let either = below.or(above).unwrap_or(sigma);
    Ok(Some(Profile {
        points,
        reach: [below.unwrap_or(either), above.unwrap_or(either)],
    }))
}

/// The cost at `values` after one Newton step of all unknowns but `k`, if that is lower.
fn lowest(
    problem: &Problem<'_>,
    best: &State,
    values: &[f64],
    k: usize,
) -> Result<Option<f64>, LabError> {
    let (factor, prior) = (best.factor, &best.prior);
    let Some(here) = problem.cost(values, factor, prior)? else {
        return Ok(None);
    };
    let others: Vec<usize> = (0..values.len()).filter(|j| *j != k).collect();
    if others.is_empty() {
        return Ok(Some(here));
    }
    let state = problem.state(values, factor, Some(prior))?;
    let information = problem.information(&state.slope);
    let slope = problem.whole_slope(&state);
    let own = Matrix::from_fn(others.len(), others.len(), |i, j| {
        information[(others[i], others[j])]
    });
    let Some(factored) = Cholesky::new(&own) else {
        return Ok(Some(here));
    };
    let step = factored.solve(&DVector::from_fn(others.len(), |i, _| -slope[others[i]]));
    let mut moved = values.to_vec();
    others.iter().zip(&step).for_each(|(j, d)| moved[*j] += d);
    let there = problem.cost(&moved, factor, prior)?;
    Ok(Some(there.map_or(here, |cost| cost.min(here))))
}
