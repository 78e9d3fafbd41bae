//! What was done to a chunk before it was stored.

use std::borrow::Cow;

use super::super::inflated::{RATIO, inflated};
use super::fault::{CUT, Fault};
use super::fields::Fields;

/// Most filters of an array.
const MOST_FILTERS: u64 = 8;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Filter {
    Deflate,
    /// The first bytes of all elements, then the second ones, and so on.
    Shuffle,
    /// A checksum at the end.
    Fletcher32,
}

/// The filters of an array, in the order in which they were applied.
#[derive(Default)]
pub(super) struct Filters(Vec<Filter>);

impl Filters {
    /// Of a message.
    ///
    /// # Errors
    /// [`Fault`] for a message that is cut short, and for filters that MATLAB does not use.
    pub(super) fn of(mut fields: Fields<'_>) -> Result<Self, Fault> {
        let (version, count) = (|| Some((fields.byte()?, fields.number(1)?)))().ok_or(CUT)?;
        if !matches!(version, 1 | 2) || count > MOST_FILTERS {
            return Err(Fault::Damaged("has a list of filters that is none"));
        }
        fields.skip(if version == 1 { 6 } else { 0 }).ok_or(CUT)?;
        let mut filters = Vec::new();
        for _ in 0..count {
            let filter = match Self::next(&mut fields, version).ok_or(CUT)? {
                1 => Filter::Deflate,
                2 => Filter::Shuffle,
                3 => Filter::Fletcher32,
                4 => return Err(Fault::Unsupported("is packed by SZIP")),
                32000 => return Err(Fault::Unsupported("is packed by LZF")),
                _ => return Err(Fault::Unsupported("has a filter that MATLAB does not use")),
            };
            if filters.contains(&filter) {
                return Err(Fault::Unsupported("has a filter twice"));
            }
            filters.push(filter);
        }
        Ok(Self(filters))
    }

    /// The number of the next filter in the list.
    fn next(fields: &mut Fields<'_>, version: u8) -> Option<u64> {
        let number = fields.number(2)?;
        let has_name = version == 1 || number >= 256;
        let name = if has_name { fields.count(2)? } else { 0 };
        // Whether it may be left out, which each chunk says.
        fields.skip(2)?;
        let values = fields.count(2)?;
        if version == 1 {
            fields.skip(name.next_multiple_of(8) + 4 * values.next_multiple_of(2))?;
        } else {
            fields.skip(name + 4 * values)?;
        }
        Some(number)
    }

    /// The most bytes that `stored` bytes can become.
    pub(super) fn most(&self, stored: usize) -> u64 {
        let ratio = if self.0.contains(&Filter::Deflate) {
            RATIO
        } else {
            1
        };
        ratio.saturating_mul(stored as u64)
    }

    /// The chunk of `length` bytes, whose elements have `element` bytes, from what was stored of
    /// it. Bit k of `left_out` is set if filter k was not applied to it.
    ///
    /// # Errors
    /// [`Fault::Damaged`] if it does not become `length` bytes, or has another checksum.
    pub(super) fn undone<'a>(
        &self,
        stored: &'a [u8],
        left_out: u64,
        element: usize,
        length: usize,
    ) -> Result<Cow<'a, [u8]>, Fault> {
        let mut chunk = Cow::Borrowed(stored);
        let applied = self.0.iter().enumerate();
        for (_, filter) in applied.rev().filter(|(k, _)| left_out >> k & 1 == 0) {
            chunk = match filter {
                // A checksum may be packed with the chunk.
                Filter::Deflate => {
                    let bytes = inflated(&chunk, length as u64 + 4);
                    let unread = Fault::Damaged("has a packed chunk that cannot be read");
                    Cow::Owned(bytes.map_err(|_| unread)?)
                }
                Filter::Shuffle => Cow::Owned(unshuffled(&chunk, element)),
                Filter::Fletcher32 => checked(chunk)?,
            };
        }
        if chunk.len() == length {
            Ok(chunk)
        } else {
            Err(Fault::Damaged("has a chunk of another length"))
        }
    }
}

/// The bytes of each element side by side again; what is no whole element stays at the end.
fn unshuffled(bytes: &[u8], element: usize) -> Vec<u8> {
    let count = bytes.len() / element;
    let mut ordered = bytes.to_vec();
    for (k, plane) in bytes.chunks_exact(count.max(1)).take(element).enumerate() {
        for (at, byte) in plane.iter().enumerate() {
            ordered[at * element + k] = *byte;
        }
    }
    ordered
}

/// What comes before a checksum that is right.
fn checked(bytes: Cow<'_, [u8]>) -> Result<Cow<'_, [u8]>, Fault> {
    let (content, sum) = bytes.split_last_chunk::<4>().ok_or(CUT)?;
    if fletcher32(content) != u32::from_le_bytes(*sum) {
        return Err(Fault::Damaged("has a chunk with another checksum"));
    }
    let length = content.len();
    Ok(match bytes {
        Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[..length]),
        Cow::Owned(mut bytes) => {
            bytes.truncate(length);
            Cow::Owned(bytes)
        }
    })
}

/// Fletcher's checksum of words of 16 bits, most significant byte first, modulo 65535.
fn fletcher32(bytes: &[u8]) -> u32 {
    let folded = |x: u32| (x & 0xffff) + (x >> 16);
    let (mut sum, mut sums) = (0u32, 0u32);
    for pair in bytes.chunks(2) {
        let low = pair.get(1).copied().unwrap_or(0);
        sum = folded(sum + u32::from(u16::from_be_bytes([pair[0], low])));
        sums = folded(sums + sum);
    }
    folded(sums) << 16 | folded(sum)
}
