//! How small a model error does `validate` detect, and how often does it cry wolf?

use serde::{Deserialize, Serialize};

use super::agreement::{Errors, Evidence, Test, agree};
use super::task::{Division, whole};
use crate::matrix::Matrix;
use crate::model::{Extent, Kernel, MatrixModel, ModelError, converged};
use crate::num::statistics::binomial_interval;
use crate::num::stream::Sampling;
use crate::scene::{Scene, SceneError};
use crate::transport::{Budget, Control, Estimator, Plan, Traced, render};

/// What is tried.
#[derive(Clone, Debug)]
pub struct PowerPlan {
    /// Estimators.
    pub estimators: Vec<Estimator>,
    /// Where random numbers come from.
    pub sampling: Sampling,
    /// Paths, as each estimator counts them.
    pub samples: Vec<u64>,
    /// Renders of each kind, with seeds first … first + seeds − 1.
    pub seeds: u64,
    /// First seed.
    pub first_seed: u64,
    /// Significance level of the verdicts.
    pub significance: f64,
}

/// How often a wrong model was rejected.
#[derive(Clone, Debug, Serialize)]
pub struct Detection {
    /// What is wrong with it.
    pub error: String,
    /// ‖wrong − right‖/‖right‖.
    pub size: f64,
    /// Rejections.
    pub rejected: u64,
}

/// The outcome for one estimator and number of samples.
#[derive(Clone, Debug, Serialize)]
pub struct PowerRow {
    /// Estimator.
    pub estimator: String,
    /// Paths.
    pub samples: u64,
    /// Renders.
    pub seeds: u64,
    /// Mean χ²/dof on the right model.
    pub chi2_per_dof: f64,
    /// Rejections of the right model.
    pub false_alarms: u64,
    /// Where 99 % of the binomial at the stated level lie.
    pub expected: [u64; 2],
    /// Wrong models.
    pub detections: Vec<Detection>,
    /// Median over the renders of the smallest scale error that is rejected.
    pub smallest_scale: f64,
}

/// The study of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Power {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Sampler.
    pub sampler: String,
    /// Significance level.
    pub significance: f64,
    /// One row for each estimator and number of samples.
    pub rows: Vec<PowerRow>,
}

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
pub enum PowerError {
    /// The scene has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The spots cannot be moved.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Not a number of paths.
    #[error("{0} samples cannot be traced (use 1 to 2³²)")]
    Samples(u64),
}

/// Relative size of the scaled wrong model, and of the wrong albedo of one element.
const SCALE: f64 = 1e-3;
const ALBEDO: f64 = 1e-2;

/// Renders each kind with many seeds and tests it against the right model (converged quadrature) and wrong ones. `Ok(None)` if
/// stopped.
///
/// # Errors
/// [`PowerError`].
pub fn power(
    scene: &Scene,
    plan: &PowerPlan,
    control: Control<'_>,
) -> Result<Option<Power>, PowerError> {
    whole(&PowerTasks::new(scene, plan.clone()), control, &|_, _| ())
}

/// [`power`](fn@power) in tasks, each a render with its verdicts.
#[derive(Debug)]
pub struct PowerTasks {
    scene: Scene,
    plan: PowerPlan,
}

impl PowerTasks {
    /// The study of a scene.
    pub fn new(scene: &Scene, plan: PowerPlan) -> Self {
        Self {
            // Validation is of three-bounce light.
            scene: scene.with_max_bounces(3),
            plan,
        }
    }

    /// Estimators with numbers of paths, in the order of the rows.
    fn kinds(&self) -> impl Iterator<Item = (Estimator, u64)> {
        let plan = &self.plan;
        let of = |e: &Estimator| {
            plan.samples.iter().map({
                let e = *e;
                move |n| (e, *n)
            })
        };
        plan.estimators.iter().flat_map(of)
    }

    fn budget(&self, samples: u64) -> Result<Budget, PowerError> {
        Budget::new(samples, self.plan.sampling).ok_or(PowerError::Samples(samples))
    }
}

/// The right model and wrong ones, each with what is wrong and ‖wrong − right‖/‖right‖.
#[derive(Debug)]
pub struct Models {
    right: Matrix,
    wrong: Vec<(String, f64, Matrix)>,
}

/// What one render comes to.
#[derive(Debug, Serialize, Deserialize)]
pub struct Verdicts {
    chi2_per_dof: f64,
    /// Whether the right model was accepted.
    agrees: bool,
    /// Whether each wrong one was rejected.
    rejected: Vec<bool>,
    smallest_scale: f64,
}

impl Division for PowerTasks {
    type Ground = Models;
    type Part = Verdicts;
    type Finding = Power;
    type Error = PowerError;

    fn tasks(&self) -> usize {
        self.kinds().count() * self.plan.seeds as usize
    }

    fn ground(&self, _: Control<'_>) -> Result<Option<Models>, PowerError> {
        let right = converged(&self.scene, Kernel::Physical, Extent::FULL)?.phi;
        let wrong = wrong_models(&self.scene, &right)?.into_iter();
        let sized = |(name, model): (String, Matrix)| {
            let size = (&model - &right).norm() / right.norm();
            (name, size, model)
        };
        let wrong = wrong.map(sized).collect();
        Ok(Some(Models { right, wrong }))
    }

    fn task(
        &self,
        models: &Models,
        index: usize,
        control: Control<'_>,
    ) -> Result<Option<Verdicts>, PowerError> {
        let (row, k) = (
            index as u64 / self.plan.seeds,
            index as u64 % self.plan.seeds,
        );
        let Some((estimator, samples)) = self.kinds().nth(row as usize) else {
            return Ok(None);
        };
        let budget = self.budget(samples)?;
        let how = Plan {
            estimator,
            sampling: self.plan.sampling,
            seed: self.plan.first_seed.wrapping_add(k),
            budget,
        };
        let test = Test {
            significance: self.plan.significance,
            replicates: budget.blocks,
            errors: Errors::of(estimator),
        };
        let spots = 0..self.scene.laser.spots.len();
        let traced = render(&self.scene, &how, spots, control);
        Ok(traced.map(|traced| verdicts(&traced, models, test)))
    }

    fn fits(&self, models: &Models, _: usize, part: &Verdicts) -> bool {
        part.rejected.len() == models.wrong.len()
    }

    fn finish(&self, models: &Models, parts: Vec<Verdicts>) -> Result<Power, PowerError> {
        let own = parts.chunks((self.plan.seeds as usize).max(1));
        let row = |((estimator, samples), own): ((Estimator, u64), &[Verdicts])| {
            let paths = self.budget(samples)?.samples();
            Ok(row((estimator, paths), own, models, &self.plan))
        };
        let rows = self.kinds().zip(own).map(row);
        Ok(Power {
            rows: rows.collect::<Result<_, PowerError>>()?,
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            sampler: self.plan.sampling.name().to_owned(),
            significance: self.plan.significance,
        })
    }
}

/// Wrong models, each with what is wrong.
fn wrong_models(scene: &Scene, right: &Matrix) -> Result<Vec<(String, Matrix)>, PowerError> {
    let hundredth = 0.01 * scene.unit.per_inch();
    let shifted = scene.with_shifted_spots([hundredth, 0.0])?;
    let integral = |s: &Scene, kernel| converged(s, kernel, Extent::FULL).map(|c| c.phi);
    let matrices = MatrixModel::new(scene, Kernel::Physical, None)?;
    // The element in the middle of those that are lit and light.
    let light: Vec<usize> = (0..matrices.albedo.len())
        .filter(|j| matrices.albedo[*j] > 0.0)
        .collect();
    let mut models = vec![
        (format!("scaled by 1 + {SCALE}"), right * (1.0 + SCALE)),
        (
            "all spots moved by 0.01 in.".to_owned(),
            integral(&shifted, Kernel::Physical)?,
        ),
        (
            "published kernel".to_owned(),
            integral(scene, Kernel::Published)?,
        ),
    ];
    if let Some(&j) = light.get(light.len() / 2) {
        let change = matrices.camera_side.column(j) * matrices.laser_side.row(j);
        let name = format!("albedo of element {j} off by 1 %");
        models.push((name, right + change * (ALBEDO * matrices.albedo[j])));
    }
    Ok(models)
}

/// Tests a render against every model.
fn verdicts(traced: &Traced, models: &Models, test: Test) -> Verdicts {
    let verdict = |model: &Matrix| {
        let evidence = Evidence {
            traced: &traced.flux,
            stderr: &traced.stderr,
            model,
            bound: None,
        };
        agree(evidence, test).0
    };
    let own = verdict(&models.right);
    let wrong = models.wrong.iter();
    Verdicts {
        chi2_per_dof: own.chi2_per_dof,
        agrees: own.agrees,
        rejected: wrong.map(|(.., model)| !verdict(model).agrees).collect(),
        smallest_scale: smallest_scale(|scale| !verdict(&(&models.right * scale)).agrees),
    }
}

/// Counts over the seeds.
fn row(
    (estimator, samples): (Estimator, u64),
    own: &[Verdicts],
    models: &Models,
    plan: &PowerPlan,
) -> PowerRow {
    let count = |f: &dyn Fn(&Verdicts) -> bool| own.iter().filter(|v| f(v)).count() as u64;
    let mut smallest: Vec<f64> = own.iter().map(|v| v.smallest_scale).collect();
    smallest.sort_by(f64::total_cmp);
    let wrong = models.wrong.iter().enumerate();
    PowerRow {
        estimator: estimator.name().to_owned(),
        samples,
        seeds: plan.seeds,
        chi2_per_dof: own.iter().fold(0.0, |sum, v| sum + v.chi2_per_dof) / plan.seeds as f64,
        false_alarms: count(&|v| !v.agrees),
        expected: binomial_interval(plan.seeds, plan.significance, 0.99),
        detections: wrong
            .map(|(i, (error, size, _))| Detection {
                error: error.clone(),
                size: *size,
                rejected: count(&|v| v.rejected[i]),
            })
            .collect(),
        smallest_scale: smallest
            .get(smallest.len() / 2)
            .copied()
            .unwrap_or(f64::NAN),
    }
}

/// Smallest s for which 1 + s is rejected, to a tenth of its size; 0 if the right model is.
fn smallest_scale(rejects: impl Fn(f64) -> bool) -> f64 {
    if rejects(1.0) {
        return 0.0;
    }
    let mut high = 1e-6;
    while high < 1.0 && !rejects(1.0 + high) {
        high *= 2.0;
    }
    let mut low = 0.5 * high;
    while high > 1.1 * low {
        let middle = 0.5 * (low + high);
        if rejects(1.0 + middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::task::tests::{divides, small};

    #[test]
    fn it_divides() {
        let plan = PowerPlan {
            estimators: vec![Estimator::Shared, Estimator::Factored],
            sampling: Sampling::Sobol,
            samples: vec![32, 64],
            seeds: 2,
            first_seed: 3,
            significance: 0.01,
        };
        let found = divides(&PowerTasks::new(&small("bench"), plan));
        assert_eq!(found.rows.len(), 4);
    }

    #[test]
    fn the_threshold_is_found() {
        for limit in [1e-5, 3.3e-3, 0.2] {
            let found = smallest_scale(|s| s > 1.0 + limit);
            assert!(
                found >= limit && found <= 1.11 * limit,
                "{found} for {limit}"
            );
        }
        assert_eq!(smallest_scale(|_| true), 0.0);
    }
}
