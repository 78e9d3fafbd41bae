//! Variables of MATLAB's MAT-files: numeric arrays.
//!
//! Two formats have the name: version 5 (`save -v6`, `save -v7`), a row of elements, and version
//! 7.3 (`save -v7.3`), an HDF5 file behind 512 bytes of header. The bytes say which one a file is.

mod choice;
mod hdf5;
mod inflated;
mod version5;
mod version73;

use super::array::{Array, ArrayError};

/// The variable `wanted` of a MAT-file of version 5 or 7.3, or its only numeric array. Its shape is
/// that in MATLAB: (rows, columns, …). `name` is only for messages. Takes at most 24 bytes of
/// memory for each entry, and there are at most [`MOST_ENTRIES`](super::MOST_ENTRIES).
///
/// # Errors
/// [`ArrayError`] for another version, no such variable, more than one where none is named, complex
/// or sparse numbers, damage, storage that MATLAB does not use, and numbers that are not finite or
/// not exact as f64.
pub fn read(name: &str, bytes: &[u8], wanted: Option<&str>) -> Result<Array, ArrayError> {
    if version73::is_it(bytes) {
        version73::read(name, bytes, wanted)
    } else {
        version5::read(name, bytes, wanted)
    }
}

#[cfg(test)]
mod tests;
