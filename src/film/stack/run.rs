//! What the frames of one run have in common, and where two frames differ in it.

use crate::film::{Frame, FrameMeta};

/// What all frames of one run have in common.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunMeta {
    /// Name of the scene.
    pub scene_name: String,
    /// SHA-256 of the scene, hexadecimal.
    pub scene_hash: String,
    /// Length unit of the scene: m, cm, mm or in.
    pub unit: String,
    /// Spots of the run.
    pub spot_count: u32,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Samples, counted as the estimator counts them.
    pub samples: u64,
    /// Name of the estimator.
    pub estimator: String,
    /// Name of the sampler.
    pub sampler: String,
    /// Version of the program.
    pub version: String,
}

impl From<&FrameMeta> for RunMeta {
    fn from(meta: &FrameMeta) -> Self {
        Self {
            scene_name: meta.scene_name.clone(),
            scene_hash: meta.scene_hash.clone(),
            unit: meta.unit.clone(),
            spot_count: meta.spot_count,
            seed: meta.seed,
            samples: meta.samples,
            estimator: meta.estimator.clone(),
            sampler: meta.sampler.clone(),
            version: meta.version.clone(),
        }
    }
}

/// The first property of the run in which `frame` differs from `first`, and its two values.
pub(super) fn difference(frame: &Frame, first: &Frame) -> Option<(&'static str, String, String)> {
    let size = |f: &Frame| format!("{} × {}", f.columns, f.rows);
    let channels = |f: &Frame| {
        let mut names: Vec<&str> = f.channels.iter().map(|c| c.name.as_str()).collect();
        names.sort_unstable();
        names.join(" ")
    };
    let (a, b) = (RunMeta::from(&frame.meta), RunMeta::from(&first.meta));
    let pairs = [
        ("scene hash", a.scene_hash, b.scene_hash),
        ("scene", a.scene_name, b.scene_name),
        ("size", size(frame), size(first)),
        ("channels", channels(frame), channels(first)),
        ("length unit", a.unit, b.unit),
        (
            "number of spots",
            a.spot_count.to_string(),
            b.spot_count.to_string(),
        ),
        ("seed", a.seed.to_string(), b.seed.to_string()),
        ("samples", a.samples.to_string(), b.samples.to_string()),
        ("estimator", a.estimator, b.estimator),
        ("sampler", a.sampler, b.sampler),
        ("version", a.version, b.version),
    ];
    pairs
        .into_iter()
        .find(|(_, found, expected)| found != expected)
}
