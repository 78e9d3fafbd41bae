//! `.npy` arrays of any dimension and plain number, from bytes.

use super::super::array::{
    Array, ArrayError, MOST_ENTRIES, Number, damaged, from_fortran, unsupported,
};
use super::error::conversion;
use super::header::{Header, Plain};
use super::one_line;

/// The array in the bytes of a `.npy` file: integers of 8 to 64 bits, booleans, or floating point
/// of 32 or 64 bits, of either byte order, in C or Fortran order. `name` is only for messages.
/// Takes at most 16 bytes of memory for each entry, and there are at most [`MOST_ENTRIES`].
///
/// # Errors
/// [`ArrayError`] for another type, a length other than the header's claim, an empty or too large
/// array, and numbers that are not finite or not exact as f64.
pub fn read_array(name: &str, bytes: &[u8]) -> Result<Array, ArrayError> {
    let mut start = bytes;
    let header = Header::read(&mut start)
        .map_err(|e| damaged(name, e))?
        .map_err(|reason| damaged(name, one_line(&reason)))?;
    let (number, big) = header.plain().and_then(number).ok_or_else(|| {
        let reason = format!(
            "it holds {}, not plain integers or floating-point numbers; {} before numpy.save",
            one_line(&header.descr),
            conversion(&header.descr)
        );
        unsupported(name, reason)
    })?;
    let count = header.shape.iter().try_fold(1u64, |n, l| n.checked_mul(*l));
    let count = count.filter(|n| (1..=MOST_ENTRIES as u64).contains(n));
    let count = count.ok_or_else(|| {
        let shape = &header.shape;
        let reason = format!("its shape is {shape:?}; use 1 to 2²⁷ entries: save it in parts");
        unsupported(name, reason)
    })? as usize;
    let content = &bytes[header.length..];
    if content.len() != count * number.bytes() {
        let reason = format!(
            "it holds {} bytes of numbers where its header promises {}",
            content.len(),
            count * number.bytes()
        );
        return Err(damaged(name, reason));
    }
    let values = number.all(name, content, big)?;
    let shape: Vec<usize> = header.shape.iter().map(|l| *l as usize).collect();
    Ok(Array {
        values: if header.fortran {
            from_fortran(&shape, &values)
        } else {
            values
        },
        full_scale: number.full_scale(),
        shape,
    })
}

/// The type of plain numbers, and whether their most significant byte comes first.
fn number(plain: Plain) -> Option<(Number, bool)> {
    let number = match (plain.kind, plain.bytes) {
        ('b', 1) => Number::Unsigned(1),
        ('u', bytes @ (1 | 2 | 4 | 8)) => Number::Unsigned(bytes),
        ('i', bytes @ (1 | 2 | 4 | 8)) => Number::Signed(bytes),
        ('f', bytes @ (4 | 8)) => Number::Float(bytes),
        _ => return None,
    };
    Some((number, plain.big_endian))
}
