//! How light beside that of the hidden surface is eliminated.
//!
//! Everything but ρ enters linearly once s ρ is one unknown, so it is eliminated exactly (variable
//! projection), never guessed first. With weights w_p v_l the constants b_l are all matrices u b'ᵀ
//! of the weighted problem, u_p = √w_p, and the background all a' vᵀ, v_l = √v_l; what either
//! cannot reach is the tensor product of what is orthogonal to u and what is orthogonal to v. So
//! both at once are eliminated by
//!
//! > C̃ → (1 − û ûᵀ) C̃,   D̃ → D̃ (1 − v̂ v̂ᵀ),   Φ̃ → (1 − û ûᵀ) Φ̃ (1 − v̂ v̂ᵀ)
//!
//! and the product form stays. A glare pattern that differs from spot to spot has no such form:
//! [`super::stacked`].

use nalgebra::{DMatrix, DVector};

use super::stacked::Coupled;
use crate::num::linalg::{Tolerance, columns_over, least_squares};
use crate::recovery::{Estimated, Nuisance, RecoveryError};

/// û, the unit vector along the roots of the weights of one side.
pub(super) fn unit(roots: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(roots).normalize()
}

/// (1 − û ûᵀ) m, twice: once leaves rounding of the size of what was removed.
pub(super) fn without_left(m: &mut DMatrix<f64>, u: &DVector<f64>) {
    for _ in 0..2 {
        let along = u.transpose() * &*m;
        m.ger(-1.0, u, &along.transpose(), 1.0);
    }
}

/// m (1 − v̂ v̂ᵀ), likewise.
pub(super) fn without_right(m: &mut DMatrix<f64>, v: &DVector<f64>) {
    for _ in 0..2 {
        let along = &*m * v;
        m.ger(-1.0, &along, v, 1.0);
    }
}

/// The sizes that fit best, in the weighted sum of squares, what the surface's light leaves over
/// (`left`, pixels × spots). `root`(p, l) is the square root of the weight; `coupled` the solution
/// of the terms of single frames where a background ties them together.
pub(super) fn estimate(
    nuisance: &Nuisance<'_>,
    left: &DMatrix<f64>,
    root: impl Fn(usize, usize) -> f64,
    coupled: Option<(&Coupled, &DVector<f64>)>,
) -> Result<Estimated, RecoveryError> {
    let (pixels, spots) = left.shape();
    let weight = |p: usize, l: usize| root(p, l) * root(p, l);
    let mut constant = nuisance.frame_constant.then(|| DVector::zeros(spots));
    let mut glare = nuisance.glare.map(|_| DVector::zeros(spots));
    if let Some((coupled, rho)) = coupled {
        let sizes = coupled.solve(rho);
        if let Some(b) = constant.as_mut() {
            b.copy_from(&sizes.rows(0, spots));
        }
        if let Some(g) = glare.as_mut() {
            g.copy_from(&sizes.rows(sizes.len() - spots, spots));
        }
    } else if let Some(pattern) = nuisance.glare {
        for l in 0..spots {
            let ones = usize::from(nuisance.frame_constant);
            let columns = DMatrix::from_fn(pixels, ones + 1, |p, k| {
                root(p, l) * if k < ones { 1.0 } else { pattern[(p, l)] }
            });
            let lengths: Vec<f64> = columns.column_iter().map(|c| nonzero(c.norm())).collect();
            let columns = columns_over(columns, &lengths);
            let data = DVector::from_fn(pixels, |p, _| root(p, l) * left[(p, l)]);
            if columns.amax() == 0.0 {
                continue;
            }
            let sizes = least_squares(&columns, &data, Tolerance::Relative(1e-12))?.solution;
            if let Some(b) = constant.as_mut() {
                b[l] = sizes[0] / lengths[0];
            }
            if let Some(g) = glare.as_mut() {
                g[l] = sizes[ones] / lengths[ones];
            }
        }
    } else if let Some(b) = constant.as_mut() {
        for l in 0..spots {
            b[l] = mean((0..pixels).map(|p| (weight(p, l), left[(p, l)])));
        }
    }
    let mut found = Estimated {
        frame_constant: constant,
        background: None,
        glare,
        scale: None,
    };
    if nuisance.background {
        let rest = left - found.light(nuisance, pixels, spots);
        let mut a = DVector::from_fn(pixels, |p, _| {
            mean((0..spots).map(|l| (weight(p, l), rest[(p, l)])))
        });
        if let Some(b) = found.frame_constant.as_mut() {
            let common = mean((0..pixels).map(|p| (weight(p, 0), a[p])));
            a.add_scalar_mut(-common);
            b.add_scalar_mut(common);
        }
        found.background = Some(a);
    }
    Ok(found)
}

fn nonzero(x: f64) -> f64 {
    if x > 0.0 { x } else { 1.0 }
}

/// The weighted mean of (weight, value) pairs.
fn mean(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (weights, sum) = pairs.fold((0.0, 0.0), |(weights, sum), (w, x)| {
        (weights + w, sum + w * x)
    });
    sum / weights
}

#[cfg(test)]
mod tests;
