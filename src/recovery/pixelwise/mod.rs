//! What the linear methods share: a generalised inverse D^# (l × r) of the laser side, pixel by pixel.
//!
//! > X = Φ D^#  (p × r),   ρ_j = (1/p) Σ_p X\[p,j\]/C\[p,j\]

mod damping;
pub(super) mod gradient;
mod laplacian;
pub(super) mod one_sided;
pub(super) mod pinv;
pub(super) mod rdivide;
mod spectrum;
pub(super) mod tikhonov;
pub(super) mod tsvd;
mod uncertainty;

pub(super) use spectrum::Spectrum;

use nalgebra::{DMatrix, DVector};

use crate::num::linalg::{LinalgError, PivotedQr, Svd, Tolerance, product, svd_to, tr_product};
use crate::recovery::{
    Choice, Method, Options, Parameter, Problem, Recovered, RecoveryError, Uncertainty,
};

/// The laser side decomposed as far as a cut at `tolerance` needs it, and the check that C can be divided by.
fn decompose(
    method: Method,
    problem: &Problem<'_>,
    tolerance: Tolerance,
) -> Result<Svd, RecoveryError> {
    if let Some(at) = problem.c.iter().position(|&x| x == 0.0) {
        let pixels = problem.c.nrows();
        return Err(RecoveryError::Unseen {
            method,
            pixel: at % pixels,
            element: at / pixels,
        });
    }
    let decomposed = svd_to(problem.d, tolerance)?;
    if decomposed.sigma[0] == 0.0 {
        return Err(RecoveryError::RankZero {
            side: "laser side D",
        });
    }
    Ok(decomposed)
}

/// Pixels whose X is held at once.
const PIXELS: usize = 512;

/// A generalised inverse of the laser side, D^# = Vᵀ S with as many rows of V and S as it has directions, applied.
struct Inverse {
    /// ρ_j = (1/p) Σ_p X\[p,j\]/C\[p,j\], X = Φ D^#.
    reflectance: DVector<f64>,
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
}

impl Inverse {
    /// Through filter factors on the first directions of a spectrum.
    fn filtered(
        problem: &Problem<'_>,
        options: &Options,
        spectrum: &Spectrum,
        filter: &[f64],
    ) -> Result<Self, RecoveryError> {
        let (data, solution) = spectrum.factors(filter);
        let across = data.transpose();
        let apply = |rows: &DMatrix<f64>| Ok(product(&product(rows, &across), &solution));
        Ok(Inverse {
            reflectance: mean_over_pixels(problem, apply)?,
            product: whole(options).then(|| spectrum.product(filter)),
            sigma: DVector::from_column_slice(&spectrum.sigma),
            rank: filter.len(),
            effective_rank: filter.iter().sum(),
            data,
            solution,
        })
    }

    /// From a solver of X D = B for any B (rows of l entries) that rests on the QR of Dᵀ, cut at the given rank; D^# is its answer for the unit matrix.
    fn solved(
        problem: &Problem<'_>,
        options: &Options,
        sigma: DVector<f64>,
        (qr, rank): (&PivotedQr, usize),
        solve: impl Fn(&DMatrix<f64>) -> Result<DMatrix<f64>, LinalgError>,
    ) -> Result<Self, RecoveryError> {
        // What Q does not span is not seen by the solver.
        let data = qr.q.columns(0, rank).transpose();
        let solution = solve(&data)?;
        let whole = whole(options);
        Ok(Inverse {
            reflectance: mean_over_pixels(problem, solve)?,
            product: whole.then(|| product(&(problem.d * data.transpose()), &solution)),
            data,
            solution,
            sigma,
            rank,
            effective_rank: rank as f64,
        })
    }

    /// The recovery with uncertainty and resolution.
    fn recovered(
        self,
        method: Method,
        problem: &Problem<'_>,
        options: &Options,
        (parameter, choice): (Parameter, Choice),
    ) -> Result<Recovered, RecoveryError> {
        let mut found = Recovered::plain(method, problem, self.reflectance, self.sigma, self.rank)?;
        (found.parameter, found.choice) = (parameter, choice);
        found.effective_rank = self.effective_rank;
        found.resolution = self.product.map(|m| uncertainty::resolution(problem.c, &m));
        if let Some(stderr) = problem.noise() {
            let factors = (&self.data, &self.solution);
            found.standard_error = Some(uncertainty::standard_error(stderr, factors, problem.c));
            if whole(options) {
                let sharp = tr_product(&self.data, &self.solution);
                found.covariance = Some(uncertainty::covariance(stderr, &sharp, problem.c)?);
            }
        }
        Ok(found)
    }
}

/// Whether matrices of elements × elements are asked for.
fn whole(options: &Options) -> bool {
    options.uncertainty == Uncertainty::Full
}

/// (1/p) Σ_p X\[p,j\]/C\[p,j\] with the rows of X that `apply` makes of rows of Φ, a block of pixels after the other.
fn mean_over_pixels(
    problem: &Problem<'_>,
    apply: impl Fn(&DMatrix<f64>) -> Result<DMatrix<f64>, LinalgError>,
) -> Result<DVector<f64>, RecoveryError> {
    let (pixels, elements) = problem.c.shape();
    let mut sum = DVector::zeros(elements);
    for first in (0..pixels).step_by(PIXELS) {
        let count = PIXELS.min(pixels - first);
        let x = apply(&problem.phi.rows(first, count).into_owned())?;
        let ratio = x.component_div(&problem.c.rows(first, count));
        for (sum, column) in sum.iter_mut().zip(ratio.column_iter()) {
            *sum += column.sum();
        }
    }
    Ok(sum / pixels as f64)
}
