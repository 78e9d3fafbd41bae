//! What somebody most likely meant whose arguments cannot be read, beside what the parser says.

use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use clap::{Arg, Command, CommandFactory};

use crate::cli::args::Args;
use crate::lab::STUDIES;
use crate::recovery::Method;
use crate::scene::builtins;

/// What is said of `error`, of a command line with these `words`: what the parser says, and the
/// cure in the place of its guesses. `None` where there is nothing to add to that.
pub(super) fn told(error: &Error, words: &[String]) -> Option<String> {
    let said = error.render().to_string();
    let plain = said
        .replace(
            "invalid float literal",
            "write a number alone, as 0.05 or 5e-2",
        )
        .replace("invalid digit found in string", "write a whole number");
    let cure = hint(error, words);
    if cure.is_none() && plain == said {
        return None;
    }
    let is_guess = |line: &&str| {
        let line = line.trim_start();
        cure.is_some() && (line.starts_with("tip: ") || line.starts_with("For more information"))
    };
    let mut lines: Vec<&str> = plain
        .trim_end()
        .lines()
        .filter(|line| !is_guess(line))
        .collect();
    lines.dedup_by(|a, b| a.is_empty() && b.is_empty());
    let text = lines.join("\n");
    let text = text.trim_end();
    Some(match cure {
        Some(cure) => format!("{text}\n  cure: {cure}"),
        None => text.to_owned(),
    })
}

/// What to do about `error`.
fn hint(error: &Error, words: &[String]) -> Option<String> {
    let mut root = Args::command();
    root.build();
    let (names, command) = called(&root, words);
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        _ => None,
    };
    let has = |kind| error.get(kind).is_some();
    match error.kind() {
        // The parser knows a near one itself.
        ErrorKind::UnknownArgument if has(ContextKind::SuggestedArg) => None,
        ErrorKind::UnknownArgument => {
            let given = text(ContextKind::InvalidArg)?;
            match given.strip_prefix("--") {
                Some(option) => elsewhere(&root, &names, option.split('=').next()?),
                None if given.starts_with('-') => one_dash(command, given, words),
                None => Some(stray(&names, command, given, words)),
            }
        }
        ErrorKind::InvalidSubcommand => {
            let cure = no_command(&root, text(ContextKind::InvalidSubcommand)?, &names);
            // Unless what it suggests is nearer.
            cure.or_else(|| {
                let asks = names.iter().filter(|name| *name != "help");
                let asks: Vec<&str> = asks.map(String::as_str).collect();
                let lists = format!("`{} --help` lists the commands", asks.join(" "));
                (!has(ContextKind::SuggestedSubcommand)).then_some(lists)
            })
        }
        ErrorKind::InvalidValue if text(ContextKind::InvalidValue) == Some("") => {
            let option = text(ContextKind::InvalidArg)?.split(' ').next()?;
            Some(format!("write a value behind {option}, or leave it out"))
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
            Some(format!(
                "--{option} is an option of {}{more}; {see}",
                all.join(", ")
            ))
        }
    }
}

/// What to do about letters behind one dash.
fn one_dash(command: &Command, given: &str, words: &[String]) -> Option<String> {
    let word = words
        .iter()
        .find(|word| word.len() > 2 && word.starts_with(given))?;
    let option = word.trim_start_matches('-').split('=').next()?;
    long(command, option)?;
    Some(format!("long options have two dashes: --{option}"))
}

/// Whether a word names a scene rather than a folder.
fn is_scene(word: &str) -> bool {
    word.ends_with(".toml") || builtins().iter().any(|b| b.name == word)
}

/// The options that a command cannot do without, with their dashes.
fn required(command: &Command) -> impl Iterator<Item = String> + '_ {
    let needed = command.get_arguments().filter(|a| a.is_required_set());
    needed.filter_map(|a| Some(format!("--{}", a.get_long()?)))
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
    let earlier = place.and_then(|at| words.get(at.checked_sub(2)?));
    let list = earlier.and_then(|word| long(command, word.strip_prefix("--")?));
    if let (Some(list), Some(before), Some(earlier)) = (list, before, earlier)
        && list.get_value_delimiter().is_some()
    {
        return format!("several values are separated by commas: {earlier} {before},{given}");
    }
    if long(command, "method").is_some() && given.parse::<Method>().is_ok() {
        return format!("methods stand behind their option: --method {given}");
    }
    if given == "D" {
        return "write it with a dash: -D KEY=VALUE".to_owned();
    }
    // A number whose option was left out.
    let mut lacks = required(command).filter(|name| !words.iter().any(|word| word == name));
    if given.parse::<f64>().is_ok()
        && let Some(option) = lacks.next()
    {
        return format!("write it behind its option: {option} {given}");
    }
    let takes_folder = command.get_arguments().any(|a| a.get_id() == "dir");
    let first = words
        .iter()
        .skip(names.len() - 1)
        .find(|word| !word.starts_with('-'));
    if let Some(first) = first.filter(|first| takes_folder && is_scene(first)) {
        return format!(
            "`{own}` takes the folder of a run, which has its scene: `{own} {given}` without `{first}`"
        );
    }
    if long(command, "against").is_some() && is_scene(given) {
        return format!("to compare with the model of another scene: --against {given}");
    }
    let takes_scene = command.get_arguments().any(|a| a.get_id() == "scene");
    if let Some(first) = first.filter(|first| takes_scene && is_scene(given) && !is_scene(first)) {
        return format!("the scene comes first, the folder behind -o: `{own} {given} -o {first}`");
    }
    if long(command, "output").is_some() {
        return format!("to write into `{given}`, say so: `-o {given}`");
    }
    format!("leave it out; `{own} --help` shows what is taken")
}

/// What to do about a first word that is no command.
fn no_command(root: &Command, word: &str, names: &[String]) -> Option<String> {
    if names.len() > 1 {
        let looks = is_scene(word) && names[1] == "scene";
        return looks.then(|| format!("to look for mistakes in it: `phicam scene check {word}`"));
    }
    if is_scene(word) {
        return Some(format!("to compute this scene: `phicam run {word}`"));
    }
    if STUDIES.iter().any(|study| study.name == word) {
        return Some(format!("that is a study: `phicam study {word}`"));
    }
    if word == "guide" {
        return Some(
            "its pages are in the sources, `src/cli/guide`, and behind links of the README; here \
             `phicam help COMMAND` and `phicam help scene` tell most"
                .to_owned(),
        );
    }
    let scene = root.find_subcommand("scene")?;
    let inner = scene
        .find_subcommand(word)
        .filter(|c| c.get_name() != "help");
    inner.map(|inner| {
        format!(
            "that belongs to scenes: `phicam scene {}`",
            inner.get_name()
        )
    })
}

/// What to do about arguments that are not there.
fn missing(names: &[String], command: &Command, error: &Error) -> Option<String> {
    let own = names.join(" ");
    let Some(ContextValue::Strings(missing)) = error.get(ContextKind::InvalidArg) else {
        return None;
    };
    let lacks = |name: &str| missing.iter().any(|m| m.contains(name));
    if lacks("--camera-side") {
        return Some(
            "give the matrix of which this is a part too: `--camera-side C.npy`".to_owned(),
        );
    }
    if lacks("--output") && long(command, "output").is_some() {
        let what = long(command, "force").map_or("FOLDER", |_| "FILE");
        return Some(format!("say where to write: `{own} … -o {what}`"));
    }
    if lacks("<SCENE>") {
        return Some(format!(
            "name a built-in scene (`phicam scene list`) or a scene file: `{own} bench`"
        ));
    }
    if lacks("<NAME>") && own == "phicam new" {
        return Some("give the scene a name: `phicam new corner`".to_owned());
    }
    if lacks("<DIR>") {
        return Some(format!(
            "name a folder that `phicam run` has written: `{own} out`"
        ));
    }
    let option = required(command).find(|name| lacks(name));
    option.map(|name| format!("give {name} too; `{own} --help` says what it is"))
}
