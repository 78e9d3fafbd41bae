//! Arguments of `phicam target`.

use std::path::PathBuf;

use clap::Args as Arguments;

use super::value::{size, whole};

#[derive(Debug, Arguments)]
#[command(
    after_help = "In a scene the same picture needs no file: `{ target = \"NAME\", size = [W, H] }`. To load the file instead: \
    `{ image = \"NAME.png\", transfer = \"srgb\" }`, or `transfer = \"linear\"` after --linear."
)]
pub(in crate::cli) struct TargetArgs {
    /// Which picture; all are listed unless given
    pub name: Option<String>,
    /// File to write; NAME.png, of a mesh NAME.ply, unless given
    #[arg(long, short, requires = "name")]
    pub output: Option<PathBuf>,
    /// Replace the file if it is there
    #[arg(long, requires = "name")]
    pub force: bool,
    /// Columns and rows, 1 to 4096 each; the target's own unless given
    #[arg(long, value_name = "W,H", value_parser = size, requires = "name")]
    pub size: Option<[usize; 2]>,
    /// Store reflectance itself instead of its sRGB code (which looks right in a viewer)
    #[arg(long, requires = "name")]
    pub linear: bool,
    /// At least so many triangles (mesh, sphere, rectangle); a million unless given
    #[arg(long, requires = "name", value_parser = whole)]
    pub faces: Option<u64>,
}
