//! What the re-enacted experiment gives.

use serde::Serialize;

use crate::study::Spread;

/// What one analysis reads from the photographs.
#[derive(Clone, Debug, Serialize)]
pub struct Reading {
    /// Name of the analysis.
    pub analysis: String,
    /// Raw modulation; none where no seed gave one.
    pub mtf: Option<Spread>,
    /// Modulation after the recovered values have been stretched to \[0, 1\], as the published code does.
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
    /// Glare over signal: the flux that glare adds to all photographs over that of the light from the object.
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
    /// One a analysis.
    pub readings: Vec<Reading>,
}

/// Where an analysis stops, or starts, to read the board.
#[derive(Clone, Debug, Serialize)]
pub struct Threshold {
    /// Name of the analysis.
    pub analysis: String,
    /// How the glare is spread.
    pub spread: String,
    /// Largest glare over signal up to which the mean normalized modulation stays at or above [`Experiment::READABLE`]; none where the least
    /// glare of the study is too much.
    pub glare: Option<f64>,
    /// Shortest exposure, s, from which on it stays there with glare as strong as the signal; none where no exposure of the study is enough.
    pub exposure: Option<f64>,
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
    /// Seeds of the sensor's noise.
    pub seeds: u64,
    /// Mean flux a pixel from the object, W.
    pub signal: f64,
    /// Flux that enters the lens straight from the spot over the flux from the object into all pixels, mean over spots: how small the
    /// scattered fraction must be.
    pub direct_over_signal: f64,
    /// Growing glare at the longest exposure.
    pub by_glare: Vec<Setting>,
    /// Growing exposure with glare as strong as the signal.
    pub by_exposure: Vec<Setting>,
    /// Where each analysis reads the board.
    pub thresholds: Vec<Threshold>,
    /// The findings in plain words.
    pub words: String,
}

impl Experiment {
    /// Normalized modulation from which on the board counts as read. The raw one of a method whose W + B may come near zero is no measure: it
    /// grows without bound where nothing is left of the picture.
    pub const READABLE: f64 = 0.5;
}
