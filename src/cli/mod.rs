//! Floor 8: the command line. The only floor that prints, reads the environment and decides exit
//! codes.
//!
//! Raw arguments become checked settings, then one file per subcommand does its work with the
//! floors below. Results go to standard output, console and progress to standard error.
//!
//! What a run leaves in its folder:
//!
//! | file | content |
//! | --- | --- |
//! | `files/` | copies of the meshes, pictures and materials that the scene names |
//! | `scene.toml`, `run.json` | the scene, whole; version, scene hash, seed, samples, estimator, threads, time, SHA-256 of the files and of itself |
//! | `frames/spot-0000.exr` | one frame a spot, f32: `flux`, `flux.stderr`, and `flux.bN` for light that met N surfaces, W |
//! | `phi.npy`, `phi.stderr.npy` | Φcam and its standard error, f64, (pixels, spots), C order, W |
//! | `phi.tails.npy` | how far each standard error is to be trusted: 0, or the sum of 1 (one block has most of the scatter), 2 (blocks too skewed), 4 (light in few blocks), 8 (no light met yet: the standard error is an upper bound), 16 (like its neighbours); f64, (pixels, spots) |
//! | `model/g12.npy`, `g23.npy`, `phi.npy` | the analytic side |
//! | `model/laser_side.npy`, `camera_side.npy` | D and C: G12 and G23 with the walls' BRDFs and in W, Φcam = C·diag(ρ)·D |
//! | `model/z.npy` | z of every entry, what `run` compared by: deviation t of the traced from the modelled flux in standard errors, as the standard normal deviate of the same probability as Student's t with N − 1 degrees of freedom, N blocks; (pixels, spots) |
//! | `recovered-NAME-DIGEST/` | what `phicam recover --phi` made of other photographs |
//! | `recovered/METHOD.npy`, `.png` | recovered reflectance, (nv, nu); `truth` beside it |
//! | `recovered/determined.npy`, `.png` | share of each element that the photographs determine at their noise, (nv, nu), 0 to 1 |
//! | `recovered/METHOD.stderr.npy` | its standard error, (nv, nu), where the noise is known |
//! | `recovered/METHOD.covariance.npy`, `METHOD.resolution.npy` | covariance and resolution matrix of a linear method, elements × elements of all surfaces |
//! | `recovered/picard.csv`, `.svg` | signal and noise in each singular direction of the laser side |
//! | `summary.json`, `report.html` | what was found |
//! | `left_out.npy`, `import.json`, `import.png` | of photographs from `phicam import`: why an entry is left out (0: it counts), f64, (pixels, spots); settings, files, noise and marks; the mean photograph with the view, spots and marks |
//! | `located/` | what `phicam locate` found: `locate.json`, `locate.csv`, `locate.svg`, `report.html` |
//! | `calibrated/` | what `phicam calibrate` found: `calibration.json`, `calibration.csv`, `identifiability.csv`, `stages.csv`, `profiles.svg`, `report.html`, the calibrated `scene.toml`, and the picture by it with the errors of the geometry in, as `recover` names its files: `joint-gp.npy`, `joint-gp.stderr.npy` (nv, nu), `joint-gp.covariance.npy`, in the unit of `grids` in `calibration.json` |
//! | `exposed/` | what `phicam expose` made of it: `phi.npy`, `phi.stderr.npy`, `saturated.npy`, `counts/`, `exposure.json` |
//! | `partial/` | finished spots and blocks of an unfinished run; gone when it is complete |
//! | `.replacement/` | a run with other settings that will take the place of this one when it is whole |
//! | `.phicam-….lock` | who writes the folder now: there is one writer |
//! | `merged.json` | of which plan it is, where it was put together from shards |
//!
//! A study keeps its finished tasks in `NAME.phs` beside its files until it is complete, and `study
//! noise` for good: the same command goes on from them. `study.json` tells of which study, scene
//! and settings its files are; what differs from it needs `--replace`.
//!
//! Exit codes: 0 done (and agreed), 1 traced and modelled disagree (`validate`, `run`) or
//! photographs and model contradict each other (`recover`: no reflectances between 0 and 1 explain
//! the photographs within their errors; what was recovered is written nevertheless), 2 error, 4
//! nothing to compare (`validate`, `run`: no evidence), 75 stopped by SIGTERM and 130 by Ctrl-C
//! with what is finished kept. The commands for many machines (`plan`, `shard`, `status`, `merge`,
//! `slurm`, `clean`) tell schedulers more: 3 not complete (`status`), 64 wrong usage, 65 refused
//! data, 66 missing blocks, 74 the system cannot read or write. What lies in `shards/` is judged
//! alike by `status`, `slurm` and `merge`: a damaged shard of the plan counts as missing (3, 66); a
//! file `.phs` that is none of the plan, or contradicts another, is refused (65).

mod args;
mod cleanup;
mod commands;
mod console;
mod exposed_folder;
mod failure;
mod findings;
pub mod from_your_camera;
pub mod guide;
mod help;
mod hints;
mod interrupt;
mod load_run;
pub mod many_machines;
mod output;
mod partial;
mod process;
mod progress;
mod replacement;
mod run_folder;
pub mod serve;
mod settings;
mod suspicious;

use std::path::Path;
use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use args::{Args, Command};
use commands::{
    calibrate, completions, expose, import, locate, man, many, model, new, notices, recover,
    render, reproduce, run, scene, stack, study, target, validate, view,
};
use console::{Console, complain};
use failure::{Codes, Failure, Outcome};
use run_folder::SCENE;

use crate::folder::Record;
use crate::num::repetition::first_repeated;
use crate::store::harmless;

/// Refuses other values of a scene's keys for a command that names no scene.
fn refuse_undefinable(command: &Command, define: &[(String, String)]) -> Result<(), Failure> {
    let mut defined = define.iter().map(|(key, _)| key);
    let Some(key) = defined.find(|key| !command.defines(key)) else {
        return Ok(());
    };
    let cause = format!("-D {key} changes a scene, and nothing here names one");
    let folder = command.of_photographs();
    let record = |dir: &Path| Record::read(dir).ok().flatten();
    let cure = match folder.map(|dir| (dir, record(dir))) {
        Some((_, Some(record))) if record.is_imported() => format!(
            "the scene of photographs is that of their import: `phicam import … -D {key}=VALUE` into another folder"
        ),
        Some((dir, None)) => format!(
            "write it into {}, which photographs of --phi are taken with",
            dir.join(SCENE).display()
        ),
        _ => "the scene of a run is that of its render: render it with -D into another folder; `validate` takes one by --against, `expose` -D sensor.KEY=VALUE".to_owned(),
    };
    Err(Failure::usage(cause, cure))
}

/// Refuses two values of one key, of which only one could hold.
fn refuse_defined_twice(define: &[(String, String)]) -> Result<(), Failure> {
    let Some(key) = first_repeated(define.iter().map(|(key, _)| key)) else {
        return Ok(());
    };
    let cause = format!("-D gives {key} twice");
    Err(Failure::usage(cause, "give every key one value"))
}

/// Parses the arguments, runs the command and returns its exit code.
pub fn main() -> ExitCode {
    interrupt::outlive_size_limits();
    if let Some(code) = help::answer() {
        return ExitCode::from(code);
    }
    let args = match Args::try_parse() {
        Ok(args) => args,
        Err(error) => return refuse(&error),
    };
    let console = Console {
        quiet: args.quiet,
        also_read: &args.also_read,
        define: &args.define,
    };
    let ready = refuse_undefinable(&args.command, &args.define)
        .and_then(|()| refuse_defined_twice(&args.define));
    if let Err(failure) = ready.and_then(|()| process::start_threads()) {
        failure.report();
        return ExitCode::from(failure.code(args.command.codes()));
    }
    let result = match &args.command {
        Command::Run(a) => run::execute(a, console),
        Command::Render(a) => render::execute(a, console),
        Command::Stack(a) => stack::execute(a, console),
        Command::Model(a) => model::execute(a, console),
        Command::Validate(a) => validate::execute(a, console),
        Command::Recover(a) => recover::execute(a, console),
        Command::Locate(a) => locate::execute(a, console),
        Command::Calibrate(a) => calibrate::execute(a, console),
        Command::Expose(a) => expose::execute(a, console),
        Command::Import(a) => import::execute(a, console),
        Command::View(a) => view::execute(a, console),
        Command::Serve(a) => serve::execute(a, console),
        Command::Scene(a) => scene::execute(a, console),
        Command::Target(a) => target::execute(a, console),
        Command::Plan(a) => many::plan::execute(a, console),
        Command::Shard(a) => many::shard::execute(a, console),
        Command::Status(a) => many::status::execute(a, console),
        Command::Merge(a) => many::merge::execute(a, console),
        Command::Slurm(a) => many::slurm::execute(a, console),
        Command::Clean(a) => many::clean::execute(a, console),
        Command::Study(a) => study::execute(a, console),
        Command::Reproduce(a) => reproduce::execute(a, console),
        Command::New(a) => new::execute(a, console),
        Command::Completions(a) => completions::execute(a),
        Command::Man(a) => man::execute(a, console),
        Command::Notices => notices::execute(),
    };
    match result {
        Ok(outcome) => ExitCode::from(outcome as u8),
        Err(failure) => {
            failure.report();
            ExitCode::from(failure.code(args.command.codes()))
        }
    }
}

/// What clap says of arguments that it cannot read, or of a question for help.
fn refuse(error: &clap::Error) -> ExitCode {
    if !error.use_stderr() {
        return match error.print() {
            Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
                output::unwritten(&e).report();
                ExitCode::from(2)
            }
            _ => ExitCode::SUCCESS,
        };
    }
    let words: Vec<String> = std::env::args_os()
        .skip(1)
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    let plain = error.render().to_string();
    if let Some(told) = hints::told(error, &words) {
        complain(&told);
    } else if harmless(&plain) == plain {
        // That nobody reads it is no reason for another code.
        let _ = error.print();
    } else {
        complain(plain.trim_end());
    }
    // The first word that is a command, whatever options stand before it.
    let commands = Args::command();
    let mut words = words.iter();
    let command = words.find(|word| commands.find_subcommand(word).is_some());
    let codes = match command {
        Some(name) if Command::SCHEDULED.contains(&name.as_str()) => Codes::Scheduler,
        _ => Codes::Plain,
    };
    ExitCode::from(Failure::Usage(String::new()).code(codes))
}
