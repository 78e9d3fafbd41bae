//! How the experiment is re-enacted, and what it gives.

use serde::{Serialize, Serializer};

use crate::lab::ensemble::Spread;
use crate::lab::error::LabError;
use crate::sensor::Sensor;

/// How the experiment is re-enacted.
#[derive(Clone, Debug)]
pub struct ExperimentPlan {
    /// The sensor.
    pub sensor: Sensor,
    /// Its name.
    pub sensor_name: String,
    /// Paths per pixel of the traced light.
    pub samples: u64,
    /// First seed of the tracer and of the sensor.
    pub seed: u64,
    /// Seeds of the sensor's noise and of the traced light.
    pub seeds: u64,
    /// Frames averaged at each spot in the sweep over glare; the sweep over exposures takes one.
    pub frames: u32,
    /// Glare over signal, growing.
    pub glares: Vec<f64>,
    /// Exposure times over the longest one that the sensor bears, growing up to 1.
    pub exposures: Vec<f64>,
    /// Distance on the wall, scene units, at which the falling glare has halved; the even one is
    /// always studied too.
    pub falloff: f64,
}

impl ExperimentPlan {
    /// Whether the lists of levels make sense.
    ///
    /// # Errors
    /// [`LabError::List`].
    pub fn check(&self) -> Result<(), LabError> {
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
                return Err(LabError::List { name, what, range });
            }
        }
        Ok(())
    }
}

/// What one analysis reads from the photographs.
#[derive(Clone, Debug, Serialize)]
pub struct Reading {
    /// Name of the analysis.
    pub analysis: String,
    /// Raw modulation; none where no seed gave one.
    pub mtf: Option<Spread>,
    /// Modulation after the recovered values have been stretched to \[0, 1\], as the published code
    /// does.
    pub mtf_normalized: Option<Spread>,
    /// Pearson correlation with the true albedos.
    pub correlation: Option<Spread>,
    /// Seeds for which the analysis failed.
    pub failed: u64,
    /// Why the last of them did.
    pub reason: Option<String>,
}

/// The photographs of one setting, and what the analyses read from them.
#[derive(Clone, Debug, Serialize)]
pub struct Setting {
    /// How the glare is spread over the image.
    pub spread: String,
    /// Glare over signal: the flux that glare adds to all photographs over that of the light from
    /// the object.
    pub glare: f64,
    /// The fraction of the flux entering the lens from the spot that this takes.
    pub fraction: f64,
    /// Exposure of a frame, s.
    pub exposure: f64,
    /// Electrons a pixel and frame that the object's light makes, on average.
    pub electrons: f64,
    /// Entries of all photographs at saturation.
    pub saturated: usize,
    /// Root mean square of standard error over signal.
    pub noise: f64,
    /// One for each analysis.
    pub readings: Vec<Reading>,
}

/// Where an analysis stops, or starts, to read the board.
#[derive(Clone, Debug, Serialize)]
pub struct Threshold {
    /// Name of the analysis.
    pub analysis: String,
    /// How the glare is spread.
    pub spread: String,
    /// Largest glare over signal up to which the mean normalized modulation stays at or above
    /// [`Experiment::READABLE`] of the picture's own, defined in every draw; none where the least
    /// glare of the study is too much.
    pub glare: Option<f64>,
    /// The neighbouring settings between which it falls below that; none at the end of what was
    /// studied.
    pub glare_between: Option<[f64; 2]>,
    /// Shortest exposure, s, from which on it stays there with glare as strong as the signal; none
    /// where no exposure of the study is enough.
    pub exposure: Option<f64>,
    /// As of the glare.
    pub exposure_between: Option<[f64; 2]>,
}

/// The study of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Experiment {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// The sensor.
    pub sensor: String,
    /// Seeds of the sensor's noise and of the traced light.
    pub seeds: u64,
    /// How often the light was traced, with seeds of its own.
    pub traced: usize,
    /// Mean flux a pixel from the object, W.
    pub signal: f64,
    /// Normalized modulation of the true picture: 1 of a board, whose elements have two values.
    pub own_modulation: f64,
    /// Flux that enters the lens straight from the spot over the flux from the object into all
    /// pixels, mean over spots: how small the scattered fraction must be.
    pub direct_over_signal: f64,
    /// Growing glare at the longest exposure.
    pub by_glare: Vec<Setting>,
    /// Growing exposure with glare as strong as the signal.
    pub by_exposure: Vec<Setting>,
    /// Where each analysis reads the picture.
    pub thresholds: Vec<Threshold>,
    /// The findings in plain words, a paragraph each; one text in the JSON.
    #[serde(serialize_with = "as_one_text")]
    pub words: Vec<String>,
}

impl Experiment {
    /// Normalized modulation, over that of the true picture, from which on this counts as read. The
    /// raw one of a method whose W + B may come near zero is no measure: it grows without bound
    /// where nothing is left of the picture.
    pub const READABLE: f64 = 0.5;

    /// Normalized modulation from which on the picture counts as read.
    pub(super) fn readable(&self) -> f64 {
        Self::READABLE * self.own_modulation
    }
}

impl Reading {
    /// The normalized modulation where each of `seeds` has one: that of a few of them tells nothing
    /// of the others, whose pictures are constant.
    pub(super) fn in_all(&self, seeds: u64) -> Option<Spread> {
        self.mtf_normalized.filter(|m| m.draws as u64 == seeds)
    }

    /// In how many of `seeds` it is defined, if in some alone.
    pub(super) fn in_some(&self, seeds: u64) -> Option<String> {
        let some = self.mtf_normalized.filter(|m| m.draws as u64 != seeds)?;
        Some(format!("{} of {seeds}", some.draws))
    }
}

impl Setting {
    /// Settings parted by the spread of their glare.
    pub(super) fn by_spread(all: &[Self]) -> impl Iterator<Item = &[Self]> {
        all.chunk_by(|a, b| a.spread == b.spread)
    }
}

fn as_one_text<S: Serializer>(paragraphs: &[String], to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(&paragraphs.join(" "))
}
