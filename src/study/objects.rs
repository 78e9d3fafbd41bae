//! The hidden objects of a scene, recovered and measured.

use crate::matrix::Matrix;
use crate::metrics::{correlation, mtf_normalized, mtf_raw, rmse};
use crate::model::MatrixModel;
use crate::recovery::{
    self, Choice, Method, Options, Parameter, Picard, Problem, Recovered, RecoveryError, recover,
};

use super::results::RecoveredObject;

/// What a recovery is told of the noise in Φcam.
#[derive(Clone, Copy, Debug)]
pub enum Noise<'a> {
    /// The standard error of each entry, W.
    StandardError(&'a Matrix),
    /// Nothing: methods that need it must be given their parameter.
    Unknown,
}

/// One method's outcome on all hidden surfaces.
#[derive(Debug)]
pub struct Attempt {
    /// The method.
    pub method: Method,
    /// One object per hidden surface, or why there is none.
    pub outcome: Result<Vec<RecoveredObject>, RecoveryError>,
}

/// Recovers the hidden reflectance from `phi` (pixels × spots, W) by each of `methods`, and measures it against the true
/// albedo at the element centres.
pub fn recover_objects(
    model: &MatrixModel,
    phi: &Matrix,
    noise: Noise<'_>,
    methods: &[Method],
    options: &Options,
) -> Vec<Attempt> {
    let grids: Vec<[usize; 2]> = model.grids.iter().map(|grid| grid.count).collect();
    let attempt = |method: Method| {
        let problem = problem(model, phi, noise)?.with_grids(&grids)?;
        recover(method, &problem, options).map(|found| objects(model, &found))
    };
    methods
        .iter()
        .map(|&method| Attempt {
            method,
            outcome: attempt(method),
        })
        .collect()
}

/// Φ in the singular directions of the model's laser side: see [`recovery::picard`].
///
/// # Errors
/// Those of [`recovery::picard`].
pub fn picard(
    model: &MatrixModel,
    phi: &Matrix,
    noise: Noise<'_>,
) -> Result<Picard, RecoveryError> {
    recovery::picard(&problem(model, phi, noise)?)
}

fn problem<'a>(
    model: &'a MatrixModel,
    phi: &'a Matrix,
    noise: Noise<'a>,
) -> Result<Problem<'a>, RecoveryError> {
    let stderr = match noise {
        Noise::StandardError(stderr) => Some(stderr),
        Noise::Unknown => None,
    };
    Problem::new(phi, &model.camera_side, &model.laser_side, stderr)
}

fn objects(model: &MatrixModel, found: &Recovered) -> Vec<RecoveredObject> {
    let cut = |grid: &crate::model::ElementGrid| {
        let range = grid.first..grid.first + grid.len();
        let reflectance = found.reflectance.as_slice()[range.clone()].to_vec();
        let truth = model.albedo[range.clone()].to_vec();
        let own = |m: &Matrix| m.rows(range.start, range.len()).into_owned();
        RecoveredObject {
            surface: grid.surface.clone(),
            method: found.method.name().to_owned(),
            elements: grid.count,
            mtf_raw: mtf_raw(&reflectance, &truth),
            mtf_normalized: mtf_normalized(&reflectance, &truth),
            correlation: correlation(&reflectance, &truth),
            rmse: rmse(&reflectance, &truth).unwrap_or(f64::NAN),
            parameter: parameter(found),
            standard_error: found
                .standard_error
                .as_ref()
                .map(|s| s.as_slice()[range.clone()].to_vec()),
            effective_rank: found.effective_rank,
            covariance: found.covariance.as_ref().map(own),
            resolution: found.resolution.as_ref().map(own),
            reflectance,
            truth,
        }
    };
    model.grids.iter().map(cut).collect()
}

/// The regularisation used and why, in words.
fn parameter(found: &Recovered) -> String {
    let what = match found.parameter {
        Parameter::None => format!("rank {}", found.rank),
        Parameter::Rank(k) => format!("{k} singular directions"),
        Parameter::Damping(lambda) => format!("damping {lambda:.2e} of σ1"),
    };
    let why = match found.choice {
        Choice::Given => ", as given".to_owned(),
        Choice::Discrepancy {
            residual, target, ..
        } => {
            format!(
                ", by the discrepancy principle (residual {residual:.3e} W, noise {target:.3e} W)"
            )
        }
        Choice::Gcv {
            freedom, predicted, ..
        } => {
            format!(
                ", by generalised cross-validation (entries predicted to {predicted:.3e} W, {freedom:.1} degrees of freedom left)"
            )
        }
        Choice::LCurve { residual, turn, .. } => {
            format!(", at the corner of the L-curve (residual {residual:.3e} W, turn {turn:.2})")
        }
        Choice::Tolerance { cutoff } => format!(", cut at {cutoff:.2e}"),
        Choice::None => String::new(),
    };
    let solver = match &found.solver {
        Some(s) => format!(
            "; {} after {} iterations, gap {:.1e}",
            s.status, s.iterations, s.gap
        ),
        None => String::new(),
    };
    what + &why + &solver
}
