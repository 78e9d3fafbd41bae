//! Arguments of `phicam import`.

use std::path::PathBuf;

use clap::Args as Arguments;

use super::choice;
use super::value::{seconds, small};
use crate::photographs::set::ChannelName;

#[derive(Debug, Arguments)]
#[command(
    after_help = "The list is TOML. Its keys: scene; frames (pattern or list), list (CSV: file, spot or x,y, exposure, gain, gain_error) or [[frame]] tables; repeats, dark, flat, \
                  flat_dark, channel, variable, axes, exposure, gamma or response, full_scale, saturation, dead, halo, noise = { gain, read_noise } (counts per electron, counts; `gain` of a scene's [sensor] is electrons per count, its inverse), watts, \
                  crop = { x, y, width, height }, [camera] (fx, fy, cx, cy, k1, k2, p1, p2, k3) and [[marks]] (pixel, wall).\n\
                  DIR then has phi.npy, phi.stderr.npy where the noise is known, left_out.npy (1 saturated, 2 dead, 4 halo of the spot, 8 outside the photograph, \
                  16 no photograph, added up; 0 where an entry counts), import.json and import.png."
)]
pub(in crate::cli) struct ImportArgs {
    /// List of the photographs and of what is known of them (TOML)
    #[arg(required_unless_present = "frames")]
    pub set: Option<PathBuf>,
    /// Folder to write to; with --channel all its folders red, green and blue
    #[arg(long, short, value_name = "DIR")]
    pub output: PathBuf,
    /// Folder of the photographs; that of the list unless given
    #[arg(long, value_name = "FOLDER")]
    pub from: Option<PathBuf>,
    /// Photographs, by a pattern like 'captures/input_*.png', in the order of the last number in
    /// their names
    #[arg(long, value_name = "PATTERN")]
    pub frames: Option<String>,
    /// Built-in scene or path of a scene file, in place of the list's
    #[arg(long, value_name = "SCENE")]
    pub scene: Option<String>,
    /// Photographs of each spot, one after the other
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = small)]
    pub repeats: Option<u32>,
    /// Photographs without the laser
    #[arg(long, value_name = "PATTERN")]
    pub dark: Option<String>,
    /// Photographs of even radiance
    #[arg(long, value_name = "PATTERN")]
    pub flat: Option<String>,
    /// Channel of photographs in colour: red, green, blue, mean, or all
    #[arg(long, value_parser = choice::channel())]
    pub channel: Option<ChannelName>,
    /// light = S·(stored/S)^GAMMA with the full scale S; 1 unless given
    #[arg(long, value_name = "GAMMA", allow_negative_numbers = true)]
    pub gamma: Option<f64>,
    /// Exposure time of every photograph, s, or with its unit: 100ms
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = seconds)]
    pub exposure: Option<f64>,
    /// Radius about each spot within which pixels are left out, scene's unit
    #[arg(long, value_name = "RADIUS", allow_negative_numbers = true)]
    pub halo: Option<f64>,
    /// Replace photographs that were imported with other settings
    #[arg(long)]
    pub replace: bool,
    /// Print import.json
    #[arg(long)]
    pub json: bool,
}
