//! The header of a `.npy` file: a Python dict of three keys, `descr` (the type of the numbers),
//! `fortran_order` and `shape`.
//!
//! It comes from outside, so nothing in it is believed: its length, its brackets and its digits are
//! bounded before it is read (a product of integers is less than ten to the number of all their
//! digits, so 19 digits cannot overflow an u64).

use std::io::{self, Read};

use super::one_line;

/// Longest header accepted, bytes: NumPy's own for two dimensions has 118.
const LONGEST: usize = 1024;
/// Most brackets in a header: the dict and the shape need four.
const BRACKETS_MAX: usize = 8;
/// Most digits in a header, such that no product of its integers leaves an u64.
const DIGITS_MAX: usize = 19;
/// Numbers start at a multiple of this many bytes, as the format asks.
const ALIGNED: usize = 64;

/// What the header of an array says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    /// The type of the numbers, as NumPy writes it: `<f8` has its byte order (`<`, `>`, `|` none,
    /// `=` this machine's), its kind and its bytes. What is no such string stands here as it is
    /// written.
    pub descr: String,
    /// Whether the first index runs fastest.
    pub fortran: bool,
    /// The lengths, slowest index first in C order.
    pub shape: Vec<u64>,
    /// Bytes of the file before its numbers.
    pub length: usize,
}

/// Kind and bytes of a plain number, and whether its most significant byte comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Plain {
    /// NumPy's letter: `f`, `i`, `u`, `b`.
    pub kind: char,
    /// Bytes of a number.
    pub bytes: usize,
    /// Whether the most significant byte comes first.
    pub big_endian: bool,
}

impl Header {
    /// Reads a file up to the end of its header; the inner error says why it is refused.
    pub(super) fn read(file: &mut impl Read) -> io::Result<Result<Self, String>> {
        let mut start = Vec::new();
        file.take(12 + LONGEST as u64).read_to_end(&mut start)?;
        Ok(Self::of(&start))
    }

    /// The header at the start of these bytes.
    fn of(start: &[u8]) -> Result<Self, String> {
        let rest = start
            .strip_prefix(b"\x93NUMPY")
            .ok_or("its first bytes are not those of .npy")?;
        let (text, length) = match *rest {
            [1, 0, a, b, ref text @ ..] => (text, usize::from(u16::from_le_bytes([a, b]))),
            [2 | 3, 0, a, b, c, d, ref text @ ..] => {
                (text, u32::from_le_bytes([a, b, c, d]) as usize)
            }
            _ => return Err("its format version is unknown or its header is cut short".to_owned()),
        };
        if length > LONGEST {
            return Err(format!(
                "its header claims {length} bytes, more than {LONGEST}"
            ));
        }
        let (text, after) = text
            .split_at_checked(length)
            .map(|(text, after)| (text, after.len()))
            .ok_or("its header is cut short")?;
        let brackets = text.iter().filter(|b| b"([{".contains(b)).count();
        let digits = text.iter().filter(|b| b.is_ascii_digit()).count();
        if brackets > BRACKETS_MAX || digits > DIGITS_MAX {
            return Err(
                "its header describes more than one plain array, or one too large".to_owned(),
            );
        }
        let text = std::str::from_utf8(text).map_err(|_| "its header is no text")?;
        let mut reader = Literal { rest: text };
        let (descr, fortran, shape) = reader
            .dict()
            .ok_or_else(|| format!("its header is not understood: {}", one_line(text)))?;
        Ok(Self {
            descr,
            fortran,
            shape,
            length: start.len() - after,
        })
    }

    /// The start of a file of little-endian f64 in C order, up to where its numbers begin.
    pub(super) fn of_f64(shape: &[u64]) -> Vec<u8> {
        let lengths: String = shape.iter().map(|n| format!("{n}, ")).collect();
        let mut text =
            format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({lengths}), }}");
        let before = b"\x93NUMPY\x01\x00".len() + 2;
        let padded = (before + text.len() + 1).next_multiple_of(ALIGNED) - before - 1;
        text = format!("{text:padded$}\n");
        let length = u16::try_from(text.len()).expect("a shape of a few lengths");
        [
            b"\x93NUMPY\x01\x00",
            &length.to_le_bytes()[..],
            text.as_bytes(),
        ]
        .concat()
    }

    /// The type of the numbers, if they are plain ones.
    pub(super) fn plain(&self) -> Option<Plain> {
        let mut letters = self.descr.chars();
        let (order, kind) = (letters.next()?, letters.next()?);
        let big_endian = match order {
            '<' | '|' => false,
            '>' => true,
            '=' => cfg!(target_endian = "big"),
            _ => return None,
        };
        let bytes = letters.as_str();
        let digits = bytes.bytes().all(|b| b.is_ascii_digit());
        let bytes = bytes.parse().ok().filter(|_| digits)?;
        "fiub".contains(kind).then_some(Plain {
            kind,
            bytes,
            big_endian,
        })
    }
}

/// What is left to read of a Python literal. Each part is `None` where it is not what it should be.
struct Literal<'a> {
    rest: &'a str,
}

impl<'a> Literal<'a> {
    /// `{'descr': …, 'fortran_order': …, 'shape': …, }`, keys in any order, each once.
    fn dict(&mut self) -> Option<(String, bool, Vec<u64>)> {
        let (mut descr, mut fortran, mut shape) = (None, None, None);
        self.sign('{')?;
        while self.sign('}').is_none() {
            let key = self.string()?;
            self.sign(':')?;
            match key {
                "descr" if descr.is_none() => descr = Some(self.descr()?),
                "fortran_order" if fortran.is_none() => fortran = Some(self.truth()?),
                "shape" if shape.is_none() => shape = Some(self.lengths()?),
                _ => return None,
            }
            if self.sign(',').is_none() {
                self.sign('}')?;
                break;
            }
        }
        self.rest.trim().is_empty().then_some(())?;
        Some((descr?, fortran?, shape?))
    }

    /// One character, after white space.
    fn sign(&mut self, sign: char) -> Option<()> {
        self.rest = self.rest.trim_start().strip_prefix(sign)?;
        Some(())
    }

    /// A string between quotes of one kind; one with a backslash is none that NumPy writes.
    fn string(&mut self) -> Option<&'a str> {
        let quote = ['\'', '"'].into_iter().find(|q| self.sign(*q).is_some())?;
        let (text, rest) = self.rest.split_once(quote)?;
        self.rest = rest;
        (!text.contains('\\')).then_some(text)
    }

    /// A type: a string, or the list of the fields of a record, as it is written.
    fn descr(&mut self) -> Option<String> {
        if let Some(text) = self.string() {
            return Some(text.to_owned());
        }
        self.sign('[')?;
        let mut depth = 1usize;
        let end = self.rest.char_indices().find_map(|(at, c)| {
            match c {
                '[' => depth += 1,
                ']' => depth -= 1,
                _ => {}
            }
            (depth == 0).then_some(at)
        })?;
        let (fields, rest) = self.rest.split_at(end);
        self.rest = &rest[1..];
        Some(format!("[{fields}]"))
    }

    fn truth(&mut self) -> Option<bool> {
        let words = self.rest.trim_start();
        let (value, rest) = match words.strip_prefix("True") {
            Some(rest) => (true, rest),
            None => (false, words.strip_prefix("False")?),
        };
        self.rest = rest;
        Some(value)
    }

    /// A tuple of whole numbers; Python 2 wrote an `L` behind long ones.
    fn lengths(&mut self) -> Option<Vec<u64>> {
        let mut lengths = Vec::new();
        self.sign('(')?;
        while self.sign(')').is_none() {
            let words = self.rest.trim_start();
            let digits = words.bytes().take_while(u8::is_ascii_digit).count();
            let (number, rest) = words.split_at(digits);
            lengths.push(number.parse().ok()?);
            self.rest = rest.strip_prefix('L').unwrap_or(rest);
            if self.sign(',').is_none() {
                // (6) is a number, not a tuple.
                (lengths.len() > 1).then_some(())?;
                self.sign(')')?;
                break;
            }
        }
        Some(lengths)
    }
}

#[cfg(test)]
mod tests;
