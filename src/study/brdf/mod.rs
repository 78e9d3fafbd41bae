//! Does the matrix model hold on a wall that is not Lambertian, and what is lost where the wall's BRDF is not known?
//!
//! A wall of BRDF f enters the model entry by entry: BRDF12 = f(laser → spot → element) multiplies G12 and BRDF23cam = f(element → wall point →
//! camera) multiplies G23. The light is traced once; then each assumption about the wall makes a model of its own, which is tested against that light
//! and used to recover the hidden surface from it. Beside them stands the same bench with a Lambertian wall of equal white-sky albedo, traced and
//! modelled as what it is: how well the method does where no BRDF is in question.
//!
//! Only light that meets three surfaces is traced, as in the model. A hidden surface that is not Lambertian is traced as it is and modelled as
//! [`crate::scene::Surface::matt`]: the part of that in the disagreement is in [`super::error_budget`].

mod assumption;
mod quality;

use serde::{Deserialize, Serialize};

use assumption::{Assumed, Fit, assumed};
use quality::{qualities, ratios};

use super::agreement::{Errors, Evidence, Test, agree};
use super::noise::Spread;
use super::results::Agreement;
use super::task::Division;
use super::validation::Integration;
use crate::matrix::Matrix;
use crate::model::{Extent, Kernel, MatrixModel, ModelError, converged};
use crate::num::stream::Sampling;
use crate::recovery::Method;
use crate::scene::{Role, Scene};
use crate::transport::{Budget, Control, Estimator, Plan, Traced, obstacle, render};

/// How the study is done.
#[derive(Clone, Debug)]
pub struct BrdfPlan {
    /// Paths per pixel, or points, of each of the two renders.
    pub samples: u64,
    /// Seed of the tracer and first one of the noise.
    pub seed: u64,
    /// Probability of rejecting a right model.
    pub significance: f64,
    /// Standard deviations of the entries of Φcam, relative to each.
    pub noise: Vec<f64>,
    /// Recovery methods.
    pub methods: Vec<Method>,
    /// Draws of the noise.
    pub draws: u64,
}

/// How good a recovery is, over draws of the noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Method.
    pub method: String,
    /// Relative noise.
    pub noise: f64,
    /// Raw MTF, where there is black and white.
    pub mtf_raw: Option<Spread>,
    /// Correlation with the truth, where both vary.
    pub correlation: Option<Spread>,
    /// Root mean square error of the reflectances.
    pub rmse: Option<Spread>,
    /// Draws from which the method gave nothing.
    pub failed: usize,
    /// What it said to the last of them.
    pub reason: Option<String>,
}

/// What becomes of one assumption about the wall.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Assumption {
    /// What is assumed, in words.
    pub name: String,
    /// Factor of the whole model: 1 but where the best single one is fitted.
    pub scale: f64,
    /// The model's integral against the traced light.
    pub agreement: Agreement,
    /// Recoveries by the model's matrices: methods, then levels of noise.
    pub qualities: Vec<Quality>,
}

/// Recovery with the known BRDF over recovery of the Lambertian case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ratio {
    /// Method.
    pub method: String,
    /// Relative noise.
    pub noise: f64,
    /// Of the mean raw MTFs.
    pub mtf_raw: Option<f64>,
    /// Of the mean correlations.
    pub correlation: Option<f64>,
    /// Of the mean RMSEs; below 1 the known BRDF does better.
    pub rmse: Option<f64>,
    /// Whether raw MTF and correlation reach 90 % of the Lambertian case's, and the RMSE exceeds it by 10 % at most; absent where the Lambertian
    /// case itself correlates with the truth by less than 0.5.
    pub reaches: Option<bool>,
}

/// The study of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct BrdfStudy {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Estimator of the traced light.
    pub estimator: String,
    /// Paths per pixel, or points.
    pub samples: u64,
    /// Seed.
    pub seed: u64,
    /// Draws of the noise.
    pub draws: u64,
    /// White-sky albedo of each relay surface at the mean of its texture: what a Lambertian wall of equal albedo has.
    pub relay_albedo: Vec<f64>,
    /// The wall's own BRDF first.
    pub assumptions: Vec<Assumption>,
    /// The Lambertian case: its own light, its own model.
    pub lambertian_case: Assumption,
    /// The first assumption over the Lambertian case.
    pub ratios: Vec<Ratio>,
}

impl BrdfStudy {
    /// The assumption that is true: the wall's own BRDF.
    pub fn known(&self) -> &Assumption {
        &self.assumptions[0]
    }
}

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
pub enum BrdfError {
    /// The scene has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Nothing to tell apart.
    #[error(
        "every relay surface of the scene is Lambertian, so its BRDF cannot be assumed wrongly (give the wall another material, or use the scene `satin`)"
    )]
    Lambertian,
    /// No light, so nothing to compare.
    #[error("no light reaches the camera by three bounces (see `phicam scene check`)")]
    Dark,
    /// Not a number of samples.
    #[error("{0} samples cannot be traced (use 1 to 2³²)")]
    Samples(u64),
}

/// Traces a scene and its Lambertian twin, and tries the assumptions. A task is one of them.
#[derive(Debug)]
pub struct BrdfTasks {
    scene: Scene,
    /// The same with Lambertian walls of equal albedo.
    matt: Scene,
    plan: BrdfPlan,
    /// What is assumed of the one, and last what is true of the other.
    assumed: Vec<Assumed>,
}

impl BrdfTasks {
    /// The study of a scene.
    pub fn new(scene: &Scene, plan: BrdfPlan) -> Self {
        let scene = scene.with_max_bounces(3);
        let matt = scene.with_lambertian_relay();
        let mut assumed = assumed(&scene);
        assumed.push(Assumed::right("Lambertian wall", &matt));
        Self {
            scene,
            matt,
            plan,
            assumed,
        }
    }
}

impl Division for BrdfTasks {
    /// Light of the scene and of its twin.
    type Ground = [Traced; 2];
    type Part = Assumption;
    type Finding = BrdfStudy;
    type Error = BrdfError;

    fn tasks(&self) -> usize {
        self.assumed.len()
    }

    fn ground(&self, control: Control<'_>) -> Result<Option<[Traced; 2]>, BrdfError> {
        if self.scene.relay_is_lambertian() {
            return Err(BrdfError::Lambertian);
        }
        let how = tracing(&self.scene, &self.plan)?;
        let Some(own) = light(&self.scene, &how, control) else {
            return Ok(None);
        };
        if own.flux.amax() <= 0.0 {
            return Err(BrdfError::Dark);
        }
        Ok(light(&self.matt, &how, control).map(|twin| [own, twin]))
    }

    fn task(
        &self,
        [own, twin]: &[Traced; 2],
        index: usize,
        _: Control<'_>,
    ) -> Result<Option<Assumption>, BrdfError> {
        let how = tracing(&self.scene, &self.plan)?;
        let light = match index + 1 == self.assumed.len() {
            true => twin,
            false => own,
        };
        tried(&self.assumed[index], light, &how, &self.plan).map(Some)
    }

    fn fits(&self, _: &[Traced; 2], _: usize, part: &Assumption) -> bool {
        part.qualities.len() == self.plan.methods.len() * self.plan.noise.len()
    }

    fn finish(&self, _: &[Traced; 2], parts: Vec<Assumption>) -> Result<BrdfStudy, BrdfError> {
        let mut assumptions = parts;
        let lambertian_case = assumptions.pop().ok_or(BrdfError::Lambertian)?;
        let how = tracing(&self.scene, &self.plan)?;
        let relays = self.matt.surfaces.iter().filter(|s| s.role == Role::Relay);
        Ok(BrdfStudy {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            estimator: how.estimator.name().to_owned(),
            samples: how.budget.samples(),
            seed: self.plan.seed,
            draws: self.plan.draws,
            relay_albedo: relays
                .map(|s| s.albedo.mean([0.0, 1.0], [0.0, 1.0]))
                .collect(),
            ratios: ratios(&assumptions[0].qualities, &lambertian_case.qualities),
            assumptions,
            lambertian_case,
        })
    }
}

/// `factored` where the hidden surfaces allow it, else `shared`.
fn tracing(scene: &Scene, plan: &BrdfPlan) -> Result<Plan, BrdfError> {
    let with = |estimator| {
        let sampling = Sampling::Sobol;
        Some(Plan {
            estimator,
            sampling,
            seed: plan.seed,
            budget: Budget::new(plan.samples, sampling)?,
        })
    };
    let factored = with(Estimator::Factored).filter(|how| obstacle(scene, how).is_none());
    factored
        .or_else(|| with(Estimator::Shared))
        .ok_or(BrdfError::Samples(plan.samples))
}

fn light(scene: &Scene, how: &Plan, control: Control<'_>) -> Option<Traced> {
    render(scene, how, 0..scene.laser.spots.len(), control)
}

/// Tests an assumption against the light, and recovers with it.
fn tried(
    assumed: &Assumed,
    light: &Traced,
    how: &Plan,
    plan: &BrdfPlan,
) -> Result<Assumption, BrdfError> {
    let integral = converged(&assumed.scene, Kernel::Physical, Extent::FULL)?;
    let scale = match assumed.fit {
        Fit::None => 1.0,
        Fit::BestScale => {
            light.flux.dot(&integral.phi) / integral.phi.norm_squared().max(f64::MIN_POSITIVE)
        }
    };
    let (model, bound): (Matrix, Matrix) = (integral.phi * scale, integral.bound * scale);
    let evidence = Evidence {
        traced: &light.flux,
        stderr: &light.stderr,
        model: &model,
        bound: Some(&bound),
    };
    let test = Test {
        significance: plan.significance,
        replicates: how.budget.blocks,
        errors: Errors::of(how.estimator),
    };
    let (mut agreement, _) = agree(evidence, test);
    Kernel::Physical.name().clone_into(&mut agreement.kernel);
    let quadrature = Integration::Quadrature.name();
    quadrature.clone_into(&mut agreement.integration);
    let mut matrices = MatrixModel::new(&assumed.scene, Kernel::Physical, None)?;
    matrices.camera_side *= scale;
    Ok(Assumption {
        name: assumed.name.clone(),
        scale,
        agreement,
        qualities: qualities(&matrices, &light.flux, plan),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::task::tests::{divides, small};

    #[test]
    fn it_divides() {
        let plan = BrdfPlan {
            samples: 64,
            seed: 1,
            significance: 0.01,
            noise: vec![0.01],
            methods: vec![Method::Pinv, Method::Joint],
            draws: 2,
        };
        let found = divides(&BrdfTasks::new(&small("satin"), plan));
        assert!(found.assumptions.len() > 5);
    }
}
