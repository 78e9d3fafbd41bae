//! Errors that neighbouring pixels share, in place of noise.
//!
//! What stands a little beside its place, and light from elsewhere, leave errors with the edges of
//! shadows: an [`ErrorField`] in each frame. (A smoother field, or a free spectrum, can be likelier
//! still: it takes most of the picture's own light for errors.) σ, τ and ℓ are the likeliest given
//! the prior of the picture, N(½, K), by expectation and maximisation (Dempster, Laird and Rubin
//! 1977) of
//!
//! > Σ_k n ln v_k + q_k/v_k,   q_k = E Σ_l r²\[k,l\],
//!
//! n frames, r what the picture and the light beside it leave over; the expectation is over both.

use nalgebra::{DMatrix, DVector};

use super::elimination::{directions, unit, without_left, without_right};
use super::gaussian_process::MEAN;
use super::khatri_rao::gathered;
use crate::num::cosines::{along_cosines, from_cosines};
use crate::num::linalg::{Cholesky, gram_product, product, rows_times, tr_product};
use crate::recovery::{ErrorField, Estimated, Nuisance, Problem, Recovered, RecoveryError};

/// What is added to the diagonal of K, of its mean.
const JITTER: f64 = 1e-10;
/// Terms of elements up to which it is looked for: some matrices of terms × terms each step.
const MOST_TERMS: usize = 4096;

/// The photographs and the camera side along the cosines.
pub(super) struct Along {
    frame: [usize; 2],
    phi: DMatrix<f64>,
    c: DMatrix<f64>,
    /// The frame's patterns, its constant the first of them; none where there are none.
    patterns: Option<DMatrix<f64>>,
    /// Mean square of an entry.
    square: f64,
}

impl Along {
    /// None where entries are left out, or a glare pattern or roughly known factors of the frames
    /// are asked for, which have no such form; and where there are not more entries than elements.
    pub(super) fn new(problem: &Problem<'_>, frame: [usize; 2]) -> Option<Self> {
        let nuisance = &problem.nuisance;
        let (pixels, spots) = problem.phi.shape();
        let plain = nuisance.left_out.is_none()
            && nuisance.glare.is_none()
            && !nuisance.has_gains()
            && problem.soft.is_none();
        let frames = spots - usize::from(nuisance.background);
        let few = problem.sides().0.ncols() <= MOST_TERMS;
        let many = pixels * frames > problem.elements();
        if !(plain && few && many) || frame[0].checked_mul(frame[1]) != Some(pixels) {
            return None;
        }
        let of_frames = nuisance.of_frames(pixels);
        Some(Self {
            frame,
            phi: along_cosines(problem.phi, frame),
            c: along_cosines(problem.sides().0, frame),
            patterns: (of_frames.ncols() > 0).then(|| along_cosines(&of_frames, frame)),
            square: problem.phi.norm_squared() / problem.phi.len() as f64,
        })
    }

    /// The likeliest field for pictures of covariance K, `unit`² and `unit`/2 their mean, from
    /// `start`; none where the errors are no more than rounding, or rounding ends the search.
    pub(super) fn likeliest(
        &self,
        problem: &Problem<'_>,
        k: &DMatrix<f64>,
        unit: f64,
        start: Option<ErrorField>,
    ) -> Result<Option<ErrorField>, RecoveryError> {
        let mut k = k * (unit * unit);
        let jitter = JITTER * k.trace() / k.nrows() as f64;
        (0..k.nrows()).for_each(|j| k[(j, j)] += jitter);
        let Some(root) = Cholesky::new(&k) else {
            return Ok(None);
        };
        let start = start.unwrap_or(ErrorField {
            pixel: 0.01 * self.square.sqrt(),
            shared: 0.0,
            range: 1.0,
        });
        ErrorField::maximised(start, self.frame, self.square, |_, v| {
            problem.control.check()?;
            Ok(self.squares(problem, root.lower(), MEAN * unit, v))
        })
    }

    /// q_k/n. With G = Σ_l A_lᵀ diag(v)⁻¹ A_l of the light of each element, what is beside it
    /// eliminated, and K = L Lᵀ the picture has the covariance L (1 + Lᵀ G L)⁻¹ Lᵀ.
    fn squares(
        &self,
        problem: &Problem<'_>,
        l: &DMatrix<f64>,
        mean: f64,
        v: &[f64],
    ) -> Option<Vec<f64>> {
        let (_, d, element) = problem.sides();
        let spots = self.phi.ncols();
        let roots: Vec<f64> = v.iter().map(|x| 1.0 / x.sqrt()).collect();
        let mut c = rows_times(self.c.clone(), &roots);
        let mut phi = rows_times(self.phi.clone(), &roots);
        let mut d = d.clone();
        let mut frames = spots;
        if problem.nuisance.background {
            let along = unit(&vec![1.0; spots]);
            without_right(&mut d, &along);
            without_right(&mut phi, &along);
            frames -= 1;
        }
        let mut leverage = vec![0.0; v.len()];
        for u in self
            .patterns
            .iter()
            .flat_map(|p| directions(p, |k| roots[k]))
        {
            without_left(&mut c, &u);
            without_left(&mut phi, &u);
            leverage
                .iter_mut()
                .zip(u.iter())
                .for_each(|(h, u)| *h += u * u);
        }
        let lasers = product(&d, &d.transpose());
        let mut gram = DMatrix::zeros(c.ncols(), c.ncols());
        gram_product(&mut gram, &c);
        gram.component_mul_assign(&lasers);
        let mut towards = tr_product(&c, &phi);
        towards.component_mul_assign(&d);
        let n = l.nrows();
        let of_elements = |m: &DMatrix<f64>| gathered(&element, m, n);
        let g = of_elements(&of_elements(&gram).transpose());
        let h = of_elements(&towards).column_sum();
        let mut inner = tr_product(l, &product(&g, l));
        (0..n).for_each(|j| inner[(j, j)] += 1.0);
        let half = Cholesky::new(&inner)?.forward(l.transpose());
        let covariance = tr_product(&half, &half);
        let grey = DVector::from_element(n, mean);
        let x = &grey + &covariance * (h - &g * &grey);
        let of_terms: Vec<f64> = element.iter().map(|j| x[*j]).collect();
        let left = phi - product(&c, &rows_times(d, &of_terms));
        let mut spread = lasers;
        for (t, j) in element.iter().enumerate() {
            for (s, i) in element.iter().enumerate() {
                spread[(s, t)] *= covariance[(*i, *j)];
            }
        }
        let spread = product(&c, &spread).component_mul(&c).column_sum();
        let of = |k: usize| left.row(k).norm_squared() + spread[k] + frames as f64 * leverage[k];
        let squares: Vec<f64> = (0..v.len()).map(|k| v[k] * of(k) / frames as f64).collect();
        squares.iter().all(|x| x.is_finite()).then_some(squares)
    }

    /// The problem along the cosines, of known errors `stderr`: √v in every frame.
    pub(super) fn problem<'b>(
        &'b self,
        problem: &Problem<'b>,
        stderr: &'b DMatrix<f64>,
    ) -> Problem<'b> {
        let nuisance = Nuisance {
            frame_constant: false,
            frame_patterns: self.patterns.as_ref(),
            ..problem.nuisance
        };
        problem.along(&self.phi, &self.c, stderr, nuisance)
    }

    /// √v, pixels × spots.
    pub(super) fn stderr(&self, field: &ErrorField) -> DMatrix<f64> {
        field.stderr(self.frame, self.phi.ncols())
    }

    /// What was recovered along the cosines, of the photographs themselves.
    pub(super) fn back(&self, problem: &Problem<'_>, found: &mut Recovered) {
        let Some(own) = found.nuisance.take() else {
            return;
        };
        let ones = usize::from(problem.nuisance.frame_constant);
        let all = own.frame_patterns;
        let mut constant = all
            .as_ref()
            .filter(|_| ones == 1)
            .map(|all| all.row(0).transpose());
        let patterns = problem.nuisance.frame_patterns.and(all);
        let mut background = own.background.map(|along| {
            let along = DMatrix::from_column_slice(along.len(), 1, along.as_slice());
            from_cosines(&along, self.frame).column(0).into_owned()
        });
        if let (Some(b), Some(a)) = (&mut constant, &mut background) {
            let common = a.mean();
            a.add_scalar_mut(-common);
            b.add_scalar_mut(common);
        }
        found.nuisance = Some(Estimated {
            frame_constant: constant,
            frame_patterns: patterns.map(|all| all.remove_rows(0, ones)),
            background,
            ..own
        });
    }
}

#[cfg(test)]
mod tests;
