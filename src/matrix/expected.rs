//! What is expected of entries whose noise goes with their size.
//!
//! The variance of an entry goes with its light, V = k Φ + c of counts, V = (ε Φ)² of relative
//! noise. By the light that was measured an entry that noise has made darker counts as more
//! certain: weighted by 1/V the mean of counts of μ electrons comes out as μ − 1, that of relative
//! noise as μ (1 − 2 ε²), and χ² too large. Photographs of a hidden surface have few directions;
//! their noise has all. So in place of the values x, of variances v, stands
//!
//! > x̂ = Σ_k u_k σ_k v_kᵀ  over σ_k > λ √n
//!
//! where x is in units of its noise (as far as v is a product of a number of the row and one of the
//! column), n the longer side, and λ the threshold of least error for noise of size 1 (Gavish and
//! Donoho, *The optimal hard threshold for singular values is 4/√3*, IEEE Trans. Inf. Theory 60,
//! 2014). What noise is small enough to show stays. An entry takes part in its own expectation by
//! h = |u_p|² + |v_l|² − |u_p|² |v_l|² (the projection on the tangent space of the directions that
//! are kept); without itself it is (x̂ − h x)/(1 − h).

use super::Matrix;
use crate::num::linalg::{LinalgError, svd};
use crate::num::separable::Separable;

/// Rows and columns of a block that is decomposed by itself: a second.
const BLOCK: usize = 512;
/// Standard errors by which a whole may come out too dark before it is told.
pub const TOO_DARK: f64 = 0.5;
/// Rows or columns below which noise is no smaller than a direction.
const FEWEST: usize = 8;
/// Rounds in which entries that are left out take what the others say.
const ROUNDS: usize = 4;
/// The least that is expected, in what the product of its row and its column has: a sum of few
/// directions may be negative.
const LEAST: f64 = 0.05;
/// Part of itself in its own expectation up to which an entry is taken out of it: beyond, there are
/// about as many directions as entries.
const MOST_ITSELF: f64 = 0.5;

/// What is expected of `values` with noise of these variances, all rows × columns; 0 where a
/// `left_out` is not 0. None of fewer than 8 rows or columns, where each is all there is.
///
/// # Errors
/// Where a decomposition does not converge.
pub fn expected(
    values: &Matrix,
    variance: &Matrix,
    left_out: Option<&Matrix>,
) -> Result<Option<Matrix>, LinalgError> {
    let (m, n) = values.shape();
    if m < FEWEST || n < FEWEST {
        return Ok(None);
    }
    let mut found = Matrix::zeros(m, n);
    for (first, rows) in blocks(m) {
        for (begin, columns) in blocks(n) {
            let of = |m: &Matrix| m.view((first, begin), (rows, columns)).into_owned();
            let left_out = left_out.map(of);
            let block = of_block(&of(values), &of(variance), left_out.as_ref())?;
            let mut there = found.view_mut((first, begin), (rows, columns));
            there.copy_from(&block);
        }
    }
    Ok(Some(found))
}

/// Standard errors ε |x̂| of photographs `phi` with `noise` ε relative to each entry, and by how
/// many of its own standard errors the whole comes out too dark where entries are weighted by them:
/// 2 ε √N where nothing is expected of so few, else 0.
///
/// # Errors
/// Those of [`expected`].
pub fn relative_errors(
    phi: &Matrix,
    noise: f64,
    left_out: Option<&Matrix>,
) -> Result<(Matrix, f64), LinalgError> {
    let variance = phi.map(|x| noise * noise * x * x);
    Ok(match expected(phi, &variance, left_out)? {
        Some(light) => (light.map(|x| noise * x.abs()), 0.0),
        None => {
            let too_dark = 2.0 * noise * (phi.len() as f64).sqrt();
            (phi.map(|x| noise * x.abs()), too_dark)
        }
    })
}

/// First and number of so many in blocks of about the same size.
fn blocks(count: usize) -> impl Iterator<Item = (usize, usize)> {
    let parts = count.div_ceil(BLOCK);
    let begin = move |k: usize| k * count / parts;
    (0..parts).map(move |k| (begin(k), begin(k + 1) - begin(k)))
}

fn of_block(
    values: &Matrix,
    variance: &Matrix,
    left_out: Option<&Matrix>,
) -> Result<Matrix, LinalgError> {
    let counts = |at: &usize| left_out.is_none_or(|out| out[*at] == 0.0);
    let at: Vec<usize> = (0..values.len()).filter(counts).collect();
    let (noise, plain) = (Separable::of(variance, &at), Separable::of(values, &at));
    let unit = |at: usize| noise.at(at).sqrt();
    // Where there is no noise, or nothing beside it, values are what they are.
    let is_lit = |at: &usize| unit(*at) > 0.0 && plain.at(*at) > 0.0;
    if !at.iter().any(is_lit) {
        return Ok(values.clone());
    }
    let mut filled = Matrix::zeros(values.nrows(), values.ncols());
    for k in (0..filled.len()).filter(is_lit) {
        let own = if counts(&k) { values[k] } else { plain.at(k) };
        filled[k] = own / unit(k);
    }
    let rounds = if at.len() < values.len() { ROUNDS } else { 1 };
    let mut found = above_noise(&filled)?;
    for _ in 1..rounds {
        for k in (0..filled.len()).filter(|k| !counts(k)) {
            filled[k] = found[0][k];
        }
        found = above_noise(&filled)?;
    }
    let [with, itself] = found;
    let mut all = Matrix::zeros(values.nrows(), values.ncols());
    for at in at {
        if !is_lit(&at) {
            all[at] = values[at];
            continue;
        }
        let h = itself[at];
        let without = if h < MOST_ITSELF {
            (with[at] - h * filled[at]) / (1.0 - h)
        } else {
            with[at]
        };
        all[at] = (without * unit(at)).max(LEAST * plain.at(at));
    }
    Ok(all)
}

/// The directions of `matrix` that stand out of noise of size 1, and h of each entry.
fn above_noise(matrix: &Matrix) -> Result<[Matrix; 2], LinalgError> {
    let (m, n) = matrix.shape();
    let longer = m.max(n) as f64;
    let beta = m.min(n) as f64 / longer;
    let root = (beta * beta + 14.0 * beta + 1.0).sqrt();
    let lambda = (2.0 * (beta + 1.0) + 8.0 * beta / (beta + 1.0 + root)).sqrt();
    let found = svd(matrix)?;
    let kept = found.sigma.iter().filter(|s| **s > lambda * longer.sqrt());
    // Light is there whatever the noise.
    let kept = kept.count().max(1);
    let (u, vt) = (found.u.columns(0, kept), found.vt.rows(0, kept));
    let sigma = Matrix::from_diagonal(&found.sigma.rows(0, kept).into_owned());
    let of_rows: Vec<f64> = u.row_iter().map(|row| row.norm_squared()).collect();
    let of_columns: Vec<f64> = vt.column_iter().map(|v| v.norm_squared()).collect();
    let itself = Matrix::from_fn(m, n, |p, l| {
        of_rows[p] + of_columns[l] - of_rows[p] * of_columns[l]
    });
    Ok([u * sigma * vt, itself])
}

#[cfg(test)]
mod tests;
