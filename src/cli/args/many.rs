//! Arguments of the commands for many machines.

use std::path::PathBuf;

use clap::Args as Arguments;

use super::PathArgs;
use super::value::{count, whole};

#[derive(Debug, Arguments)]
#[command(after_help = CODES)]
pub(in crate::cli) struct PlanArgs {
    /// Built-in scene or path of a scene file, to be rendered
    pub scene: Option<String>,
    /// Folder of the plan: the scene with every file that it names, and what is to be computed
    #[arg(long, short)]
    pub output: PathBuf,
    #[command(flatten)]
    pub paths: PathArgs,
    /// Into how many shards the work is divided, 32 unless there are fewer blocks; does not change
    /// a byte of the result
    #[arg(long, allow_negative_numbers = true, value_parser = whole)]
    pub shards: Option<u64>,
    /// Print plan.json
    #[arg(long)]
    pub json: bool,
    /// A study or published items in place of a render: `study NAME SCENE …` or `reproduce …`,
    /// without its output folder
    #[arg(last = true, conflicts_with_all = ["estimator", "sampler", "samples", "seed"])]
    pub command: Vec<String>,
}

/// What the exit codes of these commands mean.
const CODES: &str = "Exit codes: 0 done, 3 (status) not complete, 64 wrong usage, 65 refused data, 66 missing blocks, \
                     74 the system cannot read or write, 75 stopped early by SIGTERM, 130 by Ctrl-C. \
                     Another try helps with 74 and 75, never with 64 and 65.";

#[derive(Debug, Arguments)]
#[command(after_help = CODES)]
pub(in crate::cli) struct ShardArgs {
    /// Folder of a plan
    pub dir: PathBuf,
    /// Which shard, from 0
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = whole)]
    pub index: u64,
    /// Threads; all cores unless given. Does not change a byte of the result
    #[arg(long, allow_negative_numbers = true, value_parser = count)]
    pub threads: Option<usize>,
    /// Print the shard's blocks and the files computed as JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
#[command(after_help = CODES)]
pub(in crate::cli) struct StatusArgs {
    /// Folder of a plan
    pub dir: PathBuf,
    /// Print the missing shards as JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
#[command(after_help = CODES)]
pub(in crate::cli) struct MergeArgs {
    /// Folder of a plan
    pub dir: PathBuf,
    /// Folder of the result, as the command that was planned would have left it
    #[arg(long, short)]
    pub output: PathBuf,
    /// Print JSON: the record of the run (run.json), or what the study prints with --json
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
#[command(
    after_help = "Running it again is the resume: only shards that are neither there nor queued nor running are submitted. \
    SBATCH OPTIONS go to the array and to the merge alike, e.g. `phicam slurm DIR -- --partition=cpu --time=2:00:00 --cpus-per-task=16 --mem=8G`. \
    What the jobs say is in DIR/slurm."
)]
pub(in crate::cli) struct SlurmArgs {
    /// Folder of a plan
    pub dir: PathBuf,
    /// Folder that the merge writes; DIR/merged unless given
    #[arg(long, short)]
    pub output: Option<PathBuf>,
    /// Print the job scripts and the sbatch commands, as a shell script, and submit nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Options of sbatch
    #[arg(last = true, value_name = "SBATCH OPTIONS", allow_hyphen_values = true)]
    pub options: Vec<String>,
}

#[derive(Debug, Arguments)]
#[command(after_help = CODES)]
pub(in crate::cli) struct CleanArgs {
    /// Folder of a plan
    pub dir: PathBuf,
    /// The shards too: what they hold must be computed again unless it was merged
    #[arg(long)]
    pub shards: bool,
    /// Only say what would be removed
    #[arg(long)]
    pub dry_run: bool,
    /// Print the files and their bytes as JSON
    #[arg(long)]
    pub json: bool,
}
