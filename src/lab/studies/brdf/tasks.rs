//! The study in tasks: each an assumption about the wall.

use super::assumption::{Assumed, assumed};
use super::quality::{qualities, ratios};
use super::results::{Assumption, BrdfPlan, BrdfStudy};
use crate::lab::comparison::agreement::agree;
use crate::lab::comparison::evidence::{Evidence, Test};
use crate::lab::comparison::validation::Integration;
use crate::lab::error::LabError;
use crate::lab::options::Opt;
use crate::lab::studies::registered::{Registered, prepared};
use crate::lab::study::{Sharing, Study};
use crate::lab::uncertainty::certainty::Certainty;
use crate::model::{Extent, Kernel, MatrixModel, converged};
use crate::num::stream::Sampling;
use crate::scene::Scene;
use crate::transport::{Control, Estimator, Plan, SamplesError, Traced, render};

/// `phicam study brdf`.
pub(in crate::lab) const STUDY: Registered = Registered {
    name: "brdf",
    about: "The matrix model on a wall that is not Lambertian, its BRDF known, ignored, or wrong: table, JSON, CSV, figure",
    scene: Some("satin"),
    files: "brdf.csv, brdf.svg",
    options: &[
        Opt::paths(
            "samples",
            "Points between the walls, of each of the two renders",
        )
        .or("65536"),
        Opt::relative_noise(
            "Noise of the photographs, relative to each entry, separated by commas",
        )
        .or("0.001,0.01,0.1"),
        Opt::methods(
            "Recovery methods, separated by commas",
            "pinv,tikhonov,joint",
        ),
        Opt::whole("seeds", "Draws of the noise")
            .or("20")
            .within(1, 100_000),
        Opt::seed("Seed of the tracer and first one of the noise"),
        Opt::significance("0.0001"),
    ],
    prepare: |scene, values| {
        let plan = BrdfPlan {
            samples: values.one("samples")?,
            seed: values.one("seed")?,
            significance: values.one("significance")?,
            noise: values.list("noise")?,
            methods: values.methods()?,
            draws: values.one("seeds")?,
        };
        Ok(prepared(BrdfTasks::new(scene, plan)?))
    },
};

/// Why a scene has nothing to tell apart, and the cure.
const LAMBERTIAN: &str = "every relay surface of the scene is Lambertian, so its BRDF cannot be assumed wrongly (give \
     the wall another material, or use the scene `satin`)";

/// Traces a scene and its Lambertian twin, and tries the assumptions. A task is one of them.
#[derive(Debug)]
pub struct BrdfTasks {
    scene: Scene,
    plan: BrdfPlan,
    /// What is assumed of the scene's wall.
    assumed: Vec<Assumed>,
    /// What is true of the twin, the same with Lambertian walls of equal albedo.
    twin: Assumed,
}

impl BrdfTasks {
    /// The study of a scene.
    ///
    /// # Errors
    /// [`LabError::Unsuited`] if every wall is Lambertian.
    pub fn new(scene: &Scene, plan: BrdfPlan) -> Result<Self, LabError> {
        if scene.relay_is_lambertian() {
            return Err(LabError::Unsuited(LAMBERTIAN));
        }
        let scene = scene.with_max_bounces(3);
        Ok(Self {
            assumed: assumed(&scene),
            twin: Assumed::right("Lambertian wall", &scene.with_lambertian_relay()),
            scene,
            plan,
        })
    }

    fn tracing(&self) -> Result<Plan, SamplesError> {
        let BrdfPlan { seed, samples, .. } = self.plan;
        Plan::new(Estimator::Factored, Sampling::Sobol, seed, samples)
    }

    /// Tests an assumption against the light, and recovers with it.
    fn tried(&self, assumed: &Assumed, light: &Traced) -> Result<Assumption, LabError> {
        let integral = converged(&assumed.scene, Kernel::Physical, Extent::FULL)?;
        let scale = if assumed.scaled {
            light.flux.dot(&integral.phi) / integral.phi.norm_squared().max(f64::MIN_POSITIVE)
        } else {
            1.0
        };
        let evidence = Evidence {
            traced: &light.flux,
            stderr: &light.stderr,
            model: &(integral.phi * scale),
            bound: Some(&(integral.bound * scale)),
            left_out: None,
            eliminated: None,
        };
        let how = self.tracing()?;
        let test = Test {
            significance: self.plan.significance,
            known: Certainty::of(&how),
        };
        let (mut agreement, _) = agree(evidence, test, None);
        agreement.kernel = Kernel::Physical.name().to_owned();
        agreement.integration = Integration::Quadrature.name().to_owned();
        let mut matrices = MatrixModel::new(&assumed.scene, Kernel::Physical, None)?;
        matrices.scale(scale);
        Ok(Assumption {
            name: assumed.name.clone(),
            scale,
            agreement,
            qualities: qualities(&matrices, &light.flux, &self.plan),
        })
    }
}

impl Study for BrdfTasks {
    /// Light of the scene and of its twin.
    type Context = [Traced; 2];
    type Output = Assumption;
    type Result = BrdfStudy;
    type Error = LabError;

    fn tasks(&self) -> usize {
        self.assumed.len() + 1
    }

    fn agrees(&self, found: &BrdfStudy) -> bool {
        found.known().agreement.agrees
    }

    /// A render is spread over the threads by itself.
    fn sharing(&self) -> Sharing {
        Sharing::InTurn
    }

    fn context(&self, control: Control<'_>) -> Result<[Traced; 2], LabError> {
        let how = self.tracing()?;
        let light = |scene: &Scene| render(scene, &how, 0..scene.laser.spots.len(), control);
        let own = light(&self.scene)?;
        if own.flux.amax() <= 0.0 {
            return Err(LabError::DARK);
        }
        Ok([own, light(&self.twin.scene)?])
    }

    fn task(
        &self,
        [own, twin]: &[Traced; 2],
        index: usize,
        _: Control<'_>,
    ) -> Result<Assumption, LabError> {
        match self.assumed.get(index) {
            Some(assumed) => self.tried(assumed, own),
            None => self.tried(&self.twin, twin),
        }
    }

    fn fits(&self, _: &[Traced; 2], _: usize, part: &Assumption) -> bool {
        part.qualities.len() == self.plan.methods.len() * self.plan.noise.len()
    }

    fn finish(
        &self,
        _: &[Traced; 2],
        mut assumptions: Vec<Assumption>,
    ) -> Result<BrdfStudy, LabError> {
        let lambertian_case = assumptions.remove(self.assumed.len());
        let how = self.tracing()?;
        let relays = self.twin.scene.relays();
        Ok(BrdfStudy {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            estimator: how.estimator.name().to_owned(),
            samples: how.budget.samples(),
            seed: self.plan.seed,
            draws: self.plan.draws,
            relay_albedo: relays
                .map(|(_, wall)| wall.albedo.mean([0.0, 1.0], [0.0, 1.0]))
                .collect(),
            ratios: ratios(&assumptions[0].qualities, &lambertian_case.qualities),
            assumptions,
            lambertian_case,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::study::tests::{divides, small};
    use crate::recovery::Method;

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
        let found = divides(&BrdfTasks::new(&small("satin"), plan).unwrap());
        assert!(found.assumptions.len() > 5);
    }
}
