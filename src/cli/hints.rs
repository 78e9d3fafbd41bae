//! What somebody most likely meant whose arguments cannot be read, beside what the parser says.

use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use clap::{Arg, Command, CommandFactory};

use super::args::Args;
use crate::lab::STUDIES;
use crate::scene::builtins;

/// What to do about `error`, of a command line with these `words`.
pub(super) fn hint(error: &Error, words: &[String]) -> Option<String> {
    let mut root = Args::command();
    root.build();
    let (names, command) = called(&root, words);
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        _ => None,
    };
    match error.kind() {
        ErrorKind::UnknownArgument => {
            let given = text(ContextKind::InvalidArg)?;
            match given.strip_prefix("--") {
                Some(option) => elsewhere(&root, &names, option.split('=').next()?),
                None if given.starts_with('-') => None,
                None => Some(stray(&names, command, given, words)),
            }
        }
        ErrorKind::InvalidSubcommand => {
            no_command(&root, text(ContextKind::InvalidSubcommand)?)
        }
        ErrorKind::MissingRequiredArgument => missing(&names, command, error),
        _ => None,
    }
}

/// The command that `words` call, and the names that lead to it.
fn called<'a>(root: &'a Command, words: &[String]) -> (Vec<String>, &'a Command) {
    let (mut names, mut command) = (vec!["phicam".to_owned()], root);
    for word in words {
        if let Some(inner) = command.find_subcommand(word) {
            names.push(inner.get_name().to_owned());
            command = inner;
        }
    }
    (names, command)
}

fn long<'a>(command: &'a Command, option: &str) -> Option<&'a Arg> {
    let mut arguments = command.get_arguments();
    arguments.find(|a| a.get_long() == Some(option))
}

/// Which other commands take `--option`.
fn elsewhere(root: &Command, names: &[String], option: &str) -> Option<String> {
    fn collect(command: &Command, before: &str, option: &str, found: &mut Vec<String>) {
        for inner in command.get_subcommands().filter(|c| c.get_name() != "help") {
            let name = format!("{before} {}", inner.get_name());
            if long(inner, option).is_some_and(|a| !a.is_hide_set()) {
                found.push(format!("`{name}`"));
            }
            collect(inner, &name, option, found);
        }
    }
    let mut found = Vec::new();
    collect(root, "phicam", option, &mut found);
    let own = names.join(" ");
    let see = format!("`{own} --help` lists the options of this command");
    match &found[..] {
        [] => Some(see),
        [one] => Some(format!("--{option} is an option of {one}; {see}")),
        all => {
            let more = if all.len() > 4 { " and others" } else { "" };
            let all: Vec<&str> = all.iter().take(4).map(String::as_str).collect();
            Some(format!("--{option} is an option of {}{more}; {see}", all.join(", ")))
        }
    }
}

/// Whether a word names a scene rather than a folder.
fn is_scene(word: &str) -> bool {
    word.ends_with(".toml") || builtins().iter().any(|b| b.name == word)
}

/// What to do about the word `given` where no more words are taken.
fn stray(names: &[String], command: &Command, given: &str, words: &[String]) -> String {
    let own = names.join(" ");
    let place = words.iter().position(|word| word == given);
    let before = place.and_then(|at| words.get(at.checked_sub(1)?));
    let flag = before.and_then(|word| long(command, word.strip_prefix("--")?));
    if let (Some(flag), Some(before)) = (flag, before)
        && !flag.get_action().takes_values()
    {
        return format!("{before} takes no value: leave `{given}` out");
    }
    let takes_folder = command.get_arguments().any(|a| a.get_id() == "dir");
    let first = words.iter().skip(names.len() - 1).find(|word| !word.starts_with('-'));
    if let Some(first) = first.filter(|first| takes_folder && is_scene(first)) {
        return format!(
            "`{own}` takes the folder of a run, which has its scene: `{own} {given}` without `{first}`"
        );
    }
    if long(command, "output").is_some() {
        return format!("to write into `{given}`, say so: `-o {given}`");
    }
    format!("leave it out; `{own} --help` shows what is taken")
}

/// What to do about a first word that is no command.
fn no_command(root: &Command, word: &str) -> Option<String> {
    if is_scene(word) {
        return Some(format!("to compute this scene: `phicam run {word}`"));
    }
    if STUDIES.iter().any(|study| study.name == word) {
        return Some(format!("that is a study: `phicam study {word}`"));
    }
    let scene = root.find_subcommand("scene")?;
    let inner = scene.find_subcommand(word).filter(|c| c.get_name() != "help");
    match inner {
        Some(inner) => Some(format!("that belongs to scenes: `phicam scene {}`", inner.get_name())),
        None => Some("`phicam --help` lists the commands".to_owned()),
    }
}

/// What to do about arguments that are not there.
fn missing(names: &[String], command: &Command, error: &Error) -> Option<String> {
    let own = names.join(" ");
    let Some(ContextValue::Strings(missing)) = error.get(ContextKind::InvalidArg) else {
        return None;
    };
    let lacks = |name: &str| missing.iter().any(|m| m.contains(name));
    if lacks("--output") && long(command, "output").is_some() {
        return Some(format!("say where to write: `{own} … -o FOLDER`"));
    }
    if lacks("<SCENE>") {
        return Some(format!(
            "name a built-in scene (`phicam scene list`) or a scene file: `{own} bench`"
        ));
    }
    if lacks("<DIR>") {
        return Some(format!("name a folder that `phicam run` has written: `{own} out`"));
    }
    None
}
