//! What the elements of an array are.

use super::super::super::array::Number;
use super::fault::{CUT, Fault};
use super::fields::Fields;

/// A type of element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Datatype {
    /// Numbers, and whether their most significant byte comes first.
    Number(Number, bool),
    /// Several members an element, as complex numbers have them.
    Compound,
    /// Something else: text, references, numbers of odd bits.
    Other,
}

/// Where sign, exponent and mantissa of an IEEE 754 number lie: first bit and length of the
/// exponent, of the mantissa, and the exponent of 1.
const SINGLE: [u8; 8] = [23, 8, 0, 23, 127, 0, 0, 0];
const DOUBLE: [u8; 8] = [52, 11, 0, 52, 0xff, 3, 0, 0];

impl Datatype {
    /// The type that a message has.
    ///
    /// # Errors
    /// [`Fault`] for a message that is cut short.
    pub(super) fn of(mut fields: Fields<'_>) -> Result<Self, Fault> {
        let (class, flags, size) = (|| {
            let class = fields.byte()? & 15;
            Some((class, fields.number(3)?, fields.count(4)?))
        })()
        .ok_or(CUT)?;
        let is_whole = |fields: &mut Fields<'_>| {
            let (first, bits) = (fields.count(2)?, fields.count(2)?);
            Some(first == 0 && size.checked_mul(8) == Some(bits))
        };
        let is_big = flags & 1 != 0;
        let number = match (class, size) {
            (0, 1 | 2 | 4 | 8) if flags & 8 != 0 => Number::Signed(size),
            (0, 1 | 2 | 4 | 8) => Number::Unsigned(size),
            // Bit 6 is set for the byte order of a VAX.
            (1, 4 | 8) if flags & 0x40 == 0 => Number::Float(size),
            (6, _) => return Ok(Self::Compound),
            _ => return Ok(Self::Other),
        };
        let is_plain = is_whole(&mut fields).ok_or(CUT)?
            && match number {
                Number::Float(4) => fields.take(8).ok_or(CUT)? == SINGLE,
                Number::Float(_) => fields.take(8).ok_or(CUT)? == DOUBLE,
                _ => true,
            };
        Ok(if is_plain {
            Self::Number(number, is_big)
        } else {
            Self::Other
        })
    }
}
