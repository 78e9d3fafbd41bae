//! What no unbiased estimate can undercut.

use nalgebra::{DMatrix, DVector};

use crate::num::linalg::{Tolerance, rows_over, svd};
use crate::recovery::joint::operator::linear::about_grey;
use crate::recovery::joint::{operator::stacked, operator::weights};
use crate::recovery::{Method, Options, Problem, RecoveryError};

/// Directions below this fraction of the strongest are lost: QR without pivoting has an error of
/// about 4e-14 (measured).
const LOST: f64 = 1e-13;

/// The Cramér–Rao bound of all reflectances.
#[derive(Debug, Clone, PartialEq)]
pub struct CramerRao {
    /// (KᵀΣ⁻¹K)⁻¹ (r × r); the pseudo-inverse where directions are lost.
    pub covariance: DMatrix<f64>,
    /// Roots of its diagonal; infinite for an element that lost directions concern, of which no
    /// unbiased estimate exists in f64.
    pub standard_error: DVector<f64>,
    /// Singular values of Σ^(−½) K without what the nuisance terms take, descending.
    pub sigma: DVector<f64>,
    /// How many are not lost.
    pub rank: usize,
}

/// The covariance that no unbiased estimate of ρ has less than, for normal noise of the problem's
/// standard errors:
///
/// > Cov(ρ̂) ⪰ (KᵀΣ⁻¹K)⁻¹,   row (p, l) of Σ^(−½)K: C\[p,j\] D\[j,l\]/σ\[p,l\]
///
/// with each entry's own σ, no separable fit. Nuisance terms of the problem are unknown too and
/// cost what they cost (Schur complement, by QR: no Gram matrix is formed, and never more than a
/// block of rows). A free scale asks about s ρ, and is counted nothing. Entries whose σ is zero get
/// that of the separable fit. The bound does not depend on ρ or Φ, except through the standard
/// errors, and of factors that are known only roughly: these cost what they cost about the grey
/// surface that fits Φ best.
///
/// # Errors
/// [`RecoveryError::NotForMethod`] without a noise model, [`RecoveryError::RankZero`], or a failed
/// decomposition.
pub fn cramer_rao(problem: &Problem<'_>) -> Result<CramerRao, RecoveryError> {
    let stderr = problem.noise().ok_or(RecoveryError::NotForMethod {
        method: Method::JointUnbounded,
        what: "has a Cramér–Rao bound only for known noise",
        cure: "give the standard error of phi (phi.stderr.npy)",
    })?;
    let fitted = weights::fit(Some(stderr), stderr.nrows(), stderr.ncols());
    let root = |p: usize, l: usize| fitted.root(problem, Some(stderr), p, l);
    let linear = |problem: &Problem<'_>| stacked::stack(problem, root);
    let reduced = about_grey(problem, &Options::default(), linear)?.triangle;
    let decomposed = svd(&reduced.r)?;
    let elements = problem.c.ncols();
    let (rank, _) = decomposed.cut(Tolerance::Relative(LOST))?;
    if rank == 0 {
        return Err(RecoveryError::NO_DIRECTION);
    }
    let kept = decomposed.vt.rows(0, rank);
    let scaled = rows_over(kept.into_owned(), &decomposed.sigma);
    let covariance = scaled.transpose() * scaled;
    let standard_error = DVector::from_fn(elements, |j, _| {
        // 1 − what of element j the kept directions hold.
        let lost = 1.0 - kept.column(j).norm_squared();
        if rank < elements && lost > elements as f64 * f64::EPSILON {
            f64::INFINITY
        } else {
            covariance[(j, j)].sqrt()
        }
    });
    Ok(CramerRao {
        covariance,
        standard_error,
        sigma: decomposed.sigma,
        rank,
    })
}
