//! The study in tasks: each an assumption about the wall.

use super::assumption::{Assumed, Fit, assumed};
use super::quality::{qualities, ratios};
use super::{Assumption, BrdfError, BrdfPlan, BrdfStudy};
use crate::matrix::Matrix;
use crate::model::{Extent, Kernel, MatrixModel, converged};
use crate::num::stream::Sampling;
use crate::scene::{Role, Scene};
use crate::study::agreement::{Errors, Evidence, Test, agree};
use crate::study::task::{Division, Sharing};
use crate::study::validation::Integration;
use crate::transport::{Budget, Control, Estimator, Plan, Traced, obstacle, render};

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

    /// A render is spread over the threads by itself.
    fn sharing(&self) -> Sharing {
        Sharing::InTurn
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
    use crate::recovery::Method;
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
