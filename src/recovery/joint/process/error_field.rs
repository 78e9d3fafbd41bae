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
//! Whether a field is likelier than noise of single pixels alone the likelihoods of both say.

use nalgebra::{DMatrix, DVector};

use super::gaussian_process::MEAN;
use crate::num::cosines::{along_cosines, from_cosines};
use crate::num::linalg::{Cholesky, gram_product, product, rows_times, tr_product};
use crate::recovery::joint::operator::elimination::{
    directions, unit, without_left, without_right,
};
use crate::recovery::joint::operator::khatri_rao::gathered;
use crate::recovery::{ErrorField, Estimated, Nuisance, Problem, Recovered, RecoveryError};

/// What is added to the diagonal of K, of its mean.
const JITTER: f64 = 1e-10;
/// Terms of elements up to which it is looked for: some matrices of terms × terms each step.
const MOST_TERMS: usize = 4096;

/// A change of σ² that makes no difference where errors are of single pixels, and how often it is
/// looked for.
const SETTLED: f64 = 1e-3;
const MOST_STEPS: usize = 100;

/// What is left over for errors of given v, in expectation.
struct Expected {
    /// q_k/n.
    squares: Vec<f64>,
    /// ln p(Φ | v, K), other light eliminated; but for what is the same for all v.
    log_likelihood: f64,
}

/// The photographs and the camera side along the cosines.
pub(super) struct Along {
    frame: [usize; 2],
    phi: DMatrix<f64>,
    c: DMatrix<f64>,
    /// The frame's patterns, its constant the first of them; none where there are none.
    patterns: Option<DMatrix<f64>>,
    /// U, an orthonormal basis of them.
    basis: Option<DMatrix<f64>>,
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
        let patterns = (of_frames.ncols() > 0).then(|| along_cosines(&of_frames, frame));
        let basis = patterns.as_ref().map(|p| directions(p, |_| 1.0));
        Some(Self {
            frame,
            phi: along_cosines(problem.phi, frame),
            c: along_cosines(problem.sides().0, frame),
            patterns,
            basis: basis.map(|u| DMatrix::from_columns(&u)),
            square: problem.phi.norm_squared() / problem.phi.len() as f64,
        })
    }

    /// The likeliest field for pictures of covariance K, `unit`² and `unit`/2 their mean, from
    /// `start`, and the ln of its likelihood; none where the errors are no more than rounding, or
    /// rounding ends the search.
    pub(super) fn likeliest(
        &self,
        problem: &Problem<'_>,
        k: &DMatrix<f64>,
        unit: f64,
        start: Option<ErrorField>,
    ) -> Result<Option<(ErrorField, f64)>, RecoveryError> {
        let Some(root) = root(k, unit) else {
            return Ok(None);
        };
        let of = |v: &[f64]| self.expected(problem, root.lower(), MEAN * unit, v);
        let start = start.unwrap_or(ErrorField {
            pixel: 0.01 * self.square.sqrt(),
            shared: 0.0,
            range: 1.0,
        });
        let found = ErrorField::maximised(start, self.frame, self.square, |_, v| {
            problem.control.check()?;
            Ok::<_, RecoveryError>(of(v).map(|found| found.squares))
        })?;
        Ok(found.and_then(|field| {
            let own = of(&field.variances(self.frame))?;
            Some((field, own.log_likelihood))
        }))
    }

    /// ln of the likelihood of noise of single pixels alone, as large as is likeliest from `start`
    /// on; none where rounding ends the search.
    pub(super) fn alone(
        &self,
        problem: &Problem<'_>,
        k: &DMatrix<f64>,
        unit: f64,
        start: f64,
    ) -> Result<Option<f64>, RecoveryError> {
        let Some(root) = root(k, unit) else {
            return Ok(None);
        };
        let mut variance = start * start;
        let mut likelihood = None;
        for _ in 0..MOST_STEPS {
            problem.control.check()?;
            let v = vec![variance; self.phi.nrows()];
            let Some(found) = self.expected(problem, root.lower(), MEAN * unit, &v) else {
                return Ok(None);
            };
            likelihood = Some(found.log_likelihood);
            let next = found.squares.iter().sum::<f64>() / v.len() as f64;
            let moved = (next / variance - 1.0).abs();
            variance = next;
            if moved < SETTLED {
                break;
            }
        }
        Ok(likelihood)
    }

    /// With G = Σ_l A_lᵀ diag(v)⁻¹ A_l of the light of each element, what is beside it eliminated,
    /// K = L Lᵀ, m the pictures' mean and t = AᵀV⁻¹(Φ − A m) the slope there, the picture
    /// has the covariance P = L (1 + Lᵀ G L)⁻¹ Lᵀ, and
    ///
    /// > −2 ln p = n (ln det V + ln det UᵀV⁻¹U) + ln det(1 + LᵀGL) + ‖V^(−½)(Φ − A m)‖² − tᵀPt,
    ///
    /// U an orthonormal basis of the patterns (restricted likelihood: Harville 1977).
    fn expected(
        &self,
        problem: &Problem<'_>,
        l: &DMatrix<f64>,
        mean: f64,
        v: &[f64],
    ) -> Option<Expected> {
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
        let factor = Cholesky::new(&inner)?;
        let half = factor.forward(l.transpose());
        let covariance = tr_product(&half, &half);
        let grey = DVector::from_element(n, mean);
        let slope = &h - &g * &grey;
        let told = &covariance * &slope;
        // ‖Φ − A m‖² = ‖Φ‖² − 2 hᵀm + mᵀGm.
        let of_grey = phi.norm_squared() - grey.dot(&(&slope + &h));
        let chi2 = of_grey - slope.dot(&told);
        let log_errors = frames as f64
            * (v.iter().map(|v| libm::log(*v)).sum::<f64>() + self.log_patterns(v)?);
        let log_likelihood = -0.5 * (log_errors + factor.log_det() + chi2);
        let x = &grey + told;
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
        let is_finite = log_likelihood.is_finite() && squares.iter().all(|x| x.is_finite());
        is_finite.then_some(Expected {
            squares,
            log_likelihood,
        })
    }

    /// ln det UᵀV⁻¹U.
    fn log_patterns(&self, v: &[f64]) -> Option<f64> {
        let Some(basis) = &self.basis else {
            return Some(0.0);
        };
        let over: Vec<f64> = v.iter().map(|x| 1.0 / x).collect();
        let gram = tr_product(basis, &rows_times(basis.clone(), &over));
        Some(Cholesky::new(&gram)?.log_det())
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

/// L of L Lᵀ = K in the photographs' unit; none where rounding makes it indefinite.
fn root(k: &DMatrix<f64>, unit: f64) -> Option<Cholesky> {
    let mut k = k * (unit * unit);
    let jitter = JITTER * k.trace() / k.nrows() as f64;
    (0..k.nrows()).for_each(|j| k[(j, j)] += jitter);
    Cholesky::new(&k)
}

#[cfg(test)]
mod tests;
