//! The error budget of the matrix model: what each idealisation costs on this bench.
//!
//! The chain from the model M₀ (elements, pixels and spots by their centres) to the light that a run stores:
//!
//! ```text
//! M₀ →(elements)→ M₁ →(footprints)→ M₂ →(spots)→ M₃ →(occlusion)→ T₃ᵐ →(BRDF of S2)→ T₃ˡ →(other surfaces)→ T₃
//!    →(2, 4, 5, … bounces)→ T →(Monte Carlo)→ A →(f32)→ frames
//! ```
//!
//! The model knows the BRDF of the wall, but takes S2 for the Lambertian surface of equal white-sky albedo ([`crate::scene::Surface::matt`]). Where it is
//! not Lambertian, T₃ᵐ is traced with that one in its place, and what its own BRDF changes has a row.
//!
//! Each step is a matrix, computed by itself: M by quadrature, T from an ensemble of precise renders (`shared`, Sobol', seeds of
//! their own), A one render as `render` makes it (`independent`). The parts add up to frames − M₀ by construction,
//! except that T is estimated twice, by A and by the ensemble, which share no random number and no estimator: whether the sum
//! closes is a test of both.

mod sizes;
mod tasks;

use serde::Serialize;

use sizes::{Sizes, closure};
pub use tasks::BudgetTasks;
use tasks::{Found, Integral, MEMBERS, Member};

use super::ensemble::{Ensemble, Estimate};
use super::task::whole;
use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel, ModelError};
use crate::scene::Scene;
use crate::transport::Control;

/// Bounce counts that have a row of their own; more share one.
const OWN_ROW: usize = 7;

/// One cause.
#[derive(Clone, Debug, Serialize)]
pub struct Term {
    /// What it is.
    pub name: String,
    /// ‖term‖/‖Φ‖, Φ the three-bounce integral.
    pub size: Estimate,
    /// The same after the best single scale of Φ is taken off: what no calibration removes.
    pub after_scale: Estimate,
    /// ‖term‖ over the object's signal ‖Φ − Φ of the mean albedo‖.
    pub of_signal: f64,
    /// Whether it is part of the sum. What is not would be added by a cruder model or is named for comparison.
    pub in_sum: bool,
}

/// Whether the parts add up to the total.
#[derive(Clone, Debug, Serialize)]
pub struct Closure {
    /// ‖total‖/‖Φ‖: what a run's frames differ by from the matrix model.
    pub total: Estimate,
    /// ‖sum of the parts‖/‖Φ‖, Monte Carlo noise left out.
    pub sum: Estimate,
    /// ‖total − sum‖/‖Φ‖: noise, if the sum closes.
    pub rest: f64,
    /// What the standard errors say that rest should be.
    pub expected: f64,
    /// (rest² − expected²) in its standard errors, from the scatter over pixels.
    pub z: f64,
    /// |z| ≤ 3.
    pub closes: bool,
}

/// The budget of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct ErrorBudget {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Seed.
    pub seed: u64,
    /// Paths per pixel of the ensemble, all members together.
    pub ensemble_samples: u64,
    /// Paths per pixel and spot of the run that is taken apart.
    pub run_samples: u64,
    /// The object's signal, ‖Φ − Φ of the mean albedo‖/‖Φ‖.
    pub signal: f64,
    /// The causes, in the order of the chain.
    pub terms: Vec<Term>,
    /// Whether they add up.
    pub closure: Closure,
}

/// Why there is no budget.
#[derive(Debug, thiserror::Error)]
pub enum BudgetError {
    /// The scene has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// No light, so no shares.
    #[error("no light reaches the camera by three bounces (see `phicam scene check`)")]
    Dark,
    /// Too few samples for the ensemble.
    #[error("{0} samples cannot be divided into renders of an ensemble (use 1 to 2³²)")]
    Samples(u64),
}

/// How the budget is computed.
#[derive(Clone, Copy, Debug)]
pub struct BudgetPlan {
    /// Seed of everything.
    pub seed: u64,
    /// Paths per pixel of the whole ensemble.
    pub ensemble_samples: u64,
    /// Paths per pixel and spot of the run.
    pub run_samples: u64,
}

/// Takes the difference between frames and model apart. `Ok(None)` if stopped.
///
/// # Errors
/// [`BudgetError`].
pub fn error_budget(
    scene: &Scene,
    plan: BudgetPlan,
    control: Control<'_>,
) -> Result<Option<ErrorBudget>, BudgetError> {
    whole(&BudgetTasks::new(scene, plan), control, &|_, _| ())
}

impl BudgetTasks {
    /// The terms of the chain, from what was integrated and traced.
    fn terms(
        &self,
        sizes: &Sizes<'_>,
        m3: &Integral,
        found: &Found,
    ) -> Result<Vec<Term>, ModelError> {
        let scene = &self.scene;
        let [m0, m1, m2] = &found.chain;
        let mut terms = vec![
            sizes.exact("element area", m1, m0),
            sizes.exact("pixel footprint", m2, m1),
            sizes.exact("spot size and profile", m3, m2),
        ];
        // Light of three bounces by wall and hidden surfaces alone.
        let thirds: Vec<&Matrix> = found.members.iter().map(|m| &m.bounces[2]).collect();
        let occluded: Vec<&Matrix> = found.occluded.iter().collect();
        let matt: Vec<&Matrix> = found.matt.iter().collect();
        let own = if self.blocked() { &occluded } else { &thirds };
        let first = if self.glossy() { &matt } else { own };
        let less = first.iter().map(|m| *m - &m3.0).collect();
        terms.push(sizes.traced("occlusion", &Ensemble::new(less), true));
        let step = |to: &[&Matrix], from: &[&Matrix]| {
            Ensemble::new(to.iter().zip(from).map(|(t, f)| *t - *f).collect())
        };
        if self.glossy() {
            terms.push(sizes.traced("S2 not Lambertian", &step(own, &matt), true));
        }
        if self.blocked() {
            let rest = step(&thirds, &occluded);
            terms.push(sizes.traced("3 bounces by other surfaces", &rest, true));
        }
        terms.extend(found.by_bounces(sizes));
        let zero = || Matrix::zeros(m3.0.nrows(), m3.0.ncols());
        terms.push(sizes.exact(
            "storage in f32 frames",
            &(found.stored(), zero()),
            &(found.flux.clone(), zero()),
        ));
        terms.push(Term {
            in_sum: true,
            ..sizes.noise("Monte Carlo itself", &found.stderr)
        });
        terms.push(Term {
            in_sum: false,
            ..sizes.exact(
                "étendue, if taken constant",
                &(constant_etendue(scene)?, zero()),
                &(m0.0.clone(), zero()),
            )
        });
        Ok(terms)
    }

    /// The budget, from what was integrated and traced.
    fn budget(&self, m3: &Integral, found: &Found) -> Result<ErrorBudget, BudgetError> {
        let norm = m3.0.norm();
        let signal = (&m3.0 - &found.grey).norm() / norm;
        let sizes = Sizes {
            reference: &m3.0,
            norm,
            signal,
        };
        let terms = self.terms(&sizes, m3, found)?;
        let (stored, m0) = (found.stored(), &found.chain[0].0);
        let everything = Ensemble::new(found.members.iter().map(|t| t.flux.clone()).collect());
        let total = &stored - m0;
        // The parts telescope to (ensemble − M₀) plus what f32 changes in the run.
        let sum = everything.map(|t| t - m0 + &stored - &found.flux);
        let [each, run] = self.samples()?;
        Ok(ErrorBudget {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            seed: self.plan.seed,
            ensemble_samples: each.samples() * MEMBERS,
            run_samples: run.samples(),
            signal,
            terms,
            closure: closure(&total, &sum, &found.stderr, norm),
        })
    }
}

impl Found {
    /// The run as its frames store it.
    fn stored(&self) -> Matrix {
        self.flux.map(|x| f64::from(x as f32))
    }

    /// Light that met another number of surfaces than three.
    fn by_bounces(&self, sizes: &Sizes<'_>) -> Vec<Term> {
        let order = |n: usize| {
            let own = self.members.iter().map(|t| t.bounces[n - 1].clone());
            Ensemble::new(own.collect())
        };
        let beyond = |t: &Member| {
            let zero = Matrix::zeros(self.flux.nrows(), self.flux.ncols());
            t.bounces[OWN_ROW..].iter().fold(zero, |a, b| a + b)
        };
        let mut terms = Vec::new();
        for n in [1, 2, 4, 5, 6, OWN_ROW] {
            let name = if n == 1 {
                "1 bounce".to_owned()
            } else {
                format!("{n} bounces")
            };
            let dark = self.members.iter().all(|t| t.bounces[n - 1].amax() <= 0.0);
            if !(n < 3 && dark) {
                terms.push(sizes.traced(&name, &order(n), true));
            }
        }
        let beyond = Ensemble::new(self.members.iter().map(beyond).collect());
        terms.push(sizes.traced(&format!("{} and more bounces", OWN_ROW + 1), &beyond, true));
        terms
    }
}

/// The matrix model if every pixel had the mean étendue.
fn constant_etendue(scene: &Scene) -> Result<Matrix, ModelError> {
    let model = MatrixModel::new(scene, Kernel::Physical, None)?;
    let camera = scene.camera.position;
    let etendue = |p: usize| {
        let to = scene.camera.footprint(p).at([0.5, 0.5]) - camera;
        let cos = scene.camera.view.normal().dot(to.normalize());
        cos * cos / to.length_squared()
    };
    let each: Vec<f64> = (0..scene.camera.pixels()).map(etendue).collect();
    let mean = each.iter().sum::<f64>() / each.len() as f64;
    let mut phi = model.phi();
    for (mut row, e) in phi.row_iter_mut().zip(&each) {
        row *= mean / e;
    }
    Ok(phi)
}
