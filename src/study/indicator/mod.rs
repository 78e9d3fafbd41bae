//! What predicts how well the published inversion works?
//!
//! Its noiseless result is exactly (C diag ρ)·P ⊘ C averaged over the pixels, P = G12·G12⁺: the object projected on what the spots can tell apart. So the share
//! ‖P c‖²/‖c‖² of the object's zero-mean pattern c that the projector keeps should predict the raw MTF. The published study looked at the
//! condition number and at the smallest eigenvalue of G12·G12ᵀ; here all of them stand beside each other over one sweep.
//!
//! Under noise a linear method with its parameter held keeps a signal and adds a variance, both known without a single draw: mean and
//! covariance of the recovered values give mean and spread of the MTF (see [`Comparison`]), which draws are then compared with.

mod noisy;
mod projection;
mod ratio;
mod summary;
mod sweep;
mod tasks;

use std::sync::atomic::AtomicBool;

use serde::{Deserialize, Serialize};

use crate::metrics::mtf_raw;
use crate::model::{Kernel, MatrixModel, ModelError};
use crate::num::linalg::LinalgError;
use crate::recovery::{Method, Options, Problem, RecoveryError, recover};
use crate::scene::{Scene, SceneError};
use crate::transport::Control;

pub use noisy::{Comparison, NoisyOutcome, NoisyPoint};
pub use summary::{Coefficients, NoisySummary};
pub use sweep::Layout;
pub use tasks::IndicatorTasks;

use super::task::{Steps, whole};
use projection::Projection;
use sweep::{Arrangement, Site};

/// The sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct IndicatorPlan {
    /// Layouts of the spots.
    pub layouts: Vec<Layout>,
    /// Numbers of spots, roughly.
    pub spots: Vec<usize>,
    /// Half-widths or radii, in.
    pub half_widths: Vec<f64>,
    /// Elements a side.
    pub elements: Vec<usize>,
    /// Checks a side of the objects; those that do not divide the elements are left out with them.
    pub boards: Vec<usize>,
    /// Kernels, each for data and inversion.
    pub kernels: Vec<Kernel>,
    /// Methods that are compared under noise.
    pub methods: Vec<Method>,
    /// Relative noise of each entry of Φcam.
    pub noise: Vec<f64>,
    /// Under noise each configuration whose position is a multiple of this.
    pub every: usize,
    /// Draws of the noise.
    pub seeds: u64,
    /// Seed of the first.
    pub first_seed: u64,
}

impl IndicatorPlan {
    fn arrangements(&self) -> Vec<Arrangement> {
        let mut all = Vec::new();
        for &kernel in &self.kernels {
            for &layout in &self.layouts {
                for &spots in &self.spots {
                    for &half_width in &self.half_widths {
                        for &elements in &self.elements {
                            all.push(Arrangement {
                                layout,
                                spots,
                                half_width,
                                elements,
                                kernel,
                            });
                        }
                    }
                }
            }
        }
        all
    }
}

/// One bench with one object.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Configuration {
    /// Layout.
    pub layout: String,
    /// Spots that are there.
    pub spots: usize,
    /// Half-width or radius, in.
    pub half_width: f64,
    /// Elements a side.
    pub elements: usize,
    /// Checks a side.
    pub board: usize,
    /// Kernel.
    pub kernel: String,
    /// Directions that `pinv` keeps.
    pub rank: usize,
    /// The indicator: ‖P c‖²/‖c‖².
    pub kept: f64,
    /// Raw MTF of (C diag ρ)·P ⊘ C.
    pub projected: f64,
    /// Raw MTF of what `pinv` recovers from the noiseless Φcam.
    pub mtf: f64,
    /// σ1 over the last kept singular value.
    pub condition: f64,
    /// Smallest eigenvalue of G12·G12ᵀ over the largest, rounding included.
    pub smallest_eigenvalue: f64,
    /// The same from the singular values of G12; 0 for fewer spots than elements.
    pub smallest_square: f64,
}

/// The study of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Indicator {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Draws of the noise.
    pub seeds: u64,
    /// Seed of the first.
    pub first_seed: u64,
    /// Every configuration.
    pub configurations: Vec<Configuration>,
    /// Largest difference between the raw MTF of the projected object and of the recovery.
    pub identity: f64,
    /// Each figure against the raw MTF without noise.
    pub coefficients: Vec<Coefficients>,
    /// Under noise, a method after the other.
    pub noisy: Vec<NoisySummary>,
    /// Every point under noise.
    pub points: Vec<NoisyPoint>,
}

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
pub enum IndicatorError {
    /// The scene has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The wall cannot be extended.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A laser side cannot be decomposed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// Nothing was recovered.
    #[error(transparent)]
    Recovery(#[from] RecoveryError),
    /// There is no point that layouts could lie around.
    #[error(
        "the normal of the hidden surface meets no wall, so there is no centre for the spots to lie around (turn the surface towards the wall)"
    )]
    NoCentre,
    /// No board divides any number of elements.
    #[error(
        "no number of elements is a multiple of a number of checks, so there is no object to study (use e.g. 2 checks and 8 elements)"
    )]
    NoObject,
}

/// Sweeps the benches: without noise all of them, under noise every so many. `progress` is told how many of how many tasks are done. `Ok(None)`
/// if stopped.
///
/// # Errors
/// [`IndicatorError`].
pub fn indicator(
    scene: &Scene,
    plan: &IndicatorPlan,
    stop: &AtomicBool,
    progress: Steps<'_>,
) -> Result<Option<Indicator>, IndicatorError> {
    let control = Control {
        progress: &|_| (),
        stop,
    };
    whole(
        &IndicatorTasks::new(scene, plan.clone())?,
        control,
        progress,
    )
}

fn model(
    site: &Site,
    arrangement: &Arrangement,
    board: usize,
) -> Result<Option<MatrixModel>, IndicatorError> {
    let Some(scene) = site.arranged(arrangement)? else {
        return Ok(None);
    };
    let elements = Some([arrangement.elements; 2]);
    Ok(Some(MatrixModel::new(
        &scene.with_checkerboard(board),
        arrangement.kernel,
        elements,
    )?))
}

/// Every board on one arrangement.
fn configurations(
    site: &Site,
    arrangement: &Arrangement,
    boards: &[usize],
) -> Result<Vec<Configuration>, IndicatorError> {
    let mut found = Vec::new();
    let mut shared: Option<Projection> = None;
    for &board in boards
        .iter()
        .filter(|b| arrangement.elements.is_multiple_of(**b))
    {
        let Some(model) = model(site, arrangement, board)? else {
            return Ok(found);
        };
        // The projector knows nothing of the object.
        let projection = match shared.take() {
            Some(p) => p,
            None => Projection::new(&model)?,
        };
        let phi = model.phi();
        let problem = Problem::new(&phi, &model.camera_side, &model.laser_side, None)?;
        let recovered = recover(Method::Pinv, &problem, &Options::default())?;
        let mtf = mtf_raw(recovered.reflectance.as_slice(), &model.albedo);
        let projected = mtf_raw(&projection.noiseless(&model), &model.albedo);
        // A board of one check has no contrast.
        if let (Some(mtf), Some(projected)) = (mtf, projected) {
            found.push(Configuration {
                layout: arrangement.layout.name().to_owned(),
                spots: model.laser_side.ncols(),
                half_width: arrangement.half_width,
                elements: arrangement.elements,
                board,
                kernel: arrangement.kernel.name().to_owned(),
                rank: projection.rank,
                kept: projection.kept(&model.albedo),
                projected,
                mtf,
                condition: projection.condition,
                smallest_eigenvalue: projection.smallest_eigenvalue,
                smallest_square: projection.smallest_square,
            });
        }
        shared = Some(projection);
    }
    Ok(found)
}

#[cfg(test)]
mod tests;
