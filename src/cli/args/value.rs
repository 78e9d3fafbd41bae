//! Values with a grammar of their own.

use std::ops::Range;
use std::path::PathBuf;

use clap::builder::{PathBufValueParser, TypedValueParser};

use crate::num::decimal::Decimal;
use crate::scene::{Dimension, Unit, quoted};

/// A folder that is there.
pub(super) fn folder() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| {
        let there = path.is_dir();
        there
            .then_some(path)
            .ok_or("there is no such folder: check the name, it is relative to where you are")
    })
}

/// A whole number, 0 or more, as 10000 or 1e4.
pub(super) fn whole(text: &str) -> Result<u64, String> {
    let number = Decimal::parse(text).and_then(|n| n.whole());
    number.ok_or_else(|| "write a whole number, 0 or more, as 512 or 1e4".to_owned())
}

/// The same of the machine's word.
pub(super) fn count(text: &str) -> Result<usize, String> {
    let number = whole(text)?;
    usize::try_from(number).map_err(|_| "write a smaller number".to_owned())
}

/// The same below 2³².
pub(super) fn small(text: &str) -> Result<u32, String> {
    let number = whole(text)?;
    u32::try_from(number).map_err(|_| "write a number below 2³²".to_owned())
}

/// A time in s: a bare number, or one with its unit.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    text.trim()
        .parse()
        .or_else(|_| Dimension::Time.number(text, Unit::Metre))
        .map_err(|_| {
            let units = Dimension::Time.units();
            format!("write a number of seconds or one with a unit ({units}), as 0.1 or 100ms")
        })
}

/// "A..B" with A < B.
pub(super) fn spot_range(text: &str) -> Result<Range<usize>, String> {
    let parts = text
        .split_once("..")
        .and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    match (parts, last_included(text)) {
        (Some((a, b)), _) if a < b => Ok(a..b),
        (_, Some([a, b])) => {
            let end = b + 1;
            Err(format!(
                "spots {a} to {b} are {a}..{end}: A..B is A to B − 1"
            ))
        }
        _ => Err(
            "write it as A..B with A < B, spots A to B − 1, e.g. 0..30 for the first thirty"
                .to_owned(),
        ),
    }
}

/// The ends of "A-B", as other programs write a range.
fn last_included(text: &str) -> Option<[usize; 2]> {
    let (a, b) = text.split_once('-')?;
    let ends = [a.parse().ok()?, b.parse().ok()?];
    (ends[0] <= ends[1] && ends[1] < usize::MAX).then_some(ends)
}

/// "KEY=VALUE", the value as TOML, a word, a number with a unit, or a list of these.
pub(super) fn definition(text: &str) -> Result<(String, String), String> {
    let (key, value) = text
        .split_once('=')
        .ok_or("write it as KEY=VALUE, e.g. camera.pixels=[32,32]")?;
    let (key, value) = (key.trim(), value.trim());
    if key.is_empty() || value.is_empty() {
        return Err("write it as KEY=VALUE, e.g. laser.power=5mW".to_owned());
    }
    let is_plain_list = value.starts_with('[') && !value.contains(['"', '\'', '{']);
    let value = if is_plain_list {
        let entry = |part: &str| {
            let inner = part.trim_end_matches([',', ']']);
            let (inner, end) = part.split_at(inner.len());
            let start = inner.len() - inner.trim_start_matches(['[', ' ']).len();
            let (start, inner) = inner.split_at(start);
            format!("{start}{}{end}", quoted(inner.trim_end()))
        };
        value.split_inclusive([',', ']']).map(entry).collect()
    } else {
        quoted(value)
    };
    Ok((key.to_owned(), value))
}

/// "N" or "NxM", both from 1 to 1024.
pub(super) fn elements(text: &str) -> Result<[usize; 2], String> {
    let (a, b) = text.split_once('x').unwrap_or((text, text));
    sides([a, b], 1024).ok_or_else(|| "write it as 8 or 8x6, 1 to 1024 a side".to_owned())
}

/// "W,H", both from 1 to 4096.
pub(super) fn size(text: &str) -> Result<[usize; 2], String> {
    let parts = text.split_once(',');
    parts
        .and_then(|(w, h)| sides([w.trim(), h.trim()], 4096))
        .ok_or_else(|| "write it as W,H, e.g. 47,31, 1 to 4096 a side".to_owned())
}

/// Two whole numbers from 1 to `most`.
fn sides([a, b]: [&str; 2], most: usize) -> Option<[usize; 2]> {
    let sides = [a.parse().ok()?, b.parse().ok()?];
    sides
        .iter()
        .all(|n| (1..=most).contains(n))
        .then_some(sides)
}

/// "DX,DY", finite.
pub(super) fn shift(text: &str) -> Result<[f64; 2], String> {
    numbers(text).ok_or_else(|| "write it as DX,DY, e.g. 0.05,0".to_owned())
}

/// "LOW,HIGH" or "LOW..HIGH", finite, LOW < HIGH.
pub(super) fn range(text: &str) -> Result<[f64; 2], String> {
    numbers(&text.replacen("..", ",", 1))
        .filter(|[low, high]| low < high)
        .ok_or_else(|| "write it as LOW,HIGH with LOW below HIGH, e.g. -0.5,2".to_owned())
}

/// "X,Y,Z", finite.
pub(super) fn point(text: &str) -> Result<[f64; 3], String> {
    numbers(text).ok_or_else(|| "write it as X,Y,Z, e.g. 5,-8,12".to_owned())
}

/// "DARK,LIGHT", 0 ≤ DARK < LIGHT ≤ 1.
pub(super) fn levels(text: &str) -> Result<[f64; 2], String> {
    numbers(text)
        .filter(|[dark, light]| 0.0 <= *dark && dark < light && *light <= 1.0)
        .ok_or_else(|| "write it as DARK,LIGHT with 0 ≤ DARK < LIGHT ≤ 1, e.g. 0.05,0.9".to_owned())
}

/// Finite numbers, separated by commas.
fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let number = |s: &str| s.trim().parse().ok().filter(|x: &f64| x.is_finite());
    let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
    numbers?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_may_have_an_exponent() {
        assert_eq!(whole("1e4"), Ok(10_000));
        assert_eq!(whole("1.5e3"), Ok(1_500));
        for bad in ["1.5", "-5", "", "abc", "1e-1", "1e30", "0x10"] {
            assert!(whole(bad).is_err_and(|why| why.contains("1e4")), "{bad}");
        }
        assert!(small("4294967296").is_err());
    }

    #[test]
    fn times_may_have_a_unit() {
        for (text, time) in [("100ms", 0.1), ("2 s", 2.0), ("0.5", 0.5), ("1.5min", 90.0)] {
            assert_eq!(seconds(text), Ok(time), "{text}");
        }
        for bad in ["5 mW", "fast", "", "1:30"] {
            assert!(
                seconds(bad).is_err_and(|why| why.contains("100ms")),
                "{bad}"
            );
        }
    }

    #[test]
    fn words_and_units_of_definitions_need_no_quotes() {
        for (given, value) in [
            ("5 mW", "\"5 mW\""),
            ("632.8nm", "\"632.8nm\""),
            ("1e-3 W", "\"1e-3 W\""),
            ("-45°", "\"-45°\""),
            ("[1 m, -20cm,0]", "[\"1 m\", \"-20cm\",0]"),
            ("[[1 m, 2],[3, 4 in]]", "[[\"1 m\", 2],[3, \"4 in\"]]"),
            ("[\"1 m\", 0]", "[\"1 m\", 0]"),
            ("matt", "\"matt\""),
            ("5", "5"),
            ("1e-3", "1e-3"),
            ("0x1f", "0x1f"),
            ("inf", "inf"),
            ("true", "true"),
            ("[32,32]", "[32,32]"),
            ("{ x = 1 }", "{ x = 1 }"),
        ] {
            let text = format!("a.b = {given}");
            assert_eq!(
                definition(&text),
                Ok(("a.b".to_owned(), value.to_owned())),
                "{given}"
            );
        }
        for bad in ["a.b", "=5", "a.b="] {
            assert!(definition(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn ranges_elements_and_shifts_are_strict() {
        assert_eq!(spot_range("3..7"), Ok(3..7));
        assert_eq!(elements("8"), Ok([8, 8]));
        assert_eq!(elements("8x6"), Ok([8, 6]));
        assert_eq!(shift("-0.05, 1e-3"), Ok([-0.05, 1e-3]));
        for bad in ["7..3", "3..3", "3", "a..b", "-1..2"] {
            assert!(spot_range(bad).is_err(), "{bad}");
        }
        for bad in ["0", "8x0", "2000", "x", ""] {
            assert!(elements(bad).is_err(), "{bad}");
        }
        assert_eq!(size("47, 31"), Ok([47, 31]));
        for bad in ["0,5", "5", "5000,1", "-1,2", ""] {
            assert!(size(bad).is_err(), "{bad}");
        }
        for bad in ["1", "nan,0", "1,inf", ""] {
            assert!(shift(bad).is_err(), "{bad}");
        }
        assert_eq!(range("-1e-9, 2"), Ok([-1e-9, 2.0]));
        assert_eq!(range("0.01..0.1"), Ok([0.01, 0.1]));
        for bad in ["1,1", "2,1", "0,inf", "nan,1", "1", ""] {
            assert!(range(bad).is_err(), "{bad}");
        }
        assert_eq!(point("5, -8,1e1"), Ok([5.0, -8.0, 10.0]));
        for bad in ["1,2", "1,2,3,4", "1,2,nan", "1,,2", ""] {
            assert!(point(bad).is_err(), "{bad}");
        }
        assert_eq!(levels("0.1, 1"), Ok([0.1, 1.0]));
        for bad in ["1,0", "0.5", "0,nan", "-0.1,1", "0,1.5", "0.5,0.5"] {
            assert!(levels(bad).is_err(), "{bad}");
        }
    }
}
