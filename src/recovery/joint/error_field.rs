//! Errors that neighbouring pixels share, as a field over the photograph.
//!
//! What stands a little beside its place, and light from elsewhere, leave errors with the edges of
//! shadows. The error of each frame is noise of single pixels and a Matérn field of smoothness ½
//! with reflecting borders (Lindgren, Rue and Lindström 2011, 2.3), which the cosines T of a
//! photograph of columns × rows pixels diagonalise:
//!
//! > e_l ~ N(0, T diag(v) Tᵀ),   v_k = σ² + τ² w_k/w̄,
//! > w_k = (1 + ℓ²|k|²)^(−3/2),   k = π (i/columns, j/rows)
//!
//! |k|⁻³ is the spectrum of pictures with edges. (A smoother field, or a free spectrum, can be
//! likelier still: it takes most of the picture's own light for errors.) σ, τ and ℓ are the
//! likeliest given the prior of the picture, N(½, K), by expectation and maximisation (Dempster,
//! Laird and Rubin 1977) of
//!
//! > Σ_k n ln v_k + q_k/v_k,   q_k = E Σ_l r²\[k,l\],
//!
//! n frames, r what the picture and the light beside it leave over; the expectation is over both.

use nalgebra::{DMatrix, DVector};

use spectrum::{fitted, spectrum};

use super::elimination::{directions, unit, without_left, without_right};
use super::gaussian_process::MEAN;
use super::khatri_rao::gathered;
use crate::num::linalg::{Cholesky, gram_product, product, rows_times, tr_product};
use crate::recovery::{ErrorField, Estimated, Nuisance, Problem, Recovered, RecoveryError};

/// Errors of less than this share of the photographs are rounding.
const ROUNDING: f64 = 1e-5;
/// A change of the ln v that makes no difference, and how often they are looked for.
const SETTLED: f64 = 0.02;
const MOST_STEPS: usize = 40;
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
            phi: cosines(problem.phi, frame),
            c: cosines(problem.sides().0, frame),
            patterns: (of_frames.ncols() > 0).then(|| cosines(&of_frames, frame)),
            square: problem.phi.norm_squared() / problem.phi.len() as f64,
        })
    }

    /// v, one for each cosine.
    pub(super) fn variances(&self, field: &ErrorField) -> Vec<f64> {
        let shape = spectrum(self.frame, field.range);
        let of = |w: f64| field.pixel * field.pixel + field.shared * field.shared * w;
        shape.into_iter().map(of).collect()
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
        let mut field = start.unwrap_or(ErrorField {
            pixel: 0.01 * self.square.sqrt(),
            shared: 0.0,
            range: 1.0,
        });
        let mut v = self.variances(&field);
        for _ in 0..MOST_STEPS {
            problem.control.check()?;
            let Some(squares) = self.squares(problem, root.lower(), MEAN * unit, &v) else {
                return Ok(None);
            };
            field = fitted(&squares, self.frame);
            let next = self.variances(&field);
            let moved = v.iter().zip(&next).map(|(a, b)| libm::log(b / a).abs());
            let moved = moved.fold(0.0, f64::max);
            v = next;
            let mean = v.iter().sum::<f64>() / v.len() as f64;
            if mean < ROUNDING * ROUNDING * self.square {
                return Ok(None);
            }
            if moved < SETTLED {
                break;
            }
        }
        Ok(Some(field))
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
        let v = self.variances(field);
        DMatrix::from_fn(v.len(), self.phi.ncols(), |k, _| v[k].sqrt())
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

/// Tᵀ m: each column of m, a photograph, along its orthonormal cosines.
fn cosines(m: &DMatrix<f64>, frame: [usize; 2]) -> DMatrix<f64> {
    turned(m, frame.map(|n| one_sided(n).transpose()))
}

/// T m.
pub(super) fn from_cosines(m: &DMatrix<f64>, frame: [usize; 2]) -> DMatrix<f64> {
    turned(m, frame.map(one_sided))
}

/// A X Bᵀ of each column X (columns × rows) of m.
fn turned(m: &DMatrix<f64>, [a, b]: [DMatrix<f64>; 2]) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(m.nrows(), m.ncols());
    let b = b.transpose();
    for (from, mut to) in m.column_iter().zip(all.column_iter_mut()) {
        let picture = DMatrix::from_iterator(a.ncols(), b.nrows(), from.iter().copied());
        to.copy_from_slice(product(&product(&a, &picture), &b).as_slice());
    }
    all
}

/// √((2 − δ_i0)/n) cos(π i (x + ½)/n), x down, i across: orthonormal.
fn one_sided(n: usize) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |x, i| {
        let size = if i == 0 { 1.0 } else { 2.0 } / n as f64;
        let turn = i as f64 * (x as f64 + 0.5) / n as f64;
        size.sqrt() * libm::cos(std::f64::consts::PI * turn)
    })
}

mod spectrum;

#[cfg(test)]
mod tests;
