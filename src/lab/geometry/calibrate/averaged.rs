//! The picture at the geometry that was found, over all priors by their evidence.
//!
//! Geometry and picture are found by the likeliest prior of a few ([`Prior`](super::picture)).
//! Where the photographs do not determine the picture others are as likely, and errors by one alone
//! are too small. So the picture is the mean of all that [`Method::JointGp`] averages over. With H
//! = AᵀA = V Λ Vᵀ it knows the same of ρ by one photograph of unit noise,
//!
//! > Λ^−½ Vᵀ Aᵀy = Λ^½ Vᵀ ρ + N(0, 1),
//!
//! and P = cov(ρ | y, θ) over all priors. The geometry's share is to first order
//!
//! > ∂E\[ρ | y, θ\]/∂θ = cov(ρ, ∂ln p(y | ρ, θ)/∂θ) = −P AᵀB,   cov ρ = P + P AᵀB cov θ (P AᵀB)ᵀ,
//!
//! B_k = ∂_kA ρ̂, terms of y − Aρ̂ left out as in [`super::posterior`].

use nalgebra::DVector;

use super::descent::{Problem, State};
use super::geometry::Light;
use super::posterior::Columns;
use crate::lab::error::LabError;
use crate::lab::recovered::doubt::{alike_untold, uneven};
use crate::lab::recovered::fit::Judged;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::num::linalg::{Tolerance, product, rows_over, rows_times, svd};
use crate::recovery::{self, Method, Options, Recovered, determined, recover};
use crate::transport::Control;

/// The picture over all priors, its light over the scale of all.
pub(super) struct Averaged {
    pub rho: DVector<f64>,
    /// Directions that the photographs determine.
    pub directions: f64,
    /// Variance of each element, the geometry given.
    pub given: DVector<f64>,
    /// P, elements × elements; none of so many that it is not made.
    pub covariance: Option<Matrix>,
    /// P AᵀB: −∂ρ̂/∂θ, elements × unknowns.
    pub shift: Matrix,
    /// What speaks against believing its errors, each with its cure.
    pub warnings: Vec<String>,
}

impl Problem<'_> {
    /// That at `best`, by its light there and its columns.
    ///
    /// # Errors
    /// [`LabError`]: no direction that the photographs tell, or that it was stopped.
    pub(super) fn averaged(
        &self,
        (best, model): (&State, &MatrixModel),
        (light, columns): (&Light, &[Columns]),
        control: Control<'_>,
    ) -> Result<Averaged, LabError> {
        let normal = self.seen(best.factor).normal(light)?;
        let scale = best.prior.scale;
        let found = svd(&normal.h)?;
        let (rank, _) = found.cut(Tolerance::Auto)?;
        let roots = found.sigma.rows(0, rank).map(f64::sqrt);
        let v = found.vt.rows(0, rank).into_owned();
        let side = Matrix::from_columns(&[&v * &normal.side]);
        let phi = rows_over(side, &roots);
        let camera = rows_times(v, &(&roots * scale));
        let laser = Matrix::from_element(normal.side.len(), 1, 1.0);
        let stderr = Matrix::from_element(rank, 1, 1.0);
        let grids: Vec<[usize; 2]> = model.grids.iter().map(|grid| grid.count).collect();
        let quiet = Control {
            progress: &|_| (),
            ..control
        };
        let problem = recovery::Problem::new(&phi, &camera, &laser, Some(&stderr))?;
        let problem = problem.with_grids(&grids)?.with_places(&model.places)?;
        let problem = problem.under(quiet);
        let picture = recover(Method::JointGp, &problem, &Options::default())?;
        let judged = Judged {
            determined: determined(&problem).ok(),
            ..Judged::default()
        };
        let warnings = [uneven(&picture), alike_untold(&picture, &judged)];
        let Recovered {
            reflectance,
            standard_error,
            covariance,
            effective_rank,
            ..
        } = picture;
        let errors = standard_error.ok_or(LabError::DARK)?;
        // Of so many elements that there is no covariance by the likeliest prior alone.
        let shift = match &covariance {
            Some(p) => product(p, &Columns::side(columns)) * scale,
            None => &best.slope.shift / scale,
        };
        Ok(Averaged {
            rho: reflectance,
            directions: effective_rank,
            given: errors.component_mul(&errors),
            covariance,
            shift,
            warnings: warnings.into_iter().flatten().collect(),
        })
    }
}
