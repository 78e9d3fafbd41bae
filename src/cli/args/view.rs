//! Arguments of `phicam scene view`.

use std::path::PathBuf;

use clap::Args as Arguments;

use super::value::{point, size};

#[derive(Debug, Arguments)]
#[command(
    after_help = "A picture for people, in ordinary light (an even sky and a soft lamp over the viewer's shoulder), not a measurement: its light has nothing to \
    do with the laser, and it is the one picture with a tone curve (sRGB, whiter than white clipped). Backs of surfaces are hatched: grey relay, blue hidden, \
    purple occluder. Outer walls are clear as glass from behind. Marks: red spots, beams and laser; green view, lines of sight and camera."
)]
pub(in crate::cli) struct PortraitArgs {
    /// Built-in scene or path of a scene file
    pub scene: String,
    /// PNG file to write
    #[arg(long, short)]
    pub output: PathBuf,
    /// Where the viewer stands, in the scene's unit; chosen unless given, so that all is in the picture and much of it seen from its front
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub from: Option<[f64; 3]>,
    /// What is in the middle of the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub to: Option<[f64; 3]>,
    /// What is up
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true, default_value = "0,1,0")]
    pub up: [f64; 3],
    /// Angle between the left and the right edge, degrees
    #[arg(long, value_name = "DEG", default_value_t = 40.0, allow_negative_numbers = true)]
    pub fov: f64,
    /// Columns and rows, 1 to 4096 each
    #[arg(long, value_name = "W,H", value_parser = size, default_value = "960,640")]
    pub size: [usize; 2],
    /// Rays through each pixel, 1 to 65536
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=65536), allow_negative_numbers = true)]
    pub samples: u32,
    /// Draw spots, view, beams and devices, or not
    #[arg(long, value_name = "YES|NO", default_value = "yes", default_missing_value = "yes", num_args = 0..=1, require_equals = true)]
    pub mark: YesNo,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(in crate::cli) enum YesNo {
    /// Draw them
    Yes,
    /// Surfaces alone
    No,
}
