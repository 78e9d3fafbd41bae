//! The study in tasks, and the models that every render is tested against.

use super::verdicts::{Models, Verdicts, row, verdicts};
use super::{Power, PowerError, PowerPlan};
use crate::matrix::Matrix;
use crate::model::{Extent, Kernel, MatrixModel, converged};
use crate::scene::Scene;
use crate::study::agreement::{Errors, Test};
use crate::study::task::{Division, Sharing};
use crate::transport::{Budget, Control, Estimator, Plan, render};

/// Relative size of the scaled wrong model, and of the wrong albedo of one element.
const SCALE: f64 = 1e-3;
const ALBEDO: f64 = 1e-2;

/// [`power`](fn@super::power) in tasks, each a render with its verdicts.
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

impl Division for PowerTasks {
    type Ground = Models;
    type Part = Verdicts;
    type Finding = Power;
    type Error = PowerError;

    fn tasks(&self) -> usize {
        self.kinds().count() * self.plan.seeds as usize
    }

    /// A render is spread over the threads by itself.
    fn sharing(&self) -> Sharing {
        Sharing::InTurn
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::stream::Sampling;
    use crate::study::task::tests::{divides, refuses, small};

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
        let tasks = PowerTasks::new(&small("bench"), plan);
        assert_eq!(divides(&tasks).rows.len(), 4);
        // One wrong model is untold.
        let verdicts = Verdicts {
            chi2_per_dof: 1.0,
            agrees: true,
            rejected: vec![true; 3],
            smallest_scale: 0.1,
        };
        refuses(&tasks, 0, &verdicts);
    }
}
