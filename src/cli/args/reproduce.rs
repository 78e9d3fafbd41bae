//! Arguments of `phicam reproduce`.

use std::path::PathBuf;

use clap::Args as Arguments;

use super::value::{count, whole};

#[derive(Debug, Arguments)]
pub(in crate::cli) struct ReproduceArgs {
    /// Tables and figures: table1, table2, …, fig12, …, precision, dual, moving-view; all unless
    /// given
    #[arg(value_name = "ITEM")]
    pub items: Vec<String>,
    /// Folder for ITEM.csv, ITEM.svg and ITEM-images.svg, each with a PNG beside it, ITEM.json,
    /// reproduction.md and reproduction.html, a page with all figures in it
    #[arg(long, short, default_value = "out/reproduce")]
    pub output: PathBuf,
    /// Leave out curves with more elements a side than this
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u64).range(8..=64))]
    pub most_elements: u64,
    /// Draws of the noise of fig22; of moving-view a quarter of them
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u64).range(2..=100_000))]
    pub seeds: u64,
    /// First seed
    #[arg(long, default_value_t = 1, value_parser = whole)]
    pub seed: u64,
    /// Threads; all cores unless given. Does not change a byte of the result
    #[arg(long, value_parser = count)]
    pub threads: Option<usize>,
    /// Replace finished items with other settings
    #[arg(long)]
    pub replace: bool,
    /// Print the summaries of the items as JSON
    #[arg(long)]
    pub json: bool,
}
