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
mod sweep;

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use serde::Serialize;

use crate::metrics::{correlation, mtf_raw, rank_correlation};
use crate::model::{Kernel, MatrixModel, ModelError};
use crate::num::linalg::LinalgError;
use crate::num::statistics::{normal_two_sided, sidak_p, student_to_normal};
use crate::recovery::{Method, Options, Problem, RecoveryError, recover};
use crate::scene::{Scene, SceneError};

pub use noisy::{Comparison, NoisyOutcome, NoisyPoint};
pub use sweep::Layout;

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
#[derive(Clone, Debug, Serialize)]
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

/// How well a figure predicts.
#[derive(Clone, Debug, Serialize)]
pub struct Coefficients {
    /// The figure.
    pub indicator: String,
    /// Configurations in which it is defined.
    pub configurations: usize,
    /// Pearson's correlation with the measured raw MTF.
    pub pearson: Option<f64>,
    /// Spearman's.
    pub spearman: Option<f64>,
}

/// Predicted against measured under noise, one method.
#[derive(Clone, Debug, Serialize)]
pub struct NoisySummary {
    /// The method.
    pub method: String,
    /// Points compared.
    pub compared: usize,
    /// Of these within three standard errors.
    pub within_three: usize,
    /// Largest |z|.
    pub largest_z: f64,
    /// Probability that the largest of as many would be so large by chance (Šidák; Student's t with one degree of freedom less than draws).
    pub largest_p: f64,
    /// Left out because the ratio has no mean to speak of.
    pub undefined: usize,
    /// Points without a covariance.
    pub without_covariance: usize,
    /// Points from which the method gave nothing.
    pub failed: usize,
    /// Each figure against the measured mean MTF.
    pub coefficients: Vec<Coefficients>,
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

/// Sweeps the benches: without noise all of them, under noise every so many. `progress` is told how many of how many arrangements are done. `Ok(None)`
/// if stopped.
///
/// # Errors
/// [`IndicatorError`].
pub fn indicator(
    scene: &Scene,
    plan: &IndicatorPlan,
    stop: &AtomicBool,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Option<Indicator>, IndicatorError> {
    if scene.hidden().next().is_none() {
        return Err(ModelError::NothingHidden.into());
    }
    let divides = |e: &usize| plan.boards.iter().any(|b| e % b == 0);
    if !plan.elements.iter().any(divides) {
        return Err(IndicatorError::NoObject);
    }
    let widest = plan.half_widths.iter().copied().fold(0.0, f64::max);
    // Two inches for the stagger and to spare.
    let reach = (widest + 2.0) * scene.unit.per_inch();
    let site = Site::new(scene, reach)?.ok_or(IndicatorError::NoCentre)?;
    let arrangements = plan.arrangements();
    let (done, all) = (std::sync::atomic::AtomicUsize::new(0), arrangements.len());
    let swept: Vec<Option<Vec<Configured>>> = arrangements
        .par_iter()
        .map(|a| {
            if stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let found = configurations(&site, a, &plan.boards)?;
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, all);
            Ok(Some(found))
        })
        .collect::<Result<_, IndicatorError>>()?;
    let Some(swept) = swept.into_iter().collect::<Option<Vec<_>>>() else {
        return Ok(None);
    };
    let configured: Vec<Configured> = swept.into_iter().flatten().collect();
    let mut points = Vec::new();
    let chosen: Vec<usize> = (0..configured.len()).step_by(plan.every.max(1)).collect();
    for (k, &i) in chosen.iter().enumerate() {
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let Configured { arrangement, found } = &configured[i];
        if let Some(model) = model(&site, arrangement, found.board)? {
            points.extend(noisy::points(i, &model, plan));
        }
        progress(all + k + 1, all + chosen.len());
    }
    let configurations: Vec<Configuration> = configured.into_iter().map(|c| c.found).collect();
    let identity = configurations
        .iter()
        .map(|c| (c.projected - c.mtf).abs())
        .fold(0.0, f64::max);
    let mtf: Vec<f64> = configurations.iter().map(|c| c.mtf).collect();
    let everything: Vec<&Configuration> = configurations.iter().collect();
    let noisy = |m: &Method| summary(*m, &points, &configurations);
    Ok(Some(Indicator {
        scene: scene.name.clone(),
        scene_hash: scene.hash.clone(),
        seeds: plan.seeds,
        first_seed: plan.first_seed,
        identity,
        coefficients: coefficients(&everything, &mtf),
        noisy: plan.methods.iter().map(noisy).collect(),
        points,
        configurations,
    }))
}

struct Configured {
    arrangement: Arrangement,
    found: Configuration,
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
) -> Result<Vec<Configured>, IndicatorError> {
    let mut found = Vec::new();
    let mut shared: Option<Projection> = None;
    for &board in boards.iter().filter(|b| arrangement.elements % **b == 0) {
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
            found.push(Configured {
                arrangement: *arrangement,
                found: Configuration {
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
                },
            });
        }
        shared = Some(projection);
    }
    Ok(found)
}

/// Each figure against `measured`. Logarithms leave out configurations where the figure is 0.
fn coefficients(configurations: &[&Configuration], measured: &[f64]) -> Vec<Coefficients> {
    type Figure = (&'static str, fn(&Configuration) -> f64);
    let figures: [Figure; 7] = [
        ("‖P c‖²/‖c‖²", |c| c.kept),
        ("raw MTF of the projected object", |c| c.projected),
        ("condition number", |c| c.condition),
        ("log of the condition number", |c| libm::log10(c.condition)),
        ("smallest eigenvalue", |c| c.smallest_eigenvalue),
        ("log of |smallest eigenvalue|", |c| {
            libm::log10(c.smallest_eigenvalue.abs())
        }),
        ("log of (σ_r/σ1)²", |c| libm::log10(c.smallest_square)),
    ];
    let of = |(name, f): Figure| {
        let values = configurations.iter().map(|c| f(c)).zip(measured);
        let (figure, measured): (Vec<f64>, Vec<f64>) =
            values.filter(|(x, _)| x.is_finite()).unzip();
        Coefficients {
            indicator: name.to_owned(),
            configurations: figure.len(),
            pearson: correlation(&figure, &measured),
            spearman: rank_correlation(&figure, &measured),
        }
    };
    figures.map(of).to_vec()
}

fn summary(
    method: Method,
    points: &[NoisyPoint],
    configurations: &[Configuration],
) -> NoisySummary {
    let own = || points.iter().filter(move |p| p.method == method.name());
    let count = |f: fn(&NoisyOutcome) -> bool| own().filter(|p| f(&p.outcome)).count();
    let compared: Vec<(&Configuration, &Comparison)> = own()
        .filter_map(|p| match &p.outcome {
            NoisyOutcome::Compared(c) => Some((&configurations[p.configuration], c)),
            _ => None,
        })
        .collect();
    let measured: Vec<f64> = compared.iter().map(|(_, c)| c.measured.mean).collect();
    let benches: Vec<&Configuration> = compared.iter().map(|(b, _)| *b).collect();
    let predicted: Vec<f64> = compared.iter().map(|(_, c)| c.mean).collect();
    let mut coefficients = coefficients(&benches, &measured);
    coefficients.insert(
        0,
        Coefficients {
            indicator: "closed form of the mean".to_owned(),
            configurations: predicted.len(),
            pearson: correlation(&predicted, &measured),
            spearman: rank_correlation(&predicted, &measured),
        },
    );
    let sizes = || compared.iter().map(|(_, c)| c.z.abs());
    let largest_z = sizes().fold(0.0, f64::max);
    let dof = compared
        .first()
        .map_or(f64::INFINITY, |(_, c)| c.measured.draws as f64 - 1.0);
    NoisySummary {
        method: method.name().to_owned(),
        compared: compared.len(),
        within_three: sizes().filter(|z| *z <= 3.0).count(),
        largest_z,
        largest_p: sidak_p(
            normal_two_sided(student_to_normal(largest_z, dof)),
            compared.len() as u64,
        ),
        undefined: count(|o| matches!(o, NoisyOutcome::Undefined { .. })),
        without_covariance: count(|o| matches!(o, NoisyOutcome::NoCovariance)),
        failed: count(|o| matches!(o, NoisyOutcome::Failed { .. })),
        coefficients,
    }
}

#[cfg(test)]
mod tests;
