//! Numbers with units: which units fit a key of the scene file, and the number that a value with
//! one stands for.

use super::unit::Unit;
use crate::num::decimal::Decimal;

/// What a number of a scene file measures, with the unit of a bare number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// In the scene's unit.
    Length,
    /// In the square of the scene's unit.
    Area,
    /// A length in m.
    Metres,
    /// In W.
    Power,
    /// Power by area, in W by the square of the scene's unit.
    Exitance,
    /// In degrees.
    Degrees,
    /// In radians.
    Radians,
    /// In s.
    Time,
    /// In percent.
    Percent,
}

/// A unit: names and size in the unit of its kind, a whole number times a power of ten.
struct Scale {
    names: &'static [&'static str],
    whole: u64,
    tens: i64,
}

const fn scale(names: &'static [&'static str], whole: u64, tens: i64) -> Scale {
    Scale { names, whole, tens }
}

/// In m.
const LENGTHS: [Scale; 7] = [
    scale(&["m"], 1, 0),
    scale(&["cm"], 1, -2),
    scale(&["mm"], 1, -3),
    scale(&["um", "µm", "μm"], 1, -6),
    scale(&["nm"], 1, -9),
    scale(&["in", "in.", "inch"], 254, -4),
    scale(&["ft"], 3048, -4),
];

/// In W.
const POWERS: [Scale; 6] = [
    scale(&["W"], 1, 0),
    scale(&["kW"], 1, 3),
    scale(&["mW"], 1, -3),
    scale(&["uW", "µW", "μW"], 1, -6),
    scale(&["nW"], 1, -9),
    scale(&["pW"], 1, -12),
];

/// In s.
const TIMES: [Scale; 5] = [
    scale(&["s"], 1, 0),
    scale(&["ms"], 1, -3),
    scale(&["us", "µs", "μs"], 1, -6),
    scale(&["min"], 60, 0),
    scale(&["h"], 3600, 0),
];

const DEGREES: [&str; 2] = ["deg", "°"];
const RADIANS: [Scale; 2] = [scale(&["rad"], 1, 0), scale(&["mrad"], 1, -3)];

/// 180/π and π/180, to 60 digits after their first: the nearest double of a product with them is
/// that of the product with the exact number, unless it lies within 10⁻⁴⁰ of a tie.
const DEGREES_OF_A_RADIAN: (&str, i64) = (
    "57295779513082320876798154814105170332405472466564321549160243",
    -60,
);
const RADIANS_OF_A_DEGREE: (&str, i64) = (
    "1745329251994329576923690768488612713442871888541725456097191",
    -62,
);

/// What a unit is in the unit of a bare number: a product of whole numbers over another, times a
/// power of ten.
#[derive(Default)]
struct Factor {
    times: Vec<String>,
    over: Vec<u64>,
    tens: i64,
}

impl Factor {
    fn by(mut self, scale: &Scale) -> Self {
        self.times.push(scale.whole.to_string());
        self.tens += scale.tens;
        self
    }

    fn over(mut self, scale: &Scale) -> Self {
        self.over.push(scale.whole);
        self.tens -= scale.tens;
        self
    }

    fn of(self, (digits, tens): (&str, i64)) -> Self {
        Self {
            times: [self.times, vec![digits.to_owned()]].concat(),
            tens: self.tens + tens,
            ..self
        }
    }

    /// The double nearest to `value` times this factor.
    fn of_value(&self, value: &Decimal) -> f64 {
        let product = self.times.iter().fold(value.clone(), |v, f| v.times(f));
        let shifted = product.shifted(self.tens);
        shifted.over(self.over.iter().product()).nearest()
    }
}

impl Dimension {
    const ALL: [Self; 9] = [
        Self::Length,
        Self::Area,
        Self::Metres,
        Self::Power,
        Self::Exitance,
        Self::Degrees,
        Self::Radians,
        Self::Time,
        Self::Percent,
    ];

    /// The dimension of a bare number's unit as the reference writes it.
    pub(super) fn of_unit(word: &str) -> Option<Self> {
        Some(match word {
            "length" => Self::Length,
            "length²" => Self::Area,
            "m" => Self::Metres,
            "W" => Self::Power,
            "W/length²" => Self::Exitance,
            "deg" => Self::Degrees,
            "rad" => Self::Radians,
            "s" => Self::Time,
            "%" => Self::Percent,
            _ => return None,
        })
    }

    /// What it is called, with its article.
    pub fn name(self) -> &'static str {
        match self {
            Self::Length | Self::Metres => "a length",
            Self::Area => "an area",
            Self::Power => "a power",
            Self::Exitance => "a power by area",
            Self::Degrees | Self::Radians => "an angle",
            Self::Time => "a time",
            Self::Percent => "a percentage",
        }
    }

    /// The unit of a bare number in a scene of this `unit`.
    pub fn bare(self, unit: Unit) -> String {
        match self {
            Self::Length => unit.symbol().to_owned(),
            Self::Area => format!("{}²", unit.symbol()),
            Self::Metres => "m".to_owned(),
            Self::Power => "W".to_owned(),
            Self::Exitance => format!("W/{}²", unit.symbol()),
            Self::Degrees => "deg".to_owned(),
            Self::Radians => "rad".to_owned(),
            Self::Time => "s".to_owned(),
            Self::Percent => "%".to_owned(),
        }
    }

    /// The units that fit, as a list for people.
    pub fn units(self) -> String {
        let first = |scales: &[Scale]| scales.iter().map(|s| s.names[0]).collect::<Vec<_>>();
        match self {
            Self::Length | Self::Metres => first(&LENGTHS).join(", "),
            Self::Area => first(&LENGTHS).join("², ") + "²",
            Self::Power => first(&POWERS).join(", "),
            Self::Exitance => "a power over an area, as W/m² and mW/cm²".to_owned(),
            Self::Degrees | Self::Radians => format!("deg, {}", first(&RADIANS).join(", ")),
            Self::Time => first(&TIMES).join(", "),
            Self::Percent => "%".to_owned(),
        }
    }

    /// What one `name` is as a bare number; `None` for a unit that does not fit.
    fn factor(self, name: &str, unit: Unit) -> Option<Factor> {
        let scene = named(&LENGTHS, unit.symbol())?;
        let none = Factor::default();
        match self {
            Self::Metres => Some(none.by(named(&LENGTHS, name)?)),
            Self::Length => Some(none.by(named(&LENGTHS, name)?).over(scene)),
            Self::Area => {
                let side = squared(name)?;
                Some(none.by(side).by(side).over(scene).over(scene))
            }
            Self::Power => Some(none.by(named(&POWERS, name)?)),
            Self::Exitance => {
                let (power, area) = name.split_once('/')?;
                let (power, side) = (named(&POWERS, power.trim())?, squared(area.trim())?);
                Some(none.by(power).by(scene).by(scene).over(side).over(side))
            }
            Self::Degrees if DEGREES.contains(&name) => Some(none),
            Self::Degrees => Some(none.by(named(&RADIANS, name)?).of(DEGREES_OF_A_RADIAN)),
            Self::Radians if DEGREES.contains(&name) => Some(none.of(RADIANS_OF_A_DEGREE)),
            Self::Radians => Some(none.by(named(&RADIANS, name)?)),
            Self::Time => Some(none.by(named(&TIMES, name)?)),
            Self::Percent => (name == "%").then_some(none),
        }
    }

    /// The bare number that `text`, a number and a unit, stands for in a scene of this `unit`: the
    /// double nearest to the exact product.
    ///
    /// # Errors
    /// [`NoNumber`].
    pub fn number(self, text: &str, unit: Unit) -> Result<f64, NoNumber> {
        let (value, name) = parts(text).ok_or(NoNumber::Text)?;
        if name.is_empty() {
            return Err(NoNumber::Bare);
        }
        if let Some(factor) = self.factor(name, unit) {
            return Ok(factor.of_value(&value));
        }
        let other = Self::ALL
            .into_iter()
            .find(|d| d.factor(name, unit).is_some());
        Err(NoNumber::Unit(name.to_owned(), other))
    }
}

/// Why a text is no number with a unit that fits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoNumber {
    /// It does not start with a number.
    Text,
    /// It has no unit.
    Bare,
    /// This unit does not fit: of which dimension it is, if it is known.
    Unit(String, Option<Dimension>),
}

/// A number and what follows it.
fn parts(text: &str) -> Option<(Decimal, &str)> {
    let text = text.trim();
    // The longest start that is a number: the e of an exponent belongs to it, that of a unit does
    // not.
    let ends = text.char_indices().map(|(i, c)| i + c.len_utf8());
    let ends: Vec<usize> = ends.take(LONGEST).collect();
    ends.into_iter().rev().find_map(|end| {
        let value = Decimal::parse(&text[..end])?;
        Some((value, text[end..].trim()))
    })
}

/// Most characters of a number in a value with a unit.
const LONGEST: usize = 100;

fn named<'a>(scales: &'a [Scale], name: &str) -> Option<&'a Scale> {
    scales.iter().find(|s| s.names.contains(&name))
}

/// The unit of length whose square `name` is.
fn squared(name: &str) -> Option<&'static Scale> {
    let side = ["²", "^2", "2"]
        .iter()
        .find_map(|end| name.strip_suffix(end))?;
    named(&LENGTHS, side)
}

#[cfg(test)]
mod tests;
