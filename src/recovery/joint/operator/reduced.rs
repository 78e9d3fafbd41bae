//! What the bounded methods share: the operator reduced to as many rows as it has directions, and
//! the way back to reflectances.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::khatri_rao::{Operator, operator};
use super::scale;
use crate::num::linalg::{Svd, Tolerance, cut, product, rows_times};
use crate::num::quadratic::{Bounds, BoxSolution};
use crate::recovery::{
    Choice, Estimated, Method, Options, Parameter, Problem, Recovered, RecoveryError, Solver,
    Weighting,
};

/// ½‖R x/s₀ − d‖² is the objective but for a constant, x = s ρ and s₀ that of [`scale`]. Columns of
/// elements that are not seen are 0.
pub(in crate::recovery::joint) struct Reduced {
    operator: Arc<Operator>,
    pub(in crate::recovery::joint) r: DMatrix<f64>,
    pub(in crate::recovery::joint) d: DVector<f64>,
    pub(in crate::recovery::joint) sigma: DVector<f64>,
    pub(super) rank: usize,
    /// s₀.
    pub(in crate::recovery::joint) unit: f64,
    cutoff: f64,
}

impl Reduced {
    pub(in crate::recovery::joint) fn new(
        problem: &Problem<'_>,
        options: &Options,
    ) -> Result<Self, RecoveryError> {
        let operator = operator(problem, options)?;
        let directions = operator.directions()?;
        let (Svd { sigma, vt, .. }, data) = &*directions;
        let tolerance = operator.tolerance(Tolerance::Auto);
        let (rank, cutoff) = cut(
            sigma.as_slice(),
            operator.rows(),
            problem.c.ncols(),
            tolerance,
        )?;
        if rank == 0 {
            return Err(RecoveryError::NO_DIRECTION);
        }
        let unit = scale::unit(problem)?;
        // Directions below one rounding of the strongest carry nothing: k rows Σ_k V_kᵀ stand for
        // R.
        let (rows, _) = cut(sigma.as_slice(), 1, 1, Tolerance::Relative(f64::EPSILON))?;
        // An element whose light is below what is cut is not seen: without an upper bound any size
        // of it would serve to fit the noise by rounding.
        let mut r = rows_times(vt.rows(0, rows) * unit, sigma);
        for mut column in r.column_iter_mut() {
            if column.norm() <= cutoff * unit {
                column.fill(0.0);
            }
        }
        Ok(Reduced {
            operator,
            r,
            d: data.rows(0, rows).into_owned(),
            sigma: sigma.clone(),
            rank,
            unit,
            cutoff,
        })
    }

    /// What x/s₀ can be: 0 to 1, or from 0 on where the scale is free.
    pub(in crate::recovery::joint) fn bounds(&self, problem: &Problem<'_>) -> Bounds {
        let upper = if problem.nuisance.free_scale {
            f64::INFINITY
        } else {
            1.0
        };
        Bounds::all(self.r.ncols(), 0.0, upper)
    }

    /// The report of a box solver, its status by what is proved: whatever it says of itself, the
    /// gap is what its end may be above the minimum.
    pub(in crate::recovery::joint) fn report(&self, solved: &BoxSolution) -> Solver {
        let BoxSolution { objective, gap, .. } = *solved;
        // Where the noise is the unit, 2 gap is in variances of it.
        let (near, far) = match self.operator.weighting {
            Weighting::Unweighted => (1e-6 * objective, 1e-2 * objective),
            _ => (5e-4, 5e-2),
        };
        let rounding = (1e-12 * self.d.norm()).powi(2);
        let status = if gap <= near + rounding {
            "minimum"
        } else if gap <= far + rounding {
            "near its minimum"
        } else {
            "NOT PROVED to be near its minimum"
        };
        Solver {
            status: status.to_owned(),
            iterations: solved.iterations,
            refinements: solved.refinements,
            objective,
            gap,
        }
    }

    /// The recovery from x/s₀, a rank cut recorded.
    pub(in crate::recovery::joint) fn finish(
        &self,
        method: Method,
        problem: &Problem<'_>,
        options: &Options,
        seen: DVector<f64>,
    ) -> Result<Recovered, RecoveryError> {
        let mut found = finish(
            method,
            problem,
            options,
            &self.operator,
            seen * self.unit,
            self.sigma.clone(),
            self.rank,
        )?;
        if self.rank < problem.c.ncols() {
            (found.parameter, found.choice) = (
                Parameter::Rank(self.rank),
                Choice::Tolerance {
                    cutoff: self.cutoff,
                },
            );
        }
        Ok(found)
    }
}

/// Covariance of ρ̂ = x̂/x̂_m, m the brightest element, to first order in the noise:
/// (1 − ρ̂ e_mᵀ) Cov(x̂) (1 − e_m ρ̂ᵀ)/x̂_m². Element m, the unit, has none.
pub(in crate::recovery::joint) fn over_brightest(
    of_x: &DMatrix<f64>,
    x: &DVector<f64>,
) -> DMatrix<f64> {
    let (m, largest) = x.argmax();
    let mut slope = DMatrix::identity(x.len(), x.len());
    slope.column_mut(m).axpy(-1.0 / largest, x, 1.0);
    slope.row_mut(m).fill(0.0);
    product(&product(&slope, of_x), &slope.transpose()) / (largest * largest)
}

/// The recovery from x = s ρ: scale by the brightest element where that is the convention, nuisance
/// terms, residual with them.
pub(in crate::recovery::joint) fn finish(
    method: Method,
    problem: &Problem<'_>,
    options: &Options,
    operator: &Operator,
    x: DVector<f64>,
    sigma: DVector<f64>,
    rank: usize,
) -> Result<Recovered, RecoveryError> {
    let nuisance = &problem.nuisance;
    let mut found = Recovered::plain(method, problem, x.clone(), sigma, rank)?;
    found.weighting = operator.weighting;
    if !nuisance.is_some() && problem.soft.is_none() {
        return Ok(found);
    }
    let (mut estimated, left) = operator.nuisances(problem, options, &x)?;
    found.residual = problem.counted(left).norm();
    let whole = problem.counted(problem.phi.clone()).norm();
    found.relative_residual = if whole > 0.0 {
        found.residual / whole
    } else {
        0.0
    };
    if nuisance.free_scale {
        let largest = x.max();
        if largest <= 0.0 {
            return Err(RecoveryError::NoScale { largest });
        }
        found.reflectance = x / largest;
        estimated = Estimated {
            scale: Some(largest),
            ..estimated
        };
    }
    found.nuisance = Some(estimated);
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::bench::{Bench, relative_noise};

    /// Half a hundredth of ½ χ² is no "Solved", and what the solver says of itself does not count.
    #[test]
    fn the_status_says_what_the_gap_proves() {
        let bench = Bench::new(6.0, 2, 4);
        let board = bench.board(2);
        let (phi, stderr) = relative_noise(&bench.phi(&board), 1e-2, 1);
        let status = |stderr, objective, gap| {
            let problem = Problem::new(&phi, &bench.c, &bench.d, stderr).unwrap();
            let reduced = Reduced::new(&problem, &Options::default()).unwrap();
            let solved = BoxSolution {
                solution: board.clone(),
                status: "Solved".to_owned(),
                iterations: 9,
                refinements: 0,
                objective,
                gap,
            };
            reduced.report(&solved).status
        };
        let far = "NOT PROVED to be near its minimum";
        for (gap, told) in [
            (1e-9, "minimum"),
            (5e-3, "near its minimum"),
            (5.0, far),
            (f64::INFINITY, far),
        ] {
            assert_eq!(status(Some(&stderr), 20.0, gap), told, "{gap}");
        }
        // Without noise the objective is the unit.
        for (gap, told) in [
            (1e-34, "minimum"),
            (1e-29, "near its minimum"),
            (1e-26, far),
        ] {
            assert_eq!(status(None, 1e-26, gap), told, "{gap}");
        }
    }
}
