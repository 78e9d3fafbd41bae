//! The study in tasks: each a few draws of the noise on one object, or one render.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::best::best;
use super::bound::bounds;
use super::curve::NoiseCurve;
use super::ledger::write_ledger;
use super::picture::Picture;
use super::plan::NoisePlan;
use super::render::{ESTIMATORS, RenderNoise, render_noise};
use super::stage::Stage;
use super::study::NoiseStudy;
use super::trial::{Trial, measure};
use crate::lab::LabError;
use crate::lab::recovered::measures::Measures;
use crate::lab::study::Study;
use crate::model::MatrixModel;
use crate::scene::Scene;
use crate::transport::{Control, Estimator};

/// Draws of a task.
const DRAWS: usize = 4;

/// How much noise each recovery bears: every object, recovered from every draw of the noise at
/// every level.
#[derive(Debug)]
pub struct NoiseTasks {
    scene: Scene,
    plan: NoisePlan,
    renders: Vec<(Estimator, u64)>,
    objects: Vec<(Picture, usize)>,
    draws: Vec<(f64, u64)>,
}

/// What a task gives.
#[derive(Debug, Serialize, Deserialize)]
pub enum Output {
    /// Draw by draw what every method comes to.
    Draws(Vec<Vec<Result<Measures, String>>>),
    /// The noise of a render.
    Render(RenderNoise),
}

/// One object, ready to be photographed.
#[derive(Debug)]
pub struct Object {
    model: MatrixModel,
    stage: Stage,
}

impl NoiseTasks {
    /// The study of a scene, with the noise of renders with these numbers of paths.
    pub fn new(scene: &Scene, plan: NoisePlan, render_samples: Vec<u64>) -> Self {
        let seeds = (0..plan.seeds).map(|k| plan.first_seed.wrapping_add(k));
        let draws = |level: &f64| seeds.clone().map(|seed| (*level, seed)).collect::<Vec<_>>();
        let draws = plan.levels.iter().flat_map(draws).collect();
        let renders = |e: Estimator| render_samples.iter().map(move |n| (e, *n));
        Self {
            scene: scene.clone(),
            renders: ESTIMATORS.into_iter().flat_map(renders).collect(),
            objects: plan.objects(scene),
            draws,
            plan,
        }
    }

    /// Tasks of one object.
    fn groups(&self) -> usize {
        self.draws.len().div_ceil(DRAWS)
    }

    /// The object of a task, by number, and its draws; none for a render.
    fn at(&self, index: usize) -> Option<(usize, &[(f64, u64)])> {
        let object = index / self.groups().max(1);
        let from = index % self.groups().max(1) * DRAWS;
        let draws = &self.draws[from..self.draws.len().min(from + DRAWS)];
        (object < self.objects.len()).then_some((object, draws))
    }

    /// The trials of one draw, from their outcomes method by method.
    fn trials<'a>(
        &'a self,
        object: usize,
        (level, seed): (f64, u64),
        outcomes: Vec<Result<Measures, String>>,
    ) -> impl Iterator<Item = Trial> + 'a {
        let (picture, elements) = self.objects[object];
        let trial = move |(method, outcome): (&_, _)| Trial {
            picture,
            elements,
            method: *method,
            level,
            seed,
            outcome,
        };
        self.plan.methods.iter().zip(outcomes).map(trial)
    }

    /// What every method makes of one draw.
    fn draw(&self, object: &Object, (level, seed): (f64, u64)) -> Vec<Result<Measures, String>> {
        let photographs = object.stage.photograph(level, seed);
        let outcome = |method: &_| match &photographs {
            Ok(photographs) => measure(&object.model, photographs, *method),
            Err(why) => Err(why.clone()),
        };
        self.plan.methods.iter().map(outcome).collect()
    }

    fn render(&self, index: usize, control: Control<'_>) -> Result<RenderNoise, LabError> {
        let (estimator, samples) = self.renders[index - self.objects.len() * self.groups()];
        let how = (estimator, samples, self.plan.first_seed);
        render_noise(&self.scene, &self.plan.axis, how, control)
    }

    /// The study, from sorted trials.
    fn found(
        &self,
        objects: &[Object],
        trials: Vec<Trial>,
        render_noise: Vec<RenderNoise>,
    ) -> NoiseStudy {
        let plan = &self.plan;
        let (mut curves, mut winners) = (Vec::new(), Vec::new());
        for (&object, Object { model, stage }) in self.objects.iter().zip(objects) {
            let bounds = bounds(stage, model, &plan.levels);
            let curve = |m: &_| NoiseCurve::of(plan, object, *m, (&trials, &bounds), &model.albedo);
            curves.extend(plan.methods.iter().map(curve));
            winners.push(best(&plan.axis, object, &curves));
        }
        NoiseStudy {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            kernel: plan.kernel.name().to_owned(),
            axis: plan.axis.clone(),
            seeds: plan.seeds,
            first_seed: plan.first_seed,
            curves,
            best: winners,
            own: NoisePlan::own(&self.scene, &self.objects),
            unplaced: plan.unplaced(),
            render_noise,
            ledger: write_ledger(&self.plan.study(&self.scene), &trials),
        }
    }
}

impl Study for NoiseTasks {
    type Context = Vec<Object>;
    type Output = Output;
    type Result = NoiseStudy;
    type Error = LabError;

    fn tasks(&self) -> usize {
        self.objects.len() * self.groups() + self.renders.len()
    }

    fn keeps(&self) -> bool {
        true
    }

    fn context(&self, _: Control<'_>) -> Result<Vec<Object>, LabError> {
        if self.objects.is_empty() {
            return Err(LabError::NO_OBJECT);
        }
        self.plan.refuse_saturation(&self.scene)?;
        let object = |object: &(Picture, usize)| {
            let model = self.plan.model(&self.scene, *object)?;
            let stage = Stage::new(&self.plan.axis, &self.scene, model.phi())?;
            Ok(Object { model, stage })
        };
        let objects = self.objects.iter().map(object);
        objects.collect()
    }

    fn task(
        &self,
        objects: &Vec<Object>,
        index: usize,
        control: Control<'_>,
    ) -> Result<Output, LabError> {
        let Some((at, draws)) = self.at(index) else {
            return self.render(index, control).map(Output::Render);
        };
        let draws = draws.par_iter();
        let outcomes = draws.map(|draw| self.draw(&objects[at], *draw));
        Ok(Output::Draws(outcomes.collect()))
    }

    fn fits(&self, _: &Vec<Object>, index: usize, part: &Output) -> bool {
        let methods = self.plan.methods.len();
        match (self.at(index), part) {
            (Some((_, draws)), Output::Draws(found)) => {
                found.len() == draws.len() && found.iter().all(|f| f.len() == methods)
            }
            (None, Output::Render(_)) => true,
            _ => false,
        }
    }

    fn finish(&self, objects: &Vec<Object>, parts: Vec<Output>) -> Result<NoiseStudy, LabError> {
        let (mut trials, mut renders) = (Vec::new(), Vec::new());
        for (index, part) in parts.into_iter().enumerate() {
            match (self.at(index), part) {
                (Some((at, draws)), Output::Draws(found)) => {
                    for (draw, outcomes) in draws.iter().zip(found) {
                        trials.extend(self.trials(at, *draw, outcomes));
                    }
                }
                (_, Output::Render(found)) => renders.push(found),
                (None, Output::Draws(_)) => {}
            }
        }
        trials.sort_by(Trial::order);
        Ok(self.found(objects, trials, renders))
    }
}
