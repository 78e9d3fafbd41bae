//! `phicam new`: a scene file to start from.

use std::path::{Path, PathBuf};

use crate::cli::Outcome;
use crate::cli::args::NewArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::scene::{Builtin, builtins};
use crate::store::shell_word;

/// The commented scene.
const START: &str = include_str!("new.toml");

pub(in crate::cli) fn execute(args: &NewArgs, console: Console) -> Result<Outcome, Failure> {
    let path = file(&args.name)?;
    let name = scene_name(&path);
    let text = match &args.from {
        None => renamed(START, &name),
        Some(from) => renamed(builtin(from)?.text, &name),
    };
    output::write_new(&path, text, args.force)?;
    let [word, folder] = [&path.to_string_lossy(), &name[..]].map(shell_word);
    console.say(format!(
        "{}: a scene to start from; `phicam scene check {word}`, then `phicam run {word} -o {folder}`",
        path.display()
    ));
    Ok(Outcome::Done)
}

/// The file of a scene that is called `name`.
fn file(name: &Path) -> Result<PathBuf, Failure> {
    let last = name.file_name().and_then(|last| last.to_str());
    let last = last.filter(|last| !last.starts_with('-') && last.trim() == *last);
    let Some(last) = last else {
        let cause = format!("`{}` is no name of a scene", name.display());
        return Err(Failure::usage(cause, "write it as in `phicam new corner`"));
    };
    Ok(match last.strip_suffix(".toml") {
        Some(_) => name.to_owned(),
        None => name.with_file_name(format!("{last}.toml")),
    })
}

/// What a scene in the file `path` is called.
fn scene_name(path: &Path) -> String {
    path.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

fn builtin(name: &str) -> Result<&'static Builtin, Failure> {
    builtins().iter().find(|b| b.name == name).ok_or_else(|| {
        let names: Vec<&str> = builtins().iter().map(|b| b.name).collect();
        Failure::usage(
            format!("there is no built-in scene `{name}`"),
            format!("use one of {}", names.join(", ")),
        )
    })
}

/// The text of a scene file with another name in its line `name = "…"`.
fn renamed(text: &str, name: &str) -> String {
    let quoted: String = name
        .chars()
        .flat_map(|c| match c {
            '"' | '\\' => vec!['\\', c],
            c if c.is_control() => format!("\\u{:04x}", u32::from(c)).chars().collect(),
            c => vec![c],
        })
        .collect();
    let line = |line: &str| {
        if line.starts_with("name = ") {
            format!("name = \"{quoted}\"\n")
        } else {
            line.to_owned()
        }
    };
    // Names of surfaces stand below the first table.
    let (head, tables) = text.split_at(text.find("\n[").map_or(text.len(), |at| at + 1));
    head.split_inclusive('\n').map(line).collect::<String>() + tables
}
