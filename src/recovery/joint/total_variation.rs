//! Least squares over all pixels and spots with a penalty on the differences of neighbours.
//!
//! > minimise ½ Σ w_p v_l (Φ − C diag(ρ) D)² + λ TV(ρ)   over 0 ≤ ρ ≤ 1
//!
//! TV is the anisotropic total variation, Σ |ρ_a − ρ_b| over all pairs of neighbours along u and along v of each grid: edges along the rows and columns of
//! elements cost their length. With a free scale the penalty is on s ρ, and only s ρ ≥ 0 is asked.
//!
//! λ is given as a fraction of σ₁², σ₁ the largest singular value of the weighted operator, or it is the largest that the noise allows. Of the
//! pixels·spots weighted residuals, those outside the range of the operator say nothing of ρ, but their scatter, √(2 N), would hide any pattern of less. So
//! the test is on what is left inside, where the unbounded fit has no residual at all: with noise of unit variance (that is what the weights make) and k
//! singular values above rounding,
//!
//! > ‖R ρ_λ − d‖² ≤ limit = target + 2 √(2 target),   target = k − dof(λ),
//!
//! dof(λ) the number of patches of one value strictly between the bounds (Tibshirani and Taylor 2012).

use super::reduced::{Reduced, report};
use crate::num::quadratic::{Bounds, Fused, box_least_squares, fused_least_squares};
use crate::recovery::{
    Choice, Method, Options, Parameter, Problem, Recovered, RecoveryError, WeightRule,
};

/// Trial values of λ/σ₁² fall from 1 by this factor until one is accepted, and bisection goes on to within this of the answer.
const STEP: f64 = 0.1;
const NEAR: f64 = 1.02;
/// The smallest λ/σ₁² tried: some roundings.
const LEAST: f64 = 1e-24;

pub(in crate::recovery) fn recover(
    problem: &Problem<'_>,
    options: &Options,
) -> Result<Recovered, RecoveryError> {
    let method = Method::JointTv;
    let grids = problem.grids.ok_or(RecoveryError::NotForMethod {
        method,
        what: "needs to know which elements are neighbours",
        cure: "give the grids of the elements (Problem::with_grids), or use joint",
    })?;
    let reduced = Reduced::new(problem, options)?;
    let search = Search {
        pairs: neighbours(grids),
        bounds: reduced.bounds(problem),
        unit: reduced.sigma[0] * reduced.sigma[0],
        start: box_least_squares(&reduced.r, &reduced.d, &reduced.bounds(problem))?.solution,
        reduced: &reduced,
    };
    let (lambda, choice) = match options.total_variation {
        Some(value) if value.is_finite() && value >= 0.0 => (value, Choice::Given),
        Some(value) => {
            return Err(RecoveryError::BadParameter {
                method,
                name: "the total variation's weight",
                value,
                cure: "give a fraction of the largest squared singular value, 0 or more",
            });
        }
        None if problem.noise().is_none() || options.weighting == WeightRule::Unweighted => {
            return Err(RecoveryError::NoNoiseModel {
                method,
                parameter: "total variation's weight",
            });
        }
        None => search.largest()?,
    };
    let found = search.at(lambda)?.found;
    let mut recovered = reduced.finish(method, problem, options, found.solution.clone())?;
    recovered.parameter = Parameter::TotalVariation(lambda);
    recovered.choice = choice;
    recovered.solver = Some(report(&found));
    Ok(recovered)
}

struct Search<'a> {
    reduced: &'a Reduced,
    bounds: Bounds,
    pairs: Vec<[usize; 2]>,
    /// σ₁².
    unit: f64,
    /// The solution without penalty.
    start: nalgebra::DVector<f64>,
}

impl Search<'_> {
    fn at(&self, lambda: f64) -> Result<Fused, RecoveryError> {
        let Reduced { r, d, .. } = self.reduced;
        let lambda = lambda * self.unit;
        Ok(fused_least_squares(
            r,
            d,
            &self.bounds,
            &self.pairs,
            lambda,
            &self.start,
        )?)
    }

    /// [`Choice::JointDiscrepancy`] of λ, and whether it is accepted.
    fn level(&self, lambda: f64) -> Result<(Choice, bool), RecoveryError> {
        let fused = self.at(lambda)?;
        let Reduced { r, d, .. } = self.reduced;
        let residual = (r * &fused.found.solution - d).norm_squared();
        let target = r.nrows().saturating_sub(fused.free_sets).max(1) as f64;
        let limit = target + 2.0 * (2.0 * target).sqrt();
        let choice = Choice::JointDiscrepancy {
            residual,
            target,
            limit,
        };
        Ok((choice, residual <= limit))
    }

    /// The largest λ/σ₁² that is accepted, no larger than 1.
    fn largest(&self) -> Result<(f64, Choice), RecoveryError> {
        let (mut high, mut low) = (1.0, 1.0);
        let mut accepted = self.level(low)?;
        while !accepted.1 {
            high = low;
            low *= STEP;
            if low < LEAST {
                let Choice::JointDiscrepancy {
                    residual, limit, ..
                } = accepted.0
                else {
                    unreachable!("level() returns no other choice")
                };
                return Err(RecoveryError::JointNoiseUnderstated { residual, limit });
            }
            accepted = self.level(low)?;
        }
        while high / low > NEAR {
            let middle = (high * low).sqrt();
            let level = self.level(middle)?;
            if level.1 {
                (low, accepted) = (middle, level);
            } else {
                high = middle;
            }
        }
        Ok((low, accepted.0))
    }
}

/// Pairs of neighbours along u and along v.
fn neighbours(grids: &[[usize; 2]]) -> Vec<[usize; 2]> {
    let mut pairs = Vec::new();
    let mut first = 0;
    for &[nu, nv] in grids {
        for at in 0..nu * nv {
            if at % nu + 1 < nu {
                pairs.push([first + at, first + at + 1]);
            }
            if at / nu + 1 < nv {
                pairs.push([first + at, first + at + nu]);
            }
        }
        first += nu * nv;
    }
    pairs
}
