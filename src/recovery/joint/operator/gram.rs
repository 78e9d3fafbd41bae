//! The normal equations of many elements, each entry of Φ with its own weight.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::conditional::{Conditional, One, soften_whole};
use super::stacked::Stacked;
use crate::num::linalg::{Gram, gram_product, pivoted_triangle, tr_product_of};
use crate::recovery::{Problem, RecoveryError};
use frame::Frame;

/// Elements whose Gram matrix is formed whole, at half the cost of all its columns one by one.
const WHOLE: usize = 2048;
/// Multiplications that it, or the columns of that of more elements, may take.
const MOST_WORK: f64 = 2e12;
/// Parts of the spots that are summed side by side: a fixed number, whatever the threads.
const PARTS: usize = 4;
/// Terms that are multiplied at once.
const TERMS: usize = 512;
/// Pixels of a frame whose rows are held at once.
const STRIP: usize = 512;
/// The trace of the Gram matrix, in units of the noise, that may be left out: of n reflectances up
/// to 1 the light of what is lost is at most √(n·1e-6) standard deviations in all of Φ together.
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

/// What of the trace of the Gram matrix may be left out: with a free scale of s ρ, by the scale of
/// a grey surface, whose light M has ⟨Φ, M⟩ = `along` and ⟨M, M⟩ = `grey`; ⟨Φ, Φ⟩ = `square`.
pub(super) fn lost(problem: &Problem<'_>, [along, grey, square]: [f64; 3]) -> f64 {
    let factor = || grey_factor(along, grey, square);
    match problem.nuisance.free_scale.then(factor).flatten() {
        Some(scale) => LOST / (scale * scale),
        None => LOST,
    }
}

/// ‖√W (Φ − Σ_j ρ_j A_j)‖² without what constants and glare of the frames take, as ‖R ρ − d‖² +
/// rest², from the Gram matrix
///
/// > G_ij = Σ_pl w\[p,l\] A_i\[p,l\] A_j\[p,l\],
///
/// whole of up to [`WHOLE`] elements; of more from those of its columns that its Cholesky factor
/// with pivots asks for, one for each direction that the noise leaves ([`LOST`]). `root`(p, l) is
/// √w, 1/σ. `None` where that is below the rounding of G, where it takes too long, and with a
/// background, which ties the frames together.
pub(super) fn reduced(
    problem: &Problem<'_>,
    root: impl Fn(usize, usize) -> f64 + Sync,
) -> Result<Option<Stacked>, RecoveryError> {
    if problem.nuisance.background {
        return Ok(None);
    }
    let rows = Rows::new(problem, &root);
    let of_data = rows.weigh(problem.phi);
    let square = of_data.norm_squared();
    // A factor that is known roughly multiplies the light of the surface, and would take it.
    let known = problem.soft.map(|_| problem.with_known_factors());
    let known = known.as_ref().map(|known| Rows::new(known, &root));
    let known = known.as_ref().unwrap_or(&rows);
    let grey = known.weigh(&problem.light(&DVector::from_element(problem.elements(), GREY)));
    let seen = known.weigh(problem.phi);
    let sizes = [seen.dot(&grey), grey.norm_squared(), seen.norm_squared()];
    let lost = lost(problem, sizes);
    let moment = rows.gathered(&of_data);
    let found = if problem.elements() <= WHOLE {
        let Some(whole) = rows.whole() else {
            problem.control.check()?;
            return Ok(None);
        };
        let gram = Gram {
            diagonal: whole.diagonal(),
            column: |j| Some(whole.column(j).into_owned()),
            most: problem.elements(),
        };
        pivoted_triangle(gram, &moment, square, lost)?
    } else {
        let gram = Gram {
            diagonal: rows.diagonal(),
            column: |j| {
                rows.goes_on()
                    .then(|| rows.gathered(&rows.weigh(&rows.light(j))))
            },
            most: (MOST_WORK / rows.work()) as usize,
        };
        pivoted_triangle(gram, &moment, square, lost)?
    };
    let Some(mut triangle) = found else {
        problem.control.check()?;
        return Ok(None);
    };
    let frames = rows.gains();
    let whole = soften_whole(&mut triangle, problem.soft);
    Ok(Some(Stacked {
        triangle,
        coupled: None,
        frames,
        whole,
    }))
}

/// The rows of all pixels and spots, weighted, without what a frame's patterns and glare could be.
struct Rows<'a> {
    problem: &'a Problem<'a>,
    c: &'a DMatrix<f64>,
    d: &'a DMatrix<f64>,
    /// The element of each column of C.
    element: Vec<usize>,
    /// √w, pixels × spots.
    root: DMatrix<f64>,
    frames: Vec<Frame>,
}

/// The pixels of a frame, strip by strip.
fn strips(pixels: usize) -> impl Iterator<Item = Range<usize>> {
    let firsts = (0..pixels).step_by(STRIP);
    firsts.map(move |first| first..pixels.min(first + STRIP))
}

impl<'a> Rows<'a> {
    fn new(problem: &'a Problem<'a>, root: impl Fn(usize, usize) -> f64) -> Self {
        let (pixels, spots) = problem.phi.shape();
        let (c, d, element) = problem.sides();
        let root = DMatrix::from_fn(pixels, spots, root);
        let patterns = problem.nuisance.of_frames(pixels);
        let frame = |l: usize| Frame::new(problem, &patterns, root.column(l).as_slice(), l);
        Rows {
            frames: (0..spots).map(frame).collect(),
            problem,
            c,
            d,
            element,
            root,
        }
    }

    /// The rows of a light of pixels × spots, W.
    fn weigh(&self, light: &DMatrix<f64>) -> DMatrix<f64> {
        let mut rows = light.component_mul(&self.root);
        for (frame, mut column) in self.frames.iter().zip(rows.column_iter_mut()) {
            frame.take_out(&mut column);
        }
        rows
    }

    /// Whether nobody asks to stop.
    fn goes_on(&self) -> bool {
        !self.problem.control.stopped()
    }

    /// Multiplications of a column.
    fn work(&self) -> f64 {
        (self.root.len() * self.element.len()) as f64
    }

    /// √w A of some pixels of frame l, a column for each element, without what the frame's first
    /// steps take: `along` their directions.
    fn strip(&self, l: usize, pixels: &Range<usize>, along: &[DMatrix<f64>]) -> DMatrix<f64> {
        let mut rows = DMatrix::zeros(pixels.len(), self.problem.elements());
        for (s, j) in self.element.iter().enumerate() {
            let c = self.c.column(s);
            let c = c.rows_range(pixels.clone());
            rows.column_mut(*j).axpy(self.d[(s, l)], &c, 1.0);
        }
        let root = self.root.column(l);
        for mut column in rows.column_iter_mut() {
            column.component_mul_assign(&root.rows_range(pixels.clone()));
        }
        for ((u, _), along) in self.frames[l].steps().zip(along) {
            rows.gemm(-1.0, &u.rows_range(pixels.clone()), along, 1.0);
        }
        rows
    }

    /// s Uᵀ rows of each step of frame l, all of its pixels summed.
    fn along(&self, l: usize) -> Vec<DMatrix<f64>> {
        let mut found: Vec<DMatrix<f64>> = Vec::new();
        for (u, share) in self.frames[l].steps() {
            let mut sum = DMatrix::zeros(u.ncols(), self.problem.elements());
            for pixels in strips(u.nrows()) {
                let rows = self.strip(l, &pixels, &found);
                sum.gemm_tr(share, &u.rows_range(pixels), &rows, 1.0);
            }
            found.push(sum);
        }
        found
    }

    /// G, frame by frame, a strip of each at a time; none where it is not to be gone on, or takes
    /// too long.
    fn whole(&self) -> Option<DMatrix<f64>> {
        let (n, spots) = (self.problem.elements(), self.frames.len());
        if (self.root.len() * n * n) as f64 > MOST_WORK {
            return None;
        }
        let part = |frames: Range<usize>| {
            let mut sum = DMatrix::zeros(n, n);
            for l in frames.take_while(|_| self.goes_on()) {
                let along = self.along(l);
                for pixels in strips(self.root.nrows()) {
                    gram_product(&mut sum, &self.strip(l, &pixels, &along));
                }
            }
            sum
        };
        let parts = (0..PARTS).into_par_iter();
        let parts = parts.map(|k| k * spots / PARTS..(k + 1) * spots / PARTS);
        let parts = parts.filter(|frames| !frames.is_empty());
        let parts: Vec<DMatrix<f64>> = parts.map(part).collect();
        let whole = parts.into_iter().reduce(|sum, part| sum + part);
        whole.filter(|_| self.goes_on())
    }

    /// A_j, pixels × spots.
    fn light(&self, j: usize) -> DMatrix<f64> {
        let mut light = DMatrix::zeros(self.root.nrows(), self.root.ncols());
        for (s, _) in self.element.iter().enumerate().filter(|(_, of)| **of == j) {
            let along = self.d.row(s).transpose();
            light.ger(1.0, &self.c.column(s), &along, 1.0);
        }
        light
    }

    /// The squares of the elements' rows.
    fn diagonal(&self) -> DVector<f64> {
        let own = |j: usize| self.weigh(&self.light(j)).norm_squared();
        let own: Vec<f64> = (0..self.problem.elements())
            .into_par_iter()
            .map(own)
            .collect();
        DVector::from_vec(own)
    }

    /// The product of each element's rows with `rows`, which are weighed.
    fn gathered(&self, rows: &DMatrix<f64>) -> DVector<f64> {
        let mut back = rows.clone();
        for (l, mut column) in back.column_iter_mut().enumerate() {
            self.frames[l].take_out(&mut column);
            column.component_mul_assign(&self.root.column(l));
        }
        // Σ_l (Cᵀ back)[s,l] D[s,l], terms side by side.
        let terms: Vec<usize> = (0..self.element.len()).collect();
        let of_terms = terms.par_chunks(TERMS).flat_map_iter(|terms| {
            let (first, several) = (terms[0], terms.len());
            let along = tr_product_of(self.c, first..first + several, &back);
            let both = along.component_mul(&self.d.rows(first, several));
            both.column_sum().data.as_vec().clone()
        });
        let of_terms: Vec<f64> = of_terms.collect();
        let mut sums = DVector::zeros(self.problem.elements());
        for (x, j) in of_terms.iter().zip(&self.element) {
            sums[*j] += x;
        }
        sums
    }

    /// The factors of the frames as they follow from x, where they are known roughly.
    fn gains(&self) -> Option<Conditional> {
        let each = self.frames.iter().enumerate();
        let gains = each.filter_map(|(l, frame)| {
            let (m, softening) = frame.softly.as_ref()?;
            let seen = m.column(0).component_mul(&self.root.column(l));
            let of_terms = self.c.tr_mul(&seen).component_mul(&self.d.column(l));
            let mut along = DVector::zeros(self.problem.elements() + 1);
            for (s, j) in self.element.iter().enumerate() {
                along[*j] += of_terms[s];
            }
            along[self.problem.elements()] = seen.dot(&self.problem.phi.column(l));
            Some(One::new(along, softening))
        });
        let gains: Vec<One> = gains.collect();
        (!gains.is_empty()).then(|| Conditional::of(&gains))
    }
}

mod frame;
#[cfg(test)]
mod tests;
