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

use crate::num::linalg::{LinalgError, Svd, svd};
use crate::recovery::{
    Choice, Method, Options, Parameter, Problem, Recovered, RecoveryError, Uncertainty,
};

/// The laser side decomposed, and the check that C can be divided by.
fn decompose(method: Method, problem: &Problem<'_>) -> Result<Svd, RecoveryError> {
    if let Some(at) = problem.c.iter().position(|&x| x == 0.0) {
        let pixels = problem.c.nrows();
        return Err(RecoveryError::Unseen {
            method,
            pixel: at % pixels,
            element: at / pixels,
        });
    }
    let decomposed = svd(problem.d)?;
    if decomposed.sigma[0] == 0.0 {
        return Err(RecoveryError::RankZero {
            side: "laser side D",
        });
    }
    Ok(decomposed)
}

/// A generalised inverse of the laser side, applied.
struct Inverse {
    /// X = Φ D^#, p × r.
    x: DMatrix<f64>,
    /// D^#, l × r.
    sharp: DMatrix<f64>,
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
    ) -> Self {
        let sharp = spectrum.inverse(filter);
        Inverse {
            x: problem.phi * &sharp,
            sharp,
            product: whole(options).then(|| spectrum.product(filter)),
            sigma: DVector::from_column_slice(&spectrum.sigma),
            rank: filter.len(),
            effective_rank: filter.iter().sum(),
        }
    }

    /// From a solver of X D = B for any B (rows of l entries), which D^# answers for the unit matrix; of the given rank.
    fn solved(
        problem: &Problem<'_>,
        options: &Options,
        sigma: DVector<f64>,
        rank: usize,
        solve: impl Fn(&DMatrix<f64>) -> Result<DMatrix<f64>, LinalgError>,
    ) -> Result<Self, RecoveryError> {
        let spots = problem.d.ncols();
        let sharp = solve(&DMatrix::identity(spots, spots))?;
        Ok(Inverse {
            x: solve(problem.phi)?,
            product: whole(options).then(|| problem.d * &sharp),
            sharp,
            sigma,
            rank,
            effective_rank: rank as f64,
        })
    }

    /// Divided by C and averaged over the pixels, with uncertainty and resolution.
    fn recovered(
        self,
        method: Method,
        problem: &Problem<'_>,
        options: &Options,
        (parameter, choice): (Parameter, Choice),
    ) -> Result<Recovered, RecoveryError> {
        let pixels = problem.phi.nrows() as f64;
        let reflectance = mean_over_pixels(&self.x.component_div(problem.c), pixels);
        let mut found = Recovered::plain(method, problem, reflectance, self.sigma, self.rank);
        (found.parameter, found.choice) = (parameter, choice);
        found.effective_rank = self.effective_rank;
        found.resolution = self.product.map(|m| uncertainty::resolution(problem.c, &m));
        if let Some(stderr) = problem.noise() {
            let errors = uncertainty::standard_error(stderr, &self.sharp, problem.c);
            found.standard_error = Some(errors);
            if whole(options) {
                found.covariance = Some(uncertainty::covariance(stderr, &self.sharp, problem.c)?);
            }
        }
        Ok(found)
    }
}

/// Whether matrices of elements × elements are asked for.
fn whole(options: &Options) -> bool {
    options.uncertainty == Uncertainty::Full
}

fn mean_over_pixels(x: &DMatrix<f64>, divisor: f64) -> DVector<f64> {
    DVector::from_iterator(
        x.ncols(),
        x.column_iter().map(|column| column.sum() / divisor),
    )
}
