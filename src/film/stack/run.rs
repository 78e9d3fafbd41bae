//! Where two frames are not of one run.

use crate::film::Frame;

/// The first property of the run in which `frame` differs from `first`, and its two values.
pub(super) fn difference(frame: &Frame, first: &Frame) -> Option<(&'static str, String, String)> {
    let pairs = properties(frame).into_iter().zip(properties(first));
    pairs
        .map(|((name, found), (_, expected))| (name, found, expected))
        .find(|(_, found, expected)| found != expected)
}

fn properties(frame: &Frame) -> [(&'static str, String); 11] {
    let run = &frame.meta.run;
    let mut channels: Vec<&str> = frame.channels.iter().map(|c| c.name.as_str()).collect();
    channels.sort_unstable();
    [
        ("scene hash", run.scene_hash.clone()),
        ("scene", run.scene_name.clone()),
        ("size", format!("{} × {}", frame.columns, frame.rows)),
        ("channels", channels.join(" ")),
        ("length unit", run.unit.clone()),
        ("number of spots", run.spot_count.to_string()),
        ("seed", run.seed.to_string()),
        ("samples", run.samples.to_string()),
        ("estimator", run.estimator.clone()),
        ("sampler", run.sampler.clone()),
        ("version", run.version.clone()),
    ]
}
