//! Arguments of `phicam view` and `phicam scene view`.

use std::path::PathBuf;

use clap::Args as Arguments;

use super::choice::{self, one_of};
use super::value::{count, point, range, size};
use crate::report::{Law, Map};

#[derive(Debug, Arguments)]
#[command(
    after_help = "A picture for people, in ordinary light (an even sky and a soft lamp over the viewer's shoulder), not a measurement: its light has nothing to \
    do with the laser, and it is the one picture with a tone curve (sRGB, whiter than white clipped). Backs of surfaces are hatched: grey relay, blue hidden, \
    purple occluder. Outer walls are clear as glass from behind. Marks: red spots, beams and laser; green view, lines of sight and camera."
)]
pub(in crate::cli) struct PreviewArgs {
    /// Built-in scene or path of a scene file
    pub scene: String,
    /// PNG file to write
    #[arg(long, short)]
    pub output: PathBuf,
    /// Replace the PNG file if it is there
    #[arg(long)]
    pub force: bool,
    /// Where the viewer stands, in the scene's unit; chosen unless given, so that all is in the
    /// picture and much of it seen from its front
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub from: Option<[f64; 3]>,
    /// What is in the middle of the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub to: Option<[f64; 3]>,
    /// What is up
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true, default_value = "0,1,0")]
    pub up: [f64; 3],
    /// Angle between the left and the right edge, degrees
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 40.0,
        allow_negative_numbers = true
    )]
    pub fov: f64,
    /// Columns and rows, 1 to 4096 each
    #[arg(long, value_name = "W,H", value_parser = size, default_value = "960,640")]
    pub size: [usize; 2],
    /// Rays through each pixel, 1 to 65536
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=65536), allow_negative_numbers = true)]
    pub samples: u32,
    /// Draw spots, view, beams and devices, or not
    #[arg(long, value_name = "YES|NO", value_parser = one_of([("yes", true, "Draw them"), ("no", false, "Surfaces alone")]), default_value = "yes", default_missing_value = "yes", num_args = 0..=1, require_equals = true)]
    pub mark: bool,
}

#[derive(Debug, Arguments)]
#[command(
    after_help = "FILE is a frame of phicam (channels flux, flux.stderr, flux.b3, …, counts), any other OpenEXR picture of R, G, B or Y, or a matrix (.npy): \
    pixels × spots, of which --spot N is one photograph, or a recovered reflectance. Rows run upwards as the camera sees them. Numbers are shown as they are: \
    what lies outside the scale has a colour of its own and is counted.\n\n\
    Without -o the picture goes to the terminal, if standard output is one that shows colours (kitty, iTerm2 and WezTerm show it whole, others as half-block \
    characters), and else to FILE.png."
)]
pub(in crate::cli) struct ViewArgs {
    /// Frame, picture or matrix
    pub file: PathBuf,
    /// PNG file to write
    #[arg(long, short)]
    pub output: Option<PathBuf>,
    /// Replace the PNG file if it is there
    #[arg(long)]
    pub force: bool,
    /// Channel of a frame or picture; flux, luminance or the only one unless given
    #[arg(long)]
    pub channel: Option<String>,
    /// Column of a matrix pixels × spots, shown as the camera's photograph
    #[arg(long, value_name = "N", value_parser = count)]
    pub spot: Option<usize>,
    /// Scale from 0 to the largest value over 2^EV
    #[arg(
        long,
        value_name = "EV",
        allow_negative_numbers = true,
        conflicts_with = "range"
    )]
    pub exposure: Option<f64>,
    /// Values of the first and the last colour; the smallest and the largest value unless given
    #[arg(long, value_name = "LOW,HIGH", value_parser = range, allow_hyphen_values = true)]
    pub range: Option<[f64; 2]>,
    /// How colours are spread over values
    #[arg(long, value_parser = choice::law(), default_value = "linear")]
    pub scale: Law,
    /// Colours; viridis unless given, grey for a recovered reflectance
    #[arg(long, value_parser = choice::map())]
    pub map: Option<Map>,
    /// The entries alone: no title, axes, colour bar and legend
    #[arg(long)]
    pub bare: bool,
    /// Show it in the terminal, whatever standard output is; HOW is chosen by the environment
    /// unless given
    #[arg(long, value_name = "HOW", num_args = 0..=1, require_equals = true, default_missing_value = "auto", value_enum, conflicts_with = "output")]
    pub terminal: Option<Terminal>,
}

/// A way to show a picture in a terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(in crate::cli) enum Terminal {
    /// By the environment
    Auto,
    /// kitty graphics protocol
    Kitty,
    /// Inline images of iTerm2
    Iterm,
    /// Half-block characters of 24-bit colours
    Blocks,
}
