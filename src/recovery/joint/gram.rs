//! The normal equations of many elements, each entry of Φ with its own weight.

use nalgebra::{DMatrix, DVector, DVectorViewMut};
use rayon::prelude::*;

use super::conditional::{Conditional, One, Softening, soften_whole};
use super::elimination::{directions, without_left};
use super::stacked::Stacked;
use crate::num::linalg::{Gram, gram_product, pivoted_triangle, tr_product};
use crate::recovery::{Problem, RecoveryError};

/// Elements whose Gram matrix is formed whole, at half the cost of all its columns one by one.
const WHOLE: usize = 2048;
/// Multiplications that it, or the columns of that of more elements, may take.
const MOST_WORK: f64 = 2e12;
/// Parts of the spots that are summed side by side: a fixed number, whatever the threads.
const PARTS: usize = 4;
/// Terms that are multiplied at once.
const TERMS: usize = 512;
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
/// surface, whose light M has ⟨Φ, M⟩ = `along` and ⟨M, M⟩ = `grey`; ⟨Φ, Φ⟩ = `square`.
pub(super) fn lost(problem: &Problem<'_>, along: f64, grey: f64, square: f64) -> f64 {
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
/// whole of up to [`WHOLE`] elements; of more from those of its columns that its Cholesky factor with
/// pivots asks for, one for each direction that the noise leaves ([`LOST`]). `root`(p, l) is √w, 1/σ.
/// `None` where that is below the rounding of G, where it takes too long, and with a background, which
/// ties the frames together.
pub(super) fn reduced(
    problem: &Problem<'_>,
    root: impl Fn(usize, usize) -> f64 + Sync,
) -> Result<Option<Stacked>, RecoveryError> {
    if problem.nuisance.background {
        return Ok(None);
    }
    let rows = Rows::new(problem, root);
    let of_data = rows.weigh(problem.phi);
    let grey = rows.weigh(&problem.light(&DVector::from_element(problem.elements(), GREY)));
    let square = of_data.norm_squared();
    let lost = lost(problem, of_data.dot(&grey), grey.norm_squared(), square);
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

/// What is taken out of the weighted rows of a frame.
struct Frame {
    /// Orthonormal directions, as a whole,
    taken: Vec<DVector<f64>>,
    /// and the frame's factor m, softly.
    softly: Option<(DVector<f64>, Softening)>,
}

impl Frame {
    fn new(problem: &Problem<'_>, patterns: &DMatrix<f64>, root: &[f64], l: usize) -> Self {
        let taken = directions(&problem.nuisance.of_frame(patterns, l), |p| root[p]);
        let frames = problem.soft.and_then(|soft| {
            let (pattern, known_to) = soft.frames.as_ref()?;
            Some((pattern.column(l), known_to / soft.noise))
        });
        let softly = frames.map(|(pattern, width)| {
            let mut m = DMatrix::from_fn(root.len(), 1, |p, _| root[p] * pattern[p]);
            taken.iter().for_each(|u| without_left(&mut m, u));
            let m = m.column(0).into_owned();
            let softening = Softening::new(m.norm_squared(), width);
            (m, softening)
        });
        Frame { taken, softly }
    }

    fn take_out(&self, rows: &mut DVectorViewMut<'_, f64>) {
        // Twice: once leaves rounding of the size of what was removed.
        for u in self.taken.iter().flat_map(|u| [u, u]) {
            let along = u.dot(rows);
            rows.axpy(-along, u, 1.0);
        }
        if let Some((m, softening)) = &self.softly {
            let along = m.dot(rows);
            rows.axpy(-softening.taken * along, m, 1.0);
        }
    }
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

    /// G, frame by frame; none where it is not to be gone on, or takes too long.
    fn whole(&self) -> Option<DMatrix<f64>> {
        let (n, spots) = (self.problem.elements(), self.frames.len());
        if (self.root.len() * n * n) as f64 > MOST_WORK {
            return None;
        }
        let frame = |l: usize| {
            let mut rows = DMatrix::zeros(self.root.nrows(), n);
            for (s, j) in self.element.iter().enumerate() {
                rows.column_mut(*j)
                    .axpy(self.d[(s, l)], &self.c.column(s), 1.0);
            }
            for mut column in rows.column_iter_mut() {
                column.component_mul_assign(&self.root.column(l));
                self.frames[l].take_out(&mut column);
            }
            rows
        };
        let part = |k: usize| {
            let mut sum = DMatrix::zeros(n, n);
            for l in k * spots / PARTS..(k + 1) * spots / PARTS {
                if self.goes_on() {
                    gram_product(&mut sum, &frame(l));
                }
            }
            sum
        };
        let parts: Vec<DMatrix<f64>> = (0..PARTS).into_par_iter().map(part).collect();
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
            let along = tr_product(&self.c.columns(first, several).into_owned(), &back);
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
            let seen = m.component_mul(&self.root.column(l));
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
