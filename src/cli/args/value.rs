//! Values with a grammar of their own.

use std::ops::Range;

/// "A..B" with A < B.
pub(super) fn spot_range(text: &str) -> Result<Range<usize>, String> {
    let parts = text
        .split_once("..")
        .and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    match parts {
        Some((a, b)) if a < b => Ok(a..b),
        _ => Err("write it as A..B with A < B, e.g. 0..30 for the first thirty".to_owned()),
    }
}

/// "KEY=VALUE", the value as TOML or a word.
pub(super) fn definition(text: &str) -> Result<(String, String), String> {
    let (key, value) = text
        .split_once('=')
        .ok_or("write it as KEY=VALUE, e.g. camera.pixels=[32,32]")?;
    let (key, value) = (key.trim(), value.trim());
    let is_of_a_word = |c: char| c.is_alphabetic() || "_-".contains(c);
    let is_word = !value.is_empty() && value.chars().all(is_of_a_word);
    let known = ["true", "false", "nan", "inf", "-inf"].contains(&value);
    let value = if is_word && !known {
        format!("\"{value}\"")
    } else {
        value.to_owned()
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

/// "LOW,HIGH", finite, LOW < HIGH.
pub(super) fn range(text: &str) -> Result<[f64; 2], String> {
    numbers(text)
        .filter(|[low, high]| low < high)
        .ok_or_else(|| "write it as LOW,HIGH with LOW below HIGH, e.g. 0,2e-12".to_owned())
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
