//! The indicator's extension to noise: mean and spread of the MTF in closed form, against what
//! draws of the noise show.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::plan::IndicatorPlan;
use super::ratio::Pair;
use crate::lab::LabError;
use crate::lab::ensemble::{Photographs, Spread};
use crate::matrix::Matrix;
use crate::metrics::mtf_raw;
use crate::model::MatrixModel;
use crate::recovery::{Method, Options, Parameter, Recovered, Uncertainty};
use crate::transport::Control;

/// One method at one noise on one configuration.
#[derive(Clone, Debug, Serialize)]
pub struct NoisyPoint {
    /// Which of the configurations.
    pub configuration: usize,
    /// The method.
    pub method: String,
    /// Standard deviation of each entry of Φcam relative to its exact value.
    pub noise: f64,
    /// The outcome.
    #[serde(flatten, with = "Tagged")]
    pub outcome: NoisyOutcome,
}

/// What can be said of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum NoisyOutcome {
    /// Predicted and measured.
    Compared(Comparison),
    /// The relative spread of W + B is above a tenth: the ratio has no mean to speak of, and was
    /// not measured.
    Undefined {
        /// Standard deviation of W + B over its mean, as predicted.
        spread: f64,
    },
    /// The method states no covariance: it is not linear, or it does not know its own.
    NoCovariance,
    /// The method gave nothing, in its own words.
    Failed {
        /// Why.
        reason: String,
    },
}

/// An outcome as the files of a study have it: tagged by its name, which the wire format of tasks
/// cannot read back.
#[derive(Serialize)]
#[serde(remote = "NoisyOutcome", tag = "outcome", rename_all = "snake_case")]
enum Tagged {
    Compared(Comparison),
    Undefined { spread: f64 },
    NoCovariance,
    Failed { reason: String },
}

/// Predicted against measured raw MTF.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Comparison {
    /// The signal kept: raw MTF without noise, at the same parameter.
    pub kept: f64,
    /// Predicted mean.
    pub mean: f64,
    /// Predicted standard deviation: the noise added.
    pub deviation: f64,
    /// Standard deviation of W + B over its mean, as predicted.
    pub spread: f64,
    /// Mean and spread over the draws.
    pub measured: Spread,
    /// (measured − predicted mean)/(standard error of the measured mean).
    pub z: f64,
}

/// Methods and noises, in the order of the points.
pub(super) fn pairs(plan: &IndicatorPlan) -> Vec<(Method, f64)> {
    let noises = |m: &Method| {
        plan.noise
            .iter()
            .map(|noise| (*m, *noise))
            .collect::<Vec<_>>()
    };
    plan.methods.iter().flat_map(noises).collect()
}

/// Every method at every noise on one model, in the order of [`pairs`].
///
/// # Errors
/// [`LabError::Stopped`].
pub(super) fn compared(
    model: &MatrixModel,
    plan: &IndicatorPlan,
    control: Control<'_>,
) -> Result<Vec<NoisyOutcome>, LabError> {
    let exact = model.phi();
    pairs(plan)
        .par_iter()
        .map(
            |&(method, noise)| match compare(model, &exact, (method, noise), plan, control) {
                Err(LabError::Recovery(e)) => Ok(NoisyOutcome::Failed {
                    reason: e.to_string(),
                }),
                other => other,
            },
        )
        .collect()
}

fn compare(
    model: &MatrixModel,
    exact: &Matrix,
    (method, noise): (Method, f64),
    plan: &IndicatorPlan,
    control: Control<'_>,
) -> Result<NoisyOutcome, LabError> {
    let photographs = |seed| Photographs::relative(exact, noise, seed);
    // A parameter that is chosen from the data makes a method non-linear: one draw outside the
    // sample fixes it.
    let pilot = photographs(plan.first_seed.wrapping_add(plan.seeds));
    let options = fixed(&pilot.recover(model, method, &Options::default())?);
    let noiseless = Photographs {
        phi: exact.clone(),
        ..pilot
    };
    let found = noiseless.recover(model, method, &options)?;
    let Some(covariance) = &found.covariance else {
        return Ok(NoisyOutcome::NoCovariance);
    };
    let truth = &model.albedo;
    let Some(pair) = Pair::of(found.reflectance.as_slice(), covariance, truth) else {
        return Ok(NoisyOutcome::NoCovariance);
    };
    let spread = pair.spread();
    let Some(predicted) = pair.modulation() else {
        return Ok(NoisyOutcome::Undefined { spread });
    };
    // Of the draws the reflectances alone are measured.
    let options = Options {
        uncertainty: Uncertainty::StandardError,
        ..options
    };
    let mut values = Vec::new();
    for seed in (0..plan.seeds).map(|k| plan.first_seed.wrapping_add(k)) {
        control.check()?;
        let found = photographs(seed).recover(model, method, &options)?;
        values.extend(mtf_raw(found.reflectance.as_slice(), truth));
    }
    let measured = Spread::of(&values).filter(|m| m.draws as u64 == plan.seeds);
    let Some((measured, stderr)) = measured.and_then(|m| Some((m, m.stderr?))) else {
        return Ok(NoisyOutcome::Undefined { spread });
    };
    Ok(NoisyOutcome::Compared(Comparison {
        kept: pair.means[0] / pair.means[1],
        mean: predicted.mean,
        deviation: predicted.deviation,
        spread,
        measured,
        z: (measured.mean - predicted.mean) / stderr,
    }))
}

/// Options that hold the parameter that `pilot` has chosen.
fn fixed(pilot: &Recovered) -> Options {
    let mut options = Options::default();
    match pilot.parameter {
        Parameter::Rank(rank) => options.rank = Some(rank),
        Parameter::Damping(damping) => options.damping = Some(damping),
        Parameter::TotalVariation(strength) => options.total_variation = Some(strength),
        // Found with the picture: nothing to hold.
        Parameter::Levels(_) | Parameter::GaussianProcess { .. } | Parameter::None => {}
    }
    options
}

#[cfg(test)]
mod tests {
    use super::super::tests::small_plan;
    use super::*;
    use crate::lab::deviate::normal_deviates;
    use crate::model::Kernel;
    use crate::recovery::{Problem, recover};
    use crate::scene::Scene;

    fn model() -> MatrixModel {
        let text = Scene::load("thesis").unwrap().text;
        let text = text.replace("pixels = [16, 16]", "pixels = [4, 4]");
        let scene = Scene::from_toml("small", &text)
            .unwrap()
            .with_checkerboard(2);
        MatrixModel::new(&scene, Kernel::Physical, Some([4, 4])).unwrap()
    }

    /// Every linear method with its parameter held, as a linear map probed entry by entry: ρ̂ = A
    /// vec Φ, covariance A Σ Aᵀ. The mean and deviation that follow from the probed map, by brute
    /// force over draws, are those that the expansion gives for it.
    #[test]
    #[ignore = "slow"]
    fn the_expansion_holds_for_every_method_as_a_probed_linear_map() {
        let model = model();
        let exact = model.phi();
        let noise = 1e-4;
        let stderr = &exact * noise;
        for method in [
            Method::Pinv,
            Method::Tsvd,
            Method::Tikhonov,
            Method::JointUnbounded,
        ] {
            let options = Options {
                rank: Some(9),
                damping: Some(1e-3),
                ..Options::default()
            };
            let invert = |phi: &Matrix| {
                let problem =
                    Problem::new(phi, &model.camera_side, &model.laser_side, Some(&stderr));
                recover(method, &problem.unwrap(), &options)
                    .unwrap()
                    .reflectance
            };
            let columns: Vec<_> = (0..exact.len())
                .map(|k| {
                    let mut unit = Matrix::zeros(exact.nrows(), exact.ncols());
                    unit[k] = exact[k];
                    invert(&unit) * noise
                })
                .collect();
            // Column k is what one standard deviation of entry k does.
            let map = Matrix::from_columns(&columns);
            let mean = invert(&exact);
            let pair = Pair::of(mean.as_slice(), &(&map * map.transpose()), &model.albedo).unwrap();
            let Some(found) = pair.modulation() else {
                panic!("{method}: spread {}", pair.spread())
            };
            let values: Vec<f64> = (0..400)
                .map(|seed| {
                    let draw = normal_deviates(seed, exact.nrows(), exact.ncols());
                    let phi = &exact + draw.component_mul(&stderr);
                    mtf_raw(invert(&phi).as_slice(), &model.albedo).unwrap()
                })
                .collect();
            let measured = Spread::of(&values).unwrap();
            let z = (measured.mean - found.mean) / measured.stderr.unwrap();
            assert!(z.abs() < 4.0, "{method}: {found:?} {measured:?}");
            // A standard deviation from 400 draws is known to 1/√800 = 3.5 %.
            let ratio = measured.deviation.unwrap() / found.deviation;
            assert!(
                (ratio - 1.0).abs() < 0.18,
                "{method}: {found:?} {measured:?}"
            );
        }
    }

    #[test]
    fn what_is_not_linear_is_not_predicted() {
        let model = model();
        let plan = IndicatorPlan {
            methods: vec![Method::Joint],
            noise: vec![1e-4],
            ..small_plan()
        };
        let found = compared(&model, &plan, Control::none()).unwrap();
        assert!(matches!(found[0], NoisyOutcome::NoCovariance), "{found:?}");
    }
}
