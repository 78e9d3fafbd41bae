//! The budget in tasks: each an integral, a render of an ensemble, or some spots of the run.

use super::results::{BudgetPlan, ErrorBudget};
use super::sizes::{Sizes, closure};
use super::terms::{Found, OWN_ROW};
use crate::lab::ensemble::Ensemble;
use crate::lab::error::LabError;
use crate::lab::options::Opt;
use crate::lab::studies::registered::{Registered, prepared};
use crate::lab::studies::traced::{Kept, SHARES, share, side_by_side};
use crate::lab::study::{Sharing, Study, Work};
use crate::matrix::Matrix;
use crate::model::Occlusion;
use crate::model::{Extent, Kernel, ModelError, Take, converged};
use crate::num::stream::Sampling;
use crate::scene::{Role, Scene};
use crate::transport::{Budget as Samples, Control, Estimator, Plan, SamplesError, Traced, render};

/// `phicam study budget`.
pub(in crate::lab) const STUDY: Registered = Registered {
    name: "budget",
    about: "What the matrix model leaves out, cause by cause: table, JSON, CSV, figure",
    scene: None,
    files: "budget.csv, budget.svg",
    options: &[
        Opt::paths(
            "samples",
            "Paths per pixel of the precise renders, all together",
        )
        .or("16384"),
        Opt::paths(
            "run-samples",
            "Paths per pixel and spot of the run that is taken apart",
        )
        .or("512"),
        Opt::seed("Seed of everything"),
    ],
    prepare: |scene, values| {
        let plan = BudgetPlan {
            seed: values.one("seed")?,
            ensemble_samples: values.one("samples")?,
            run_samples: values.one("run-samples")?,
        };
        Ok(prepared(BudgetTasks::new(scene, plan)))
    },
};

/// Renders of an ensemble.
const MEMBERS: u64 = 8;
/// Paths of the ensemble go on to this many surfaces.
const LONGEST: u32 = 12;

/// Takes the difference between frames and model of a scene apart. A task is an integral, a render
/// or a part of one.
#[derive(Debug)]
pub struct BudgetTasks {
    scene: Scene,
    plan: BudgetPlan,
    tasks: Vec<Task>,
}

/// What one task computes: a list of matrices, pixels × spots, W.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Task {
    /// Φ by quadrature, with this much of it by centres, and its bound.
    Integral(Extent),
    /// Φ of the mean albedo.
    Grey,
    /// A member of the ensemble of whole light: the flux, then that of 1, 2, … bounces.
    Long(u64),
    /// Its three-bounce light with black occluders.
    Black(u64),
    /// The same with the Lambertian hidden surface of equal albedo.
    Matt(u64),
    /// A share of the run and its standard error.
    Run(usize),
}

const CENTRES: Extent = Extent {
    elements: Take::Centre,
    footprints: Take::Centre,
    spots: Take::Centre,
    occlusion: Occlusion::Ignored,
};
const AREAS: Extent = Extent {
    elements: Take::Integral,
    ..CENTRES
};
const FOOTPRINTS: Extent = Extent {
    footprints: Take::Integral,
    ..AREAS
};

impl BudgetTasks {
    /// The budget of a scene.
    pub fn new(scene: &Scene, plan: BudgetPlan) -> Self {
        let blocked = scene.surfaces.iter().any(|s| s.role == Role::Occluder);
        let glossy = scene.hidden().any(|(_, s)| !s.is_lambertian());
        let members = |there: bool| 0..if there { MEMBERS } else { 0 };
        let mut tasks = [CENTRES, AREAS, FOOTPRINTS].map(Task::Integral).to_vec();
        tasks.push(Task::Grey);
        tasks.extend(members(true).map(Task::Long));
        tasks.extend(members(blocked).map(Task::Black));
        tasks.extend(members(glossy).map(Task::Matt));
        tasks.extend((0..SHARES).map(Task::Run));
        Self {
            scene: scene.clone(),
            plan,
            tasks,
        }
    }

    /// Paths of a member of the ensemble, and of the run.
    fn samples(&self) -> Result<[Samples; 2], SamplesError> {
        let of = |samples| Samples::new(samples, Sampling::Sobol);
        let BudgetPlan {
            ensemble_samples,
            run_samples,
            ..
        } = self.plan;
        Ok([of(ensemble_samples.div_ceil(MEMBERS))?, of(run_samples)?])
    }

    /// The scene whose paths go on.
    fn long(&self) -> Scene {
        self.scene
            .with_max_bounces(LONGEST.max(self.scene.max_bounces))
    }

    /// Member `stream` of the ensemble; stream 0 is the run.
    fn plan(&self, stream: u64) -> Result<Plan, SamplesError> {
        let [each, run] = self.samples()?;
        let (estimator, budget) = match stream {
            0 => (Estimator::Independent, run),
            _ => (Estimator::Shared, each),
        };
        Ok(Plan {
            estimator,
            sampling: Sampling::Sobol,
            seed: self.plan.seed.wrapping_mul(1000).wrapping_add(stream),
            budget,
        })
    }

    fn member(&self, scene: &Scene, k: u64, control: Control<'_>) -> Result<Traced, LabError> {
        let spots = 0..scene.laser.spots.len();
        Ok(render(scene, &self.plan(k)?, spots, control)?)
    }

    fn integral(&self, extent: Extent) -> Result<[Matrix; 2], ModelError> {
        converged(&self.scene, Kernel::Physical, extent).map(|m| [m.phi, m.bound])
    }
}

impl Study for BudgetTasks {
    /// M₃, the three-bounce integral, and its bound.
    type Context = [Matrix; 2];
    type Output = Vec<Kept>;
    type Result = ErrorBudget;
    type Error = LabError;

    fn work(&self) -> Work {
        Work::samples(
            &self.scene,
            self.plan.ensemble_samples,
            self.plan.run_samples,
        )
    }

    fn agrees(&self, found: &ErrorBudget) -> bool {
        found.closure.closes
    }

    fn tasks(&self) -> usize {
        self.tasks.len()
    }

    /// A render is spread over the threads by itself.
    fn sharing(&self) -> Sharing {
        Sharing::InTurn
    }

    fn context(&self, _: Control<'_>) -> Result<[Matrix; 2], LabError> {
        let m3 = self.integral(Extent::UNOBSTRUCTED)?;
        if m3[0].norm() <= 0.0 {
            return Err(LabError::DARK);
        }
        self.samples()?;
        Ok(m3)
    }

    fn task(
        &self,
        _: &[Matrix; 2],
        index: usize,
        control: Control<'_>,
    ) -> Result<Vec<Kept>, LabError> {
        let third = |traced: Traced| traced.bounces.into_iter().skip(2).take(1).collect();
        let black = || self.scene.with_black_occluders().with_max_bounces(3);
        let found: Vec<Matrix> = match self.tasks[index] {
            Task::Integral(extent) => self.integral(extent)?.into(),
            Task::Grey => {
                let grey = self.scene.with_lambertian_hidden().with_mean_albedo();
                vec![converged(&grey, Kernel::Physical, Extent::UNOBSTRUCTED)?.phi]
            }
            Task::Long(k) => {
                let traced = self.member(&self.long(), k + 1, control)?;
                [traced.flux].into_iter().chain(traced.bounces).collect()
            }
            Task::Black(k) => third(self.member(&black(), k + 101, control)?),
            Task::Matt(k) => {
                let matt = black().with_lambertian_hidden();
                third(self.member(&matt, k + 201, control)?)
            }
            Task::Run(k) => {
                let spots = share(&self.scene, k, SHARES);
                let traced = render(&self.long(), &self.plan(0)?, spots, control)?;
                vec![traced.flux, traced.stderr]
            }
        };
        Ok(found.into_iter().map(Kept).collect())
    }

    fn fits(&self, m3: &[Matrix; 2], index: usize, part: &Vec<Kept>) -> bool {
        let (pixels, mut spots) = m3[0].shape();
        let count = match self.tasks[index] {
            Task::Integral(_) => 2..=2,
            Task::Grey | Task::Black(_) | Task::Matt(_) => 1..=1,
            Task::Long(_) => OWN_ROW + 2..=usize::MAX,
            Task::Run(k) => {
                spots = share(&self.scene, k, SHARES).len();
                2..=2
            }
        };
        count.contains(&part.len()) && part.iter().all(|m| m.0.shape() == (pixels, spots))
    }

    fn finish(&self, m3: &[Matrix; 2], parts: Vec<Vec<Kept>>) -> Result<ErrorBudget, LabError> {
        let parts = parts.into_iter();
        let mut parts = parts.map(|part| part.into_iter().map(|m| m.0).collect::<Vec<_>>());
        // Tasks of a kind follow each other.
        let mut all = |kind: fn(&Task) -> bool| -> Vec<Vec<Matrix>> {
            let count = self.tasks.iter().filter(|task| kind(task)).count();
            parts.by_ref().take(count).collect()
        };
        let found = Found {
            integrals: all(|task| matches!(task, Task::Integral(_))),
            grey: all(|task| matches!(task, Task::Grey)),
            long: all(|task| matches!(task, Task::Long(_))),
            black: all(|task| matches!(task, Task::Black(_))),
            matt: all(|task| matches!(task, Task::Matt(_))),
            run: {
                let shares = all(|task| matches!(task, Task::Run(_)));
                [0, 1].map(|i| side_by_side(m3[0].nrows(), shares.iter().map(|m| &m[i])))
            },
        };
        let norm = m3[0].norm();
        let sizes = Sizes {
            reference: &m3[0],
            norm,
            signal: (&m3[0] - &found.grey[0][0]).norm() / norm,
        };
        let (stored, m0) = (found.stored(), &found.integrals[0][0]);
        let [flux, stderr] = &found.run;
        let everything = Ensemble::new(found.long.iter().map(|m| m[0].clone()).collect());
        // The parts telescope to (ensemble − M₀) plus what f32 changes in the run.
        let sum = everything.map(|t| t - m0 + &stored - flux);
        let [each, run] = self.samples()?;
        Ok(ErrorBudget {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            seed: self.plan.seed,
            ensemble_samples: each.samples() * MEMBERS,
            run_samples: run.samples(),
            signal: sizes.signal,
            terms: found.terms(&self.scene, &sizes, m3)?,
            closure: closure(&(&stored - m0), &sum, stderr, norm),
        })
    }
}

#[cfg(test)]
mod tests;
