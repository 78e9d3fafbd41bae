//! Arguments of `phicam calibrate`.

use std::path::PathBuf;

use clap::Args as Arguments;

use super::PhotographsArgs;
use super::value::whole;
use crate::lab::Free;

#[derive(Debug, Arguments)]
pub(in crate::cli) struct CalibrateArgs {
    #[command(flatten)]
    pub photographs: PhotographsArgs,
    /// Folder for the results; DIR/calibrated unless given
    #[arg(long, short, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// What is not known: names of the geometry, e.g. hinge.angle, hidden.normal, hidden.yaw,
    /// spots.shift, spots.each, view.shift, camera.position, occluders.x, NAME.normal, and of how
    /// laser and walls spread light, laser.spot_diameter, wall.roughness, wall.ior, NAME.albedo,
    /// wall.mixture.0.weight; with =SIGMA how well it was measured (degrees, percent, the scene's
    /// unit; percentage points of a mixture's weight, for which its other parts make room in
    /// proportion, so that their sum stays). The scene's [uncertainty] unless given
    #[arg(long, value_name = "NAME[=SIGMA],…", value_delimiter = ',', value_parser = free)]
    pub free: Vec<Free>,
    /// Each frame has an unknown gain too, of this relative standard deviation, up to 1
    #[arg(long, value_name = "SIGMA", value_parser = gain)]
    pub frame_gain: Option<f64>,
    /// The scale of all light is unknown
    #[arg(long)]
    pub free_scale: bool,
    /// Where the noise is not known: take what is left over for noise of single pixels and a field
    /// of errors that neighbours share, and say how much likelier that is
    #[arg(long, conflicts_with = "background")]
    pub error_field: bool,
    /// Starts: the first where the scene has everything, the others at random, 1 to 1000
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub starts: u16,
    /// How far off the other starts are, in standard deviations: those given, or 1°, 1 %, 1 % of
    /// the distance; 1 unless given
    #[arg(long, value_name = "FACTOR", value_parser = spread)]
    pub spread: Option<f64>,
    /// Seed of the starts; 1 unless given
    #[arg(long, value_parser = whole)]
    pub seed: Option<u64>,
}

/// "NAME" or "NAME=SIGMA".
fn free(text: &str) -> Result<Free, String> {
    let (name, sigma) = match text.split_once('=') {
        None => (text, None),
        Some((name, sigma)) => {
            let sigma: Option<f64> = sigma.trim().parse().ok();
            let positive = sigma.filter(|s| *s > 0.0 && s.is_finite());
            let form = "write it as NAME or NAME=SIGMA with SIGMA above 0, e.g. hinge.angle=0.5";
            (name, Some(positive.ok_or(form)?))
        }
    };
    Ok(Free {
        name: name.trim().to_owned(),
        sigma,
    })
}

/// Above 0, up to 1.
fn gain(text: &str) -> Result<f64, String> {
    let sigma: Option<f64> = text.parse().ok();
    sigma
        .filter(|s| *s > 0.0 && *s <= 1.0)
        .ok_or_else(|| "use a number above 0, up to 1, e.g. 0.1".to_owned())
}

/// Above 0 and finite.
fn spread(text: &str) -> Result<f64, String> {
    let factor: Option<f64> = text.parse().ok();
    factor
        .filter(|s| *s > 0.0 && s.is_finite())
        .ok_or_else(|| "use a number above 0, e.g. 1".to_owned())
}
