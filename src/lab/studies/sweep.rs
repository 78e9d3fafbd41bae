//! What does a key of the scene do for the picture?
//!
//! One key takes one value after the other, everything else stays as it is. For each value the
//! matrix model of that scene tells how bright the photographs are, how many directions of the
//! picture are above a noise, and what share of the prior variance is left
//! ([`Grey`](super::grey::Grey)).

mod describe;

use serde::{Deserialize, Serialize};

use super::grey::{Grey, LEVELS};
use super::registered::{Registered, prepared};
use crate::lab::error::LabError;
use crate::lab::options::{Opt, OptionError};
use crate::lab::study::{Sharing, Study};
use crate::lab::uncertainty::noise_law::NoiseLaw;
use crate::model::{Kernel, MatrixModel};
use crate::num::named::Named;
use crate::scene::{Scene, quoted};
use crate::transport::Control;

/// `phicam study sweep`.
pub(super) const STUDY: Registered = Registered {
    name: "sweep",
    about: "What one key of the scene does for the picture, value by value: table, JSON, CSV, figure",
    scene: Some("bench"),
    files: "sweep.csv, sweep.svg",
    options: &[
        Opt::text(
            "key",
            "The key, as in -D, e.g. camera.position.2 or surface.wall.material.lambertian",
        )
        .or("laser.spots.half_width"),
        Opt::text(
            "values",
            "Its values, separated by commas: numbers, with units or without, or words; at least two",
        )
        .list()
        .or("1,1.5,2,2.5,3"),
        Opt::number("noise", "Noise at which the risk is computed, relative to the law's own size")
            .or("0.01")
            .rule(
                |x| x > 0.0 && x <= 1.0,
                "has no meaning here",
                "use a number above 0 and not above 1, e.g. 0.01",
            ),
        Opt::choice("law", "How the noise goes with the light", NoiseLaw::NAMES).or("relative"),
        Opt::whole("elements", "Elements a side, in place of the scene's").within(1, 1024),
    ],
    prepare: |scene, values| {
        let key: String = values.one("key")?;
        let steps: Vec<String> = values.list("values")?;
        if steps.len() < 2 {
            let cause = format!("one value of {key} is no sweep");
            return Err(OptionError::new(cause, "list at least two, as --values 1,2,3").into());
        }
        let with = |value: &String| scene.with(&[(&key, &quoted(value))]);
        let scenes = steps.iter().map(with).collect::<Result<_, _>>()?;
        Ok(prepared(SweepTasks {
            scene: scene.clone(),
            key,
            values: steps,
            scenes,
            noise: values.one("law")?,
            level: values.one("noise")?,
            elements: values.maybe("elements")?.map(|n| [n; 2]),
        }))
    },
};

/// The study of a scene. A task is one value.
#[derive(Debug)]
pub(super) struct SweepTasks {
    scene: Scene,
    key: String,
    values: Vec<String>,
    /// One a value.
    scenes: Vec<Scene>,
    noise: NoiseLaw,
    level: f64,
    elements: Option<[usize; 2]>,
}

/// The scene with one of the values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SweepStep {
    pub value: String,
    /// Hash of the scene with it.
    pub scene_hash: String,
    /// Pixels, spots, and elements of the hidden surfaces.
    pub pixels: usize,
    pub spots: usize,
    pub elements: usize,
    /// Flux of the brightest entry and mean over all, of the scene's own picture, W.
    pub brightest: f64,
    pub mean: f64,
    /// Directions above a noise of 10 %, 1 %, 0.1 %, 0.01 %.
    pub directions: Vec<usize>,
    /// Share of the prior variance that is left.
    pub risk: f64,
}

/// What the key does.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Sweep {
    /// Name of the scene.
    pub scene: String,
    /// Its hash, with the key as it is.
    pub scene_hash: String,
    /// The key.
    pub key: String,
    /// How the noise goes with the light.
    pub law: &'static str,
    /// Noise at which the risk is computed.
    pub noise: f64,
    /// In the order of the values.
    pub steps: Vec<SweepStep>,
}

impl Study for SweepTasks {
    type Context = ();
    type Output = SweepStep;
    type Result = Sweep;
    type Error = LabError;

    fn tasks(&self) -> usize {
        self.values.len()
    }

    fn sharing(&self) -> Sharing {
        Sharing::InTurn
    }

    fn context(&self, _: Control<'_>) -> Result<(), LabError> {
        Ok(())
    }

    fn task(&self, (): &(), index: usize, _: Control<'_>) -> Result<SweepStep, LabError> {
        let scene = &self.scenes[index];
        let model = MatrixModel::new(scene, Kernel::Physical, self.elements)?;
        let phi = model.phi();
        let grey = Grey::new(&model, self.noise);
        Ok(SweepStep {
            value: self.values[index].clone(),
            scene_hash: scene.hash.clone(),
            pixels: phi.nrows(),
            spots: phi.ncols(),
            elements: model.albedo.len(),
            brightest: phi.max(),
            mean: phi.mean(),
            directions: grey.directions()?,
            risk: grey.risk(self.level)?,
        })
    }

    fn fits(&self, (): &(), index: usize, step: &SweepStep) -> bool {
        step.value == self.values[index] && step.directions.len() == LEVELS.len()
    }

    fn finish(&self, (): &(), steps: Vec<SweepStep>) -> Result<Sweep, LabError> {
        Ok(Sweep {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            key: self.key.clone(),
            law: self.noise.name(),
            noise: self.level,
            steps,
        })
    }
}
