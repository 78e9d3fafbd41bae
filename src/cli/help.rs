//! `phicam help scene`: the help of the command `scene` and the reference of the scene file, or
//! with a key what the reference says of it.

use clap::{CommandFactory, Parser};

use crate::cli::args::Args;
use crate::cli::failure::{Codes, Failure};
use crate::cli::output;
use crate::scene::reference::{self, Key};

/// Columns of what is printed.
const COLUMNS: usize = 100;

/// Answers `phicam help scene [KEY]`; `None` for any other arguments, of a command's help too.
pub(super) fn answer() -> Option<u8> {
    let words = std::env::args_os().skip(1);
    let words: Vec<String> = words.map(|w| w.to_string_lossy().into_owned()).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let words: Vec<&str> = words
        .into_iter()
        .filter(|w| !["-q", "--quiet"].contains(w))
        .collect();
    let keys = match words[..] {
        ["help", "scene", ref keys @ ..] | ["scene", "help", ref keys @ ..] => keys,
        _ => return None,
    };
    let scene = Args::command();
    let scene = scene.find_subcommand("scene")?;
    let is_command = |word: &&str| *word == "help" || scene.find_subcommand(word).is_some();
    if keys.first().is_some_and(is_command) {
        return None;
    }
    let printed = if keys.is_empty() {
        whole()
    } else {
        of_keys(keys)
    };
    Some(match printed {
        Ok(()) => 0,
        Err(failure) => {
            failure.report();
            failure.code(Codes::Plain)
        }
    })
}

/// The help of the command, and the whole reference.
fn whole() -> Result<(), Failure> {
    if let Err(help) = Args::try_parse_from(["phicam", "help", "scene"]) {
        output::printed(help.print())?;
    }
    output::print(&format!("\n{}", reference_text()))
}

fn of_keys(paths: &[&str]) -> Result<(), Failure> {
    let parts: Result<Vec<String>, Failure> = paths.iter().map(|path| of_key(path)).collect();
    output::print(&parts?.join("\n"))
}

/// What the reference says of a key and of the keys below it.
fn of_key(path: &str) -> Result<String, Failure> {
    let path = path.trim().trim_matches(['[', ']']);
    if ["material", "albedo"].contains(&path) {
        return Ok(all_below(path, path));
    }
    let Some((shown, key)) = reference::find(path) else {
        let cause = format!("a scene file has no key `{path}`");
        let near = reference::nearest(path);
        let cure = match &near[..] {
            [] => "`phicam help scene` lists all keys".to_owned(),
            near => {
                let near: Vec<String> = near
                    .iter()
                    .map(|n| format!("`phicam help scene {n}`"))
                    .collect();
                format!("did you mean {}?", near.join(" or "))
            }
        };
        return Err(Failure::usage(cause, cure));
    };
    let mut text = entry(&shown, key);
    if let Some(units) = key.units() {
        text += &format!("    units: {units}; a bare number is in the one above\n");
    }
    Ok(text + &all_below(&shown, key.inside()))
}

/// The keys below `prefix`, shown below `shown`.
fn all_below(shown: &str, prefix: &str) -> String {
    reference::below(prefix)
        .map(|key| entry(&format!("{shown}{}", &key.path[prefix.len()..]), key))
        .collect()
}

/// A key with its value, default and meaning.
fn entry(path: &str, key: &Key) -> String {
    let default = match key.default {
        "none" => String::new(),
        "required" => ", required".to_owned(),
        "one shape" | "one kind" | "one source" => format!(", exactly {} of these", key.default),
        value => format!(", default {value}"),
    };
    let meaning = wrapped(&plain(key.meaning), 4);
    format!("{path}  ({}{default})\n{meaning}", plain(key.value))
}

/// The reference as text.
fn reference_text() -> String {
    let mut text = String::new();
    let mut paragraph = String::new();
    for line in reference::TEXT.lines().chain([""]) {
        let is_prose = !line.is_empty() && !line.starts_with(['#', '|']);
        if is_prose {
            paragraph = format!("{paragraph} {line}");
            continue;
        }
        if !paragraph.is_empty() {
            text += &(wrapped(&plain(&paragraph), 0) + "\n");
            paragraph.clear();
        }
        if let Some(title) = line.strip_prefix("# ") {
            text += &format!("{}\n\n", title.to_uppercase());
        } else if let Some(key) = reference::row(line) {
            text += &entry(key.path, &key);
        } else if let Some(cells) = line.strip_prefix("| `") {
            let cells = cells.trim_end_matches(" |").replacen('`', "", 1);
            let (first, rest) = cells.split_once(" | ").unwrap_or((&cells, ""));
            text += &format!(
                "{first}\n{}",
                wrapped(&plain(&rest.replace(" | ", ": ")), 4)
            );
        } else if line.is_empty() && text.ends_with("\n") && !text.ends_with("\n\n") {
            text += "\n";
        }
    }
    text.trim_end().to_owned() + "\n"
}

/// Markdown as plain text: links by their names, brackets without backslashes.
fn plain(markdown: &str) -> String {
    let text = markdown.replace("[`", "`").replace("`]", "`");
    text.replace("\\[", "[").replace("\\]", "]")
}

/// `text` in lines of [`COLUMNS`] columns that start with `indent` spaces.
fn wrapped(text: &str, indent: usize) -> String {
    let mut lines = String::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        let length = line.chars().count() + 1 + word.chars().count();
        if !line.is_empty() && indent + length > COLUMNS {
            lines += &format!("{:indent$}{line}\n", "");
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line += word;
    }
    if !line.is_empty() {
        lines += &format!("{:indent$}{line}\n", "");
    }
    lines
}
