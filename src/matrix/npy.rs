//! `.npy`, NumPy's file of one array.
//!
//! Layout (NumPy format 1.0): `\x93NUMPY`, version (2 bytes), length of the header (u16), the
//! header as a Python dict `{'descr': '<f8', 'fortran_order': False, 'shape': (p, l), }` padded
//! with spaces and ended by a newline, then the numbers. C order means row after row.
//!
//! The claim of a header is held against the length of the file before anything is allocated.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

mod array;
mod entries;
mod error;
mod header;
mod rows;

pub use array::read_array;
pub use entries::Entries;
pub use error::NpyError;
use header::Header;
pub use rows::Rows;

use super::Matrix;
use crate::store::{self, ReadError, StoreError};

/// Rows in C order that are held before they are put into their columns.
const BAND: usize = 32;

/// Writes `matrix` to `path` as f64, little-endian, C order, shape (rows, columns): Φcam as
/// (pixels, spots) in W. The file appears whole or not at all.
///
/// # Errors
/// [`StoreError`] if the file cannot be written.
pub fn write(path: &Path, matrix: &Matrix) -> Result<(), StoreError> {
    store::write_whole(path, |file| {
        file.write_all(&Header::of_f64(&[
            matrix.nrows() as u64,
            matrix.ncols() as u64,
        ]))?;
        for row in 0..matrix.nrows() {
            for column in 0..matrix.ncols() {
                file.write_all(&matrix[(row, column)].to_le_bytes())?;
            }
        }
        Ok(())
    })
}

/// A file whose header makes sense, and whose length is what the header claims.
struct Opened {
    /// Behind its header.
    file: BufReader<File>,
    layout: Layout,
    rows: usize,
    columns: usize,
}

/// How numbers lie in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Layout {
    /// Where the first one stands.
    start: u64,
    /// Whether the first index runs fastest.
    fortran: bool,
    /// Bytes of a number, 4 or 8.
    bytes: usize,
    /// Whether its most significant byte comes first.
    big_endian: bool,
}

impl Layout {
    /// The next number of a file, as f64.
    fn next(self, file: &mut impl Read) -> io::Result<f64> {
        let mut bytes = [0; 8];
        let bytes = &mut bytes[..self.bytes];
        file.read_exact(bytes)?;
        if self.big_endian {
            bytes.reverse();
        }
        Ok(match *bytes {
            [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
            _ => f64::from_le_bytes(std::array::from_fn(|i| bytes[i])),
        })
    }
}

fn open(path: &Path) -> Result<Opened, NpyError> {
    examine(path, store::open(path)?)
}

/// Looks at the header of an open file, which messages call `path`.
fn examine(path: &Path, file: File) -> Result<Opened, NpyError> {
    let unreadable = |source| unreadable(path, source);
    let length = file.metadata().map_err(unreadable)?.len();
    let mut file = BufReader::new(file);
    let header = Header::read(&mut file)
        .map_err(unreadable)?
        .map_err(|r| not_npy(path, &r))?;
    // The header that was looked at counts, whatever the file has become.
    let start = header.length as u64;
    file.seek(SeekFrom::Start(start)).map_err(unreadable)?;

    let plain = header.plain();
    let plain = plain.filter(|p| p.kind == 'f' && [4, 8].contains(&p.bytes));
    let layout = match plain {
        Some(plain) => Layout {
            start,
            fortran: header.fortran,
            bytes: plain.bytes,
            big_endian: plain.big_endian,
        },
        None => {
            return Err(NpyError::Type {
                path: path.into(),
                dtype: one_line(&header.descr),
            });
        }
    };
    let (rows, columns) = match header.shape[..] {
        [rows] if rows > 0 => (rows, 1),
        [rows, columns] if rows > 0 && columns > 0 => (rows, columns),
        _ => {
            return Err(NpyError::Shape {
                path: path.into(),
                shape: header.shape,
            });
        }
    };
    let promised = u128::from(rows) * u128::from(columns) * layout.bytes as u128;
    let found = length.saturating_sub(start);
    if promised != u128::from(found) {
        return Err(NpyError::Length {
            path: path.into(),
            found,
            promised,
        });
    }
    let too_large = |_| NpyError::Shape {
        path: path.into(),
        shape: vec![rows, columns],
    };
    Ok(Opened {
        rows: usize::try_from(rows).map_err(too_large)?,
        columns: usize::try_from(columns).map_err(too_large)?,
        file,
        layout,
    })
}

/// Rows and columns of the matrix in `path`, by its header: to be held against what is expected
/// before [`read`] takes memory for it.
///
/// # Errors
/// As [`read`].
pub fn shape(path: &Path) -> Result<(usize, usize), NpyError> {
    open(path).map(|opened| (opened.rows, opened.columns))
}

/// Reads a matrix from `path`: f64 or f32 of either byte order, C or Fortran order, two dimensions,
/// or one, which becomes a column. NaN and infinity are passed on: see [`read_finite`]. Allocates
/// at most twice what its numbers take as f64: twice the length of the file, four times that of one
/// of f32.
///
/// # Errors
/// [`NpyError`] if the file cannot be read, is no `.npy`, has another type or shape, or another
/// length than it claims.
pub fn read(path: &Path) -> Result<Matrix, NpyError> {
    let Opened {
        mut file,
        layout,
        rows,
        columns,
    } = open(path)?;
    fill(rows, columns, &mut file, layout).map_err(|source| unreadable(path, source))
}

/// [`read`], and only finite values.
///
/// # Errors
/// As [`read`], and [`NpyError::NotFinite`] for the first NaN or infinity, rows first.
pub fn read_finite(path: &Path) -> Result<Matrix, NpyError> {
    read_counted(path, None)
}

/// [`read`] with 0 in place of NaN and infinity where `left_out`, of the same shape, is not 0, and
/// only finite values elsewhere.
///
/// # Errors
/// As [`read_finite`], for the entries that count.
pub fn read_counted(path: &Path, left_out: Option<&Matrix>) -> Result<Matrix, NpyError> {
    let mut matrix = read(path)?;
    for (x, flag) in matrix.iter_mut().zip(left_out.into_iter().flatten()) {
        if *flag != 0.0 && !x.is_finite() {
            *x = 0.0;
        }
    }
    finite(path, 0, matrix)
}

/// The matrix, which starts at row `first` of the file, if all of it is finite.
fn finite(path: &Path, first: usize, matrix: Matrix) -> Result<Matrix, NpyError> {
    if matrix.iter().all(|x| x.is_finite()) {
        return Ok(matrix);
    }
    for row in 0..matrix.nrows() {
        for column in 0..matrix.ncols() {
            let value = matrix[(row, column)];
            if !value.is_finite() {
                return Err(NpyError::NotFinite {
                    path: path.into(),
                    row: first + row,
                    column,
                    value,
                });
            }
        }
    }
    Ok(matrix)
}

fn unreadable(path: &Path, source: io::Error) -> NpyError {
    ReadError::system(path, source).into()
}

fn not_npy(path: &Path, reason: &str) -> NpyError {
    NpyError::NotNpy {
        path: path.into(),
        reason: one_line(reason),
    }
}

/// A file may be quoted, line breaks and what moves a cursor included: not these.
fn one_line(words: &str) -> String {
    let parts = words.split(|c: char| c.is_whitespace() || c.is_control());
    let parts: Vec<&str> = parts.filter(|p| !p.is_empty()).collect();
    parts.join(" ")
}

/// The matrix of the next numbers of a file.
fn fill(rows: usize, columns: usize, file: &mut impl Read, layout: Layout) -> io::Result<Matrix> {
    let mut matrix = Matrix::zeros(rows, columns);
    if layout.fortran {
        for value in matrix.iter_mut() {
            *value = layout.next(file)?;
        }
        return Ok(matrix);
    }
    // Some rows at a time, so that neighbours in memory are written together.
    let mut band = vec![0.0; BAND.min(rows) * columns];
    for first in (0..rows).step_by(BAND) {
        let count = BAND.min(rows - first);
        for value in &mut band[..count * columns] {
            *value = layout.next(file)?;
        }
        for column in 0..columns {
            for row in 0..count {
                matrix[(first + row, column)] = band[row * columns + column];
            }
        }
    }
    Ok(matrix)
}

#[cfg(test)]
mod tests;
