//! The failed laboratory experiment, re-enacted: traced light, glare of the lens, a real sensor, and every way of reading the photographs.
//!
//! The photographs of a scene are Φ\[p,l\] = Φ_object\[p,l\] + Φ_glare\[p,l\], exposed by a sensor. Φ_object is traced, so no analysis is
//! helped by a model that made its data. The glare is the light that enters the lens straight from the laser spot, scattered over the image
//! ([`crate::sensor::glare`]); its strength is given as glare over signal, Σ Φ_glare/Σ Φ_object.

mod analysis;
mod results;
mod series;
mod words;

use super::Spread;
use super::task::Division;
use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel, ModelError};
use crate::num::stream::Sampling;
use crate::scene::{Scene, Spread as GlareSpread};
use crate::sensor::{Sensor, SensorError, entering_lens};
use crate::transport::{Budget, Control, Estimator, Plan, render};
use analysis::{ANALYSES, Figures, Laboratory};
pub use results::{Experiment, Reading, Setting, Threshold};
use series::{Pattern, Seed, Series};

/// How the experiment is re-enacted.
#[derive(Clone, Debug)]
pub struct ExperimentPlan {
    /// The sensor.
    pub sensor: Sensor,
    /// Its name.
    pub sensor_name: String,
    /// Paths per pixel of the traced light.
    pub samples: u64,
    /// Seed of the tracer, and first one of the sensor.
    pub seed: u64,
    /// Seeds of the sensor's noise.
    pub seeds: u64,
    /// Frames averaged at each spot in the sweep over glare; the sweep over exposures takes one.
    pub frames: u32,
    /// Glare over signal, growing.
    pub glares: Vec<f64>,
    /// Exposure times over the longest one that the sensor bears, growing up to 1.
    pub exposures: Vec<f64>,
    /// Distance on the wall, scene units, at which the falling glare has halved; the even one is always studied too.
    pub falloff: f64,
}

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// The scene has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The sensor cannot take the photographs.
    #[error(transparent)]
    Sensor(#[from] SensorError),
    /// Nothing to be traced with.
    #[error("{0} samples cannot be traced (use 1 to 2³²)")]
    Samples(u64),
    /// No light.
    #[error("no light from the object reaches the camera (see `phicam scene check`)")]
    Dark,
    /// No glare to be had.
    #[error(
        "no light enters the lens straight from any spot, so there is no glare to study (let the camera face the wall where the spots are)"
    )]
    NoGlare,
    /// A list of levels that is empty, does not grow, or leaves its range.
    #[error(
        "the values of {name} ({what}) must be finite and {range}, and grow; list at least one, each once"
    )]
    List {
        /// Its name.
        name: &'static str,
        /// What its values are.
        what: &'static str,
        /// Where they may lie.
        range: &'static str,
    },
}

impl ExperimentPlan {
    /// Whether the lists of levels make sense.
    ///
    /// # Errors
    /// [`ExperimentError::List`].
    pub fn check(&self) -> Result<(), ExperimentError> {
        for (list, fine, name, what, range) in [
            (
                &self.glares,
                (|x| x >= 0.0) as fn(f64) -> bool,
                "--glares",
                "glare over signal",
                "0 or more",
            ),
            (
                &self.exposures,
                |x| x >= f64::MIN_POSITIVE,
                "--exposures",
                "over the longest exposure",
                "above 0",
            ),
        ] {
            let within = list.iter().all(|&x| fine(x) && x.is_finite());
            if list.is_empty() || !within || !list.windows(2).all(|w| w[0] < w[1]) {
                return Err(ExperimentError::List { name, what, range });
            }
        }
        Ok(())
    }
}

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
