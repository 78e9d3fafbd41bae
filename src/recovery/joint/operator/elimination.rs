//! How light beside that of the hidden surface is eliminated.
//!
//! Everything but ρ enters linearly once s ρ is one unknown, so it is eliminated exactly (variable
//! projection), never guessed first. With weights w_p v_l the constants b_l are all matrices u b'ᵀ
//! of the weighted problem, u_p = √w_p (of patterns √w_p F\[p,k\]), and the background all a' vᵀ,
//! v_l = √v_l; what either cannot reach is the tensor product of what is orthogonal to u and what
//! is orthogonal to v. So both at once are eliminated by
//!
//! > C̃ → (1 − û ûᵀ) C̃,   D̃ → D̃ (1 − v̂ v̂ᵀ),   Φ̃ → (1 − û ûᵀ) Φ̃ (1 − v̂ v̂ᵀ)
//!
//! and the product form stays. A glare pattern that differs from spot to spot has no such form:
//! [`super::stacked`].

use nalgebra::{DMatrix, DVector};

use crate::num::linalg::{Tolerance, columns_over, least_squares};
use crate::recovery::{Estimated, Nuisance, RecoveryError};

/// A pattern that others leave less of than this is one of theirs.
const DEPENDENT: f64 = 1e-12;

/// Orthonormal directions of the weighted patterns, √w_p F\[p,k\].
pub(in crate::recovery::joint) fn directions(
    patterns: &DMatrix<f64>,
    root: impl Fn(usize) -> f64,
) -> Vec<DVector<f64>> {
    let mut taken: Vec<DVector<f64>> = Vec::new();
    for pattern in patterns.column_iter() {
        let mut left = DMatrix::from_fn(pattern.len(), 1, |p, _| root(p) * pattern[p]);
        let length = left.norm();
        taken.iter().for_each(|u| without_left(&mut left, u));
        if left.norm() > DEPENDENT * length {
            taken.push(left.column(0).normalize());
        }
    }
    taken
}

/// û, the unit vector along the roots of the weights of one side.
pub(in crate::recovery::joint) fn unit(roots: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(roots).normalize()
}

/// (1 − û ûᵀ) m, twice: once leaves rounding of the size of what was removed.
pub(in crate::recovery::joint) fn without_left(m: &mut DMatrix<f64>, u: &DVector<f64>) {
    for _ in 0..2 {
        let along = u.transpose() * &*m;
        m.ger(-1.0, u, &along.transpose(), 1.0);
    }
}

/// m (1 − v̂ v̂ᵀ), likewise.
pub(in crate::recovery::joint) fn without_right(m: &mut DMatrix<f64>, v: &DVector<f64>) {
    for _ in 0..2 {
        let along = &*m * v;
        m.ger(-1.0, &along, v, 1.0);
    }
}

/// The sizes that fit best, in the weighted sum of squares, what the surface's light leaves over
/// (`left`, pixels × spots). `root`(p, l) is the square root of the weight; `coupled` the solution
/// of the terms of single frames, kind by kind, where a background ties them together.
pub(super) fn estimate(
    nuisance: &Nuisance<'_>,
    left: &DMatrix<f64>,
    root: impl Fn(usize, usize) -> f64,
    coupled: Option<&DVector<f64>>,
) -> Result<Estimated, RecoveryError> {
    let (pixels, spots) = left.shape();
    let weight = |p: usize, l: usize| root(p, l) * root(p, l);
    let patterns = nuisance.of_frames(pixels);
    let of_frames = patterns.ncols();
    let kinds = of_frames + usize::from(nuisance.glare.is_some());
    // Of each kind in each frame.
    let mut sizes = DMatrix::zeros(kinds, spots);
    if let Some(found) = coupled {
        sizes = DMatrix::from_fn(kinds, spots, |k, l| found[k * spots + l]);
    } else if kinds == 1 && nuisance.frame_constant {
        for l in 0..spots {
            sizes[(0, l)] = mean((0..pixels).map(|p| (weight(p, l), left[(p, l)])));
        }
    } else if kinds > 0 {
        for l in 0..spots {
            let own = nuisance.of_frame(&patterns, l);
            let columns = DMatrix::from_fn(pixels, kinds, |p, k| root(p, l) * own[(p, k)]);
            let lengths: Vec<f64> = columns.column_iter().map(|c| nonzero(c.norm())).collect();
            let columns = columns_over(columns, &lengths);
            let data = DVector::from_fn(pixels, |p, _| root(p, l) * left[(p, l)]);
            if columns.amax() == 0.0 {
                continue;
            }
            let found = least_squares(&columns, &data, Tolerance::Relative(1e-12))?.solution;
            sizes.set_column(l, &DVector::from_fn(kinds, |k, _| found[k] / lengths[k]));
        }
    }
    let ones = usize::from(nuisance.frame_constant);
    let row = |k: usize| sizes.row(k).transpose();
    let mut found = Estimated {
        frame_constant: nuisance.frame_constant.then(|| row(0)),
        frame_patterns: nuisance
            .frame_patterns
            .map(|patterns| sizes.rows(ones, patterns.ncols()).into_owned()),
        background: None,
        glare: nuisance.glare.map(|_| row(of_frames)),
        scale: None,
        gains: None,
        freedom: freedom(nuisance, &patterns, spots, &root),
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

/// Directions that the terms take up: those of each frame, and with a background one for each pixel
/// that counts, less the patterns of the frames that are the same in all of them.
fn freedom(
    nuisance: &Nuisance<'_>,
    patterns: &DMatrix<f64>,
    spots: usize,
    root: impl Fn(usize, usize) -> f64,
) -> usize {
    let pixels = patterns.nrows();
    let of_frame = |l: usize| directions(&nuisance.of_frame(patterns, l), |p| root(p, l)).len();
    let frames: usize = (0..spots).map(of_frame).sum();
    if !nuisance.background {
        return frames;
    }
    let counts = |p: usize| (0..spots).any(|l| root(p, l) > 0.0);
    let seen = (0..pixels).filter(|p| counts(*p)).count();
    frames + seen - directions(patterns, |p| f64::from(u8::from(counts(p)))).len()
}

fn nonzero(x: f64) -> f64 {
    if x > 0.0 { x } else { 1.0 }
}

/// The weighted mean of (weight, value) pairs.
fn mean(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (weights, sum) = pairs.fold((0.0, 0.0), |(weights, sum), (w, x)| {
        (weights + w, sum + w * x)
    });
    if weights > 0.0 { sum / weights } else { 0.0 }
}

#[cfg(test)]
mod tests;
