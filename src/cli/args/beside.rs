//! What photographs hold beside the light of the hidden surface.

use std::path::PathBuf;

use clap::Args as Arguments;

/// Terms that are estimated with what is asked for.
#[derive(Clone, Debug, Arguments)]
pub(in crate::cli) struct BesideArgs {
    /// Other light: a constant in each frame
    #[arg(long)]
    pub frame_constant: bool,
    /// Other light: a polynomial of this degree over each frame, 0 (a constant) to 8
    #[arg(
        long,
        value_name = "DEGREE",
        value_parser = clap::value_parser!(u8).range(0..=8),
        conflicts_with = "frame_constant"
    )]
    pub frame_polynomial: Option<u8>,
    /// Other light: these patterns, each with a strength of its own in each frame: pixels ×
    /// patterns
    #[arg(long, value_name = "FILE")]
    pub frame_patterns: Option<PathBuf>,
    /// Other light: an image that is the same in all frames
    #[arg(long)]
    pub background: bool,
    /// Other light: this pattern in each frame, of unknown strength, as glare of the spot: pixels ×
    /// spots
    #[arg(long, value_name = "FILE")]
    pub glare_pattern: Option<PathBuf>,
    /// The scale of all photographs is unknown, as of counts: a recovered picture has its brightest
    /// element as unit, and a verdict does not see a factor of all light
    #[arg(long)]
    pub free_scale: bool,
    /// Each frame has a factor of its own, 1 within this standard deviation (0 to 1): a laser whose
    /// power drifts
    #[arg(long, value_name = "DEVIATION", allow_negative_numbers = true)]
    pub frame_gain: Option<f64>,
    /// The scale of all photographs is known to this relative standard deviation alone (0 to 1):
    /// the error of a calibration
    #[arg(
        long,
        value_name = "DEVIATION",
        allow_negative_numbers = true,
        conflicts_with = "free_scale"
    )]
    pub scale_error: Option<f64>,
}
