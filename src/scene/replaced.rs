//! A scene with other values of some keys.

use toml::{Table, Value};

use super::Scene;
use super::error::SceneError;
use super::files::Files;

/// Characters of changes that an error repeats.
const MOST_LISTED: usize = 100;

impl Scene {
    /// The same scene with other values of some keys: (key, value as TOML). Keys are names parted
    /// by dots; a table of a list is named by its `name` or by its number from 0.
    ///
    /// ```
    /// use phicam::scene::Scene;
    ///
    /// let bench = Scene::load("bench")?;
    /// let other = bench.with(&[("camera.pixels", "[8, 4]"), ("surface.wall.material.lambertian", "0.5")])?;
    /// assert_eq!(other.camera.pixels(), 32);
    /// # Ok::<(), phicam::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError`]: no such table, no such value in TOML, or what the scene then has wrong,
    /// without a line, for the text with the new values is nobody's file.
    pub fn with(&self, changes: &[(&str, &str)]) -> Result<Self, SceneError> {
        let mut document: Value =
            super::read_toml(&self.name, &self.text, "export the scene again")?;
        for (key, value) in changes {
            let fault = |cause, cure| SceneError {
                source: self.name.clone(),
                place: None,
                cause,
                cure,
            };
            let value = parsed(value).ok_or_else(|| {
                let cause = format!("`{value}` for `{key}` is no value in TOML");
                fault(
                    cause,
                    "write text in quotes: \"matt\"; lists in brackets: [32, 32]".to_owned(),
                )
            })?;
            set(&mut document, key, value).map_err(|(cause, cure)| fault(cause, cure))?;
        }
        let text = super::parse::write(&self.name, &document)?;
        let read = Self::read(&self.name, &text, Files::from(self.folders.clone()));
        read.map_err(|error| SceneError {
            source: format!("{} with {}", self.name, listed(changes)),
            place: None,
            ..error
        })
    }

    /// The scene of another text, which reads its files where this one does.
    ///
    /// # Errors
    /// [`SceneError`] with line, cause and cure.
    pub fn remade(&self, text: &str) -> Result<Self, SceneError> {
        Self::read(&self.name, text, Files::from(self.folders.clone()))
    }
}

/// The changes in words, of long ones the keys.
fn listed(changes: &[(&str, &str)]) -> String {
    let each = changes.iter().map(|(key, value)| format!("{key}={value}"));
    let all = each.collect::<Vec<_>>().join(", ");
    if all.chars().count() <= MOST_LISTED {
        all
    } else {
        let keys = changes.iter().map(|(key, _)| *key);
        format!("other values of {}", keys.collect::<Vec<_>>().join(", "))
    }
}

/// The value that TOML text stands for.
fn parsed(text: &str) -> Option<Value> {
    let line: Table = toml::from_str(&format!("value = {text}")).ok()?;
    // More than one line would be more than one key.
    (line.len() == 1)
        .then(|| line.into_iter().next())
        .flatten()
        .map(|(_, value)| value)
}

/// Puts `value` in the place below `at` that `key` names; what is wrong, and the cure.
fn set(at: &mut Value, key: &str, value: Value) -> Result<(), (String, String)> {
    let (step, rest) = key
        .split_once('.')
        .map_or((key, None), |(s, r)| (s, Some(r)));
    if step.is_empty() {
        let cure = "write keys as in camera.pixels or surface.wall.material";
        return Err((
            "a key has no name between its dots".to_owned(),
            cure.to_owned(),
        ));
    }
    let inner = match at {
        Value::Table(table) => {
            let none = || Value::Table(Table::new());
            table.entry(step).or_insert_with(none)
        }
        Value::Array(list) => entry(list, step)?,
        other => {
            let cause = format!("`{step}` is looked for in `{other}`, which has no keys");
            return Err((
                cause,
                "name the whole table: its key without the rest".to_owned(),
            ));
        }
    };
    match rest {
        Some(rest) => set(inner, rest, value),
        None => {
            *inner = value;
            Ok(())
        }
    }
}

/// The entry of a list that has the name or the number `step`.
fn entry<'a>(list: &'a mut [Value], step: &str) -> Result<&'a mut Value, (String, String)> {
    let name = |value: &Value| value.get("name").and_then(Value::as_str).map(str::to_owned);
    let names: Vec<String> = list.iter().filter_map(name).collect();
    let named = list
        .iter()
        .position(|value| name(value).as_deref() == Some(step));
    let found = named.or_else(|| step.parse().ok().filter(|i| *i < list.len()));
    let count = list.len();
    let cause = format!("no entry of the list is called `{step}`");
    let cure = if names.is_empty() {
        format!("use a number below {count}")
    } else {
        format!("use one of {}, or a number below {count}", names.join(", "))
    };
    found.and_then(|i| list.get_mut(i)).ok_or((cause, cure))
}

/// Whether `text` is a number and a unit, as 5 mW.
fn has_unit(text: &str) -> bool {
    let is_of_a_number = |c: char| c.is_ascii_digit() || "+-.".contains(c);
    let rest = text.trim_start_matches(is_of_a_number);
    let digits = &text[..text.len() - rest.len()];
    // Of a number with an exponent the unit follows that.
    let exponent = rest
        .strip_prefix(['e', 'E'])
        .map(|r| (r, r.trim_start_matches(is_of_a_number)));
    let unit = match exponent {
        Some((whole, after)) if whole.len() > after.len() => after,
        _ => rest,
    };
    let unit = unit.trim();
    let starts_a_unit = |c: char| c.is_alphabetic() || "°%".contains(c);
    let is_of_a_base = digits == "0" && unit.starts_with(['x', 'o', 'b']);
    digits.contains(|c: char| c.is_ascii_digit())
        && unit.starts_with(starts_a_unit)
        && !is_of_a_base
}

/// A value as TOML from what a user writes: words, and numbers with units, need no quotes there.
pub fn quoted(value: &str) -> String {
    let is_of_a_word = |c: char| c.is_alphabetic() || "_-".contains(c);
    let is_word = !value.is_empty() && value.chars().all(is_of_a_word);
    let known = ["true", "false", "nan", "inf", "-inf"].contains(&value);
    if (is_word && !known) || has_unit(value) {
        format!("\"{value}\"")
    } else {
        value.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bench() -> Scene {
        Scene::load("bench").unwrap()
    }

    /// The file's own keys, written by hand, make the same scene.
    #[test]
    fn a_replaced_key_is_that_of_a_file() {
        let text = bench().text.replace("pixels = [16, 16]", "pixels = [8, 4]");
        let by_hand = Scene::from_toml("bench", &text).unwrap();
        let replaced = bench().with(&[("camera.pixels", "[8, 4]")]).unwrap();
        assert_ne!(by_hand.hash, bench().hash);
        assert_eq!(replaced.hash, by_hand.hash);
    }

    #[test]
    fn entries_of_lists_have_names_and_numbers() {
        let by = |key| bench().with(&[(key, "0.25")]).unwrap().hash;
        let named = by("surface.wall.material.lambertian");
        assert_eq!(named, by("surface.0.material.lambertian"));
        assert_ne!(named, bench().hash);
    }

    #[test]
    fn what_cannot_be_is_told_with_a_cure() {
        for (key, value, cause, cure) in [
            ("camera.pixels", "[8, ", "no value in TOML", "brackets"),
            (
                "camera.pixels",
                "1\nname = 2",
                "no value in TOML",
                "brackets",
            ),
            ("camera.pixel", "[8, 8]", "unknown field `pixel`", "pixels"),
            ("surface.door.material", "1", "called `door`", "wall"),
            ("unit.of.length", "1", "has no keys", "whole table"),
            ("camera..pixels", "1", "no name", "camera.pixels"),
            ("camera.pixels", "[0, 8]", "pixel", "1"),
        ] {
            let error = bench().with(&[(key, value)]).unwrap_err();
            assert!(error.cause.contains(cause), "{key}: {}", error.cause);
            assert!(error.cure.contains(cure), "{key}: {}", error.cure);
            assert_eq!(error.place, None);
        }
    }

    /// No line of a text that nobody wrote: what was changed.
    #[test]
    fn what_is_wrong_is_told_with_what_was_changed() {
        let error = |value: &str| bench().with(&[("camera.pixels", value)]).unwrap_err();
        let told = error("[0, 8]").to_string();
        assert!(
            told.starts_with("bench with camera.pixels=[0, 8]: 0 × 8 pixels\n  cure: "),
            "{told}"
        );
        let told = error(&format!("[0, 8{}]", " ".repeat(100))).to_string();
        assert!(
            told.starts_with("bench with other values of camera.pixels: "),
            "{told}"
        );
    }

    #[test]
    fn files_are_read_where_they_were() {
        let dir = tempfile::tempdir().unwrap();
        let text = bench().text;
        std::fs::write(dir.path().join("own.toml"), text).unwrap();
        let path = dir.path().join("own.toml");
        let scene = Scene::load(&path.to_string_lossy()).unwrap();
        let picture = [(
            "surface.object.material.lambertian",
            "{ image = \"absent.png\" }",
        )];
        let error = scene.with(&picture).unwrap_err();
        assert!(error.to_string().contains("absent.png"), "{error}");
    }
}
