//! The study in tasks, and the models that every render is tested against.

use super::results::{Power, PowerPlan};
use super::verdicts::{Models, Verdicts, row, verdicts};
use crate::lab::comparison::derivatives::SceneDerivatives;
use crate::lab::comparison::evidence::Test;
use crate::lab::comparison::unmodelled::unmodelled;
use crate::lab::error::LabError;
use crate::lab::options::Opt;
use crate::lab::problem::lit;
use crate::lab::studies::registered::{Registered, prepared};
use crate::lab::study::{Sharing, Study, Work};
use crate::lab::uncertainty::certainty::Certainty;
use crate::matrix::Matrix;
use crate::model::{Extent, Kernel, MatrixModel, converged};
use crate::num::named::Named;
use crate::num::stream::Sampling;
use crate::scene::Scene;
use crate::transport::{
    Budget, Control, Estimator, Plan, RenderError, SamplesError, render, unsupported_surface,
};

/// `phicam study power`.
pub(in crate::lab) const STUDY: Registered = Registered {
    name: "power",
    about: "How small a model error validate detects, and how often it errs: table and JSON",
    scene: Some("bench"),
    files: "",
    options: &[
        Opt::choice(
            "estimator",
            "Estimators, separated by commas; all unless given",
            Estimator::NAMES,
        )
        .list(),
        Opt::choice("sampler", "Where random numbers come from", Sampling::NAMES).or("sobol"),
        Opt::paths("samples", "Numbers of paths, separated by commas")
            .or("64,256")
            .list(),
        Opt::whole("seeds", "Renders of each kind")
            .or("40")
            .within(1, 100_000),
        Opt::seed("First seed"),
        Opt::significance("0.01"),
    ],
    prepare: |scene, values| {
        let plan = PowerPlan {
            estimators: match values.list("estimator")? {
                all if all.is_empty() => Estimator::ALL.to_vec(),
                some => some,
            },
            sampling: values.one("sampler")?,
            samples: values.list("samples")?,
            seeds: values.one("seeds")?,
            first_seed: values.one("seed")?,
            significance: values.one("significance")?,
        };
        let study = PowerTasks::new(scene, plan);
        for (estimator, samples) in study.kinds() {
            let plan = study.tracing(estimator, samples, 0)?;
            if let Some(surface) = unsupported_surface(scene, &plan) {
                let surface = surface.to_owned();
                return Err(RenderError::UnsupportedSurface { surface }.into());
            }
        }
        Ok(prepared(study))
    },
};

/// Relative size of the scaled wrong model, and of the wrong albedo of one element.
const SCALE: f64 = 1e-3;
const ALBEDO: f64 = 1e-2;

/// Renders each kind with many seeds and tests it against the right model (converged quadrature)
/// and wrong ones. A task is one render with its verdicts.
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
    fn kinds(&self) -> Vec<(Estimator, u64)> {
        let of = |e| self.plan.samples.iter().map(move |n| (e, *n));
        self.plan.estimators.iter().copied().flat_map(of).collect()
    }

    /// How a render is traced.
    fn tracing(&self, estimator: Estimator, samples: u64, seed: u64) -> Result<Plan, SamplesError> {
        let sampling = self.plan.sampling;
        Ok(Plan {
            estimator,
            sampling,
            seed,
            budget: Budget::new(samples, sampling)?,
        })
    }
}

impl Study for PowerTasks {
    type Context = Models;
    type Output = Verdicts;
    type Result = Power;
    type Error = LabError;

    fn work(&self) -> Work {
        let all = |for_all_spots: bool| {
            let kinds = self.kinds().into_iter();
            let own = kinds.filter(|(e, _)| e.serves_all_spots() == for_all_spots);
            own.fold(0, |sum: u64, (_, samples)| {
                sum.saturating_add(samples.saturating_mul(self.plan.seeds))
            })
        };
        Work::samples(&self.scene, all(true), all(false))
    }

    fn tasks(&self) -> usize {
        self.kinds().len() * self.plan.seeds as usize
    }

    /// A render is spread over the threads by itself.
    fn sharing(&self) -> Sharing {
        Sharing::InTurn
    }

    fn context(&self, _: Control<'_>) -> Result<Models, LabError> {
        let integral = lit(&self.scene)?;
        let right = integral.phi;
        let wrong = wrong_models(&self.scene, &right)?.into_iter();
        let sized = |(name, model): (String, Matrix)| {
            let size = (&model - &right).norm() / right.norm();
            (name, size, model)
        };
        let wrong = wrong.map(sized).collect();
        let share = integral.visible.map(|visible| visible.share);
        let off = SceneDerivatives::new(
            &self.scene,
            Kernel::Physical,
            integral.rough,
            &right,
            share.as_ref(),
        );
        let slopes = (0..off.parameters.len()).map(|k| off.of(k)).collect();
        Ok(Models {
            slopes,
            parameters: off.parameters,
            right,
            bound: integral.bound,
            share,
            wrong,
        })
    }

    fn task(
        &self,
        models: &Models,
        index: usize,
        control: Control<'_>,
    ) -> Result<Verdicts, LabError> {
        let seeds = self.plan.seeds as usize;
        let (estimator, samples) = self.kinds()[index / seeds];
        let seed = self.plan.first_seed.wrapping_add((index % seeds) as u64);
        let how = self.tracing(estimator, samples, seed)?;
        let test = Test {
            significance: self.plan.significance,
            known: Certainty::of(&how),
        };
        let spots = 0..self.scene.laser.spots.len();
        let traced = render(&self.scene, &how, spots, control)?;
        verdicts(&self.scene, &traced, models, test)
    }

    fn fits(&self, models: &Models, _: usize, part: &Verdicts) -> bool {
        part.rejected.len() == models.wrong.len()
    }

    fn finish(&self, models: &Models, parts: Vec<Verdicts>) -> Result<Power, LabError> {
        let own = parts.chunks((self.plan.seeds as usize).max(1));
        let row = |((estimator, samples), own): ((Estimator, u64), &[Verdicts])| {
            let paths = self.tracing(estimator, samples, 0)?.budget.samples();
            Ok(row((estimator, paths), own, models, &self.plan))
        };
        let rows = self.kinds().into_iter().zip(own).map(row);
        Ok(Power {
            rows: rows.collect::<Result<_, LabError>>()?,
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            sampler: self.plan.sampling.name().to_owned(),
            significance: self.plan.significance,
            unmodelled: unmodelled(&self.scene),
        })
    }
}

/// Wrong models, each with what is wrong.
fn wrong_models(scene: &Scene, right: &Matrix) -> Result<Vec<(String, Matrix)>, LabError> {
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
    use crate::lab::comparison::seldom::tests::{PATHS, bench, blocks, certainty};
    use crate::lab::study::tests::{divides, refuses, small};
    use crate::lab::{Against, Integration, Measured, validate};
    use crate::model::Occlusion;
    use crate::num::statistics::sidak_threshold;
    use crate::num::stream::Sampling;
    use crate::transport::Traced;

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

    fn models(scene: &Scene) -> Models {
        let plan = PowerPlan {
            estimators: vec![Estimator::Independent],
            sampling: Sampling::Sobol,
            samples: vec![64],
            seeds: 1,
            first_seed: 1,
            significance: 0.01,
        };
        let tasks = PowerTasks::new(scene, plan);
        tasks.context(Control::none()).unwrap()
    }

    fn test(paths: Option<u64>) -> Test {
        Test {
            significance: 0.01,
            known: certainty(paths),
        }
    }

    /// Photographs of a right model past small plates that few paths meet: by the scatter of blocks
    /// alone most of 20 draws are rejected at 1 %, with what such shadows add one at most; and each
    /// verdict, of the right model and of wrong ones, is that of `validate`.
    #[test]
    fn verdicts_are_those_of_validate() {
        let scene = bench(&[[3.6, 4.0, 2.0], [5.2, 6.1, 2.5]]);
        let models = models(&scene);
        let taken = models.share.as_ref().unwrap().map(|left| 1.0 - left);
        let free = converged(&scene, Kernel::Physical, Extent::UNOBSTRUCTED);
        let free = free.unwrap().phi;
        let against = Against {
            kernel: Kernel::Physical,
            integration: Integration::Quadrature,
            occlusion: Occlusion::Considered,
        };
        let mut rejected = [0; 2];
        for seed in 0..20 {
            let [flux, stderr] = blocks(&free, &taken, seed);
            let traced = Traced {
                bounces: Vec::new(),
                tails: flux.map(|_| 0.0),
                flux,
                stderr,
            };
            for (paths, rejected) in [None, Some(PATHS)].into_iter().zip(&mut rejected) {
                let own = verdicts(&scene, &traced, &models, test(paths)).unwrap();
                *rejected += u32::from(!own.agrees);
                let measured = Measured::new(&traced.flux, &traced.stderr, None);
                let found = validate(&scene, measured, against, test(paths)).unwrap();
                let found = found.agreement;
                assert_eq!(
                    (own.agrees, own.chi2_per_dof),
                    (found.agrees, found.chi2_per_dof),
                    "{seed}"
                );
            }
        }
        assert!(rejected[0] >= 15 && rejected[1] <= 1, "{rejected:?}");
    }

    /// Light without noise, with errors ε = 1e-2 of each of n entries: of a scale that is off by s
    /// z = s √n/ε, and it is told from the limit for parameters of the scene, at a sixth of the
    /// level. An entry alone or χ² would tell ten times as much.
    #[test]
    fn a_scale_is_told_by_all_entries_together() {
        let scene = bench(&[]);
        let models = models(&scene);
        let entries = models.right.len() as f64;
        let stderr = &models.right * 1e-2;
        let traced = Traced {
            bounces: Vec::new(),
            tails: stderr.map(|_| 0.0),
            flux: models.right.clone(),
            stderr,
        };
        let own = verdicts(&scene, &traced, &models, test(None)).unwrap();
        let limit = sidak_threshold(0.01 / 6.0, models.parameters.len() as u64);
        let expected = 1e-2 * limit / entries.sqrt();
        let off = own.smallest_scale / expected;
        assert!(own.agrees && (0.95..1.15).contains(&off), "{off}");
    }
}
