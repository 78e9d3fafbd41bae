//! Floor 8: the command line. The only floor that prints, reads the environment and decides exit codes.
//!
//! Raw arguments ([`args`]) become checked settings, then one file per subcommand does its work with the floors below.
//! Results go to standard output, talk and progress to standard error.
//!
//! Exit codes: 0 done (and agreed), 1 traced and modelled disagree, 2 error, 130 stopped by Ctrl-C with what is finished
//! kept.

mod args;
mod failure;
mod finished;
mod folder;
mod interrupt;
mod model;
mod output;
mod progress;
mod record;
mod recover;
mod render;
mod run;
mod scene;
mod settings;
mod stack;
mod validate;

use std::process::ExitCode;

use clap::Parser;

use args::{Args, Command};
use output::Talk;

/// How a command ended, if it did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    Done,
    Disagreed,
}

/// Parses the arguments, runs the command and returns its exit code.
pub fn main() -> ExitCode {
    let args = Args::parse();
    let talk = Talk { quiet: args.quiet };
    let result = match &args.command {
        Command::Run(a) => run::execute(a, talk),
        Command::Render(a) => render::execute(a, talk),
        Command::Stack(a) => stack::execute(a, talk),
        Command::Model(a) => model::execute(a, talk),
        Command::Validate(a) => validate::execute(a, talk),
        Command::Recover(a) => recover::execute(a, talk),
        Command::Scene(a) => scene::execute(a, talk),
    };
    match result {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Disagreed) => ExitCode::from(1),
        Err(failure) => {
            failure.report();
            ExitCode::from(failure.code())
        }
    }
}
