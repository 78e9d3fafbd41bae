//! Raw arguments, as clap reads them.

mod beside;
mod calibrate;
mod choice;
mod expose;
mod import;
mod locate;
mod many;
mod new;
mod photographs;
mod recover;
mod reproduce;
mod scene;
mod serve;
mod shared;
mod study;
mod target;
mod terms;
mod validate;
mod value;
mod view;

use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::{Args as Arguments, Parser, Subcommand};

use crate::cli::failure::Codes;
use crate::lab::Integration;
use crate::model::Kernel;
use terms::explained;
use value::{definition, elements, folder, spot_range};

pub(in crate::cli) use beside::BesideArgs;
pub(in crate::cli) use calibrate::CalibrateArgs;
pub(in crate::cli) use expose::{ExposeArgs, StatedBy};
pub(in crate::cli) use import::ImportArgs;
pub(in crate::cli) use locate::LocateArgs;
pub(in crate::cli) use many::{CleanArgs, MergeArgs, PlanArgs, ShardArgs, SlurmArgs, StatusArgs};
pub(in crate::cli) use new::{CompletionsArgs, ManArgs, NewArgs};
pub(in crate::cli) use photographs::PhotographsArgs;
pub(in crate::cli) use recover::RecoverArgs;
pub(in crate::cli) use reproduce::ReproduceArgs;
pub(in crate::cli) use scene::{SceneArgs, SceneCommand};
pub(in crate::cli) use serve::ServeArgs;
pub(in crate::cli) use shared::{OcclusionArgs, PathArgs, TestArgs, TraceArgs};
pub(in crate::cli) use study::StudyArgs;
pub(in crate::cli) use target::TargetArgs;
pub(in crate::cli) use validate::ValidateArgs;
pub(in crate::cli) use view::{PreviewArgs, Terminal, ViewArgs};

/// phicam: a physically based renderer for indirect photography, and the laboratory around it.
#[derive(Debug, Parser)]
#[command(version, about, max_term_width = 100, propagate_version = true)]
#[command(
    after_help = "Exit codes: 0 done, 1 traced and modelled disagree (recover: photographs and model), 2 error, 4 no evidence, 75 stopped by SIGTERM, 130 by Ctrl-C. \
                  Those for schedulers: `phicam help shard`."
)]
pub(in crate::cli) struct Args {
    /// No progress and no remarks on standard error
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Let scenes read meshes, pictures and materials in this folder too, not only beside the scene
    /// file; may be given several times
    #[arg(long, value_name = "DIR", global = true, value_parser = folder())]
    pub also_read: Vec<PathBuf>,
    /// Another value of a key of the scene, e.g. camera.pixels=[32,32], laser.power=5mW or
    /// surface.wall.material.lambertian=0.5; may be given several times
    #[arg(short = 'D', long = "define", value_name = "KEY=VALUE", global = true, value_parser = definition)]
    pub define: Vec<(String, String)>,
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub(in crate::cli) enum Command {
    /// The main job: render, stack, model, validate, recover, report
    Run(RunArgs),
    /// Trace Φcam: one EXR frame per spot, and phi.npy
    Render(RenderArgs),
    /// Rebuild phi.npy and phi.stderr.npy from the EXR frames alone
    Stack(StackArgs),
    /// Write the matrices of the model: G12, G23 and Φcam
    Model(ModelArgs),
    /// Test traced or measured against modelled Φcam: exit 0 agree, 1 disagree, 2 error, 4 no
    /// evidence
    Validate(ValidateArgs),
    /// Recover the hidden reflectance from Φcam: exit 0 done, 1 no reflectances explain it, 2 error
    Recover(Box<RecoverArgs>),
    /// Where the hidden surface is, its reflectances unknown, and whether the photographs belong to
    /// their spots: exit 0 found, 1 not, or the photographs refute what was found, 2 error
    Locate(LocateArgs),
    /// Estimate the geometry itself from the photographs, whatever the picture: where the hidden
    /// surface, spots, view, camera, occluders are, with errors: exit 0 found, 1 not, another place
    /// does as well or the photographs refute it, 2 error
    Calibrate(Box<CalibrateArgs>),
    /// Photograph the clean flux with a sensor: shot noise, read noise, glare, converter
    Expose(ExposeArgs),
    /// Make Φcam of photographs from a real camera: PNG, TIFF, JPEG, OpenEXR, NumPy and MATLAB
    /// files
    Import(Box<ImportArgs>),
    /// Look at a frame or a matrix in false colour, as PNG or in the terminal
    View(ViewArgs),
    /// Show the report of a run or study over a local address, for what is too large to be in one
    /// page
    Serve(ServeArgs),
    /// List, check, draw, look at or export scenes
    #[command(
        after_help = "The keys of a scene file: `phicam help scene`; one of them, e.g.: `phicam help scene camera.view`."
    )]
    Scene(SceneArgs),
    /// Write a commented scene to start from
    New(NewArgs),
    /// Write a target picture, or list them: card, letters, siemens, edge, usaf, ramp
    Target(TargetArgs),
    /// Divide a render or a study into shards for many machines
    Plan(PlanArgs),
    /// Compute one shard of a plan
    Shard(ShardArgs),
    /// Which shards of a plan are missing
    Status(StatusArgs),
    /// Put the shards of a plan together
    Merge(MergeArgs),
    /// Submit what is missing of a plan to Slurm, and the merge after it; once more to resume
    Slurm(SlurmArgs),
    /// Remove from a plan's folder what is not needed any more
    Clean(CleanArgs),
    /// Experiments around a scene
    Study(StudyArgs),
    /// The published tables and figures, computed again
    Reproduce(ReproduceArgs),
    /// Print a script that makes a shell complete commands, options and values
    Completions(CompletionsArgs),
    /// Print the manual page, or write those of all commands into a folder
    Man(ManArgs),
    /// Print the licences of phicam and of what it is linked with
    Notices,
}

impl Command {
    /// Those that schedulers call.
    pub(in crate::cli) const SCHEDULED: [&str; 6] =
        ["plan", "shard", "status", "merge", "slurm", "clean"];

    /// Whether it takes another value of a key of the scene: where it reads a scene that is named
    /// in its arguments, and `expose` for its sensor, which is no part of a render.
    pub(in crate::cli) fn defines(&self, key: &str) -> bool {
        match self {
            Self::Expose(_) => key.starts_with("sensor."),
            Self::Validate(args) => args.against.is_some(),
            Self::Recover(_)
            | Self::Calibrate(_)
            | Self::View(_)
            | Self::Stack(_)
            | Self::Locate(_)
            | Self::Serve(_)
            | Self::Target(_)
            | Self::Shard(_)
            | Self::Status(_)
            | Self::Merge(_)
            | Self::Slurm(_)
            | Self::Clean(_)
            | Self::New(_)
            | Self::Completions(_)
            | Self::Man(_)
            | Self::Notices
            | Self::Reproduce(_) => false,
            Self::Scene(args) => !matches!(args.command, SceneCommand::List { .. }),
            _ => true,
        }
    }

    /// The folder whose photographs it explains by the scene there.
    pub(in crate::cli) fn of_photographs(&self) -> Option<&Path> {
        match self {
            Self::Recover(args) => args.dir.as_deref(),
            Self::Calibrate(args) => Some(&args.photographs.dir),
            Self::Locate(args) => Some(&args.photographs.dir),
            _ => None,
        }
    }

    /// Which exit codes its failures have.
    pub(in crate::cli) fn codes(&self) -> Codes {
        match self {
            Self::Plan(_)
            | Self::Shard(_)
            | Self::Status(_)
            | Self::Merge(_)
            | Self::Slurm(_)
            | Self::Clean(_) => Codes::Scheduler,
            _ => Codes::Plain,
        }
    }
}

#[derive(Debug, Arguments)]
#[command(after_long_help = explained(&["traced", "modelled", "entry", "z", "χ²/dof", "degrees of freedom", "best scale", "determined", "MTF raw", "MTF normalized", "RMSE"]))]
pub(in crate::cli) struct RunArgs {
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
    #[command(flatten)]
    pub occlusion: OcclusionArgs,
    /// Replace a run with other settings, or of another scene, once this one is whole
    #[arg(long)]
    pub replace: bool,
    /// Print summary.json instead of the table
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
pub(in crate::cli) struct RenderArgs {
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
    /// Replace a run with other settings, or of another scene, once this one is whole
    #[arg(long)]
    pub replace: bool,
    /// Goes on where the same run stopped, as it does without being told
    #[arg(long, hide = true)]
    pub resume: bool,
    /// Print the record of the run (run.json)
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
pub(in crate::cli) struct StackArgs {
    /// Folder of a run, or of its frames
    pub dir: PathBuf,
    /// Folder to write phi.npy and phi.stderr.npy to; DIR unless given
    #[arg(long, short)]
    pub output: Option<PathBuf>,
    /// Print what was stacked as JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
#[command(after_long_help = explained(&["G12", "G23", "Φcam", "modelled", "by centres"]))]
pub(in crate::cli) struct ModelArgs {
    /// Built-in scene or path of a scene file
    pub scene: String,
    /// Output folder; the matrices go to its folder model/
    #[arg(long, short)]
    pub output: PathBuf,
    /// Kernel of G12 and G23
    #[arg(long, value_parser = choice::named::<Kernel>(), default_value = "physical")]
    pub kernel: Kernel,
    /// Elements along u and v, in place of the scene's: N or NxM
    #[arg(long, value_name = "N", value_parser = elements)]
    pub elements: Option<[usize; 2]>,
    #[command(flatten)]
    pub occlusion: OcclusionArgs,
    /// Where Φcam is evaluated; G12 and G23 are always those of the centres
    #[arg(long, value_parser = choice::named::<Integration>(), default_value = "centres")]
    pub integration: Integration,
    /// Print the shapes of the matrices as JSON
    #[arg(long)]
    pub json: bool,
}

#[cfg(test)]
mod tests;
