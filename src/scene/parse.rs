//! TOML text ↔ tables, with line, column and the nearest known key in every error.

use std::ops::Range;

use serde::Serialize;
use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

use super::error::{Fault, Place, SceneError, Step};

/// Parses the text of a scene file; `source` names it in errors.
pub(super) fn parse<T: DeserializeOwned>(source: &str, text: &str) -> Result<T, SceneError> {
    read_toml(
        source,
        text,
        "`phicam scene export bench` shows a whole scene",
    )
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
        let message = e.message().trim().replace('\n', "; ");
        SceneError {
            source: source.to_owned(),
            place: e.span().map(|span| Place::new(text, &span)),
            cure: cure(&message, example),
            cause: message,
        }
    })
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
    SceneError {
        source: source.to_owned(),
        place,
        cause: fault.cause,
        cure: fault.cure,
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

/// What to do about a message of the TOML reader.
fn cure(message: &str, example: &str) -> String {
    let mut quoted = message.split('`').skip(1).step_by(2);
    let unknown = message.starts_with("unknown field") || message.starts_with("unknown variant");
    let missing = message.starts_with("missing field");
    let first = quoted.next();
    let known: Vec<&str> = quoted.collect();
    match first {
        Some(word) if unknown => {
            let nearest = known
                .iter()
                // A word of a megabyte is near to none of them.
                .filter(|k| word.len() <= 2 * k.len())
                .map(|k| (strsim::damerau_levenshtein(word, k), *k))
                .min_by_key(|(distance, _)| *distance);
            match nearest {
                Some((distance, k)) if distance <= word.len().max(k.len()) / 2 => {
                    format!("did you mean `{k}`? ({example})")
                }
                _ if known.is_empty() => format!("remove `{word}`"),
                _ => format!("remove it, or use one of {}", known.join(", ")),
            }
        }
        Some(word) if missing => {
            format!("add `{word} = …` here ({example})")
        }
        _ => format!("write it as in one that works: {example}"),
    }
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
            ("power = 5.0e-3", "power = \"5 mW\""),
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
