//! What to do about what the TOML reader says is wrong.

use super::reference;

/// What to do about a message of the reader that blames the key at `path`.
pub(super) fn cure_of_key(message: &str, path: &str) -> String {
    let parent = path.rsplit_once('.').map_or("", |(parent, _)| parent);
    let below =
        |table: &str, key: &str| format!("{table}.{key}").trim_start_matches('.').to_owned();
    let see = |path: &str| {
        let command = reference::command(path);
        command.unwrap_or_else(|| "`phicam help scene`".to_owned())
    };
    match Remark::of(message) {
        Remark::UnknownKey(word, known) => match nearest(word, &known) {
            Some(key) => format!("did you mean `{key}`? {}", see(&below(parent, key))),
            None => match elsewhere(word) {
                Some(path) => format!("its place is `{path}`; {}", see(&path)),
                None => format!("{}; {}", instead(word, &known), see(parent)),
            },
        },
        Remark::UnknownValue(word, known) => match nearest(word, &known) {
            Some(value) => format!("did you mean `{value}`? {}", see(path)),
            None => format!("use one of {}; {}", known.join(", "), see(path)),
        },
        Remark::Missing(word) => {
            format!("add `{word} = …` here; {}", see(&below(path, word)))
        }
        Remark::Other => match reference::find(path) {
            Some((shown, key)) => {
                let value = key.value;
                format!("write `{shown}` as {value}; `phicam help scene {shown}`")
            }
            None => format!("write it as the reference says; {}", see(path)),
        },
    }
}

/// The key of that name in another table, if there is one alone.
fn elsewhere(word: &str) -> Option<String> {
    let own = |path: &String| path.rsplit('.').next() == Some(word);
    match &reference::nearest(word)[..] {
        [path] if own(path) => Some(path.clone()),
        _ => None,
    }
}

/// What a message of the TOML reader says.
enum Remark<'a> {
    /// A key, and those that are known.
    UnknownKey(&'a str, Vec<&'a str>),
    /// A value, and those that are known.
    UnknownValue(&'a str, Vec<&'a str>),
    /// A key that has to be there.
    Missing(&'a str),
    /// Anything else.
    Other,
}

impl<'a> Remark<'a> {
    fn of(message: &'a str) -> Self {
        let mut quoted = message.split('`').skip(1).step_by(2);
        let Some(first) = quoted.next() else {
            return Self::Other;
        };
        if message.starts_with("unknown field") {
            Self::UnknownKey(first, quoted.collect())
        } else if message.starts_with("unknown variant") {
            Self::UnknownValue(first, quoted.collect())
        } else if message.starts_with("missing field") {
            Self::Missing(first)
        } else {
            Self::Other
        }
    }
}

/// The word of `known` that is near to `word`, if one is.
fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let near = known
        .iter()
        // A word of a megabyte is near to none of them.
        .filter(|k| word.len() <= 2 * k.len())
        .map(|k| (strsim::damerau_levenshtein(word, k), *k))
        .min_by_key(|(distance, _)| *distance);
    near.filter(|(distance, k)| *distance <= word.len().max(k.len()) / 2)
        .map(|(_, k)| k)
}

/// What to do about a key that is not known nor near to one that is.
fn instead(word: &str, known: &[&str]) -> String {
    if known.is_empty() {
        format!("remove `{word}`")
    } else {
        format!("remove it, or use one of {}", known.join(", "))
    }
}

/// What to do about a message of the TOML reader.
pub(super) fn cure(message: &str, example: &str) -> String {
    match Remark::of(message) {
        Remark::UnknownKey(word, known) | Remark::UnknownValue(word, known) => {
            match nearest(word, &known) {
                Some(k) => format!("did you mean `{k}`? ({example})"),
                None => instead(word, &known),
            }
        }
        Remark::Missing(word) => format!("add `{word} = …` here ({example})"),
        Remark::Other => format!("write it as in one that works: {example}"),
    }
}
