//! What the linear methods share: a generalised inverse D^# (l × r) of the laser side, pixel by
//! pixel.
//!
//! > X = Φ D^#  (p × r),   ρ_j = (1/p) Σ_p X\[p,j\]/C\[p,j\]

mod damping;
mod gradient;
mod laplacian;
pub(super) mod laser_side;
mod one_sided;
mod pinv;
mod rdivide;
pub(super) mod strips;
mod tikhonov;
mod tsvd;
mod uncertainty;

use nalgebra::{DMatrix, DVector};

use one_sided::Side;
use rdivide::Solution;

use crate::num::linalg::{LinalgError, PivotedQr, Svd, Tolerance, product, tr_product};
use crate::recovery::{
    Choice, Method, Options, Parameter, Problem, Recovered, RecoveryError, Spectrum, Uncertainty,
};

/// The laser side decomposed as far as a cut at `tolerance` needs it, and the check that C can be
/// divided by.
fn decompose(
    method: Method,
    problem: &Problem<'_>,
    tolerance: Tolerance,
) -> Result<Svd, RecoveryError> {
    refuse_unseen(method, problem)?;
    refuse_one_spot(method, problem)?;
    problem.laser(tolerance)
}

/// Refuses a single photograph: these methods tell elements apart by how the spots light them, and
/// of one spot D⁺ = Dᵀ/‖D‖² is no inverse. Only differences that are damped make up for it.
fn refuse_one_spot(method: Method, problem: &Problem<'_>) -> Result<(), RecoveryError> {
    let (elements, spots) = problem.d.shape();
    if spots > 1 || elements == 1 || method == Method::TikhonovGradient {
        return Ok(());
    }
    Err(RecoveryError::NotForMethod {
        method,
        what: "tells elements apart by the spots that light them, and there is one spot",
        cure: "use joint-unbounded, which inverts the camera side, or another joint method",
    })
}

/// Refuses an element that a pixel does not see: its C cannot be divided by.
fn refuse_unseen(method: Method, problem: &Problem<'_>) -> Result<(), RecoveryError> {
    match problem.c.iter().position(|&x| x == 0.0) {
        None => Ok(()),
        Some(at) => Err(RecoveryError::Unseen {
            method,
            pixel: at % problem.c.nrows(),
            element: at / problem.c.nrows(),
        }),
    }
}

/// Pixels whose X is held at once.
const PIXELS: usize = 512;

/// X of A X = B by the QR of A, cut at a rank.
type Quotient = fn(&PivotedQr, usize, &DMatrix<f64>) -> Result<DMatrix<f64>, LinalgError>;
type Solver = dyn Fn(&DMatrix<f64>) -> Result<DMatrix<f64>, LinalgError>;

/// A generalised inverse of the laser side, D^# = Vᵀ S with as many rows of V and S as it has
/// directions.
pub(super) struct Inverse {
    /// X = Φ D^# of any rows of Φ.
    apply: Box<Solver>,
    /// V, k × l, orthonormal rows.
    data: DMatrix<f64>,
    /// S, k × r.
    solution: DMatrix<f64>,
    /// D D^#, r × r, where the resolution is asked for.
    product: Option<DMatrix<f64>>,
    /// Singular values of what was inverted.
    sigma: DVector<f64>,
    /// Directions that were not dropped.
    rank: usize,
    /// tr D D^#.
    effective_rank: f64,
    /// Its parameter, and why that one.
    why: (Parameter, Choice),
}

impl Inverse {
    /// Through filter factors on the first directions of a spectrum.
    fn filtered(
        options: &Options,
        spectrum: &Spectrum,
        filter: &[f64],
        why: (Parameter, Choice),
    ) -> Self {
        let (data, solution) = spectrum.factors(filter);
        let (across, along) = (data.transpose(), solution.clone());
        Inverse {
            apply: Box::new(move |rows| Ok(product(&product(rows, &across), &along))),
            product: whole(options).then(|| spectrum.product(filter)),
            sigma: DVector::from_column_slice(&spectrum.sigma),
            rank: filter.len(),
            effective_rank: filter.iter().sum(),
            data,
            solution,
            why,
        }
    }

    /// From a solver of X D = B for any B (rows of l entries) that rests on the QR of Dᵀ, cut at
    /// the given rank; D^# is its answer for the unit matrix.
    fn solved(
        problem: &Problem<'_>,
        options: &Options,
        sigma: DVector<f64>,
        (qr, rank): (PivotedQr, usize),
        solve: Quotient,
        choice: Choice,
    ) -> Result<Self, RecoveryError> {
        // What Q does not span is not seen by the solver.
        let data = qr.q.columns(0, rank).transpose();
        let apply = move |rows: &DMatrix<f64>| Ok(solve(&qr, rank, &rows.transpose())?.transpose());
        let solution = apply(&data)?;
        let whole = whole(options);
        Ok(Inverse {
            apply: Box::new(apply),
            product: whole.then(|| product(&product(problem.d, &data.transpose()), &solution)),
            data,
            solution,
            sigma,
            rank,
            effective_rank: rank as f64,
            why: (Parameter::Rank(rank), choice),
        })
    }

    /// Σ_p X\[p,j\]/C\[p,j\], a block of pixels after the other.
    fn sum(&self, problem: &Problem<'_>) -> Result<DVector<f64>, RecoveryError> {
        let (pixels, elements) = problem.c.shape();
        let mut sum = DVector::zeros(elements);
        for first in (0..pixels).step_by(PIXELS) {
            let count = PIXELS.min(pixels - first);
            let x = (self.apply)(&problem.phi.rows(first, count).into_owned())?;
            let ratio = x.component_div(&problem.c.rows(first, count));
            for (sum, column) in sum.iter_mut().zip(ratio.column_iter()) {
                *sum += column.sum();
            }
        }
        Ok(sum)
    }

    /// ‖(D D^# − 1)_j‖² of each element j: what of it the laser side does not tell. Its part in R
    /// but for ratios of C.
    fn lost(&self, d: &DMatrix<f64>) -> DVector<f64> {
        let elements = d.nrows();
        if let Some(product) = &self.product {
            let off = |i: usize, j: usize| product[(i, j)] - f64::from(u8::from(i == j));
            let lost = |j: usize| (0..elements).map(|i| off(i, j).powi(2)).sum();
            return DVector::from_fn(elements, |j, _| lost(j));
        }
        let told = product(d, &self.data.transpose());
        let mut lost = DVector::zeros(elements);
        for first in (0..elements).step_by(PIXELS) {
            let count = PIXELS.min(elements - first);
            let mut block = product(&told, &self.solution.columns(first, count).into_owned());
            for (j, mut column) in (first..).zip(block.column_iter_mut()) {
                column[j] -= 1.0;
                lost[j] = column.norm_squared();
            }
        }
        lost
    }

    /// ρ_j = (1/p) Σ_p X\[p,j\]/C\[p,j\], with uncertainty and resolution.
    fn recovered(
        self,
        method: Method,
        problem: &Problem<'_>,
        options: &Options,
    ) -> Result<Recovered, RecoveryError> {
        let reflectance = self.sum(problem)? / problem.phi.nrows() as f64;
        let sigma = self.sigma.clone();
        let mut found = Recovered::plain(method, problem, reflectance, sigma, self.rank)?;
        (found.parameter, found.choice) = self.why;
        found.effective_rank = self.effective_rank;
        let product = self.product.as_ref();
        found.resolution = product.map(|m| uncertainty::resolution(problem.c, m));
        if let Some(stderr) = problem.noise() {
            let factors = (&self.data, &self.solution);
            found.standard_error = Some(uncertainty::standard_error(stderr, factors, problem.c));
            if whole(options) {
                let sharp = tr_product(&self.data, &self.solution);
                found.covariance = Some(uncertainty::covariance(stderr, &sharp, problem.c)?);
            }
        }
        Ok(found.without_errors_of_the_unseen(|| self.lost(problem.d)))
    }
}

/// Whether matrices of elements × elements are asked for.
fn whole(options: &Options) -> bool {
    options.uncertainty == Uncertainty::Full
}

/// The inverse of a method that works pixel by pixel; what `problem` holds of Φ serves the choice
/// of a parameter that is not given.
pub(super) fn inverse(
    method: Method,
    problem: &Problem<'_>,
    options: &Options,
) -> Result<Inverse, RecoveryError> {
    match method {
        Method::LeftInverse => one_sided::inverse(problem, options, Side::Left),
        Method::RightInverse => one_sided::inverse(problem, options, Side::Right),
        Method::Rdivide => rdivide::inverse(problem, options, Solution::Basic),
        Method::RdivideMinNorm => rdivide::inverse(problem, options, Solution::LeastNorm),
        Method::Tsvd => tsvd::inverse(problem, options),
        Method::Tikhonov => tikhonov::inverse(problem, options),
        Method::TikhonovGradient => gradient::inverse(problem, options),
        _ => pinv::inverse(problem, options),
    }
}

/// A method that works pixel by pixel.
pub(super) fn recover(
    method: Method,
    problem: &Problem<'_>,
    options: &Options,
) -> Result<Recovered, RecoveryError> {
    inverse(method, problem, options)?.recovered(method, problem, options)
}
