//! What photographs tell of each unknown, before anything is fitted.

use serde::Serialize;

use super::descent::{Problem, State};
use crate::matrix::Matrix;
use crate::num::linalg::{Cholesky, svd};

/// What the photographs tell of one unknown, at their noise.
#[derive(Clone, Debug, Serialize)]
pub struct Identified {
    /// Its standard error if picture and all other unknowns were known.
    pub alone: f64,
    /// The same if only the other unknowns were.
    pub picture_unknown: f64,
    /// By the photographs alone, all else unknown; absent where they do not tell it.
    pub by_light: Option<f64>,
    /// With what is known beforehand; absent likewise.
    pub with_prior: Option<f64>,
}

/// A combination of unknowns that changes no photograph beyond its noise.
#[derive(Clone, Debug, Serialize)]
pub struct Direction {
    /// The unknowns that take part, by index, with their parts of the combination.
    pub parts: Vec<(usize, f64)>,
    /// By how many of their typical sizes it is uncertain by the photographs alone.
    pub by_light: f64,
    /// The same with what is known beforehand.
    pub with_prior: f64,
}

/// Typical sizes by which a direction is uncertain that light does not tell.
const UNTOLD: f64 = 30.0;
/// Parts of a direction that are named.
const NAMED: f64 = 0.2;

/// Of every unknown, and the directions that light does not tell. `sizes` are typical ones of each.
pub(super) fn identified(
    problem: &Problem<'_>,
    state: &State,
    sizes: &[f64],
) -> (Vec<Identified>, Vec<Direction>) {
    let slope = &state.slope;
    let scaled =
        |m: &Matrix| Matrix::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] * sizes[i] * sizes[j]);
    let light = scaled(&slope.curvature);
    let whole = scaled(&problem.information(slope));
    let errors = |m: &Matrix| {
        let inverse = Cholesky::new(m)?.inverse();
        Some(inverse.diagonal().map(|x| x.max(0.0).sqrt()))
    };
    let (by_light, with_prior) = (errors(&light), errors(&whole));
    let each = (0..sizes.len()).map(|k| Identified {
        alone: 1.0 / slope.known[k].sqrt(),
        picture_unknown: 1.0 / slope.curvature[(k, k)].sqrt(),
        by_light: by_light.as_ref().map(|e| e[k] * sizes[k]),
        with_prior: with_prior.as_ref().map(|e| e[k] * sizes[k]),
    });
    (each.collect(), untold(&light, &whole))
}

/// Directions of `light` that it does not tell.
fn untold(light: &Matrix, whole: &Matrix) -> Vec<Direction> {
    let Ok(found) = svd(light) else {
        return Vec::new();
    };
    let weak = (0..found.sigma.len()).filter(|k| found.sigma[*k] < 1.0 / (UNTOLD * UNTOLD));
    weak.map(|k| {
        let own = found.u.column(k).into_owned();
        let largest = own.amax();
        let parts = own.iter().copied().enumerate();
        let information = own.dot(&(whole * &own));
        Direction {
            by_light: 1.0 / found.sigma[k].sqrt(),
            with_prior: 1.0 / information.max(0.0).sqrt(),
            parts: parts.filter(|(_, x)| x.abs() > NAMED * largest).collect(),
        }
    })
    .collect()
}

impl Direction {
    /// Whether what is known beforehand does not tell it either.
    pub fn is_free(&self) -> bool {
        self.with_prior.is_nan() || self.with_prior > UNTOLD
    }
}
