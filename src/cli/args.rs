//! Raw arguments, as clap reads them.

use std::ops::Range;
use std::path::PathBuf;

use clap::{Args as Arguments, Parser, Subcommand, ValueEnum};

/// phicam: a physically based renderer for indirect photography, and the laboratory around it.
#[derive(Debug, Parser)]
#[command(version, about, max_term_width = 100, propagate_version = true)]
#[command(
    after_help = "Exit codes: 0 done, 1 traced and modelled disagree, 2 error, 130 stopped by Ctrl-C."
)]
pub(super) struct Args {
    /// No progress and no remarks on standard error
    #[arg(long, short, global = true)]
    pub quiet: bool,
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// The main job: render, stack, model, validate, recover, report
    Run(RunArgs),
    /// Trace Φcam: one EXR frame per spot, and phi.npy
    Render(RenderArgs),
    /// Rebuild phi.npy and phi.stderr.npy from the EXR frames alone
    Stack(StackArgs),
    /// Write the matrices of the model: G12, G23 and Φcam
    Model(ModelArgs),
    /// Test traced against modelled Φcam: exit 0 agree, 1 disagree, 2 error
    Validate(ValidateArgs),
    /// Recover the hidden reflectance from Φcam
    Recover(RecoverArgs),
    /// List, check, draw or export scenes
    Scene(SceneArgs),
    /// Experiments around a scene
    Study(StudyArgs),
}

/// What has to be traced.
#[derive(Debug, Arguments)]
pub(super) struct TraceArgs {
    /// Which paths are shared
    #[arg(long, value_enum, default_value_t = EstimatorName::Independent)]
    pub estimator: EstimatorName,
    /// Where random numbers come from
    #[arg(long, value_enum, default_value_t = SamplerName::Sobol)]
    pub sampler: SamplerName,
    /// Paths per pixel and spot (independent) or per pixel (shared); rounded up to whole blocks
    #[arg(long, default_value_t = 512)]
    pub samples: u64,
    /// Seed: the same seed gives the same bytes
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads; all cores unless given. Does not change a byte of the result
    #[arg(long)]
    pub threads: Option<usize>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum EstimatorName {
    /// Every (pixel, spot) entry has its own paths
    Independent,
    /// The paths of a pixel serve all spots
    Shared,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum SamplerName {
    /// Independent random numbers
    Pcg,
    /// Owen-scrambled Sobol' points
    Sobol,
}

#[derive(Debug, Arguments)]
pub(super) struct RunArgs {
    /// Built-in scene or path of a scene file
    #[arg(default_value = "bench")]
    pub scene: String,
    /// Output folder
    #[arg(long, short, default_value = "out")]
    pub output: PathBuf,
    #[command(flatten)]
    pub trace: TraceArgs,
    #[command(flatten)]
    pub test: TestArgs,
    /// Print summary.json instead of the table
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
pub(super) struct RenderArgs {
    /// Built-in scene or path of a scene file
    pub scene: String,
    /// Output folder
    #[arg(long, short)]
    pub output: PathBuf,
    #[command(flatten)]
    pub trace: TraceArgs,
    /// Only spots A to B − 1; phi.npy follows when every spot is there
    #[arg(long, value_name = "A..B", value_parser = spot_range)]
    pub spots: Option<Range<usize>>,
    /// Keep the spots that an interrupted run with the same settings has finished
    #[arg(long)]
    pub resume: bool,
    /// Print the record of the run (run.json)
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
pub(super) struct StackArgs {
    /// Folder of a run, or of its frames
    pub dir: PathBuf,
    /// Folder to write phi.npy and phi.stderr.npy to; DIR unless given
    #[arg(long, short)]
    pub output: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum KernelName {
    /// The true cosine at the hidden surface
    Physical,
    /// The one in the published simulation
    Published,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum IntegrationName {
    /// Elements, pixels and spots by their centres, with a bound on what that leaves out
    Centres,
    /// Converged quadrature over elements, footprints and spots
    Quadrature,
}

#[derive(Debug, Arguments)]
pub(super) struct ModelArgs {
    /// Built-in scene or path of a scene file
    pub scene: String,
    /// Output folder; the matrices go to its folder model/
    #[arg(long, short)]
    pub output: PathBuf,
    /// Kernel of G12 and G23
    #[arg(long, value_enum, default_value_t = KernelName::Physical)]
    pub kernel: KernelName,
    /// Elements along u and v, in place of the scene's: N or NxM
    #[arg(long, value_name = "N", value_parser = elements)]
    pub elements: Option<[usize; 2]>,
    /// Where Φcam is evaluated; G12 and G23 are always those of the centres
    #[arg(long, value_enum, default_value_t = IntegrationName::Centres)]
    pub integration: IntegrationName,
}

/// How traced and modelled are compared.
#[derive(Debug, Arguments)]
pub(super) struct TestArgs {
    /// Kernel of the model
    #[arg(long, value_enum, default_value_t = KernelName::Physical)]
    pub kernel: KernelName,
    /// How the model integrates
    #[arg(long, value_enum, default_value_t = IntegrationName::Centres)]
    pub integration: IntegrationName,
    /// Probability of rejecting a right model
    #[arg(long, default_value_t = 1e-3)]
    pub significance: f64,
}

#[derive(Debug, Arguments)]
pub(super) struct ValidateArgs {
    /// Folder of a run
    pub dir: PathBuf,
    #[command(flatten)]
    pub test: TestArgs,
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

#[derive(Debug, Arguments)]
pub(super) struct RecoverArgs {
    /// Folder of a run
    pub dir: PathBuf,
    /// Methods, separated by commas: pinv, tsvd, tikhonov, joint-unbounded, joint; all unless given
    #[arg(long, value_delimiter = ',', value_name = "METHOD")]
    pub method: Vec<String>,
    /// Φcam to invert, pixels × spots in W, in place of DIR/phi.npy
    #[arg(long, value_name = "FILE")]
    pub phi: Option<PathBuf>,
    /// Its standard error, in place of DIR/phi.stderr.npy
    #[arg(long, value_name = "FILE", conflicts_with = "noise")]
    pub stderr: Option<PathBuf>,
    /// Noise model: standard deviation of each entry relative to its value, in place of a standard error
    #[arg(long, value_name = "RELATIVE")]
    pub noise: Option<f64>,
    /// Kernel of the model that is inverted
    #[arg(long, value_enum, default_value_t = KernelName::Physical)]
    pub kernel: KernelName,
    /// Elements along u and v, in place of the scene's: N or NxM
    #[arg(long, value_name = "N", value_parser = elements)]
    pub elements: Option<[usize; 2]>,
    /// Singular directions that tsvd keeps, in place of the discrepancy principle
    #[arg(long, value_name = "K")]
    pub rank: Option<usize>,
    /// Damping of tikhonov relative to σ1, in place of the discrepancy principle
    #[arg(long, value_name = "LAMBDA")]
    pub damping: Option<f64>,
    /// Relative singular value below which pinv and joint cut; max(size)·eps unless given
    #[arg(long, value_name = "RELATIVE")]
    pub tolerance: Option<f64>,
    /// Print the results as JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
pub(super) struct SceneArgs {
    #[command(subcommand)]
    pub command: SceneCommand,
}

#[derive(Debug, Subcommand)]
pub(super) enum SceneCommand {
    /// List the built-in scenes
    List,
    /// Say what is wrong (exit 2) or suspicious in a scene
    Check {
        /// Built-in scene or path of a scene file
        scene: String,
    },
    /// Draw the bench from the side and from above, as SVG
    Show {
        /// Built-in scene or path of a scene file
        scene: String,
        /// File to write; standard output unless given
        #[arg(long, short)]
        output: Option<PathBuf>,
    },
    /// Write the text of a scene, as a start for one's own
    Export {
        /// Built-in scene or path of a scene file
        scene: String,
        /// A Python program instead, that renders the same Φcam with Mitsuba 3
        #[arg(long)]
        mitsuba: bool,
        /// File to write; standard output unless given
        #[arg(long, short)]
        output: Option<PathBuf>,
    },
}

#[derive(Debug, Arguments)]
pub(super) struct StudyArgs {
    #[command(subcommand)]
    pub command: StudyCommand,
}

#[derive(Debug, Subcommand)]
pub(super) enum StudyCommand {
    /// What the matrix model leaves out, cause by cause: table, JSON, CSV, figure
    Budget(BudgetArgs),
}

#[derive(Debug, Arguments)]
pub(super) struct BudgetArgs {
    /// Built-in scene or path of a scene file
    pub scene: String,
    /// Folder for budget.json, budget.csv and budget.svg
    #[arg(long, short, default_value = "out/budget")]
    pub output: PathBuf,
    /// Paths per pixel of the precise renders, all together
    #[arg(long, default_value_t = 16384)]
    pub samples: u64,
    /// Paths per pixel and spot of the run that is taken apart
    #[arg(long, default_value_t = 512)]
    pub run_samples: u64,
    /// Seed of everything
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads; all cores unless given
    #[arg(long)]
    pub threads: Option<usize>,
    /// Print budget.json instead of the table
    #[arg(long)]
    pub json: bool,
}

/// "A..B" with A < B.
fn spot_range(text: &str) -> Result<Range<usize>, String> {
    let parts = text
        .split_once("..")
        .and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    match parts {
        Some((a, b)) if a < b => Ok(a..b),
        _ => Err("write it as A..B with A < B, e.g. 0..30 for the first thirty".to_owned()),
    }
}

/// "N" or "NxM", both from 1 to 1024.
fn elements(text: &str) -> Result<[usize; 2], String> {
    let side = |s: &str| s.parse().ok().filter(|n| (1..=1024).contains(n));
    let parts = match text.split_once('x') {
        None => side(text).map(|n| [n, n]),
        Some((a, b)) => side(a).zip(side(b)).map(|(a, b)| [a, b]),
    };
    parts.ok_or_else(|| "write it as 8 or 8x6, 1 to 1024 a side".to_owned())
}

/// "DX,DY", finite.
fn shift(text: &str) -> Result<[f64; 2], String> {
    let number = |s: &str| s.trim().parse().ok().filter(|x: &f64| x.is_finite());
    let parts = text
        .split_once(',')
        .and_then(|(a, b)| Some([number(a)?, number(b)?]));
    parts.ok_or_else(|| "write it as DX,DY, e.g. 0.05,0".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        Args::command().debug_assert();
    }

    #[test]
    fn ranges_elements_and_shifts_are_strict() {
        assert_eq!(spot_range("3..7"), Ok(3..7));
        assert_eq!(elements("8"), Ok([8, 8]));
        assert_eq!(elements("8x6"), Ok([8, 6]));
        assert_eq!(shift("-0.05, 1e-3"), Ok([-0.05, 1e-3]));
        for bad in ["7..3", "3..3", "3", "a..b", "-1..2"] {
            assert!(spot_range(bad).is_err(), "{bad}");
        }
        for bad in ["0", "8x0", "2000", "x", ""] {
            assert!(elements(bad).is_err(), "{bad}");
        }
        for bad in ["1", "nan,0", "1,inf", ""] {
            assert!(shift(bad).is_err(), "{bad}");
        }
    }
}
