//! The two sides of the operator by the few directions that rounding leaves of each.

use nalgebra::DMatrix;

use crate::num::linalg::{Svd, Tolerance, columns_times, rows_times, svd_to};
use crate::recovery::RecoveryError;

/// C = U T and D = S V, U and Vᵀ with few orthonormal columns.
#[derive(Debug)]
pub(super) struct Sides {
    pub(super) u: DMatrix<f64>,
    pub(super) t: DMatrix<f64>,
    pub(super) s: DMatrix<f64>,
    pub(super) v: DMatrix<f64>,
}

impl Sides {
    /// Of C and D, whose norms were `before` when nothing was projected out of them.
    pub(super) fn new([c, d]: [&DMatrix<f64>; 2], before: [f64; 2]) -> Result<Self, RecoveryError> {
        let (camera, rc) = compress(c, before[0], "camera side C")?;
        let (laser, rd) = compress(d, before[1], "laser side D")?;
        Ok(Self {
            u: camera.u.columns(0, rc).into_owned(),
            t: rows_times(camera.vt.rows(0, rc).into_owned(), &camera.sigma),
            s: columns_times(laser.u.columns(0, rd).into_owned(), &laser.sigma),
            v: laser.vt.rows(0, rd).into_owned(),
        })
    }
}

/// U_k, Σ_k V_kᵀ of a side, cut at its rounding; `before` is its norm before anything was projected
/// out of it.
fn compress(
    side: &DMatrix<f64>,
    before: f64,
    name: &'static str,
) -> Result<(Svd, usize), RecoveryError> {
    let none = || {
        if before > 0.0 {
            RecoveryError::TakenUp
        } else {
            RecoveryError::RankZero { side: name }
        }
    };
    if side.is_empty() {
        return Err(none());
    }
    let decomposed = svd_to(side, Tolerance::Auto)?;
    let (rank, _) = decomposed.cut(Tolerance::Auto)?;
    let rounding = side.nrows().max(side.ncols()) as f64 * f64::EPSILON * before;
    let rank = if side.norm() < 0.999 * before {
        decomposed
            .sigma
            .iter()
            .take(rank)
            .filter(|&&s| s > rounding)
            .count()
    } else {
        rank
    };
    if rank == 0 {
        Err(none())
    } else {
        Ok((decomposed, rank))
    }
}
