//! Variables of MAT-files of version 5 (`save -v6`, `save -v7`).
//!
//! Layout: 128 bytes of header, the last four of them the version (0x0100) and the byte order
//! (`IM` or `MI`); then elements. An element is its type (u32), its length in bytes (u32) and its
//! content, padded to 8 bytes; one of up to 4 bytes has length and type in two u16 and its content
//! in the other 4. A variable is an element of type 14 that holds flags, dimensions, name and
//! numbers (first index fastest), or one of type 15 with such an element packed by Deflate.
//!
//! Source: MAT-File Format, MathWorks, R2021b.

use super::super::array::{Array, ArrayError, Number, damaged, from_fortran, unsupported};
use super::choice::{Choice, entries};
use super::inflated;

/// Bytes before the first element.
const HEADER: usize = 128;
/// Types of elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Bytes within which flags, dimensions and name of a variable lie.
const HEAD: u64 = 4096;

/// The variable `wanted`, or the only numeric array. Takes at most 24 bytes of memory for each
/// entry.
pub(super) fn read(name: &str, bytes: &[u8], wanted: Option<&str>) -> Result<Array, ArrayError> {
    let big = byte_order(name, bytes)?;
    let mut rest = &bytes[HEADER..];
    let mut choice = Choice::new(name, wanted);
    while !rest.is_empty() {
        let (element, after) = Element::first(rest, big)
            .ok_or_else(|| damaged(name, "a variable reaches beyond its end"))?;
        rest = after;
        let start = match element.kind {
            MATRIX => element.content[..element.content.len().min(HEAD as usize)].to_vec(),
            COMPRESSED => {
                // The tag of the variable within comes first.
                let start = inflated(name, element.content, HEAD + 8)?;
                start.get(8..).unwrap_or_default().to_vec()
            }
            _ => continue,
        };
        let Some(head) = Head::of(&start, big) else {
            continue;
        };
        choice.offer(head.name.clone(), head.is_numeric(), (head, element))?;
    }
    let (_, (head, element)) = choice.made()?;
    head.array(name, &element, big)
}

/// Whether the most significant byte comes first, of a file of version 5.
fn byte_order(name: &str, bytes: &[u8]) -> Result<bool, ArrayError> {
    match bytes.get(124..HEADER) {
        Some([0, 1, b'I', b'M']) => Ok(false),
        Some([1, 0, b'M', b'I']) => Ok(true),
        _ => {
            let reason = "it is no MAT-file of version 5 or 7.3; save it in MATLAB or Octave with `save -v7`";
            Err(unsupported(name, reason))
        }
    }
}

/// A part of a file.
struct Element<'a> {
    kind: u32,
    content: &'a [u8],
}

impl<'a> Element<'a> {
    /// The element that `bytes` begins with, and what follows it.
    fn first(bytes: &'a [u8], big: bool) -> Option<(Self, &'a [u8])> {
        let kind = word(bytes, big)?;
        let (kind, content, end) = match kind >> 16 {
            0 => {
                let length = word(bytes.get(4..)?, big)? as usize;
                let content = bytes.get(8..length.checked_add(8)?)?;
                let end = match kind {
                    COMPRESSED => 8 + length,
                    _ => 8 + length.checked_next_multiple_of(8)?,
                };
                (kind, content, end)
            }
            length => {
                let content = bytes.get(4..8)?.get(..length as usize)?;
                (kind & 0xffff, content, 8)
            }
        };
        // The last one may lack its padding.
        let rest = bytes.get(end..).unwrap_or_default();
        Some((Self { kind, content }, rest))
    }
}

fn word(bytes: &[u8], big: bool) -> Option<u32> {
    let bytes = *bytes.first_chunk()?;
    Some(if big {
        u32::from_be_bytes(bytes)
    } else {
        u32::from_le_bytes(bytes)
    })
}

/// At most `most` bytes of what a packed variable becomes.
fn inflated(name: &str, packed: &[u8], most: u64) -> Result<Vec<u8>, ArrayError> {
    inflated::inflated(packed, most)
        .map_err(|e| damaged(name, format!("a packed variable cannot be read ({e})")))
}

/// What a variable says of itself before its numbers.
struct Head {
    class: u32,
    is_complex: bool,
    shape: Vec<usize>,
    name: String,
    /// Bytes before the element of its numbers.
    length: usize,
}

impl Head {
    /// Flags, dimensions and name at the start of a variable's content.
    fn of(start: &[u8], big: bool) -> Option<Self> {
        let (flags, rest) = Element::first(start, big)?;
        let (dimensions, rest) = Element::first(rest, big)?;
        let (name, rest) = Element::first(rest, big)?;
        let flags = word(flags.content, big)?;
        let lengths = dimensions.content.chunks_exact(4);
        let shape = lengths.map(|l| word(l, big).map(|l| l as usize));
        Some(Self {
            class: flags & 0xff,
            is_complex: flags & 0x800 != 0,
            shape: shape.collect::<Option<_>>()?,
            name: String::from_utf8_lossy(name.content).into_owned(),
            length: start.len() - rest.len(),
        })
    }

    /// Whether it is an array of plain numbers.
    fn is_numeric(&self) -> bool {
        self.number().is_some()
    }

    /// The type of its numbers in MATLAB.
    fn number(&self) -> Option<Number> {
        Some(match self.class {
            6 => Number::Float(8),
            7 => Number::Float(4),
            8 => Number::Signed(1),
            9 => Number::Unsigned(1),
            10 => Number::Signed(2),
            11 => Number::Unsigned(2),
            12 => Number::Signed(4),
            13 => Number::Unsigned(4),
            14 => Number::Signed(8),
            15 => Number::Unsigned(8),
            _ => return None,
        })
    }

    /// The whole array.
    fn array(&self, name: &str, element: &Element<'_>, big: bool) -> Result<Array, ArrayError> {
        let own = &self.name;
        let number = self.number().filter(|_| !self.is_complex).ok_or_else(|| {
            let reason =
                format!("its variable `{own}` is no array of real numbers; save one that is");
            unsupported(name, reason)
        })?;
        let count = entries(name, own, &self.shape)?;
        let cut = || damaged(name, format!("its variable `{own}` is cut short"));
        let whole;
        let content = if element.kind == COMPRESSED {
            // Its tag, its head, the tag of its numbers, and they.
            let most = 8 + self.length as u64 + 8 + 8 * count as u64;
            whole = inflated(name, element.content, most)?;
            whole.get(8..).ok_or_else(cut)?
        } else {
            element.content
        };
        let numbers = content.get(self.length..).ok_or_else(cut)?;
        let kind = word(numbers, big).ok_or_else(cut)?;
        let stored = stored(kind & 0xffff)
            .ok_or_else(|| damaged(name, format!("its variable `{own}` has no type")))?;
        // What follows (padding) may be left out of what was inflated.
        let bytes = count * stored.bytes();
        let content = match kind >> 16 {
            0 if word(&numbers[4..], big) == Some(bytes as u32) => numbers.get(8..8 + bytes),
            length if length as usize == bytes => numbers.get(4..4 + bytes),
            _ => None,
        };
        let values = stored.all(name, content.ok_or_else(cut)?, big)?;
        Ok(Array {
            values: from_fortran(&self.shape, &values),
            full_scale: number.full_scale(),
            shape: self.shape.clone(),
        })
    }
}

/// How numbers are stored, which may be shorter than their type in MATLAB.
fn stored(kind: u32) -> Option<Number> {
    Some(match kind {
        1 => Number::Signed(1),
        2 => Number::Unsigned(1),
        3 => Number::Signed(2),
        4 => Number::Unsigned(2),
        5 => Number::Signed(4),
        6 => Number::Unsigned(4),
        7 => Number::Float(4),
        9 => Number::Float(8),
        12 => Number::Signed(8),
        13 => Number::Unsigned(8),
        _ => return None,
    })
}
