//! How the noise of an entry goes with its light.

use nalgebra::DVector;

use crate::matrix::Matrix;
use crate::num::linalg::Cholesky;

/// Powers of x of which σ² may be a sum, the fewest first.
const LAWS: [&[usize]; 5] = [&[1], &[2], &[0, 1], &[1, 2], &[0, 1, 2]];
/// How far a law may be off σ², relative: single precision.
const EXACT: f64 = 1e-5;
/// Entries that follow it at least, as a share and in number: those without light may have an
/// error of their own.
const MOST: f64 = 0.8;
const FEWEST: usize = 16;
/// A constant up to this share of the largest σ² is no law of the light.
const CONSTANT: f64 = 1e-3;

/// a, b and c of σ² = a + b x + c x², W², W and 1: noise that is the same in all entries, that of
/// counts of b each, and a share of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightLaw(pub [f64; 3]);

impl LightLaw {
    /// The one that the entries follow which have errors and are not `left_out`; none where none
    /// does, or it is of no light.
    pub(super) fn of(phi: &Matrix, stderr: &Matrix, left_out: Option<&Matrix>) -> Option<Self> {
        if phi.shape() != stderr.shape() {
            return None;
        }
        let counts = |at: &usize| stderr[*at] > 0.0 && left_out.is_none_or(|out| out[*at] == 0.0);
        let mut at: Vec<usize> = (0..phi.len()).filter(counts).collect();
        at.sort_by(|a, b| phi[*b].total_cmp(&phi[*a]));
        let brighter = &at[..at.len().div_ceil(2)];
        let unit = phi[*at.first()?];
        if at.len() < FEWEST || unit <= 0.0 {
            return None;
        }
        let law = |powers: &&[usize]| Self::fitted(powers, (phi, stderr), (brighter, unit));
        let found = LAWS.iter().filter_map(law).find(|law| {
            let follows = |at: &&usize| {
                let variance = stderr[**at] * stderr[**at];
                (law.variance(phi[**at]) - variance).abs() < EXACT * variance
            };
            let share = at.iter().filter(follows).count() as f64 / at.len() as f64;
            share >= MOST
        })?;
        // A sum of powers with a negative one is no noise; a constant alone has nothing of light.
        let whole = found.variance(unit);
        let LightLaw([a, b, c]) = found;
        let terms = [a, b * unit, c * unit * unit];
        let is_noise = terms.iter().all(|term| *term > -EXACT * whole);
        (is_noise && terms[1] + terms[2] > CONSTANT * whole).then_some(found)
    }

    /// By least squares of relative differences.
    fn fitted(
        powers: &[usize],
        (phi, stderr): (&Matrix, &Matrix),
        (at, unit): (&[usize], f64),
    ) -> Option<Self> {
        let n = powers.len();
        let (mut gram, mut side) = (Matrix::zeros(n, n), DVector::zeros(n));
        for at in at {
            let x = phi[*at] / unit;
            let row = powers
                .iter()
                .map(|k| x.powi(*k as i32) / (stderr[*at] * stderr[*at]));
            let row = DVector::from_iterator(n, row);
            gram += &row * row.transpose();
            side += row;
        }
        // Columns of size 1: variances are of any unit.
        let size: DVector<f64> = gram.diagonal().map(|x| x.sqrt());
        let scaled = Matrix::from_fn(n, n, |i, j| gram[(i, j)] / (size[i] * size[j]));
        let factors = Cholesky::new(&scaled)?.solve(&side.component_div(&size));
        let mut all = [0.0; 3];
        for (power, factor) in powers.iter().zip(factors.component_div(&size).iter()) {
            all[*power] = factor / unit.powi(*power as i32);
        }
        Some(Self(all))
    }

    fn variance(self, light: f64) -> f64 {
        let Self([a, b, c]) = self;
        a + light * (b + c * light)
    }

    /// σ of this light, W; none where the law leaves it none.
    pub(super) fn stderr(self, light: f64) -> Option<f64> {
        let variance = self.variance(light);
        (variance > 0.0).then(|| variance.sqrt())
    }

    /// Standard errors where this light is expected, W; those given where the law says nothing, and
    /// where an entry has none.
    pub(in crate::lab) fn stderrs(
        self,
        light: &Matrix,
        (phi, given): (&Matrix, &Matrix),
    ) -> Matrix {
        Matrix::from_fn(phi.nrows(), phi.ncols(), |p, l| {
            let at = (p, l);
            let is_told = given[at] > 0.0 || self.is_count_of_none(phi[at], given[at]);
            let own = self.stderr(light[at]).filter(|_| is_told);
            own.unwrap_or(given[at])
        })
    }

    /// Whether nothing was counted: that has the error of what is expected, not of 0.
    pub(super) fn is_count_of_none(self, x: f64, stderr: f64) -> bool {
        x == 0.0 && stderr == 0.0 && self.0[1] > 0.0
    }

    /// The same of light over `scale`.
    pub(super) fn over(self, scale: f64) -> Self {
        let Self([a, b, c]) = self;
        Self([a / (scale * scale), b / scale.abs(), c])
    }
}
