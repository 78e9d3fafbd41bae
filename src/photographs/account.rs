//! What was imported, and how it came about.

use serde::Serialize;

use super::left_out::LeftOut;
use super::mapping::Mapping;
use super::noise::{CameraNoise, PhotonTransferFit};
use super::read::SourceFile;
use super::set::{ChannelName, Set};
use crate::matrix::Matrix;

/// What was imported.
#[derive(Clone, Debug)]
pub struct Imported {
    /// Φcam, pixels × spots; W, or counts per second where no factor is known. 0 where an entry is
    /// left out.
    pub phi: Matrix,
    /// Its standard error; none where the noise is not known. 0 where an entry is left out.
    pub stderr: Option<Matrix>,
    /// 0 where an entry counts, else the codes of the reasons.
    pub left_out: Matrix,
    /// The mean of all photographs, row by row from the top, columns and rows.
    pub mean: (Vec<f64>, [usize; 2]),
    /// From the wall to the photograph.
    pub mapping: Mapping,
    /// How it came about.
    pub account: ImportAccount,
}

/// How an import came about.
#[derive(Clone, Debug, Serialize)]
pub struct ImportAccount {
    /// The scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// All settings.
    pub set: Set,
    /// The channel of photographs in colour.
    pub channel: Option<ChannelName>,
    /// W, counts/s or counts.
    pub unit: &'static str,
    /// Columns and rows of the photographs.
    pub photograph: [usize; 2],
    /// Photographs in all.
    pub photographs: usize,
    /// Gain and read noise, in counts, where they are known.
    pub noise: Option<CameraNoise>,
    /// The line that they were found by.
    pub photon_transfer: Option<PhotonTransferFit>,
    /// Distance of each mark from where the mapping has it, px.
    pub mark_residuals: Vec<f64>,
    /// Their root mean square, px.
    pub mark_rms: Option<f64>,
    /// Error of a mark along each axis that explains them, px.
    pub mark_error: Option<f64>,
    /// The gain of each spot that has one other than 1, with its standard error, which all pixels
    /// of the photograph share: the standard errors of Φ leave it out.
    pub gains: Vec<(usize, f64, f64)>,
    /// Variance of the entries' variances over their squares, by the line that the noise was found
    /// by, mean over the entries: all are off alike. Infinite where it tells none of some entry.
    pub unknown: f64,
    /// Part of the variance that is that of the dark frames, which all spots of a pixel share, mean
    /// over the entries.
    pub common: f64,
    /// The same of the flat field, a factor of each pixel that all spots share.
    pub of_flat: f64,
    /// Entries that are left out.
    pub left_out: LeftOut,
    /// What a user has to know.
    pub warnings: Vec<String>,
    /// What was read.
    pub files: Vec<SourceFile>,
}

impl ImportAccount {
    /// The largest relative error of a gain; none where all are exact.
    pub fn frame_gain(&self) -> Option<f64> {
        let each = self.gains.iter().map(|(_, gain, error)| error / gain);
        Some(each.fold(0.0, f64::max)).filter(|most| *most > 0.0)
    }
}
