//! The study in tasks: each one series of photographs under one seed of the sensor.

use std::sync::OnceLock;

use super::analysis::{ANALYSES, Laboratory};
use super::describe::words;
use super::limits::thresholds;
use super::results::{Experiment, ExperimentPlan, Reading, Setting};
use super::series::{self, Pattern, Seed, Series};
use crate::lab::ensemble::Draws;
use crate::lab::error::LabError;
use crate::lab::options::Opt;
use crate::lab::recovered::measures::Measures;
use crate::lab::studies::noise::NamedSensor;
use crate::lab::studies::registered::{Registered, prepared};
use crate::lab::study::Study;
use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel};
use crate::num::stream::Sampling;
use crate::num::units::photon_energy;
use crate::scene::{Scene, Spread as GlareSpread};
use crate::sensor::entering_lens;
use crate::transport::{Budget, Control, Estimator, Plan, render};

/// `phicam study experiment`.
pub(in crate::lab) const STUDY: Registered = Registered {
    name: "experiment",
    about: "The failed laboratory experiment with a real sensor and glare: findings in words, tables, JSON, CSV, figure",
    scene: Some("experiment"),
    files: "experiment.csv, experiment.svg",
    options: &[
        Opt::text(
            "sensor",
            "Built-in sensor (ideal, ccd, dslr, machine-vision); that of the scene's [sensor] table unless given, or ccd if it has none",
        ),
        Opt::number("glares", "Glare over signal, separated by commas, growing")
            .or("0,0.1,1,3,10")
            .list(),
        Opt::number(
            "exposures",
            "Exposures over the longest that the sensor bears, separated by commas, growing",
        )
        .or("0.0001,0.001,0.003,0.01,0.1,1")
        .list(),
        Opt::falloff("Distance, in the scene's unit, at which the falling glare has halved")
            .or("1"),
        Opt::whole(
            "frames",
            "Frames averaged at each spot in the sweep over glare",
        )
        .or("16")
        .within(1, 100_000),
        Opt::paths("samples", "Paths per pixel of the traced light").or("512"),
        Opt::whole(
            "seeds",
            "Draws of the sensor's noise, each of the first 16 with light traced anew",
        )
        .or("4")
        .within(1, 100_000),
        Opt::seed("First seed of the tracer and of the sensor"),
    ],
    prepare: |scene, values| {
        let NamedSensor { name, sensor, .. } =
            NamedSensor::studied(values.maybe("sensor")?, scene)?;
        let plan = ExperimentPlan {
            sensor,
            sensor_name: name,
            samples: values.one("samples")?,
            seed: values.one("seed")?,
            seeds: values.one("seeds")?,
            frames: values.one("frames")?,
            glares: values.list("glares")?,
            exposures: values.list("exposures")?,
            falloff: values.one("falloff")?,
        };
        plan.check()?;
        Ok(prepared(ExperimentTasks::new(scene, plan)))
    },
};

/// Re-enacts the experiment of a scene. A task is one series of photographs under one seed of the
/// sensor.
#[derive(Debug)]
pub struct ExperimentTasks {
    scene: Scene,
    plan: ExperimentPlan,
}

/// Seeds of the sensor for which light is traced anew; further ones take the same in turn.
const TRACED: u64 = 16;

/// What every series is photographed and read with.
pub struct Context {
    laboratory: Laboratory,
    /// Flux from the object, pixels × spots, W: traced anew for each seed of the sensor, the first
    /// [`TRACED`] of them, when it is first asked for. The settings are those of the first.
    signals: Vec<OnceLock<Matrix>>,
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

    fn series<'a>(&self, context: &'a Context, signal: &Matrix) -> Vec<Series<'a>> {
        series::all(&self.scene, &self.plan, &context.patterns, signal)
    }

    /// The light of the object by the seed of this draw.
    fn traced(&self, draw: u64, control: Control<'_>) -> Result<Matrix, LabError> {
        let (scene, sampling) = (&self.scene, Sampling::Sobol);
        let trace = Plan {
            estimator: Estimator::Shared,
            sampling,
            seed: self.plan.seed.wrapping_add(draw),
            budget: Budget::new(self.plan.samples, sampling)?,
        };
        let signal = render(scene, &trace, 0..scene.laser.spots.len(), control)?.flux;
        if signal.sum() <= 0.0 {
            return Err(LabError::DARK_OBJECT);
        }
        Ok(signal)
    }

    /// The same, traced once.
    fn signal<'a>(
        &self,
        context: &'a Context,
        draw: usize,
        control: Control<'_>,
    ) -> Result<&'a Matrix, LabError> {
        let draw = draw % context.signals.len();
        let own = &context.signals[draw];
        if let Some(signal) = own.get() {
            return Ok(signal);
        }
        let signal = self.traced(draw as u64, control)?;
        Ok(own.get_or_init(|| signal))
    }
}

impl Study for ExperimentTasks {
    type Context = Context;
    type Output = Seed;
    type Result = Experiment;
    type Error = LabError;

    fn tasks(&self) -> usize {
        let levels = self.plan.glares.len() + self.plan.exposures.len();
        2 * levels * self.plan.seeds as usize
    }

    fn context(&self, control: Control<'_>) -> Result<Context, LabError> {
        let Self { scene, plan } = self;
        plan.check()?;
        let laboratory = Laboratory::new(
            MatrixModel::new(scene, Kernel::Physical, None)?,
            MatrixModel::new(scene, Kernel::Published, None)?,
            [scene.camera.columns, scene.camera.rows],
        );
        let signals = vec![OnceLock::from(self.traced(0, control)?)];
        let further = (1..plan.seeds.min(TRACED)).map(|_| OnceLock::new());
        let signals = signals.into_iter().chain(further).collect();
        let direct: f64 = entering_lens(scene).iter().sum();
        if direct <= 0.0 {
            return Err(LabError::NO_GLARE);
        }
        Ok(Context {
            laboratory,
            signals,
            direct,
            patterns: series::patterns(scene, plan),
        })
    }

    fn task(
        &self,
        context: &Context,
        index: usize,
        control: Control<'_>,
    ) -> Result<Seed, LabError> {
        let Self { scene, plan } = self;
        let seeds = plan.seeds as usize;
        let draw = index % seeds;
        let seed = plan.seed.wrapping_add(draw as u64);
        let quiet = Control {
            progress: &|_| (),
            ..control
        };
        let series = &self.series(context, self.signal(context, 0, quiet)?)[index / seeds];
        let signal = self.signal(context, draw, quiet)?;
        series::read(scene, plan, &context.laboratory, series, signal, seed)
    }

    fn fits(&self, _: &Context, _: usize, part: &Seed) -> bool {
        part.measures.len() == ANALYSES.len()
    }

    fn finish(&self, context: &Context, parts: Vec<Seed>) -> Result<Experiment, LabError> {
        let Self { scene, plan } = self;
        let signal = self.signal(context, 0, Control::none())?;
        let series = self.series(context, signal);
        let seeds = parts.chunks((plan.seeds as usize).max(1));
        let settings = series.iter().zip(seeds);
        let mut by_glare: Vec<Setting> = settings
            .map(|(series, seeds)| setting(scene, plan, series, signal, seeds))
            .collect();
        let by_exposure = by_glare.split_off(2 * plan.glares.len());
        let hidden = scene.hidden().map(|(_, s)| format!("`{}`", s.name));
        let mut found = Experiment {
            scene: scene.name.clone(),
            scene_hash: scene.hash.clone(),
            sensor: plan.sensor_name.clone(),
            seeds: plan.seeds,
            traced: context.signals.len(),
            signal: signal.mean(),
            own_modulation: context.laboratory.own_modulation(),
            direct_over_signal: context.direct / signal.sum(),
            thresholds: Vec::new(),
            by_glare,
            by_exposure,
            words: Vec::new(),
        };
        let sweeps = [&found.by_glare[..], &found.by_exposure];
        found.thresholds = thresholds(sweeps, found.own_modulation, plan.seeds);
        found.words = words(&found, &hidden.collect::<Vec<_>>().join(" and "));
        Ok(found)
    }
}

/// What all seeds of a series come to.
fn setting(
    scene: &Scene,
    plan: &ExperimentPlan,
    series: &Series<'_>,
    signal: &Matrix,
    seeds: &[Seed],
) -> Setting {
    let reading = |i: usize| {
        let draws = Draws::of(seeds.iter().map(|s| &s.measures[i]));
        let spread = |f: fn(&Measures) -> Option<f64>| draws.spread(f);
        Reading {
            analysis: ANALYSES[i].name.to_owned(),
            mtf: spread(|m| m.mtf_raw),
            mtf_normalized: spread(|m| m.mtf_normalized),
            correlation: spread(|m| m.correlation),
            failed: draws.failures.len() as u64,
            reason: draws.failures.last().map(|why| (*why).to_owned()),
        }
    };
    let efficiency = plan.sensor.figures().quantum_efficiency;
    let rate = efficiency / photon_energy(scene.laser.wavelength);
    let spread = match series.spread {
        GlareSpread::Uniform => "even",
        GlareSpread::Falloff(_) => "falling",
    };
    Setting {
        spread: spread.to_owned(),
        glare: series.ratio,
        fraction: series.fraction,
        exposure: series.time,
        electrons: rate * signal.mean() * series.time,
        saturated: seeds.iter().map(|s| s.saturated).max().unwrap_or(0),
        noise: seeds.iter().map(|s| s.noise).sum::<f64>() / seeds.len() as f64,
        readings: (0..ANALYSES.len()).map(reading).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::study::tests::{divides, small};
    use crate::scene::SensorModel;
    use crate::sensor::Sensor;

    fn plan() -> ExperimentPlan {
        ExperimentPlan {
            sensor: Sensor::builtin(SensorModel::Ccd),
            sensor_name: "ccd".to_owned(),
            samples: 32,
            seed: 1,
            seeds: 2,
            frames: 2,
            glares: vec![1.0],
            exposures: vec![0.1],
            falloff: 1.0,
        }
    }

    #[test]
    #[ignore = "slow"]
    fn it_divides() {
        let found = divides(&ExperimentTasks::new(&small("experiment"), plan()));
        assert_eq!([found.by_glare.len(), found.by_exposure.len()], [2, 2]);
    }

    /// Each seed reads light of its own: with that of the first it reads something else.
    #[test]
    fn light_is_traced_anew_for_each_seed() {
        let tasks = ExperimentTasks::new(&small("experiment"), plan());
        let mut context = tasks.context(Control::none()).unwrap();
        let read = |context: &Context| {
            let seed = tasks.task(context, 1, Control::none()).unwrap();
            serde_json::to_string(&seed).unwrap()
        };
        let own = read(&context);
        assert_eq!(context.signals.len(), 2);
        context.signals[1] = context.signals[0].clone();
        assert_ne!(own, read(&context));
    }
}
