//! `phicam completions`: what a shell needs to complete commands, options and values.

use clap::builder::PossibleValuesParser;
use clap::{Command, CommandFactory};

use crate::cli::Outcome;
use crate::cli::args::{Args, CompletionsArgs};
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::scene::builtins;

pub(in crate::cli) fn execute(args: &CompletionsArgs) -> Result<Outcome, Failure> {
    let mut command = with_scenes(Args::command());
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, "phicam", &mut script);
    output::draw(&String::from_utf8_lossy(&script))?;
    Ok(Outcome::Done)
}

/// The command whose arguments that take a scene have the built-in names as values: shells complete
/// them, and where none fits, files.
fn with_scenes(command: Command) -> Command {
    let names = || PossibleValuesParser::new(builtins().iter().map(|b| b.name));
    let command = command.mut_args(|argument| {
        if ["scene", "against", "from_scene"].contains(&argument.get_id().as_str()) {
            argument.value_parser(names())
        } else {
            argument
        }
    });
    command.mut_subcommands(with_scenes)
}
