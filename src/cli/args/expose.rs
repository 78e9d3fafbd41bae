//! Arguments of `phicam expose`.

use std::path::PathBuf;

use clap::{Args as Arguments, ValueEnum};
use serde::Serialize;

use super::value::{seconds, small, whole};

#[derive(Debug, Arguments)]
pub(in crate::cli) struct ExposeArgs {
    /// Folder of a finished run
    #[arg(required_unless_present = "list")]
    pub dir: Option<PathBuf>,
    /// Folder to write to; DIR/exposed unless given
    #[arg(long, short)]
    pub output: Option<PathBuf>,
    /// Built-in sensor in place of the scene's figures: ideal, ccd, dslr, machine-vision
    #[arg(long, value_name = "NAME")]
    pub sensor: Option<String>,
    /// Exposure time of a frame, s, or with its unit: 100ms
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = seconds)]
    pub exposure: Option<f64>,
    /// Frames averaged
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = small)]
    pub frames: Option<u32>,
    /// Frames without laser, averaged and subtracted
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = small)]
    pub dark_frames: Option<u32>,
    /// Exposure times of a series, separated by commas, s
    #[arg(
        long,
        value_name = "S,…",
        value_delimiter = ',',
        value_parser = seconds,
        conflicts_with = "exposure",
        allow_negative_numbers = true
    )]
    pub brackets: Vec<f64>,
    /// Multiply each finished entry by 1 + NOISE·N(0, 1)
    #[arg(long, value_name = "NOISE", allow_negative_numbers = true)]
    pub noise: Option<f64>,
    /// Part of the spot's light entering the lens that is scattered, evenly unless the scene says
    /// otherwise
    #[arg(long, value_name = "FRACTION", allow_negative_numbers = true)]
    pub glare: Option<f64>,
    /// Ambient light, W into each pixel
    #[arg(long, value_name = "W", allow_negative_numbers = true)]
    pub ambient: Option<f64>,
    /// Seed: the same seed gives the same bytes
    #[arg(long, default_value_t = 1, allow_negative_numbers = true, value_parser = whole)]
    pub seed: u64,
    /// Where phi.stderr.npy comes from; the render's own standard error is added to both
    #[arg(long, value_enum, default_value_t = StatedBy::Counts)]
    pub stderr: StatedBy,
    /// Refuse photographs with saturated or cut-off entries, or such that are near to either
    #[arg(long)]
    pub strict: bool,
    /// Replace photographs with other settings, once these are whole
    #[arg(long)]
    pub replace: bool,
    /// Print exposure.json instead of the table
    #[arg(long)]
    pub json: bool,
    /// List the built-in sensors, and do nothing else
    #[arg(long)]
    pub list: bool,
}

/// Where the standard deviation of a photograph comes from.
#[derive(Clone, Copy, Debug, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub(in crate::cli) enum StatedBy {
    /// The counts of a metering frame and of dark frames, and pairs of frames that calibrate the
    /// sensor: what a laboratory has
    Counts,
    /// The sensor's law at the true flux, which no laboratory knows
    Oracle,
}
