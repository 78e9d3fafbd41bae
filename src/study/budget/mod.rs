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

use serde::Serialize;

use sizes::{Sizes, closure};

use super::ensemble::{Ensemble, Estimate};
use crate::matrix::Matrix;
use crate::model::{Extent, Kernel, MatrixModel, ModelError, Take, converged};
use crate::num::stream::Sampling;
use crate::scene::{Role, Scene};
use crate::transport::{Budget as Samples, Control, Estimator, Plan, Traced, render};

/// Renders of the ensemble.
const MEMBERS: u64 = 8;
/// Bounce counts that have a row of their own; more share one.
const OWN_ROW: usize = 7;
/// Paths of the ensemble go on to this many surfaces.
const LONGEST: u32 = 12;

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
    let centres = Extent {
        elements: Take::Centre,
        footprints: Take::Centre,
        spots: Take::Centre,
    };
    let areas = Extent {
        elements: Take::Integral,
        ..centres
    };
    let footprints = Extent {
        footprints: Take::Integral,
        ..areas
    };
    let integral = |extent| converged(scene, Kernel::Physical, extent);
    let chain = [centres, areas, footprints, Extent::FULL].map(integral);
    let [m0, m1, m2, m3] = chain.map(|m| m.map(|m| (m.phi, m.bound)));
    let (m0, m1, m2, m3) = (m0?, m1?, m2?, m3?);
    let norm = m3.0.norm();
    if norm <= 0.0 {
        return Err(BudgetError::Dark);
    }
    let grey = scene.with_lambertian_hidden().with_mean_albedo();
    let grey = converged(&grey, Kernel::Physical, Extent::FULL)?.phi;
    let signal = (&m3.0 - grey).norm() / norm;

    let each = Samples::new(plan.ensemble_samples.div_ceil(MEMBERS), Sampling::Sobol)
        .ok_or(BudgetError::Samples(plan.ensemble_samples))?;
    let run = Samples::new(plan.run_samples, Sampling::Sobol)
        .ok_or(BudgetError::Samples(plan.run_samples))?;
    let long = scene.with_max_bounces(LONGEST.max(scene.max_bounces));
    let spots = 0..scene.laser.spots.len();
    let member = |scene: &Scene, stream: u64| {
        let seed = plan.seed.wrapping_mul(1000).wrapping_add(stream);
        let plan = Plan {
            estimator: Estimator::Shared,
            sampling: Sampling::Sobol,
            seed,
            budget: each,
        };
        render(scene, &plan, spots.clone(), control)
    };
    let Some(members) = (0..MEMBERS)
        .map(|k| member(&long, k + 1))
        .collect::<Option<Vec<Traced>>>()
    else {
        return Ok(None);
    };
    let blocked = scene.surfaces.iter().any(|s| s.role == Role::Occluder);
    let black = scene.with_black_occluders().with_max_bounces(3);
    let Some(occluded) = (0..if blocked { MEMBERS } else { 0 })
        .map(|k| member(&black, k + 101))
        .collect::<Option<Vec<Traced>>>()
    else {
        return Ok(None);
    };
    let glossy = scene.hidden().any(|(_, s)| !s.is_lambertian());
    let matt = black.with_lambertian_hidden();
    let Some(matt) = (0..if glossy { MEMBERS } else { 0 })
        .map(|k| member(&matt, k + 201))
        .collect::<Option<Vec<Traced>>>()
    else {
        return Ok(None);
    };
    let seed = plan.seed.wrapping_mul(1000);
    let frames = Plan {
        estimator: Estimator::Independent,
        sampling: Sampling::Sobol,
        seed,
        budget: run,
    };
    let Some(frames) = render(&long, &frames, spots.clone(), control) else {
        return Ok(None);
    };

    let sizes = Sizes {
        reference: &m3.0,
        norm,
        signal,
    };
    let order =
        |n: usize| Ensemble::new(members.iter().map(|t| t.bounces[n - 1].clone()).collect());
    let beyond = Ensemble::new(
        members
            .iter()
            .map(|t| {
                t.bounces[OWN_ROW..]
                    .iter()
                    .fold(Matrix::zeros(m3.0.nrows(), m3.0.ncols()), |a, b| a + b)
            })
            .collect(),
    );
    let mut terms = vec![
        sizes.exact("element area", &m1, &m0),
        sizes.exact("pixel footprint", &m2, &m1),
        sizes.exact("spot size and profile", &m3, &m2),
    ];
    // Light of three bounces by wall and hidden surfaces alone.
    let own = if blocked { &occluded } else { &members };
    let third = |traced: &[Traced]| traced.iter().map(|t| t.bounces[2].clone()).collect();
    let first = if glossy { &matt } else { own };
    let occlusion = Ensemble::new(third(first)).map(|m| m - &m3.0);
    terms.push(sizes.traced("occlusion", &occlusion, true));
    let step = |to: &[Traced], from: &[Traced]| {
        let pairs = to.iter().zip(from);
        Ensemble::new(pairs.map(|(t, f)| &t.bounces[2] - &f.bounces[2]).collect())
    };
    if glossy {
        terms.push(sizes.traced("S2 not Lambertian", &step(own, &matt), true));
    }
    if blocked {
        let rest = step(&members, &occluded);
        terms.push(sizes.traced("3 bounces by other surfaces", &rest, true));
    }
    for n in [1, 2, 4, 5, 6, OWN_ROW] {
        let name = if n == 1 {
            "1 bounce".to_owned()
        } else {
            format!("{n} bounces")
        };
        let dark = members.iter().all(|t| t.bounces[n - 1].amax() <= 0.0);
        if !(n < 3 && dark) {
            terms.push(sizes.traced(&name, &order(n), true));
        }
    }
    terms.push(sizes.traced(&format!("{} and more bounces", OWN_ROW + 1), &beyond, true));
    let stored = frames.flux.map(|x| f64::from(x as f32));
    let zero = Matrix::zeros(m3.0.nrows(), m3.0.ncols());
    terms.push(sizes.exact(
        "storage in f32 frames",
        &(stored.clone(), zero.clone()),
        &(frames.flux.clone(), zero.clone()),
    ));
    terms.push(Term {
        in_sum: true,
        ..sizes.noise("Monte Carlo itself", &frames.stderr)
    });
    terms.push(Term {
        in_sum: false,
        ..sizes.exact(
            "étendue, if taken constant",
            &(constant_etendue(scene)?, zero.clone()),
            &(m0.0.clone(), zero),
        )
    });

    let everything = Ensemble::new(members.iter().map(|t| t.flux.clone()).collect());
    let total = &stored - &m0.0;
    // The parts telescope to (ensemble − M₀) plus what f32 changes in the run.
    let sum = everything.map(|t| t - &m0.0 + &stored - &frames.flux);
    let closure = closure(&total, &sum, &frames.stderr, norm);
    Ok(Some(ErrorBudget {
        scene: scene.name.clone(),
        scene_hash: scene.hash.clone(),
        seed: plan.seed,
        ensemble_samples: each.samples() * MEMBERS,
        run_samples: run.samples(),
        signal,
        terms,
        closure,
    }))
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
