//! The study in tasks: each one series of photographs under one seed of the sensor.

use super::analysis::{ANALYSES, Figures, Laboratory};
use super::series::{self, Pattern, Seed, Series};
use super::{Experiment, ExperimentError, ExperimentPlan, Reading, Setting, words};
use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel};
use crate::num::stream::Sampling;
use crate::scene::{Scene, Spread as GlareSpread};
use crate::sensor::entering_lens;
use crate::study::Spread;
use crate::study::task::Division;
use crate::transport::{Budget, Control, Estimator, Plan, render};

/// Re-enacts the experiment of a scene. A task is one series of photographs under one seed of the sensor.
#[derive(Debug)]
pub struct ExperimentTasks {
    scene: Scene,
    plan: ExperimentPlan,
}

/// What every series is photographed and read with.
pub struct Ground {
    laboratory: Laboratory,
    /// Flux from the object, pixels × spots, W.
    signal: Matrix,
    /// Flux that enters the lens straight from the spots, W, over all of them.
    direct: f64,
    patterns: [Pattern; 2],
}

impl ExperimentTasks {
    /// The study of a scene.
    pub fn new(scene: &Scene, plan: ExperimentPlan) -> Self {
        let scene = scene.clone();
        Self { scene, plan }
    }

    fn series<'a>(&self, ground: &'a Ground) -> Vec<Series<'a>> {
        series::all(&self.scene, &self.plan, &ground.patterns, &ground.signal)
    }
}

impl Division for ExperimentTasks {
    type Ground = Ground;
    type Part = Seed;
    type Finding = Experiment;
    type Error = ExperimentError;

    fn tasks(&self) -> usize {
        let levels = self.plan.glares.len() + self.plan.exposures.len();
        2 * levels * self.plan.seeds as usize
    }

    fn ground(&self, control: Control<'_>) -> Result<Option<Ground>, ExperimentError> {
        let Self { scene, plan } = self;
        plan.check()?;
        let sampling = Sampling::Sobol;
        let laboratory = Laboratory::new(
            MatrixModel::new(scene, Kernel::Physical, None)?,
            MatrixModel::new(scene, Kernel::Published, None)?,
            [scene.camera.columns, scene.camera.rows],
        );
        let trace = Plan {
            estimator: Estimator::Shared,
            sampling,
            seed: plan.seed,
            budget: Budget::new(plan.samples, sampling)
                .ok_or(ExperimentError::Samples(plan.samples))?,
        };
        let Some(traced) = render(scene, &trace, 0..scene.laser.spots.len(), control) else {
            return Ok(None);
        };
        let signal = traced.flux;
        if signal.sum() <= 0.0 {
            return Err(ExperimentError::Dark);
        }
        let direct: f64 = entering_lens(scene).iter().sum();
        if direct <= 0.0 {
            return Err(ExperimentError::NoGlare);
        }
        Ok(Some(Ground {
            laboratory,
            signal,
            direct,
            patterns: series::patterns(scene, plan),
        }))
    }

    fn task(
        &self,
        ground: &Ground,
        index: usize,
        _: Control<'_>,
    ) -> Result<Option<Seed>, ExperimentError> {
        let Self { scene, plan } = self;
        let seeds = plan.seeds as usize;
        let (own, seed) = (
            index / seeds,
            plan.seed.wrapping_add((index % seeds) as u64),
        );
        let of = |series: &Series<'_>| {
            let Ground {
                laboratory, signal, ..
            } = ground;
            series::read(scene, plan, laboratory, series, signal, seed)
        };
        self.series(ground).get(own).map(of).transpose()
    }

    fn fits(&self, _: &Ground, _: usize, part: &Seed) -> bool {
        part.figures.len() == ANALYSES.len()
    }

    fn finish(&self, ground: &Ground, parts: Vec<Seed>) -> Result<Experiment, ExperimentError> {
        let Self { scene, plan } = self;
        let signal = &ground.signal;
        let work = self.series(ground);
        let own = parts.chunks((plan.seeds as usize).max(1));
        let mut settings: Vec<Setting> = work
            .iter()
            .zip(own)
            .map(|(w, seeds)| setting(scene, w, signal, seeds, plan))
            .collect();
        let by_exposure = settings.split_off(2 * plan.glares.len());
        let thresholds = words::thresholds(&settings, &by_exposure);
        let mut found = Experiment {
            scene: scene.name.clone(),
            scene_hash: scene.hash.clone(),
            sensor: plan.sensor_name.clone(),
            seeds: plan.seeds,
            signal: signal.mean(),
            direct_over_signal: ground.direct / signal.sum(),
            by_glare: settings,
            by_exposure,
            thresholds,
            words: String::new(),
        };
        found.words = words::words(&found, &object(scene));
        Ok(found)
    }
}

/// The object in words.
fn object(scene: &Scene) -> String {
    let names: Vec<String> = scene
        .hidden()
        .map(|(_, s)| format!("`{}`", s.name))
        .collect();
    names.join(" and ")
}

fn setting(
    scene: &Scene,
    work: &Series<'_>,
    signal: &Matrix,
    seeds: &[Seed],
    plan: &ExperimentPlan,
) -> Setting {
    let readings = ANALYSES
        .iter()
        .enumerate()
        .map(|(i, analysis)| {
            let of = |f: fn(&Figures) -> Option<f64>| {
                let values: Vec<f64> = seeds
                    .iter()
                    .filter_map(|s| f(s.figures[i].as_ref().ok()?))
                    .collect();
                Spread::of(&values)
            };
            let reasons = || seeds.iter().filter_map(|s| s.figures[i].as_ref().err());
            Reading {
                analysis: analysis.name.to_owned(),
                mtf: of(|f| f.mtf),
                mtf_normalized: of(|f| f.mtf_normalized),
                correlation: of(|f| f.correlation),
                failed: reasons().count() as u64,
                reason: reasons().next_back().cloned(),
            }
        })
        .collect();
    let rate = plan.sensor.figures().quantum_efficiency
        / crate::num::units::photon_energy(scene.laser.wavelength);
    Setting {
        spread: match work.spread {
            GlareSpread::Uniform => "even".to_owned(),
            GlareSpread::Falloff(_) => "falling".to_owned(),
        },
        glare: work.ratio,
        fraction: work.fraction,
        exposure: work.time,
        electrons: rate * signal.mean() * work.time,
        saturated: seeds.iter().map(|s| s.saturated).max().unwrap_or(0),
        noise: seeds.iter().map(|s| s.noise).sum::<f64>() / seeds.len() as f64,
        readings,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SensorModel;
    use crate::sensor::Sensor;
    use crate::study::task::tests::{divides, small};

    #[test]
    fn it_divides() {
        let plan = ExperimentPlan {
            sensor: Sensor::builtin(SensorModel::Ccd),
            sensor_name: "ccd".to_owned(),
            samples: 32,
            seed: 1,
            seeds: 2,
            frames: 2,
            glares: vec![1.0],
            exposures: vec![0.1],
            falloff: 1.0,
        };
        let found = divides(&ExperimentTasks::new(&small("experiment"), plan));
        assert_eq!([found.by_glare.len(), found.by_exposure.len()], [2, 2]);
    }
}
