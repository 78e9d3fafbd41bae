//! The budget in tasks: each an integral, a render of an ensemble, or some spots of the run.

use serde::{Deserialize, Serialize};

use super::{BudgetError, BudgetPlan, ErrorBudget, OWN_ROW};
use crate::matrix::Matrix;
use crate::model::{Extent, Kernel, ModelError, Take, converged};
use crate::num::stream::Sampling;
use crate::scene::{Role, Scene};
use crate::study::task::matrix::{Columns, Kept, SHARES, share};
use crate::study::task::{Division, Sharing};
use crate::transport::{Budget as Samples, Control, Estimator, Plan, Traced, render};

/// Renders of an ensemble.
pub(super) const MEMBERS: u64 = 8;
/// Paths of the ensemble go on to this many surfaces.
const LONGEST: u32 = 12;
/// Light that met three surfaces.
const THIRD: usize = 2;

/// [`super::error_budget`] in tasks.
#[derive(Debug)]
pub struct BudgetTasks {
    pub(super) scene: Scene,
    pub(super) plan: BudgetPlan,
    tasks: Vec<Task>,
}

/// What one task computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Task {
    /// Φ by quadrature, with this much of it by centres.
    Integral(Extent),
    /// Φ of the mean albedo.
    Grey,
    /// A member of the ensemble of whole light.
    Long(u64),
    /// Its three-bounce light with black occluders.
    Black(u64),
    /// The same with the Lambertian hidden surface of equal albedo.
    Matt(u64),
    /// A share of the run.
    Run(usize),
}

/// What it gives.
#[derive(Debug, Serialize, Deserialize)]
pub enum Part {
    /// Φ and its bound.
    Integral([Kept; 2]),
    /// One matrix.
    One(Kept),
    /// Flux, and the flux of every number of bounces.
    Member(Kept, Vec<Kept>),
    /// Columns of the run.
    Run(Columns),
}

/// Φ and what the quadrature may be off by, W.
pub(super) type Integral = (Matrix, Matrix);

/// A render of the ensemble, W.
pub(super) struct Member {
    pub(super) flux: Matrix,
    pub(super) bounces: Vec<Matrix>,
}

/// What all tasks have found.
#[derive(Default)]
pub(super) struct Found {
    /// M₀, M₁ and M₂.
    pub(super) chain: [Integral; 3],
    pub(super) grey: Matrix,
    pub(super) members: Vec<Member>,
    pub(super) occluded: Vec<Matrix>,
    pub(super) matt: Vec<Matrix>,
    /// The run and its standard error.
    pub(super) flux: Matrix,
    pub(super) stderr: Matrix,
}

const CENTRES: Extent = Extent {
    elements: Take::Centre,
    footprints: Take::Centre,
    spots: Take::Centre,
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
        let mut own = Self {
            scene: scene.clone(),
            plan,
            tasks: [CENTRES, AREAS, FOOTPRINTS].map(Task::Integral).to_vec(),
        };
        let members = |there: bool| 0..if there { MEMBERS } else { 0 };
        let (blocked, glossy) = (own.blocked(), own.glossy());
        own.tasks.push(Task::Grey);
        own.tasks.extend(members(true).map(Task::Long));
        own.tasks.extend(members(blocked).map(Task::Black));
        own.tasks.extend(members(glossy).map(Task::Matt));
        own.tasks.extend((0..SHARES).map(Task::Run));
        own
    }

    /// Whether something stands in the way.
    pub(super) fn blocked(&self) -> bool {
        self.scene.surfaces.iter().any(|s| s.role == Role::Occluder)
    }

    /// Whether a hidden surface is not Lambertian.
    pub(super) fn glossy(&self) -> bool {
        self.scene.hidden().any(|(_, s)| !s.is_lambertian())
    }

    /// Paths of a member of the ensemble, and of the run.
    pub(super) fn samples(&self) -> Result<[Samples; 2], BudgetError> {
        let BudgetPlan {
            ensemble_samples,
            run_samples,
            ..
        } = self.plan;
        let of = |each, all| Samples::new(each, Sampling::Sobol).ok_or(BudgetError::Samples(all));
        Ok([
            of(ensemble_samples.div_ceil(MEMBERS), ensemble_samples)?,
            of(run_samples, run_samples)?,
        ])
    }

    /// The scene whose paths go on.
    fn long(&self) -> Scene {
        self.scene
            .with_max_bounces(LONGEST.max(self.scene.max_bounces))
    }

    fn member(
        &self,
        scene: &Scene,
        stream: u64,
        control: Control<'_>,
    ) -> Result<Option<Traced>, BudgetError> {
        let plan = Plan {
            estimator: Estimator::Shared,
            sampling: Sampling::Sobol,
            seed: self.plan.seed.wrapping_mul(1000).wrapping_add(stream),
            budget: self.samples()?[0],
        };
        Ok(render(scene, &plan, 0..scene.laser.spots.len(), control))
    }

    fn run(&self, k: usize, control: Control<'_>) -> Result<Option<Traced>, BudgetError> {
        let plan = Plan {
            estimator: Estimator::Independent,
            sampling: Sampling::Sobol,
            seed: self.plan.seed.wrapping_mul(1000),
            budget: self.samples()?[1],
        };
        let spots = share(&self.scene, k, SHARES);
        Ok(render(&self.long(), &plan, spots, control))
    }

    fn integral(&self, extent: Extent) -> Result<Integral, ModelError> {
        converged(&self.scene, Kernel::Physical, extent).map(|m| (m.phi, m.bound))
    }
}

impl Division for BudgetTasks {
    /// M₃, the three-bounce integral.
    type Ground = Integral;
    type Part = Part;
    type Finding = ErrorBudget;
    type Error = BudgetError;

    fn tasks(&self) -> usize {
        self.tasks.len()
    }

    /// A render is spread over the threads by itself.
    fn sharing(&self) -> Sharing {
        Sharing::InTurn
    }

    fn ground(&self, _: Control<'_>) -> Result<Option<Integral>, BudgetError> {
        let m3 = self.integral(Extent::FULL)?;
        if m3.0.norm() <= 0.0 {
            return Err(BudgetError::Dark);
        }
        self.samples()?;
        Ok(Some(m3))
    }

    fn task(
        &self,
        _: &Integral,
        index: usize,
        control: Control<'_>,
    ) -> Result<Option<Part>, BudgetError> {
        let third = |traced: Option<Traced>| {
            traced.map(|mut t| Part::One(Kept(t.bounces.swap_remove(THIRD))))
        };
        let black = || self.scene.with_black_occluders().with_max_bounces(3);
        Ok(match self.tasks[index] {
            Task::Integral(extent) => {
                let (phi, bound) = self.integral(extent)?;
                Some(Part::Integral([Kept(phi), Kept(bound)]))
            }
            Task::Grey => {
                let grey = self.scene.with_lambertian_hidden().with_mean_albedo();
                let phi = converged(&grey, Kernel::Physical, Extent::FULL)?.phi;
                Some(Part::One(Kept(phi)))
            }
            Task::Long(k) => self.member(&self.long(), k + 1, control)?.map(|t| {
                let bounces = t.bounces.into_iter().map(Kept);
                Part::Member(Kept(t.flux), bounces.collect())
            }),
            Task::Black(k) => third(self.member(&black(), k + 101, control)?),
            Task::Matt(k) => {
                let matt = black().with_lambertian_hidden();
                third(self.member(&matt, k + 201, control)?)
            }
            Task::Run(k) => self.run(k, control)?.map(|t| Part::Run(Columns::of(t))),
        })
    }

    fn fits(&self, m3: &Integral, index: usize, part: &Part) -> bool {
        let shape = m3.0.shape();
        let shaped = |m: &Kept| m.0.shape() == shape;
        match (self.tasks[index], part) {
            (Task::Integral(_), Part::Integral(both)) => both.iter().all(shaped),
            (Task::Grey | Task::Black(_) | Task::Matt(_), Part::One(m)) => shaped(m),
            (Task::Long(_), Part::Member(flux, bounces)) => {
                shaped(flux) && bounces.iter().all(shaped) && bounces.len() > OWN_ROW
            }
            (Task::Run(k), Part::Run(columns)) => {
                columns.shaped((shape.0, share(&self.scene, k, SHARES).len()))
            }
            _ => false,
        }
    }

    fn finish(&self, m3: &Integral, parts: Vec<Part>) -> Result<ErrorBudget, BudgetError> {
        let (mut found, mut run, mut at) = (Found::default(), Vec::new(), 0);
        for (task, part) in self.tasks.iter().zip(parts) {
            match part {
                Part::Integral([Kept(phi), Kept(bound)]) => {
                    found.chain[at] = (phi, bound);
                    at += 1;
                }
                Part::One(Kept(m)) => match task {
                    Task::Black(_) => found.occluded.push(m),
                    Task::Matt(_) => found.matt.push(m),
                    _ => found.grey = m,
                },
                Part::Member(Kept(flux), bounces) => found.members.push(Member {
                    flux,
                    bounces: bounces.into_iter().map(|m| m.0).collect(),
                }),
                Part::Run(columns) => run.push(columns),
            }
        }
        [found.flux, found.stderr] = Columns::join(m3.0.nrows(), run.iter());
        self.budget(m3, &found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::task::tests::{divides, refuses, small, unstopped};

    #[test]
    fn it_divides() {
        for name in ["bench", "corner"] {
            let plan = BudgetPlan {
                seed: 1,
                ensemble_samples: 256,
                run_samples: 32,
            };
            let tasks = BudgetTasks::new(&small(name), plan);
            assert!(divides(&tasks).terms.len() > 8);
        }
    }

    /// The last tasks are shares of the run, the first an integral.
    #[test]
    fn results_of_another_kind_are_refused() {
        let plan = BudgetPlan {
            seed: 1,
            ensemble_samples: 64,
            run_samples: 32,
        };
        let tasks = BudgetTasks::new(&small("bench"), plan);
        let integral = unstopped(|c| tasks.ground(c)).unwrap().unwrap();
        let last = tasks.tasks() - 1;
        for (index, at) in [(0, last), (last, 0)] {
            let part = unstopped(|c| tasks.task(&integral, at, c));
            refuses(&tasks, index, &part.unwrap().unwrap());
        }
    }
}
