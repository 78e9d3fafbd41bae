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

use crate::num::linalg::{Svd, svd};
use crate::recovery::{Choice, Method, Options, Parameter, Problem, Recovered, RecoveryError};

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
    /// D D^#, r × r.
    product: DMatrix<f64>,
    /// Singular values of what was inverted.
    sigma: DVector<f64>,
    /// Directions that were not dropped.
    rank: usize,
    /// tr D D^#.
    effective_rank: f64,
}

impl Inverse {
    /// Through filter factors on the first directions of a spectrum.
    fn filtered(problem: &Problem<'_>, spectrum: &Spectrum, filter: &[f64]) -> Self {
        let sharp = spectrum.inverse(filter);
        Inverse {
            x: problem.phi * &sharp,
            sharp,
            product: spectrum.product(filter),
            sigma: DVector::from_column_slice(&spectrum.sigma),
            rank: filter.len(),
            effective_rank: filter.iter().sum(),
        }
    }

    /// From X and D^# themselves, of the given rank.
    fn explicit(
        problem: &Problem<'_>,
        x: DMatrix<f64>,
        sharp: DMatrix<f64>,
        laser: Svd,
        rank: usize,
    ) -> Self {
        Inverse {
            x,
            product: problem.d * &sharp,
            sharp,
            sigma: laser.sigma,
            rank,
            effective_rank: rank as f64,
        }
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
        found.resolution = Some(uncertainty::resolution(problem.c, &self.product));
        if let Some(stderr) = problem.noise() {
            let errors = uncertainty::standard_error(stderr, &self.sharp, problem.c);
            found.standard_error = Some(errors);
            if options.uncertainty == crate::recovery::Uncertainty::Full {
                found.covariance = Some(uncertainty::covariance(stderr, &self.sharp, problem.c)?);
            }
        }
        Ok(found)
    }
}

fn mean_over_pixels(x: &DMatrix<f64>, divisor: f64) -> DVector<f64> {
    DVector::from_iterator(
        x.ncols(),
        x.column_iter().map(|column| column.sum() / divisor),
    )
}
