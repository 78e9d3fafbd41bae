//! What goes with a solution of the operator: light beside that of the hidden surface, factors that
//! are known roughly, covariances.

use nalgebra::{DMatrix, DVector};

use super::super::elimination::estimate;
use super::super::sides::Sides;
use super::{Form, Operator, known};
use crate::num::linalg::{LeastSquares, columns_over, product, rows_times, tr_product};
use crate::recovery::{Deviations, Estimated, Gains, Options, Problem, RecoveryError, Weighting};

/// v_k/s_k as columns, r × rank.
fn towards(solved: &LeastSquares) -> DMatrix<f64> {
    columns_over(solved.vt.transpose(), &solved.sigma)
}

impl Operator {
    /// The nuisance terms that go with `seen` = s ρ, and what they and its light leave over,
    /// pixels × spots, W.
    pub(in crate::recovery::joint) fn nuisances(
        &self,
        problem: &Problem<'_>,
        options: &Options,
        seen: &DVector<f64>,
    ) -> Result<(Estimated, DMatrix<f64>), RecoveryError> {
        let (seen, whole) = match (&self.gains.whole, self.direction(problem)) {
            (Some(of), Some(z)) => {
                let whole = of.given(seen);
                (seen + z * whole[0], Some(whole))
            }
            _ => (seen.clone(), None),
        };
        let frames = self.gains.frames.as_ref().map(|of| of.given(&seen));
        let mut left = problem.phi - problem.light(&seen);
        let pattern = problem.soft.and_then(|soft| soft.frames.as_ref());
        if let (Some((pattern, _)), Some(gains)) = (pattern, &frames) {
            for (l, gain) in gains.iter().enumerate() {
                left.column_mut(l).axpy(-gain, &pattern.column(l), 1.0);
            }
        }
        let known = known(problem, options);
        let mut found = match &self.form {
            Form::Stacked { coupled, .. } => {
                let coupled = coupled.as_ref().map(|c| c.solve(&seen, frames.as_ref()));
                let root = |p: usize, l: usize| self.weights.root(problem, known, p, l);
                estimate(&problem.nuisance, &left, root, coupled.as_ref())?
            }
            _ => {
                let root = |p: usize, l: usize| self.weights.pixels[p] * self.weights.spots[l];
                estimate(&problem.nuisance, &left, root, None)?
            }
        };
        let (pixels, spots) = left.shape();
        left -= found.light(&problem.nuisance, pixels, spots);
        if let Some(soft) = problem.soft {
            let factors = |size: Option<DVector<f64>>, known_to: Option<f64>| {
                let (size, known_to) = (size?, known_to?);
                Some(Deviations {
                    standard_error: DVector::zeros(size.len()),
                    size,
                    known_to,
                    picture_given: true,
                })
            };
            let mut gains = Gains {
                frames: factors(frames, soft.frames.as_ref().map(|of| of.1)),
                whole: factors(whole, soft.whole.as_ref().map(|of| of.1)),
                ..Gains::default()
            };
            self.add_errors(problem, &mut gains, None);
            found.gains = Some(gains);
        }
        Ok((found, left))
    }

    /// z: the common factor's ε multiplies the light of these numbers.
    fn direction<'a>(&self, problem: &Problem<'a>) -> Option<&'a DVector<f64>> {
        let (z, _) = problem.soft?.whole.as_ref()?;
        Some(z)
    }

    /// The standard errors of the factors where x has the covariance `of_x`; where none is known,
    /// given x. With x and ε uncertain x + ε z has the covariance
    ///
    /// > (1 − z qᵀ) Cov(x) (1 − q zᵀ) + v z zᵀ,   ε | x ~ N(… − qᵀx, v).
    pub(in crate::recovery::joint) fn add_errors(
        &self,
        problem: &Problem<'_>,
        gains: &mut Gains,
        of_x: Option<&DMatrix<f64>>,
    ) {
        let Some(soft) = problem.soft else { return };
        let n = self.elements;
        let mut of_seen = of_x.cloned().unwrap_or_else(|| DMatrix::zeros(n, n));
        if let (Some(of), Some(z)) = (&self.gains.whole, self.direction(problem)) {
            if let Some(whole) = &mut gains.whole {
                whole.standard_error = of.errors(&of_seen, soft.noise);
                whole.picture_given = of_x.is_none();
            }
            let turn = DMatrix::identity(n, n) - z * of.slope.row(0);
            of_seen = product(&product(&turn, &of_seen), &turn.transpose());
            of_seen.ger(of.variance[0] * soft.noise * soft.noise, z, z, 1.0);
        }
        if let (Some(of), Some(frames)) = (&self.gains.frames, &mut gains.frames) {
            frames.standard_error = of.errors(&of_seen, soft.noise);
            frames.picture_given = of_x.is_none();
        }
    }

    /// Covariance of the solution as the standard errors make it, whether or not the weights are
    /// theirs:
    ///
    /// > (KᵀWK)⁺ KᵀW Σ W K (KᵀWK)⁺ = Σ_kk' v_k (1/s_k) N_kk' (1/s_k') v_k'ᵀ,
    ///
    /// N that of [`Operator::noise`]. Where the weights are the entries' own it is (KᵀWK)⁺.
    pub(in crate::recovery::joint) fn covariance(
        &self,
        problem: &Problem<'_>,
        solved: &LeastSquares,
    ) -> Option<DMatrix<f64>> {
        let towards = towards(solved);
        let noise = self.noise(problem, solved)?;
        Some(product(&product(&towards, &noise), &towards.transpose()))
    }

    /// Covariance of the data along the left singular vectors, as the standard errors make it, rank
    /// × rank:
    ///
    /// > N_kk' = Σ_pl u_k\[p,l\] u_k'\[p,l\] w_p v_l σ²\[p,l\],   u_k = √W K v_k/s_k as pixels × spots.
    ///
    /// The unit matrix where the weights are the entries' own; none without a noise model, and none
    /// for unweighted rows with glare patterns. C̃ = U T and D̃ = S V with few (c, d) orthonormal
    /// columns to rounding, so that the sums cost d·c·r·k + l·(p·c² + c·k·(d + c + k)) operations
    /// and not l·p·k·(r + k).
    pub(in crate::recovery::joint) fn noise(
        &self,
        problem: &Problem<'_>,
        solved: &LeastSquares,
    ) -> Option<DMatrix<f64>> {
        let stderr = problem.noise()?;
        let Some(Sides { u, t, s, v }) = &self.sides else {
            return (self.weighting == Weighting::EntryByEntry)
                .then(|| DMatrix::identity(solved.rank, solved.rank));
        };
        let towards = towards(solved).select_rows(&self.element);
        // T diag(S_b) v_k/s_k of each direction b of the laser side, as columns.
        let (c, k) = (t.nrows(), solved.rank);
        let mut lit = DMatrix::zeros(c * k, s.ncols());
        for (b, mut target) in lit.column_iter_mut().enumerate() {
            let by_term = rows_times(towards.clone(), s.column(b).iter());
            target.copy_from_slice(product(t, &by_term).as_slice());
        }
        let mut sum = DMatrix::zeros(k, k);
        for l in 0..v.ncols() {
            let along = DMatrix::from_column_slice(c, k, (&lit * v.column(l)).as_slice());
            let errors: Vec<f64> = (0..u.nrows())
                .map(|p| self.weights.pixels[p] * self.weights.spots[l] * stderr[(p, l)])
                .collect();
            let noise = rows_times(u.clone(), &errors);
            let weighted = product(&tr_product(&noise, &noise), &along);
            sum += tr_product(&along, &weighted);
        }
        Some(sum)
    }
}
