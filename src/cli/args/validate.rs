//! Arguments of `phicam validate`.

use std::path::PathBuf;

use clap::Args as Arguments;

use super::terms::explained;
use super::value::shift;
use super::{BesideArgs, OcclusionArgs, TestArgs, choice};
use crate::lab::Errors;

#[derive(Debug, Arguments)]
#[command(after_long_help = explained(&["traced", "modelled", "entry", "z", "χ²/dof", "degrees of freedom", "best scale", "by centres", "Šidák"]))]
pub(in crate::cli) struct ValidateArgs {
    /// Folder of a run; with --phi a folder with a scene.toml is enough, or none, if --against says
    /// of which scene
    #[arg(required_unless_present_all = ["phi", "against"])]
    pub dir: Option<PathBuf>,
    #[command(flatten)]
    pub test: TestArgs,
    #[command(flatten)]
    pub occlusion: OcclusionArgs,
    /// Test this matrix (.npy, pixels × spots, W; any unit with --free-scale) instead of the run's
    #[arg(long, value_name = "FILE", requires = "stderr")]
    pub phi: Option<PathBuf>,
    /// Standard errors of --phi, of the same shape
    #[arg(long, value_name = "FILE", requires = "phi")]
    pub stderr: Option<PathBuf>,
    /// Entries that do not count, of the same shape: those that are not 0
    #[arg(long, value_name = "FILE")]
    pub left_out: Option<PathBuf>,
    /// Replicates from which --stderr was estimated, at least 2; those of fewer than 32 are pooled
    /// over pixels and spots where these say more. Known errors unless given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..), requires = "phi")]
    pub replicates: Option<u32>,
    /// Which entries of --phi share their errors
    #[arg(long, value_parser = choice::named::<Errors>(), default_value = "independent", requires = "phi")]
    pub errors: Errors,
    #[command(flatten)]
    pub beside: BesideArgs,
    /// Move the spots by DX,DY (scene's unit) in the model only
    #[arg(long, value_name = "DX,DY", value_parser = shift, allow_hyphen_values = true)]
    pub shift_spots: Option<[f64; 2]>,
    /// Compute the model from this scene (built-in name or path) instead of DIR/scene.toml
    #[arg(long, value_name = "SCENE")]
    pub against: Option<String>,
    /// Print the verdict as JSON
    #[arg(long)]
    pub json: bool,
}
