//! Variances of the expected light in place of those of the light that was measured.
//!
//! The variance of an entry goes with its light, V = k Φ + c. By the light that was measured an
//! entry that noise has made darker counts as more certain: weighted by 1/V the mean of counts of μ
//! electrons comes out as μ − 1, and χ² too large. Photographs of a hidden surface have few
//! directions, and V as many; the noise k√V that V has from its light has all of them. So V is
//!
//! > V̂ = Σ_k u_k σ_k v_kᵀ  over σ_k > λ √n
//!
//! where V is in units of that noise (as far as it is a product of a number of its pixel and one of
//! its spot), n the longer side, and λ the threshold of least error for noise of size 1 (Gavish and
//! Donoho, *The optimal hard threshold for singular values is 4/√3*, IEEE Trans. Inf. Theory 60,
//! 2014). Where light is plenty all directions are above it, and V stays.

use super::error::{PhotographError, refused};
use crate::matrix::Matrix;
use crate::num::linalg::{LinalgError, svd};
use crate::num::separable::Separable;

/// Pixels and spots of a block that is decomposed by itself: a second.
const BLOCK: usize = 512;
/// Pixels or spots below which noise is no smaller than a direction.
const FEWEST: usize = 8;
/// Rounds in which entries that are left out take what the others say.
const ROUNDS: usize = 4;
/// The least that is expected, in what the product of its pixel and its spot has: a sum of few
/// directions may be negative.
const LEAST: f64 = 0.05;

/// The variances, W², of Φ whose variances by its own light are `variance`, and rise with it by
/// `slope`, W, both pixels × spots; 0 where a `left_out` is not 0. None of fewer than 8 pixels or
/// spots, where each is all there is.
///
/// # Errors
/// Where a decomposition does not converge.
pub(super) fn expected(
    variance: &Matrix,
    slope: &Matrix,
    left_out: &Matrix,
) -> Result<Option<Matrix>, PhotographError> {
    let (pixels, spots) = variance.shape();
    if pixels < FEWEST || spots < FEWEST {
        return Ok(None);
    }
    let mut found = Matrix::zeros(pixels, spots);
    for (first, rows) in blocks(pixels) {
        for (begin, columns) in blocks(spots) {
            let of = |m: &Matrix| m.view((first, begin), (rows, columns)).into_owned();
            let block = of_block(&of(variance), &of(slope), &of(left_out));
            let block = block.map_err(|e| {
                let cause = format!("the variances of the photographs have no decomposition: {e}");
                refused(
                    cause,
                    "look for photographs without light, or far out of scale",
                )
            })?;
            found
                .view_mut((first, begin), (rows, columns))
                .copy_from(&block);
        }
    }
    Ok(Some(found))
}

/// First and number of so many in blocks of about the same size.
fn blocks(count: usize) -> impl Iterator<Item = (usize, usize)> {
    let parts = count.div_ceil(BLOCK);
    let begin = move |k: usize| k * count / parts;
    (0..parts).map(move |k| (begin(k), begin(k + 1) - begin(k)))
}

fn of_block(variance: &Matrix, slope: &Matrix, left_out: &Matrix) -> Result<Matrix, LinalgError> {
    let counts = |at: &usize| left_out[*at] == 0.0;
    let at: Vec<usize> = (0..variance.len()).filter(counts).collect();
    let noise = variance.zip_map(slope, |v, k| k * k * v);
    let (noise, plain) = (Separable::of(&noise, &at), Separable::of(variance, &at));
    let unit = |at: usize| noise.at(at).sqrt();
    // Where no noise comes from light, or there is none, V is what it is.
    if at.iter().any(|at| unit(*at) <= 0.0 || plain.at(*at) <= 0.0) {
        return Ok(variance.clone());
    }
    let mut filled = Matrix::zeros(variance.nrows(), variance.ncols());
    for k in 0..filled.len() {
        let own = if counts(&k) { variance[k] } else { plain.at(k) };
        filled[k] = own / unit(k);
    }
    let rounds = if at.len() < variance.len() { ROUNDS } else { 1 };
    let mut found = filled.clone();
    for _ in 0..rounds {
        found = above_noise(&filled)?;
        for k in (0..filled.len()).filter(|k| !counts(k)) {
            filled[k] = found[k];
        }
    }
    let mut all = Matrix::zeros(variance.nrows(), variance.ncols());
    for at in at {
        all[at] = (found[at] * unit(at)).max(LEAST * plain.at(at));
    }
    Ok(all)
}

/// The directions of `matrix` that stand out of noise of size 1.
fn above_noise(matrix: &Matrix) -> Result<Matrix, LinalgError> {
    let (m, n) = matrix.shape();
    let longer = m.max(n) as f64;
    let beta = m.min(n) as f64 / longer;
    let root = (beta * beta + 14.0 * beta + 1.0).sqrt();
    let lambda = (2.0 * (beta + 1.0) + 8.0 * beta / (beta + 1.0 + root)).sqrt();
    let found = svd(matrix)?;
    let kept = found.sigma.iter().filter(|s| **s > lambda * longer.sqrt());
    // Light is there whatever the noise.
    let kept = kept.count().max(1);
    let sigma = Matrix::from_diagonal(&found.sigma.rows(0, kept).into_owned());
    Ok(found.u.columns(0, kept) * sigma * found.vt.rows(0, kept))
}

#[cfg(test)]
mod tests;
