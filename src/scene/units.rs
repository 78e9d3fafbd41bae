//! Values with units in the text of a scene file, and the text with numbers in their place.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::dimension::{Dimension, NoNumber};
use super::error::{Place, SceneError};
use super::reference::{self, Key};
use super::unit::Unit;

/// The text of a scene file in which every value with a unit is a number.
#[derive(Debug, Default)]
pub(super) struct Converted {
    /// That text, of as many lines.
    pub text: String,
    /// Where values stood, and how long the numbers are that stand there now.
    replaced: Vec<(Range<usize>, usize)>,
}

impl Converted {
    /// The place in the text as it was given of byte `at` of [`Converted::text`].
    pub(super) fn given(&self, at: usize) -> usize {
        let mut shift = 0_isize;
        for (range, length) in &self.replaced {
            let start = range.start.saturating_add_signed(shift);
            if at < start {
                break;
            }
            if at < start + length {
                return range.start;
            }
            shift += length.cast_signed() - range.len().cast_signed();
        }
        at.saturating_add_signed(-shift)
    }
}

/// Converts the values with units of a scene file; `source` names it in errors. What is no TOML is
/// left as it is.
///
/// # Errors
/// [`SceneError`]: a unit of another dimension, or none.
pub(super) fn convert(source: &str, text: &str) -> Result<Converted, SceneError> {
    let mut found = Found::default();
    if let Ok(document) = DeTable::parse(text) {
        let table = document.get_ref();
        let unit = table.get("unit").and_then(|unit| unit.get_ref().as_str());
        // A file without a unit that there is is refused by who reads it on.
        let units = [Unit::Metre, Unit::Centimetre, Unit::Millimetre, Unit::Inch];
        found.unit = units.into_iter().find(|u| Some(u.symbol()) == unit);
        found.in_table(table, None);
    }
    if let Some((span, key, text_there, dimension, why)) = found.wrong {
        let (cause, cure) = refused(&text_there, &key, dimension, &why, found.unit);
        return Err(SceneError {
            source: source.to_owned(),
            place: Some(Place::new(text, &span)),
            cause,
            cure,
        });
    }
    let mut numbers = found.numbers;
    numbers.sort_by_key(|(span, _)| span.start);
    let mut converted = Converted::default();
    let mut done = 0;
    for (span, number) in numbers {
        converted.text += &text[done..span.start];
        converted.text += &number;
        done = span.end;
        converted.replaced.push((span, number.len()));
    }
    converted.text += &text[done..];
    Ok(converted)
}

/// What the values of a document are.
#[derive(Default)]
struct Found {
    unit: Option<Unit>,
    /// Values with units, and the numbers that they stand for.
    numbers: Vec<(Range<usize>, String)>,
    /// The first that cannot be converted: where it stands, its key, itself.
    wrong: Option<(Range<usize>, String, String, Dimension, NoNumber)>,
}

impl Found {
    fn in_table(&mut self, table: &DeTable<'_>, outer: Option<&Key>) {
        for (step, value) in table {
            let step = step.get_ref();
            if let Some(key) = reference::inside(outer, step) {
                let beside = |other: &str| table.contains_key(other);
                self.in_value(value, key, key.dimension(step, beside));
            }
        }
    }

    fn in_value(&mut self, value: &Spanned<DeValue<'_>>, key: &Key, dimension: Option<Dimension>) {
        match (value.get_ref(), dimension) {
            (DeValue::Table(table), _) => self.in_table(table, Some(key)),
            (DeValue::Array(list), _) => {
                for value in list {
                    self.in_value(value, key, dimension);
                }
            }
            (DeValue::String(text), Some(dimension)) => {
                match dimension.number(text, self.unit.unwrap_or(Unit::Metre)) {
                    // As Rust writes a double: the shortest digits that are read as the same one.
                    Ok(number) => self.numbers.push((value.span(), format!("{number:?}"))),
                    // No number at all: the reader of the tables says what it expects.
                    Err(NoNumber::Text) => {}
                    Err(why) if self.wrong.is_none() => {
                        let (key, text) = (key.path.to_owned(), text.to_string());
                        self.wrong = Some((value.span(), key, text, dimension, why));
                    }
                    Err(_) => {}
                }
            }
            _ => {}
        }
    }
}

/// Cause and cure of a value that is no number with a unit that fits.
fn refused(
    text: &str,
    path: &str,
    dimension: Dimension,
    why: &NoNumber,
    unit: Option<Unit>,
) -> (String, String) {
    let path = reference::example(path);
    let (name, units) = (dimension.name(), dimension.units());
    let cause = match why {
        NoNumber::Bare | NoNumber::Text => format!("\"{text}\" has no unit"),
        NoNumber::Unit(_, Some(other)) => {
            format!("\"{text}\" is {}, and `{path}` is {name}", other.name())
        }
        NoNumber::Unit(given, None) => {
            format!("there is no unit `{given}`, and `{path}` is {name}")
        }
    };
    let bare = unit.map_or_else(String::new, |unit| {
        format!(" (then in {})", dimension.bare(unit))
    });
    let command = reference::command(&path).unwrap_or_default();
    let cure = format!("use {units}, or a number without quotes{bare}; {command}");
    (cause, cure)
}

#[cfg(test)]
mod tests;
