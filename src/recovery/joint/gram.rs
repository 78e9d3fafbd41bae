//! The normal equations of many elements, each entry of Φ with its own weight.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::conditional::{Conditional, One, soften, soften_whole};
use super::elimination::{directions, without_left};
use super::stacked::Stacked;
use crate::num::linalg::{gram_product, pivoted_triangle};
use crate::recovery::{Problem, RecoveryError};

/// Multiplications that the Gram matrix may take.
const MOST_WORK: f64 = 2e12;
/// Parts of the spots that are summed side by side: a fixed number, whatever the threads.
const PARTS: usize = 4;
/// The trace of the Gram matrix, in units of the noise, that may be left out: of n reflectances up to
/// 1 the light of what is lost is at most √(n·1e-6) standard deviations in all of Φ together.
const LOST: f64 = 1e-6;
/// A grey picture.
pub(super) const GREY: f64 = 0.5;

/// ⟨Φ, M⟩/⟨M, M⟩ from ⟨Φ, M⟩, ⟨M, M⟩ and ⟨Φ, Φ⟩, or ‖Φ‖/‖M‖ where that is not positive; none where
/// neither is.
pub(super) fn grey_factor(along: f64, grey: f64, square: f64) -> Option<f64> {
    let possible = |size: &f64| *size > 0.0 && size.is_finite();
    let best = Some(along / grey).filter(possible);
    best.or(Some((square / grey).sqrt()).filter(possible))
}

/// What of the trace of the Gram matrix may be left out: with a free scale of s ρ, by the scale of a grey
/// surface.
pub(super) fn lost(
    problem: &Problem<'_>,
    gram: &DMatrix<f64>,
    moment: &DVector<f64>,
    square: f64,
) -> f64 {
    let factor = || grey_factor(GREY * moment.sum(), GREY * GREY * gram.sum(), square);
    match problem.nuisance.free_scale.then(factor).flatten() {
        Some(scale) => LOST / (scale * scale),
        None => LOST,
    }
}

/// ‖√W (Φ − Σ_j ρ_j A_j)‖² without what constants and glare of the frames take, as ‖R ρ − d‖² +
/// rest², from
///
/// > G_ij = Σ_pl w\[p,l\] A_i\[p,l\] A_j\[p,l\],
///
/// frame by frame; `root`(p, l) is √w, 1/σ. R has the rows that the noise leaves ([`LOST`]). `None`
/// where that is below the rounding of G, where it takes too long, and with a background, which ties
/// the frames together.
pub(super) fn reduced(
    problem: &Problem<'_>,
    root: impl Fn(usize, usize) -> f64 + Sync,
) -> Result<Option<Stacked>, RecoveryError> {
    let (pixels, spots) = problem.phi.shape();
    let n = problem.elements();
    let work = (pixels * spots) as f64 * (n as f64) * (n as f64);
    if problem.nuisance.background || work > MOST_WORK {
        return Ok(None);
    }
    let (c, d, element) = problem.sides();
    let frame = |l: usize| {
        let mut rows = DMatrix::zeros(pixels, n + 1);
        for (s, j) in element.iter().enumerate() {
            rows.column_mut(*j).axpy(d[(s, l)], &c.column(s), 1.0);
        }
        rows.set_column(n, &problem.phi.column(l));
        for mut column in rows.column_iter_mut() {
            column
                .iter_mut()
                .enumerate()
                .for_each(|(p, x)| *x *= root(p, l));
        }
        let gain = without_frame(problem, &root, l, &mut rows);
        (rows, gain)
    };
    let part = |k: usize| {
        let mut sum = DMatrix::zeros(n + 1, n + 1);
        let mut gains: Vec<One> = Vec::new();
        for l in k * spots / PARTS..(k + 1) * spots / PARTS {
            let (rows, gain) = frame(l);
            gram_product(&mut sum, &rows);
            gains.extend(gain);
        }
        (sum, gains)
    };
    let parts: Vec<(DMatrix<f64>, Vec<One>)> = (0..PARTS).into_par_iter().map(part).collect();
    let sums = parts.iter().map(|(sum, _)| sum);
    let all = sums
        .skip(1)
        .fold(parts[0].0.clone(), |sum, part| sum + part);
    let gains: Vec<One> = parts.into_iter().flat_map(|(_, gains)| gains).collect();
    let gram = all.view((0, 0), (n, n)).into_owned();
    let moment = all.column(n).rows(0, n).into_owned();
    let square = all[(n, n)];
    let lost = lost(problem, &gram, &moment, square);
    let Some(mut triangle) = pivoted_triangle(&gram, &moment, square, lost)? else {
        return Ok(None);
    };
    let whole = soften_whole(&mut triangle, problem.soft);
    Ok(Some(Stacked {
        triangle,
        coupled: None,
        frames: (!gains.is_empty()).then(|| Conditional::of(&gains)),
        whole,
    }))
}

/// Takes out of the weighted rows of frame l what its patterns and its glare could be, and softly its
/// factor.
fn without_frame(
    problem: &Problem<'_>,
    root: &impl Fn(usize, usize) -> f64,
    l: usize,
    rows: &mut DMatrix<f64>,
) -> Option<One> {
    let nuisance = &problem.nuisance;
    let patterns = nuisance.of_frame(&nuisance.of_frames(rows.nrows()), l);
    let taken = directions(&patterns, |p| root(p, l));
    taken.iter().for_each(|u| without_left(rows, u));
    let soft = problem.soft?;
    let (pattern, known_to) = soft.frames.as_ref()?;
    let mut own = DMatrix::from_fn(rows.nrows(), 1, |p, _| root(p, l) * pattern[(p, l)]);
    taken.iter().for_each(|u| without_left(&mut own, u));
    Some(soften(rows, &own.column(0), known_to / soft.noise))
}

#[cfg(test)]
mod tests {
    use super::super::stacked::stack;
    use super::*;
    use crate::num::linalg::Triangle;
    use crate::recovery::Nuisance;
    use crate::recovery::bench::{Bench, normal_stream};

    /// Differences of the objective are those of rows reduced by orthogonal transformations,
    /// with and without constants and glare, to what may be lost.
    #[test]
    fn it_is_the_objective_of_the_rows() {
        let bench = Bench::new(3.0, 6, 8);
        let exact = bench.phi(&bench.board(2));
        let stderr = exact.map(|x| 0.02 * x.abs() + 1e-3 * exact.amax());
        let mut normal = normal_stream(3);
        let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
        let pattern = DMatrix::from_fn(64, 120, |p, l| 1.0 + ((p * 7 + l) % 11) as f64);
        let plain = Nuisance::default();
        let cases = [
            plain,
            Nuisance {
                frame_constant: true,
                ..plain
            },
            Nuisance {
                frame_constant: true,
                glare: Some(&pattern),
                ..plain
            },
        ];
        for nuisance in cases {
            let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
            let problem = problem.with_nuisance(nuisance).unwrap();
            let root = |p: usize, l: usize| 1.0 / stderr[(p, l)];
            let found = reduced(&problem, root).unwrap().unwrap().triangle;
            let whole = stack(&problem, root).unwrap().triangle;
            assert!(
                found.r.nrows() < 36 && whole.r.nrows() == 36,
                "{}",
                found.r.nrows()
            );
            let of =
                |t: &Triangle, x: &DVector<f64>| (&t.r * x - &t.d).norm_squared() + t.rest * t.rest;
            for _ in 0..10 {
                let x = DVector::from_fn(36, |_, _| libm::erfc(normal()) / 2.0);
                let [a, b] = [&found, &whole].map(|t| of(t, &x).sqrt());
                assert!((a - b).abs() < (36.0 * LOST).sqrt(), "{a} {b}");
            }
        }
        let background = Nuisance {
            background: true,
            ..plain
        };
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let problem = problem.with_nuisance(background).unwrap();
        assert!(reduced(&problem, |_, _| 1.0).unwrap().is_none());
        // In units of a millionth of the noise too much is below the rounding.
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let finer = |p: usize, l: usize| 1e6 / stderr[(p, l)];
        assert!(reduced(&problem, finer).unwrap().is_none());
    }
}
