//! The names of the files in the folder of a run.

use crate::film::frame_name;
use crate::recovery::Method;

/// The frames, one a spot.
pub const FRAMES: &str = "frames";
/// Φcam, pixels × spots, W.
pub const PHI: &str = "phi.npy";
/// Its standard error.
pub const STDERR: &str = "phi.stderr.npy";
/// Entries whose standard error is not to be trusted: 0 where it is, f64, pixels × spots.
pub const TAILS: &str = "phi.tails.npy";
/// Why entries of imported photographs are left out: 0 where they count, f64, pixels × spots.
pub const LEFT_OUT: &str = "left_out.npy";
/// How photographs were imported.
pub const IMPORT: &str = "import.json";
/// The mean of them, with what was found in it.
pub const IMPORT_PNG: &str = "import.png";
/// The results of `phicam run`.
pub const SUMMARY: &str = "summary.json";
/// Its page.
pub const REPORT: &str = "report.html";
/// The scene.
pub const SCENE: &str = "scene.toml";
/// The analytic side.
pub const MODEL: &str = "model";
/// Deviations of traced from modelled entries, in [`MODEL`].
pub const Z: &str = "z.npy";
/// What is in [`MODEL`].
pub const MODEL_FILES: [&str; 6] = [
    "g12.npy",
    "g23.npy",
    "laser_side.npy",
    "camera_side.npy",
    "phi.npy",
    Z,
];
/// The map of `phicam validate`.
pub const VALIDATION: &str = "validation";
/// Where the hidden surface is.
pub const LOCATED: &str = "located";
/// What is in [`LOCATED`].
pub const LOCATED_FILES: [&str; 4] = ["locate.json", "locate.csv", "locate.svg", "report.html"];
/// The calibrated geometry.
pub const CALIBRATED: &str = "calibrated";
/// The account of it.
pub const CALIBRATION: &str = "calibration.json";
/// What is in [`CALIBRATED`].
pub const CALIBRATED_FILES: [&str; 7] = [
    CALIBRATION,
    "calibration.csv",
    "identifiability.csv",
    "stages.csv",
    "profiles.svg",
    "report.html",
    "scene.toml",
];
/// Recovered reflectances.
pub const RECOVERED: &str = "recovered";
/// Photographs of `phicam expose`: [`PHI`], [`STDERR`] and these.
pub const EXPOSED: &str = "exposed";
/// How they were taken.
pub const EXPOSURE: &str = "exposure.json";
/// Which entries are saturated or cut off.
pub const SATURATED: &str = "saturated.npy";
/// Folder of what the converter gave.
pub const COUNTS: &str = "counts";

/// Whether `name` is that of the frame of one of `spots` spots.
pub fn is_frame(name: &str, spots: usize) -> bool {
    let number = name.strip_prefix("spot-").and_then(|n| n.split_once('.'));
    let number = number.and_then(|(n, _)| n.parse::<u32>().ok());
    number.is_some_and(|n| (n as usize) < spots && frame_name(n) == name)
}

/// Whether `name` is that of a file of [`MODEL`].
pub fn is_of_model(name: &str) -> bool {
    MODEL_FILES.contains(&name)
}

/// What is known of the uncertainty of a method's picture: `stderr` of METHOD.stderr.npy, ….
pub const UNCERTAINTIES: [&str; 9] = [
    "stderr",
    "light",
    "alike",
    "alike.stderr",
    "bias",
    "lower",
    "upper",
    "covariance",
    "resolution",
];
/// What a method estimated beside the picture, likewise.
pub const ESTIMATED: [&str; 5] = [
    "frame_constant",
    "frame_patterns",
    "background",
    "glare",
    "frame_gain",
];

/// Whether `name` is that of a file of [`RECOVERED`]: METHOD.npy, METHOD-0.png, METHOD.stderr.npy,
/// picard.csv, …, or one of the truth.
pub fn is_of_recovered(name: &str) -> bool {
    let Some((stem, ext)) = name.rsplit_once('.') else {
        return false;
    };
    let (name, what) = stem.split_once('.').unwrap_or((stem, ""));
    let name = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let name = name.strip_suffix('-').unwrap_or(name);
    let pictures = ["truth", "overview", "picard", "picard-joint", "determined"];
    let known = pictures.contains(&name) || name.parse::<Method>().is_ok();
    let of_picture = ["", "texture", "choice"].contains(&what);
    let known_beside = UNCERTAINTIES.contains(&what) || ESTIMATED.contains(&what);
    let exts = ["npy", "png", "csv", "svg", "ply", "json"];
    known && (of_picture || known_beside) && exts.contains(&ext)
}
