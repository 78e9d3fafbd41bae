//! TOML text ↔ tables, with line, column and the nearest known key in every error.

use std::ops::Range;

use serde::Serialize;
use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

use super::cure::{cure, cure_of_key};
use super::error::{Fault, Place, SceneError, Step};
use super::{reference, units};

/// Reads the text of a scene file, and returns with it the text in which values with units are
/// numbers; `source` names it in errors.
pub(super) fn parse<T: DeserializeOwned>(
    source: &str,
    text: &str,
) -> Result<(T, String), SceneError> {
    let converted = units::convert(source, text)?;
    match toml::from_str(&converted.text) {
        Ok(file) => Ok((file, converted.text)),
        Err(e) => {
            let message = message(&e);
            let path = DeTable::parse(&converted.text).ok().map(|document| {
                let at = e.span().map_or(0, |span| span.start);
                path_at(document.get_ref(), at)
            });
            let example = "`phicam scene export bench` shows a whole scene";
            let cure = path.map_or_else(
                || cure(&message, example),
                |path| cure_of_key(&message, &path),
            );
            let given = |at: usize| converted.given(at);
            let span = e.span().map(|span| given(span.start)..given(span.end));
            Err(SceneError {
                source: source.to_owned(),
                place: span.map(|span| Place::new(text, &span)),
                cause: message,
                cure,
            })
        }
    }
}

/// What the TOML reader says is wrong, on one line.
fn message(error: &toml::de::Error) -> String {
    let message = error.message().trim().replace('\n', "; ");
    let words = [
        ("expected f64", "expected a number"),
        ("expected u32", "expected a whole number"),
        ("expected u64", "expected a whole number"),
        (
            "invalid mantissa, expected digits",
            "no digits before the point (0.2 is written so, not .2)",
        ),
        (
            "invalid fraction, expected digits",
            "no digits after the point (2.0 is written so, not 2.)",
        ),
        (
            "unexpected key or value, expected newline, `#`",
            "something follows the value (a decimal comma is a point here: 1.5)",
        ),
    ];
    let all = words.into_iter();
    all.fold(message, |message, (old, new)| message.replace(old, new))
}

/// Parses TOML text; `source` names it in errors, and `example` says where a right one is shown.
///
/// # Errors
/// [`SceneError`] with line, cause and cure.
pub fn read_toml<T: DeserializeOwned>(
    source: &str,
    text: &str,
    example: &str,
) -> Result<T, SceneError> {
    toml::from_str(text).map_err(|e| {
        let message = message(&e);
        SceneError {
            source: source.to_owned(),
            place: e.span().map(|span| Place::new(text, &span)),
            cure: cure(&message, example),
            cause: message,
        }
    })
}

/// The keys that lead to byte `at` of a document's text, parted by dots; those of lists' entries
/// left out.
fn path_at(document: &DeTable<'_>, at: usize) -> String {
    fn search(table: &DeTable<'_>, at: usize, path: &str, found: &mut String) {
        for (key, value) in table {
            let path = format!("{path}.{}", key.get_ref());
            if key.span().contains(&at) || value.span().contains(&at) {
                found.clone_from(&path);
            }
            within(value.get_ref(), at, &path, found);
        }
    }
    fn within(value: &DeValue<'_>, at: usize, path: &str, found: &mut String) {
        match value {
            DeValue::Table(table) => search(table, at, path, found),
            DeValue::Array(list) => {
                for entry in list {
                    if entry.span().contains(&at) {
                        path.clone_into(found);
                    }
                    within(entry.get_ref(), at, path, found);
                }
            }
            _ => {}
        }
    }
    let mut found = String::new();
    search(document, at, "", &mut found);
    found.trim_start_matches('.').to_owned()
}

/// The text of a scene file; `source` names it in errors.
pub(super) fn write(source: &str, file: &impl Serialize) -> Result<String, SceneError> {
    toml::to_string(file).map_err(|e| SceneError {
        source: source.to_owned(),
        place: None,
        cause: format!("TOML cannot hold this scene: {e}"),
        cure: "use whole numbers below 2⁶³".to_owned(),
    })
}

/// Names the place in `text` that a fault blames: the longest part of its path that exists there.
pub(super) fn locate(source: &str, text: &str, fault: Fault) -> SceneError {
    let place = DeTable::parse(text).ok().and_then(|document| {
        let root = DeValue::Table(document.into_inner());
        span(&root, &fault.path).map(|s| Place::new(text, &s))
    });
    let keys = fault.path.iter().filter_map(|step| match step {
        Step::Key(key) => Some(*key),
        Step::Index(_) => None,
    });
    let path = keys.collect::<Vec<_>>().join(".");
    let command = reference::command(&path);
    SceneError {
        source: source.to_owned(),
        place,
        cause: fault.cause,
        cure: match command {
            Some(command) => format!("{}; {command}", fault.cure),
            None => fault.cure,
        },
    }
}

fn span(value: &DeValue<'_>, path: &[Step]) -> Option<Range<usize>> {
    let (first, rest) = path.split_first()?;
    let inner = match (first, value) {
        (Step::Key(key), DeValue::Table(table)) => table.get(*key)?,
        (Step::Index(i), DeValue::Array(array)) => array.get(*i)?,
        _ => return None,
    };
    span(inner.get_ref(), rest).or_else(|| Some(inner.span()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::file::SceneFile;

    const BENCH: &str = include_str!("../../scenes/bench.toml");

    fn error(text: &str) -> SceneError {
        parse::<SceneFile>("my.toml", text).unwrap_err()
    }

    #[test]
    fn an_unknown_key_is_named_with_its_line_and_nearest_key() {
        let text = BENCH.replacen("aperture_area", "apperture_area", 1);
        let line = text.lines().position(|l| l.contains("apperture")).unwrap() + 1;
        let error = error(&text);
        assert_eq!(error.place.as_ref().unwrap().line, line);
        assert!(error.cure.contains("`aperture_area`"), "{error}");
        assert!(
            error.to_string().starts_with(&format!("my.toml:{line}:")),
            "{error}"
        );
    }

    #[test]
    fn unknown_keys_are_found_at_every_depth() {
        for (old, new, nearest) in [
            ("half_width", "halfwidth", "`half_width`"),
            ("\"square\"", "\"sqare\"", "`square`"),
            ("lambertian =", "lambertain =", "`lambertian`"),
            ("{ checkerboard", "{ chekerboard", "`checkerboard`"),
            ("max_bounces", "max_bounce", "`max_bounces`"),
            ("unit = \"in\"", "unit = \"inch\"", "`in`"),
        ] {
            let text = BENCH.replacen(old, new, 1);
            assert_ne!(text, BENCH, "{old}");
            let error = error(&text);
            assert!(error.place.is_some(), "{new}: {error}");
            assert!(error.cure.contains(nearest), "{new}: {error}");
        }
    }

    #[test]
    fn wrong_types_and_missing_keys_have_their_line() {
        for (old, new) in [
            ("power = 5.0e-3", "power = \"much\""),
            ("pixels = [16, 16]", "pixels = 16"),
        ] {
            let text = BENCH.replacen(old, new, 1);
            assert_ne!(text, BENCH, "{old}");
            let error = error(&text);
            assert_eq!(
                error.place.unwrap().text.trim(),
                text.lines().find(|l| l.contains(new)).unwrap().trim()
            );
        }
        let error = error("name = \"x\"\nunit = \"in\"\n");
        assert!(error.cause.contains("missing field"), "{error}");
    }

    #[test]
    fn a_fault_is_located_by_its_path() {
        let path = super::super::error::keys!["camera", "view", "x"];
        let error = locate("my.toml", BENCH, Fault::new(path, "", ""));
        assert!(error.place.unwrap().text.contains("view"));
        let path = super::super::error::keys!["surface", 1usize, "name"];
        let error = locate("my.toml", BENCH, Fault::new(path, "", ""));
        assert!(error.place.unwrap().text.contains("object"));
    }
}
