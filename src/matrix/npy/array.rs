//! `.npy` arrays of any dimension and plain number, from bytes.

use npyz::{DType, Endianness, NpyHeader, Order, TypeChar};

use super::super::array::{
    Array, ArrayError, MOST_ENTRIES, Number, damaged, from_fortran, unsupported,
};
use super::{checked_header, one_line};

/// The array in the bytes of a `.npy` file: integers of 8 to 64 bits, booleans, or floating point of
/// 32 or 64 bits, of either byte order, in C or Fortran order. `name` is only for messages. Takes at
/// most 16 bytes of memory for each entry, and there are at most [`MOST_ENTRIES`].
///
/// # Errors
/// [`ArrayError`] for another type, a length other than the header's claim, an empty or too large
/// array, and numbers that are not finite or not exact as f64.
pub fn read_array(name: &str, bytes: &[u8]) -> Result<Array, ArrayError> {
    let mut start = bytes;
    let checked = checked_header(&mut start)
        .map_err(|e| damaged(name, e))?
        .map_err(|reason| damaged(name, one_line(&reason)))?;
    let header = NpyHeader::from_reader(&checked[..])
        .map_err(|e| damaged(name, one_line(&e.to_string())))?;
    let (number, big) = number(&header.dtype()).ok_or_else(|| {
        let reason = format!(
            "it holds {}, not plain integers or floating-point numbers; convert it with a.astype('<f8') before numpy.save",
            one_line(&header.dtype().descr())
        );
        unsupported(name, reason)
    })?;
    let count = header
        .shape()
        .iter()
        .try_fold(1u64, |n, l| n.checked_mul(*l));
    let count = count.filter(|n| (1..=MOST_ENTRIES as u64).contains(n));
    let count = count.ok_or_else(|| {
        let shape = header.shape();
        let reason = format!("its shape is {shape:?}; use 1 to 2²⁷ entries: save it in parts");
        unsupported(name, reason)
    })? as usize;
    let content = &bytes[checked.len()..];
    if content.len() != count * number.bytes() {
        let reason = format!(
            "it holds {} bytes of numbers where its header promises {}",
            content.len(),
            count * number.bytes()
        );
        return Err(damaged(name, reason));
    }
    let values = number.all(name, content, big)?;
    let shape: Vec<usize> = header.shape().iter().map(|l| *l as usize).collect();
    Ok(Array {
        values: match header.order() {
            Order::C => values,
            Order::Fortran => from_fortran(&shape, &values),
        },
        full_scale: number.full_scale(),
        shape,
    })
}

/// The type of plain numbers, and whether their most significant byte comes first.
fn number(dtype: &DType) -> Option<(Number, bool)> {
    let DType::Plain(plain) = dtype else {
        return None;
    };
    let bytes = usize::try_from(plain.size_field()).ok()?;
    let number = match plain.type_char() {
        TypeChar::Bool if bytes == 1 => Number::Unsigned(1),
        TypeChar::Uint if [1, 2, 4, 8].contains(&bytes) => Number::Unsigned(bytes),
        TypeChar::Int if [1, 2, 4, 8].contains(&bytes) => Number::Signed(bytes),
        TypeChar::Float if [4, 8].contains(&bytes) => Number::Float(bytes),
        _ => return None,
    };
    Some((number, plain.endianness() == Endianness::Big))
}
