//! `phicam man`: manual pages.

use clap::{Command, CommandFactory};
use clap_mangen::Man;

use crate::cli::Outcome;
use crate::cli::args::{Args, ManArgs};
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::store::ensure_writable;

pub(in crate::cli) fn execute(args: &ManArgs, console: Console) -> Result<Outcome, Failure> {
    let mut command = Args::command().disable_help_subcommand(true);
    command.build();
    let Some(dir) = &args.dir else {
        output::draw(&page(command)?)?;
        return Ok(Outcome::Done);
    };
    let mut pages = Vec::new();
    collect(command, "", &mut pages)?;
    for (name, _) in &pages {
        output::refuse_taken(&dir.join(name), args.force)?;
    }
    ensure_writable(dir)?;
    for (name, text) in &pages {
        output::write_new(&dir.join(name), text, args.force)?;
    }
    let (count, dir) = (pages.len(), dir.display());
    console.say(format!(
        "{dir}: {count} pages; `man -l {dir}/phicam.1` shows the first"
    ));
    Ok(Outcome::Done)
}

/// The pages of a command and of its subcommands, by file name; `before` is what leads to it.
fn collect(
    command: Command,
    before: &str,
    pages: &mut Vec<(String, String)>,
) -> Result<(), Failure> {
    let name = format!("{before}{}", command.get_name());
    for inner in command
        .get_subcommands()
        .filter(|inner| !inner.is_hide_set())
    {
        collect(inner.clone(), &format!("{name}-"), pages)?;
    }
    let called = command.display_name(name.clone());
    pages.push((format!("{name}.1"), page(called)?));
    Ok(())
}

fn page(command: Command) -> Result<String, Failure> {
    let mut roff = Vec::new();
    Man::new(command).render(&mut roff)?;
    Ok(String::from_utf8_lossy(&roff).into_owned())
}
