//! Floor 8: the command line. The only floor that prints, reads the environment and decides exit codes.
//!
//! Raw arguments become checked settings, then one file per subcommand does its work with the floors below.
//! Results go to standard output, talk and progress to standard error.
//!
//! What a run leaves in its folder:
//!
//! | file | content |
//! | --- | --- |
//! | `files/` | copies of the meshes, pictures and materials that the scene names |
//! | `scene.toml`, `run.json` | the scene, whole; version, scene hash, seed, samples, estimator, threads, time |
//! | `frames/spot-0000.exr` | one frame a spot, f32: `flux`, `flux.stderr`, and `flux.bN` for light that met N surfaces, W |
//! | `phi.npy`, `phi.stderr.npy` | Φcam and its standard error, f64, (pixels, spots), C order, W |
//! | `model/g12.npy`, `g23.npy`, `phi.npy` | the analytic side |
//! | `model/laser_side.npy`, `camera_side.npy` | D and C: G12 and G23 with the walls' BRDFs and in W, Φcam = C·diag(ρ)·D |
//! | `model/z.npy` | z of every entry, what `run` compared by: deviation of the traced from the modelled flux in standard errors, (pixels, spots) |
//! | `recovered/METHOD.npy`, `.png` | recovered reflectance, (nv, nu); `truth` beside it |
//! | `recovered/METHOD.stderr.npy` | its standard error, (nv, nu), where the noise is known |
//! | `recovered/METHOD.covariance.npy`, `METHOD.resolution.npy` | covariance and resolution matrix of a linear method, elements × elements of all surfaces |
//! | `recovered/picard.csv`, `.svg` | signal and noise in each singular direction of the laser side |
//! | `summary.json`, `report.html` | what was found |
//! | `exposed/` | what `phicam expose` made of it: `phi.npy`, `phi.stderr.npy`, `saturated.npy`, `counts/`, `exposure.json` |
//! | `partial/` | finished spots and blocks of an unfinished run; gone when it is complete |
//! | `merged.json` | of which plan it is, where it was put together from shards |
//!
//! Exit codes: 0 done (and agreed), 1 traced and modelled disagree, 2 error, 75 stopped by SIGTERM and 130 by Ctrl-C with what is finished
//! kept. The commands for many machines (`plan`, `shard`, `status`, `merge`, `slurm`, `clean`) tell schedulers more: 3 not complete
//! (`status`), 64 wrong usage, 65 refused data, 66 missing blocks, 74 the system cannot read or write.

mod args;
mod batches;
mod checkpoint;
mod columns;
mod expose;
mod failure;
mod finished;
mod folder;
mod indices;
mod interrupt;
mod many;
pub mod many_machines;
mod model;
mod output;
mod portrait;
mod progress;
mod record;
mod recover;
mod recover_memory;
mod recover_options;
mod render;
mod reproduce;
mod run;
mod scene;
pub mod serve;
mod settings;
mod stack;
mod stale;
mod study;
mod target;
mod tasks;
mod trust;
mod validate;
mod view;

use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use args::{Args, Command};
use failure::{Codes, Failure};
use output::Talk;

/// How a command ended, if it did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    Done,
    Disagreed,
    Incomplete,
}

/// Parses the arguments, runs the command and returns its exit code.
pub fn main() -> ExitCode {
    interrupt::outlive_size_limits();
    let args = match Args::try_parse() {
        Ok(args) => args,
        Err(error) => return refuse(&error),
    };
    let talk = Talk { quiet: args.quiet };
    trust::also_read(&args.also_read);
    let result = match &args.command {
        Command::Run(a) => run::execute(a, talk),
        Command::Render(a) => render::execute(a, talk),
        Command::Stack(a) => stack::execute(a, talk),
        Command::Model(a) => model::execute(a, talk),
        Command::Validate(a) => validate::execute(a, talk),
        Command::Recover(a) => recover::execute(a, talk),
        Command::Expose(a) => expose::execute(a, talk),
        Command::View(a) => view::execute(a, talk),
        Command::Serve(a) => serve::execute(a, talk),
        Command::Scene(a) => scene::execute(a, talk),
        Command::Target(a) => target::execute(a, talk),
        Command::Plan(a) => many::plan::execute(a, talk),
        Command::Shard(a) => many::shard::execute(a, talk),
        Command::Status(a) => many::status::execute(a, talk),
        Command::Merge(a) => many::merge::execute(a, talk),
        Command::Slurm(a) => many::slurm::execute(a, talk),
        Command::Clean(a) => many::clean::execute(a, talk),
        Command::Study(a) => study::execute(a, talk),
        Command::Reproduce(a) => reproduce::execute(a, talk),
    };
    match result {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Disagreed) => ExitCode::from(1),
        Ok(Outcome::Incomplete) => ExitCode::from(3),
        Err(failure) => {
            failure.report();
            ExitCode::from(failure.code(args.command.codes()))
        }
    }
}

/// What clap says of arguments that it cannot read, or of a question for help.
fn refuse(error: &clap::Error) -> ExitCode {
    // That nobody reads it is no reason for another code.
    let _ = error.print();
    // The first word that is a command, whatever options stand before it.
    let commands = Args::command();
    let is_command = |word: &String| commands.find_subcommand(word).is_some();
    let words = || {
        std::env::args_os()
            .skip(1)
            .filter_map(|a| a.into_string().ok())
    };
    let scheduled = || words().find(is_command);
    match error.use_stderr() {
        false => ExitCode::SUCCESS,
        true if scheduled().is_some_and(|c| Command::SCHEDULED.contains(&c.as_str())) => {
            ExitCode::from(Failure::Usage(String::new()).code(Codes::Scheduler))
        }
        true => ExitCode::from(2),
    }
}
