//! Floor 5: from the photographs back to the hidden reflectance.
//!
//! The photographs are the p × l matrix Φ (pixels × laser spots). Light that meets the hidden
//! surface once makes it
//!
//! > Φ\[p,l\] = Σ_j C\[p,j\] ρ_j D\[j,l\]
//!
//! with C (p × r) the way from element j to pixel p, D (r × l) the way from spot l to element j,
//! and ρ the reflectances (albedos) of the r elements. Absolute scale is the caller's: it is folded
//! into C and D. Nothing here knows what scene it inverts; it is given three matrices and, if there
//! is one, the standard error of each entry of Φ.
//!
//! | method | estimate |
//! | --- | --- |
//! | [`Method::Pinv`] | X = Φ D⁺, divided by C entry by entry, mean over pixels: the published method |
//! | [`Method::LeftInverse`] | the same with (DᵀD)⁻¹Dᵀ; only where the spots' patterns are independent |
//! | [`Method::RightInverse`] | the same with Dᵀ(DDᵀ)⁻¹; only where the elements' patterns are independent |
//! | [`Method::Rdivide`] | X = Φ/D as MATLAB divides: pivoted QR, basic solution, at most rank elements not zero |
//! | [`Method::RdivideMinNorm`] | X = Φ/D as Octave divides: pivoted QR, solution of least norm |
//! | [`Method::Tsvd`] | X = Φ D⁺ with D's small singular values left out, as many as the [`Rule`] asks for |
//! | [`Method::Tikhonov`] | the same with them damped, as much as the [`Rule`] asks for |
//! | [`Method::TikhonovGradient`] | the same with differences between neighbouring elements damped in place of the values |
//! | [`Method::JointUnbounded`] | least squares over all pixels and spots at once; unbiased |
//! | [`Method::Joint`] | the same under 0 ≤ ρ ≤ 1 |
//! | [`Method::Nnls`] | the same under 0 ≤ ρ |
//! | [`Method::JointGp`] | mean of a Gaussian process on the surface given the photographs: pictures whose neighbours resemble one another |
//! | [`Method::JointTv`] | `joint` with λ Σ \|ρ_i − ρ_j\| over neighbours i, j: patches of one value |
//! | [`Method::JointTwoValued`] | `joint` with two reflectances only, given or estimated |
//!
//! Measured: raw MTF of boards on 8 × 8 elements, 16 × 16 pixels, 120 staggered spots, relative
//! normal noise; mean of 20 seeds (`joint-two-valued`: 6). At levels 0 and 1 the bounds say as
//! much as a total variation does or more (fine boards near the limit of what can be seen it
//! flattens); where only two values are possible, knowing that says most.
//!
//! | half-width, board, noise | `nnls` | `joint` | `joint-tv` | `joint-two-valued` |
//! | --- | --- | --- | --- | --- |
//! | 6, 2 × 2, 0.1 | 0.849 | 0.967 | 0.968 | 0.979 |
//! | 6, 2 × 2, 0.01 | 0.844 | 0.996 | 0.996 | 1.000 |
//! | 6, 4 × 4, 1e-4 | 0.755 | 0.938 | 0.896 | 1.000 |
//! | 3, 2 × 2, 0.1 | 0.820 | 0.947 | 0.940 | 0.999 |
//! | 3, 2 × 2, 0.01 | 0.918 | 0.994 | 0.994 | 1.000 |
//! | 3, 4 × 4, 1e-4 | 0.559 | 0.752 | 0.375 | 0.846 |
//!
//! The joint methods can estimate other light of known form with the reflectances, and factors of
//! the light that are known only roughly ([`Nuisance`]). [`cramer_rao`] says what no unbiased
//! estimate can undercut; [`determined`](determined()) how much of each element the photographs
//! determine by any method; [`Bands`] what a recovery knows of itself.
//!
//! Those up to [`Method::JointUnbounded`] are linear in Φ: with a noise model they carry the
//! covariance that it makes of their noise, and always the resolution matrix of what they make of
//! the truth, from which their bias follows ([`Recovered::bias`]). [`picard`](picard()) and
//! [`picard_joint`] show which singular directions rise above the noise.
//!
//! Large problems cost what their numerical rank costs: D of 4096 elements × 4000 spots has about
//! 100 directions above rounding, and only those are looked for
//! ([`svd_to`](crate::num::linalg::svd_to)); generalised inverses, products and residuals keep them
//! as thin factors. Photographs that no memory holds are taken strip by strip ([`recover_strips`]).
//!
//! A matrix of one's own: the scene says where wall, camera and spots are, the model makes C and D
//! of it, and Φ comes from a file.
//!
//! ```
//! use phicam::matrix::{Matrix, npy};
//! use phicam::model::{Kernel, MatrixModel};
//! use phicam::recovery::{Method, Options, Problem, recover};
//! use phicam::scene::{Scene, file::SceneFile};
//!
//! // The geometry: the bench with 24 spots, and 2 × 2 elements on the hidden surface.
//! let mut file = SceneFile::default();
//! file.laser.as_mut().expect("the bench has a laser").spots.per_side = Some(6);
//! let scene = Scene::new(&file, None)?;
//! let model = MatrixModel::new(&scene, Kernel::Physical, Some([2, 2]))?;
//!
//! // The photographs, pixels × spots, W. In place of real ones: what two light and two dark
//! // elements send, written and read as NumPy does.
//! let board = [0.9, 0.2, 0.1, 0.8];
//! let photographed =
//!     &model.camera_side * Matrix::from_diagonal(&board.to_vec().into()) * &model.laser_side;
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("phi.npy");
//! npy::write(&path, &photographed)?;
//! let phi = npy::read_finite(&path)?;
//!
//! // Each entry is known to 0.1 %; the reflectances come with what that makes of them.
//! let stderr = phi.map(|entry| 1e-3 * entry);
//! let problem = Problem::new(&phi, &model.camera_side, &model.laser_side, Some(&stderr))?;
//! let found = recover(Method::JointUnbounded, &problem, &Options::default())?;
//! let sigma = found.standard_error.expect("a linear method with a noise model has one");
//! for (element, truth) in board.iter().enumerate() {
//!     assert!((found.reflectance[element] - truth).abs() < 1e-6);
//!     assert!(sigma[element] > 0.0 && sigma[element] < 0.05);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bands;
mod error;
mod field;
mod gains;
mod joint;
mod method;
mod nuisance;
mod options;
mod outcome;
mod patterns;
mod picard;
mod pixelwise;
mod problem;
mod rule;
mod setting;
mod shared;
mod soft;
mod spectrum;

pub use bands::{BandKind, Bands};
pub use error::RecoveryError;
pub use field::ErrorField;
pub use gains::{Deviations, Gains};
pub use joint::{
    CramerRao, Determined, Exponential, cramer_rao, determined, picard_joint, two_valued_bytes,
    unseen,
};
pub use method::{Method, UnknownMethod};
pub use nuisance::{Estimated, Nuisance};
pub use options::{Options, Rule, Uncertainty, WeightRule};
pub use outcome::{Choice, Parameter, Recovered, Solver, Weighting};
pub use patterns::{Patterns, Sum};
pub use picard::{Directions, Picard, picard};
pub use pixelwise::laser_side::{LaserSide, Parts};
pub use pixelwise::strips::{Strip, recover_strips};
pub use problem::{Problem, Terms};
pub use setting::Setting;
pub use shared::Shared;
use spectrum::Spectrum;

/// Recovers the reflectances of the r elements by the method asked for.
///
/// # Errors
/// [`RecoveryError`]: what is missing for the method (and how to supply it), or what the matrices
/// do not allow.
pub fn recover(
    method: Method,
    problem: &Problem<'_>,
    options: &Options,
) -> Result<Recovered, RecoveryError> {
    problem.refuse_darkness()?;
    if problem.nuisance.is_some() && !method.is_joint() {
        return Err(RecoveryError::NotForMethod {
            method,
            what: "takes every entry as light of the surface, and estimates nothing else: no frame constants or patterns, background, glare, gain or scale, no entries left out",
            cure: "use a joint method, or subtract what else is there first",
        });
    }
    if let Some(confidence) = options.bands {
        bands::allowed(method, confidence)?;
    }
    joint::refuse_no_light(problem, options)?;
    let mut found = if problem.nuisance.has_gains() {
        joint::gauss_newton::recover(method, problem, options, by)
    } else {
        by(method, problem, options)
    }?;
    if found.rests_on_wrong_gains() {
        found.standard_error = None;
    }
    if let (Some(confidence), None, None) = (options.bands, &found.bands, found.no_bands) {
        match bands::never(method) {
            Some(why) => found.no_bands = Some(why),
            None => found.add_gaussian_bands(confidence)?,
        }
    }
    Ok(found)
}

/// The same without factors that are known only roughly, or about estimates of them.
fn by(
    method: Method,
    problem: &Problem<'_>,
    options: &Options,
) -> Result<Recovered, RecoveryError> {
    problem.control.check()?;
    match method {
        Method::Pinv
        | Method::LeftInverse
        | Method::RightInverse
        | Method::Rdivide
        | Method::RdivideMinNorm
        | Method::Tsvd
        | Method::Tikhonov
        | Method::TikhonovGradient => pixelwise::recover(method, problem, options),
        Method::JointUnbounded => joint::unbounded::recover(problem, options),
        Method::Joint | Method::Nnls => joint::bounded::recover(method, problem, options),
        Method::JointGp => joint::process::unknown_noise::recover(problem, options),
        Method::JointTv => joint::total_variation::recover(problem, options),
        Method::JointTwoValued => joint::patterns::two_valued::recover(problem, options),
    }
}

#[cfg(test)]
mod bench;
