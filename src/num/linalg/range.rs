//! The range of a matrix that has far fewer directions than rows and columns, at the cost of those.
//!
//! Randomised range finder (Halko, Martinsson and Tropp 2011) with one power step, block after
//! block, each taken out of the matrix before the next is looked for (Martinsson and Voronin 2016):
//!
//! > E ← A;   Y = E Eᵀ E Ω,   Q_new = orth(Y) ⟂ Q,   B_new = Q_newᵀ E,   E ← E − Q_new B_new
//!
//! What is missed, E = A − Q B, is therefore always at hand and its norm no estimate: chance can
//! make the search longer, not the answer wrong.

use nalgebra::DMatrix;

use super::householder::{Pivoting, reduce};
use super::{LinalgError, product, scaled, subtract_product, times_two_to, tr_product};
use crate::num::stream::{Key, Sampling, Stream};

/// Directions looked for at once.
const BLOCK: usize = 64;
/// A search beyond this fraction of the shorter side costs more than it saves.
const LARGEST_SHARE: f64 = 1.0 / 3.0;
/// ‖E‖ accepted, in roundings of ‖A‖ (Frobenius norms): some six are what the search itself leaves
/// (measured).
const ROUNDINGS: f64 = 32.0;

/// A = Q B + E, m × n, with E of the size of rounding.
#[derive(Debug, Clone, PartialEq)]
pub struct Range {
    /// Q, m × k, orthonormal columns.
    pub q: DMatrix<f64>,
    /// B = QᵀA, k × n.
    pub b: DMatrix<f64>,
    /// ‖E‖, Frobenius, in the unit of A; E is orthogonal to Q to rounding, so that σ_i(B)² ≤
    /// σ_i(A)² ≤ σ_i(B)² + ‖E‖².
    pub rest: f64,
}

/// The range of A; `None` where no more than a third of the shorter side is not enough to come
/// within 32 eps ‖A‖, or where the matrix is too small for a search: decompose A itself then.
///
/// The random numbers are a function of the shape alone.
///
/// # Errors
/// [`LinalgError::Empty`], [`LinalgError::NotFinite`].
pub fn range(a: &DMatrix<f64>) -> Result<Option<Range>, LinalgError> {
    let shorter = a.nrows().min(a.ncols());
    let most = (LARGEST_SHARE * shorter as f64) as usize;
    if most < BLOCK {
        return Ok(None);
    }
    let (mut left, exponent) = scaled(a)?;
    let allowed = ROUNDINGS * f64::EPSILON * left.norm();
    let Some((q, b)) = search(&mut left, most, allowed) else {
        return Ok(None);
    };
    Ok(Some(Range {
        q,
        b: b.map(times_two_to(exponent)),
        rest: times_two_to(exponent)(left.norm()),
    }))
}

/// Q and B with ‖`left` − Q B‖ ≤ `allowed`, at most `most` directions; `left` becomes the
/// difference.
fn search(
    left: &mut DMatrix<f64>,
    most: usize,
    allowed: f64,
) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let (m, n) = left.shape();
    let mut q = DMatrix::zeros(m, 0);
    let mut bt = DMatrix::zeros(n, 0);
    while left.norm() > allowed {
        let found = q.ncols();
        if found + BLOCK > most {
            return None;
        }
        let towards = orthonormal(tr_product(
            left,
            &orthonormal(product(left, &random(n, found))),
        ));
        let mut new = orthonormal(without(&q, product(left, &towards)));
        // Twice is enough (Giraud, Langou and Rozložník 2005).
        new = orthonormal(without(&q, new));
        let along = tr_product(&new, left);
        subtract_product(left, &new, &along);
        q = beside(q, &new);
        bt = beside(bt, &along.transpose());
    }
    let k = q.ncols();
    let off = (tr_product(&q, &q) - DMatrix::identity(k, k)).norm();
    (k > 0 && off <= ROUNDINGS * f64::EPSILON * k as f64).then(|| (q, bt.transpose()))
}

/// n × BLOCK independent standard normal numbers.
fn random(n: usize, found: usize) -> DMatrix<f64> {
    let key = Key {
        seed: 0,
        spot: n as u32,
        pixel: found as u32,
        block: 0,
    };
    let mut stream = Stream::new(Sampling::Pcg, key);
    DMatrix::from_fn(n, BLOCK, |_, _| stream.normal())
}

/// An orthonormal basis of the columns, by Householder reductions, which stay orthogonal where
/// columns depend on each other.
fn orthonormal(y: DMatrix<f64>) -> DMatrix<f64> {
    reduce(y, Pivoting::Never).0.thin()
}

/// What of Y lies outside Q.
fn without(q: &DMatrix<f64>, mut y: DMatrix<f64>) -> DMatrix<f64> {
    if q.ncols() > 0 {
        let along = tr_product(q, &y);
        subtract_product(&mut y, q, &along);
    }
    y
}

/// \[A | B\].
fn beside(a: DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let (rows, found) = a.shape();
    let mut all = a.resize(rows, found + b.ncols(), 0.0);
    all.columns_mut(found, b.ncols()).copy_from(b);
    all
}

#[cfg(test)]
mod tests;
