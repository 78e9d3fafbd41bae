//! The indicator's extension to noise: mean and spread of the MTF in closed form, against what
//! draws of the noise show.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::plan::IndicatorPlan;
use super::ratio::{Modulation, Pair};
use crate::lab::LabError;
use crate::lab::deviate::normal_deviates;
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

/// Every method at every noise on one model, in the order of [`pairs`], measured on the same draws.
///
/// # Errors
/// [`LabError::Stopped`].
pub(super) fn compared(
    model: &MatrixModel,
    plan: &IndicatorPlan,
    control: Control<'_>,
) -> Result<Vec<NoisyOutcome>, LabError> {
    let exact = model.phi();
    let predicted = pairs(plan)
        .into_par_iter()
        .map(|pair| Ok(kept(predict(model, &exact, pair, plan))?.and_then(|found| found)))
        .collect::<Result<Vec<_>, LabError>>()?;
    let draws = (0..plan.seeds)
        .into_par_iter()
        .map(|k| {
            control.check()?;
            let seed = plan.first_seed.wrapping_add(k);
            let deviates = normal_deviates(seed, exact.nrows(), exact.ncols());
            let of = |own: &Result<Prediction, NoisyOutcome>| match own {
                Ok(own) => kept(own.drawn(model, &exact, &deviates)),
                Err(_) => Ok(Ok(None)),
            };
            predicted.iter().map(of).collect()
        })
        .collect::<Result<Vec<Vec<_>>, LabError>>()?;
    let measured = |(at, own): (usize, Result<Prediction, NoisyOutcome>)| {
        let values = draws.iter().filter_map(|draw| draw[at].clone().transpose());
        let values: Result<Vec<f64>, NoisyOutcome> = values.collect();
        Ok(own?.measured(&values?, plan.seeds))
    };
    let outcomes = predicted.into_iter().enumerate().map(measured);
    let either = |found: Result<_, NoisyOutcome>| found.unwrap_or_else(|why| why);
    Ok(outcomes.map(either).collect())
}

/// A recovery that failed is an outcome of its own.
fn kept<T>(found: Result<T, LabError>) -> Result<Result<T, NoisyOutcome>, LabError> {
    match found {
        Err(LabError::Recovery(e)) => Ok(Err(NoisyOutcome::Failed {
            reason: e.to_string(),
        })),
        other => other.map(Ok),
    }
}

/// What the draws are held against.
struct Prediction {
    method: Method,
    /// Standard errors of the photographs, W.
    stderr: Matrix,
    /// Its parameter is held, and of the draws the reflectances alone are asked for.
    options: Options,
    pair: Pair,
    predicted: Modulation,
}

/// What is predicted of a method at a noise, or why nothing is.
fn predict(
    model: &MatrixModel,
    exact: &Matrix,
    (method, noise): (Method, f64),
    plan: &IndicatorPlan,
) -> Result<Result<Prediction, NoisyOutcome>, LabError> {
    // A parameter that is chosen from the data makes a method non-linear: one draw outside the
    // sample fixes it.
    let outside = plan.first_seed.wrapping_add(plan.seeds);
    let pilot = Photographs::relative(exact, noise, outside);
    let options = fixed(&pilot.recover(model, method, &Options::default())?);
    let noiseless = Photographs {
        phi: exact.clone(),
        ..pilot
    };
    let found = noiseless.recover(model, method, &options)?;
    let Some(covariance) = &found.covariance else {
        return Ok(Err(NoisyOutcome::NoCovariance));
    };
    let Some(pair) = Pair::of(found.reflectance.as_slice(), covariance, &model.albedo) else {
        return Ok(Err(NoisyOutcome::NoCovariance));
    };
    let Some(predicted) = pair.modulation() else {
        let spread = pair.spread();
        return Ok(Err(NoisyOutcome::Undefined { spread }));
    };
    Ok(Ok(Prediction {
        method,
        stderr: noiseless.stderr,
        options: Options {
            uncertainty: Uncertainty::StandardError,
            ..options
        },
        pair,
        predicted,
    }))
}

impl Prediction {
    /// The raw MTF of one draw, where it is defined.
    fn drawn(
        &self,
        model: &MatrixModel,
        exact: &Matrix,
        deviates: &Matrix,
    ) -> Result<Option<f64>, LabError> {
        let photographs = Photographs::of_deviates(exact, self.stderr.clone(), deviates);
        let found = photographs.recover(model, self.method, &self.options)?;
        Ok(mtf_raw(found.reflectance.as_slice(), &model.albedo))
    }

    /// Against the raw MTF of so many draws.
    fn measured(&self, values: &[f64], draws: u64) -> NoisyOutcome {
        let spread = self.pair.spread();
        let measured = Spread::of(values).filter(|m| m.draws as u64 == draws);
        let Some((measured, stderr)) = measured.and_then(|m| Some((m, m.stderr?))) else {
            return NoisyOutcome::Undefined { spread };
        };
        NoisyOutcome::Compared(Comparison {
            kept: self.pair.means[0] / self.pair.means[1],
            mean: self.predicted.mean,
            deviation: self.predicted.deviation,
            spread,
            measured,
            z: (measured.mean - self.predicted.mean) / stderr,
        })
    }
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
