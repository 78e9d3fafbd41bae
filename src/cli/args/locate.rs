//! Arguments of `phicam locate`.

use std::path::PathBuf;

use clap::Args as Arguments;
use clap::builder::TypedValueParser;

use super::value::{range, whole};
use super::{PhotographsArgs, choice};
use crate::lab::LOCATABLE;

#[derive(Debug, Arguments)]
pub(in crate::cli) struct LocateArgs {
    #[command(flatten)]
    pub photographs: PhotographsArgs,
    /// Folder for the results; DIR/located unless given
    #[arg(long, short, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// What is looked for: a shift or a turn of what the scene has
    #[arg(long, value_name = "WHAT", value_parser = what(), default_value = "normal")]
    pub what: &'static str,
    /// Sizes between which it is looked for, in the scene's unit or degrees; unless given ± 30 % of
    /// the distance between the middles of hidden surface and view, or ± 15°
    #[arg(long, value_name = "LOW,HIGH", value_parser = range, allow_hyphen_values = true)]
    pub range: Option<[f64; 2]>,
    /// Sizes that are tried at first, 3 to 1000
    #[arg(long, value_name = "N", default_value_t = 17, value_parser = clap::value_parser!(u16).range(3..=1000))]
    pub steps: u16,
    /// Random orders of the spots that are tried, up to 1000000; 999 or more reach p = 0.001, 0
    /// leaves that question out
    #[arg(long, value_name = "N", default_value_t = 999, value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub orders: u32,
    /// Seed of these orders; 1 unless given
    #[arg(long, value_parser = whole)]
    pub seed: Option<u64>,
}

/// One of the names of what may be looked for.
fn what() -> impl TypedValueParser<Value = &'static str> {
    choice::possible(&LOCATABLE).try_map(|given| {
        let found = LOCATABLE.iter().find(|(name, _)| *name == given);
        found.map(|(name, _)| *name).ok_or("no such name")
    })
}
