//! The list of photographs as written: TOML tables, strict.
//!
//! The doc comment of each field is the documentation of its key. Names of files and patterns are
//! relative to the folder of the list, or to the one that `--from` names.

mod check;

use serde::{Deserialize, Serialize};

use super::error::PhotographError;
use super::lens::Lens;
use super::noise::CameraNoise;
use crate::scene::{exactly, read_toml};

/// A whole list.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Set {
    /// Built-in scene, or scene file beside the list: its spots, pixels and view are the truth of
    /// where light falls. Empty where an argument says it.
    #[serde(default)]
    pub scene: String,
    /// The photographs: a pattern (`*` and `?` in the file's name), ordered by the last number in
    /// the name, which may not skip any; or a list of files in order. Each file is a spot, each
    /// page of a file a photograph.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frames: Option<Files>,
    /// In place of `frames`: a CSV file (or with semicolons or tabs and decimal commas, as
    /// spreadsheets write it) whose first line names its columns, of `file`, `spot` or
    /// `x` and `y`, `exposure`, `gain`, `gain_error`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub list: Option<String>,
    /// In place of `frames`: one table for each photograph.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frame: Vec<FrameTable>,
    /// Photographs of each spot, one after the other (`frames`); default 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeats: Option<u32>,
    /// Photographs without the laser, averaged and subtracted: files, or `[{ files, exposure }, …]`
    /// for several exposure times.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dark: Option<DarkTable>,
    /// Photographs of even radiance, averaged: the others are divided by them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flat: Option<Files>,
    /// Photographs without light of the flat field's exposure time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flat_dark: Option<Files>,
    /// red, green, blue, mean (of all three) or all (one folder each), of photographs in colour.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<ChannelName>,
    /// The variable of a MATLAB file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub variable: Option<String>,
    /// What the indices of an array are, where its shape does not say: frames-rows-columns,
    /// rows-columns-frames, rows-columns-channels, frames-rows-columns-channels or
    /// rows-columns-channels-frames.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axes: Option<Axes>,
    /// Exposure time of every photograph, s; without any fluxes are in counts per photograph.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure: Option<f64>,
    /// light = S·(s/S)^gamma with the full scale S; 1 unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gamma: Option<f64>,
    /// In place of `gamma`: a CSV file of lines `stored value,light`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub response: Option<String>,
    /// Largest value that the camera stores; that of the file's integers unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub full_scale: Option<f64>,
    /// Stored value from which on a pixel is saturated; `full_scale` unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub saturation: Option<f64>,
    /// Dead pixels: `[[column, row], …]` from the upper left one, (0, 0); or a picture that is not
    /// 0 there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dead: Option<DeadTable>,
    /// Radius on the wall about each spot within which pixels are left out, scene's unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub halo: Option<f64>,
    /// Gain and read noise of the camera; from repeated photographs unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<NoiseTable>,
    /// W into the scene's camera for each count per second; without it fluxes are in counts per
    /// second, an arbitrary unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub watts: Option<f64>,
    /// The scene's view in the photograph, without marks: `{ x, y, width, height }`, px from the
    /// upper left corner; the whole photograph unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crop: Option<CropTable>,
    /// Camera matrix and distortion: fx, fy, cx, cy, k1, k2, p1, p2, k3.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<Lens>,
    /// Marked points of the wall, four or more.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub marks: Vec<MarkTable>,
}

/// One or more files.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(untagged, expecting = "a file name, a pattern, or a list of them")]
pub enum Files {
    /// A name or a pattern.
    One(String),
    /// Several, in order.
    Several(Vec<String>),
}

/// Dark frames.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(untagged, expecting = "files, or [{ files, exposure }, …]")]
pub enum DarkTable {
    /// Of the exposure time of all photographs.
    Files(Files),
    /// Of several exposure times.
    Series(Vec<DarkSeries>),
}

/// Dark frames of one exposure time.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct DarkSeries {
    /// The files.
    pub files: Files,
    /// Their exposure time, s.
    pub exposure: f64,
}

/// One photograph.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct FrameTable {
    /// The file; its pages are repeats.
    pub file: String,
    /// The number of its spot in the scene, from 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spot: Option<usize>,
    /// In place of `spot`: where the spot was, x and y on the wall (z may follow, and is the
    /// wall's). The positions of all photographs then replace the scene's spots.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<Vec<f64>>,
    /// Exposure time, s, in place of that of all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure: Option<f64>,
    /// The laser's power or the camera's gain relative to the others: the photograph is divided by
    /// it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain: Option<f64>,
    /// Standard error of `gain`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain_error: Option<f64>,
}

/// A channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ChannelName {
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// The mean of their light.
    Mean,
    /// Each in a folder of its own.
    All,
}

/// What the indices of an array of three or four dimensions are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axes {
    /// Photographs one after the other.
    FramesRowsColumns,
    /// The number of the photograph is the last index, as MATLAB stacks them.
    RowsColumnsFrames,
    /// One photograph in colour.
    RowsColumnsChannels,
    /// Photographs in colour one after the other.
    FramesRowsColumnsChannels,
    /// Photographs in colour, as MATLAB stacks them.
    RowsColumnsChannelsFrames,
}

/// Dead pixels.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(untagged, expecting = "[[column, row], …], or a picture's name")]
pub enum DeadTable {
    /// A picture.
    Picture(String),
    /// Columns and rows.
    Pixels(Vec<[usize; 2]>),
}

/// Gain and read noise.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseTable {
    /// Counts per electron: variance for each count of light.
    pub gain: f64,
    /// Root mean square, counts, with that of the dark current of the shortest exposure time.
    pub read_noise: f64,
}

/// A rectangle of the photograph.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CropTable {
    /// Left border, px.
    pub x: f64,
    /// Upper border, px.
    pub y: f64,
    /// Columns.
    pub width: f64,
    /// Rows.
    pub height: f64,
}

/// A marked point of the wall.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct MarkTable {
    /// Where it is in the photograph: column and row, (0, 0) the centre of the upper left pixel.
    #[serde(deserialize_with = "exactly::one")]
    pub pixel: [f64; 2],
    /// Where it is on the wall: x and y, or x, y and z.
    pub wall: Vec<f64>,
}

impl Set {
    /// Reads the text of a list; `source` names it in errors. It need not be whole: arguments may
    /// take the place of what it says before it is [`Set::checked`].
    ///
    /// # Errors
    /// [`PhotographError`] with line, cause and cure.
    pub fn parse(source: &str, text: &str) -> Result<Self, PhotographError> {
        Ok(read_toml(
            source,
            text,
            "see `phicam import --help`; numbers have no unit: exposure is in s, halo in the scene's unit",
        )?)
    }

    /// The camera's noise, where it is given.
    ///
    /// # Errors
    /// [`PhotographError::Refused`] for one without meaning.
    pub fn camera_noise(&self) -> Result<Option<CameraNoise>, PhotographError> {
        let of = |n: NoiseTable| CameraNoise::new(n.gain, n.read_noise);
        self.noise.map(of).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A list of marks and noise alone is whole once arguments name photographs and scene.
    #[test]
    fn arguments_complete_a_list_before_it_is_checked() {
        let text = "noise = { gain = 0.5, read_noise = 2.0 }\n\
                    [[marks]]\npixel = [1.0, 2.0]\nwall = [3.0, 4.0]\n";
        let mut set = Set::parse("calib.toml", text).unwrap();
        assert!(set.scene.is_empty() && set.marks.len() == 1);
        let error = set.clone().checked().unwrap_err().to_string();
        assert!(error.contains("photographs are not given"), "{error}");
        set.frames = Some(Files::One("a_*.png".into()));
        set.scene = "bench".into();
        assert!(set.checked().is_ok());
        // Names that are no keys are refused at once.
        assert!(Set::parse("calib.toml", "frams = \"a\"\n").is_err());
    }
}
