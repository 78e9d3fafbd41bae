//! Arguments of what takes photographs whose reflectances are unknown.

use std::path::PathBuf;

use clap::Args as Arguments;

use super::value::{count, elements};
use super::{OcclusionArgs, choice};
use crate::lab::Integration;

#[derive(Debug, Arguments)]
pub(in crate::cli) struct PhotographsArgs {
    /// Folder of a run or of an import; with --phi a folder with a scene.toml is enough
    pub dir: PathBuf,
    /// Φcam, pixels × spots, in place of DIR/phi.npy: photographs of which DIR/scene.toml is only
    /// thought to be the geometry
    #[arg(long, value_name = "FILE")]
    pub phi: Option<PathBuf>,
    /// Its standard errors; without them its noise is unknown
    #[arg(long, value_name = "FILE", requires = "phi")]
    pub stderr: Option<PathBuf>,
    /// Replicates from which --stderr was estimated, at least 2; those of fewer than 32 are pooled
    /// over pixels and spots where these say more. Known errors unless given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..), requires = "stderr")]
    pub replicates: Option<u32>,
    /// Entries that do not count, pixels × spots: those that are not 0; left_out.npy or
    /// phi.tails.npy of the run unless given
    #[arg(long, value_name = "FILE")]
    pub left_out: Option<PathBuf>,
    /// Other light in each frame: a polynomial of this degree, 0 (a constant) to 8
    #[arg(long, value_name = "DEGREE", value_parser = clap::value_parser!(u8).range(0..=8))]
    pub frame_polynomial: Option<u8>,
    /// Other light that all frames share, unknown in each pixel
    #[arg(long, conflicts_with = "frame_polynomial")]
    pub background: bool,
    /// Elements along u and v; the scene's unless given, or 12x12 where those are more than 256
    #[arg(long, value_name = "N", value_parser = elements)]
    pub elements: Option<[usize; 2]>,
    #[command(flatten)]
    pub occlusion: OcclusionArgs,
    /// How the model integrates
    #[arg(long, value_parser = choice::named::<Integration>(), default_value = "quadrature")]
    pub integration: Integration,
    /// Threads; all cores unless given. They do not change a bit of the results
    #[arg(long, value_name = "N", value_parser = count)]
    pub threads: Option<usize>,
    /// Print the results as JSON
    #[arg(long)]
    pub json: bool,
}
