//! What the photographs say of the reflectances, as a few numbers with known errors.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use crate::num::linalg::{Cholesky, LeastSquares};
use crate::recovery::joint::operator::khatri_rao::{Operator, operator};
use crate::recovery::joint::operator::reduced::finish;
use crate::recovery::{Method, Options, Problem, Recovered, RecoveryError, WeightRule, bands};

/// A direction that is known to no better than this many times the largest picture says nothing.
const UNKNOWN: f64 = 100.0;

/// > y = V x + errors,   y = V x̂,   x = s ρ
///
/// for the unbounded least-squares estimate x̂ along k directions V (k × n) of the joint operator,
/// whose errors have the covariance that the noise makes of them. Of unknown noise, the same in all
/// entries, the variance is what least squares leaves over, times the pixels that it hangs together
/// over ([`crate::recovery::joint::process::correlated`]) where those are known.
pub(super) struct Coordinates {
    pub(super) v: DMatrix<f64>,
    pub(super) y: DVector<f64>,
    /// Covariance of y, k × k, and its Cholesky factor.
    pub(super) errors: DMatrix<f64>,
    pub(super) factor: Cholesky,
    operator: Arc<Operator>,
    solved: Arc<LeastSquares>,
}

impl Coordinates {
    /// `unit` is the size of the largest x; `alike`, how many pixels unknown noise hangs together
    /// over.
    pub(super) fn new(
        method: Method,
        problem: &Problem<'_>,
        options: &Options,
        unit: f64,
        alike: f64,
    ) -> Result<Self, RecoveryError> {
        let by_entry = Options {
            weighting: match options.weighting {
                WeightRule::Noise => WeightRule::Entries,
                other => other,
            },
            ..*options
        };
        let operator = operator(problem, &by_entry)?;
        let solved = operator.solve(options.tolerance)?;
        let rank = solved.rank;
        let noise = match operator.noise(problem, &solved) {
            Some(noise) => noise,
            None => {
                let (free, sigma) = (Method::JointUnbounded, solved.sigma.clone());
                let x = solved.solution.clone();
                let mut left = finish(free, problem, options, &operator, x, sigma, rank)?;
                if let (Some(soft), Some(found)) = (problem.soft, &mut left.nuisance)
                    && let Some(gains) = &mut found.gains
                {
                    let of_x = solved.covariance() * (soft.noise * soft.noise);
                    operator.add_errors(problem, gains, Some(&of_x));
                }
                let freedom = problem.entries() as f64 - left.freedom_used();
                if freedom < 1.0 {
                    return Err(bands::without_noise(method));
                }
                let floor = f64::EPSILON * problem.counted(problem.phi.clone()).norm();
                let variance = left.residual.max(floor).powi(2) / freedom;
                DMatrix::identity(rank, rank) * (variance * alike)
            }
        };
        let sigma = &solved.sigma;
        let errors = DMatrix::from_fn(rank, rank, |i, j| noise[(i, j)] / (sigma[i] * sigma[j]));
        let largest = UNKNOWN * unit * (problem.elements() as f64).sqrt();
        let told: Vec<usize> = (0..rank)
            .filter(|&i| errors[(i, i)] < largest * largest)
            .collect();
        if told.is_empty() {
            return Err(RecoveryError::NO_DIRECTION);
        }
        let v = solved.vt.select_rows(&told);
        let errors = errors.select_rows(&told).select_columns(&told);
        Ok(Self {
            y: &v * &solved.solution,
            factor: Cholesky::new(&errors).ok_or(RecoveryError::NO_DIRECTION)?,
            errors,
            v,
            operator,
            solved,
        })
    }

    /// R = L⁻¹ V and d = L⁻¹ y, LLᵀ the covariance: ‖R x − d‖² is χ², 0 for the best x of all.
    pub(super) fn whitened(&self) -> (DMatrix<f64>, DVector<f64>) {
        let y = DMatrix::from_column_slice(self.y.len(), 1, self.y.as_slice());
        let d = self.factor.forward(y).column(0).into_owned();
        (self.factor.forward(self.v.clone()), d)
    }

    /// Adds the standard errors of factors that are known roughly to a recovery whose x has this
    /// covariance.
    pub(super) fn add_errors(
        &self,
        problem: &Problem<'_>,
        found: &mut Recovered,
        of_x: Option<&DMatrix<f64>>,
    ) {
        if let Some(gains) = found.nuisance.as_mut().and_then(|n| n.gains.as_mut()) {
            self.operator.add_errors(problem, gains, of_x);
        }
    }

    /// The recovery from x.
    pub(super) fn finish(
        &self,
        method: Method,
        problem: &Problem<'_>,
        options: &Options,
        x: DVector<f64>,
    ) -> Result<Recovered, RecoveryError> {
        let (sigma, rank) = (self.solved.sigma.clone(), self.solved.rank);
        finish(method, problem, options, &self.operator, x, sigma, rank)
    }
}
