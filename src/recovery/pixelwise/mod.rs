//! What `pinv`, `tsvd` and `tikhonov` share: a generalised inverse D^# of the laser side, pixel by pixel.
//!
//! > X = Φ D^#  (p × r),   ρ_j = (1/p) Σ_p X\[p,j\]/C\[p,j\]

pub(super) mod pinv;
pub(super) mod tikhonov;
pub(super) mod tsvd;

use nalgebra::{DMatrix, DVector};

use crate::num::linalg::{Svd, svd};
use crate::recovery::{Method, Parameter, Problem, Recovered, RecoveryError};

/// The laser side decomposed, and the check that C can be divided by.
fn decompose(method: Method, problem: &Problem<'_>) -> Result<Svd, RecoveryError> {
    if let Some(at) = problem.c.iter().position(|&x| x == 0.0) {
        let pixels = problem.c.nrows();
        return Err(RecoveryError::Unseen {
            method,
            pixel: at % pixels,
            element: at / pixels,
        });
    }
    let decomposed = svd(problem.d)?;
    if decomposed.sigma[0] == 0.0 {
        return Err(RecoveryError::RankZero {
            side: "laser side D",
        });
    }
    Ok(decomposed)
}

/// The recovery through D^# = V diag(f/σ) Uᵀ with filter factors f (as many as are kept, descending σ).
fn invert(
    method: Method,
    problem: &Problem<'_>,
    laser: &Svd,
    filter: &[f64],
    parameter: Parameter,
) -> Recovered {
    let rank = filter.len();
    let mut v = laser.vt.rows(0, rank).transpose();
    for ((mut column, &f), &s) in v.column_iter_mut().zip(filter).zip(laser.sigma.iter()) {
        column.apply(|x| *x = *x / s * f);
    }
    let inverse = v * laser.u.columns(0, rank).transpose();
    let pixels = problem.phi.nrows() as f64;
    let x = problem.phi * &inverse;
    let reflectance = mean_over_pixels(&x.component_div(problem.c), pixels);
    let mut found = Recovered::plain(method, problem, reflectance, laser.sigma.clone(), rank);
    found.parameter = parameter;
    found.effective_rank = filter.iter().sum();
    // Independent entries: var ρ_j = Σ_p Σ_l σ²[p,l] (D^#[l,j] / (p C[p,j]))².
    found.standard_error = problem.noise().map(|stderr| {
        let squares = |m: &DMatrix<f64>| m.component_mul(m);
        let ratio = (squares(stderr) * squares(&inverse)).component_div(&squares(problem.c));
        mean_over_pixels(&ratio, pixels * pixels).map(f64::sqrt)
    });
    found
}

fn mean_over_pixels(x: &DMatrix<f64>, divisor: f64) -> DVector<f64> {
    DVector::from_iterator(
        x.ncols(),
        x.column_iter().map(|column| column.sum() / divisor),
    )
}
