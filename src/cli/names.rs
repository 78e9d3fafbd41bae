//! The names of the files in the folder of a run.

use crate::film::frame_name;
use crate::recovery::Method;

pub(super) const PHI: &str = "phi.npy";
pub(super) const STDERR: &str = "phi.stderr.npy";
/// Entries whose standard error is not to be trusted: 0 where it is, f64, pixels × spots.
pub(super) const TAILS: &str = "phi.tails.npy";
/// Why entries of imported photographs are left out: 0 where they count, f64, pixels × spots.
pub(super) const LEFT_OUT: &str = "left_out.npy";
/// How photographs were imported, and the mean of them with what was found in it.
pub(super) const IMPORT: &str = "import.json";
pub(super) const IMPORT_PNG: &str = "import.png";
pub(super) const SUMMARY: &str = "summary.json";
pub(super) const REPORT: &str = "report.html";
pub(super) const SCENE: &str = "scene.toml";
/// The analytic side.
pub(super) const MODEL: &str = "model";
/// Deviations of traced from modelled entries, in [`MODEL`].
pub(super) const Z: &str = "z.npy";
/// What is in [`MODEL`].
pub(super) const MODEL_FILES: [&str; 6] = [
    "g12.npy",
    "g23.npy",
    "laser_side.npy",
    "camera_side.npy",
    "phi.npy",
    Z,
];
/// The map of `phicam validate`.
pub(super) const VALIDATION: &str = "validation";
/// Where the hidden surface is.
pub(super) const LOCATED: &str = "located";
/// What is in [`LOCATED`].
pub(super) const LOCATED_FILES: [&str; 4] =
    ["locate.json", "locate.csv", "locate.svg", "report.html"];
/// The calibrated geometry.
pub(super) const CALIBRATED: &str = "calibrated";
/// What is in [`CALIBRATED`].
pub(super) const CALIBRATED_FILES: [&str; 7] = [
    "calibration.json",
    "calibration.csv",
    "identifiability.csv",
    "stages.csv",
    "profiles.svg",
    "report.html",
    "scene.toml",
];
/// Recovered reflectances.
pub(super) const RECOVERED: &str = "recovered";
/// Photographs of `phicam expose`: [`PHI`], [`STDERR`] and these.
pub(super) const EXPOSED: &str = "exposed";
pub(super) const EXPOSURE: &str = "exposure.json";
pub(super) const SATURATED: &str = "saturated.npy";
pub(super) const COUNTS: &str = "counts";

/// Whether `name` is that of the frame of one of `spots` spots.
pub(super) fn is_frame(name: &str, spots: usize) -> bool {
    let number = name.strip_prefix("spot-").and_then(|n| n.split_once('.'));
    let number = number.and_then(|(n, _)| n.parse::<u32>().ok());
    number.is_some_and(|n| (n as usize) < spots && frame_name(n) == name)
}

/// Whether `name` is that of a file of [`MODEL`].
pub(super) fn is_of_model(name: &str) -> bool {
    MODEL_FILES.contains(&name)
}

/// Whether `name` is that of a file of [`RECOVERED`]: METHOD.npy, METHOD-0.png, METHOD.stderr.npy,
/// picard.csv, …, or one of the truth.
pub(super) fn is_of_recovered(name: &str) -> bool {
    let Some((stem, ext)) = name.rsplit_once('.') else {
        return false;
    };
    let (name, what) = stem.split_once('.').unwrap_or((stem, ""));
    let name = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let name = name.strip_suffix('-').unwrap_or(name);
    let pictures = ["truth", "overview", "picard", "picard-joint", "determined"];
    let known = pictures.contains(&name) || name.parse::<Method>().is_ok();
    let whats = [
        "",
        "stderr",
        "light",
        "covariance",
        "resolution",
        "bias",
        "lower",
        "upper",
        "texture",
        "choice",
        "frame_constant",
        "frame_patterns",
        "background",
        "glare",
    ];
    let exts = ["npy", "png", "csv", "svg", "ply", "json"];
    known && whats.contains(&what) && exts.contains(&ext)
}
