//! `.npy`, NumPy's file of one array: the only door of the crate `npyz`.
//!
//! Layout (NumPy format 1.0): `\x93NUMPY`, version (2 bytes), length of the header (u16), the
//! header as a Python dict `{'descr': '<f8', 'fortran_order': False, 'shape': (p, l), }` padded
//! with spaces and ended by a newline, then the numbers. C order means row after row.
//!
//! The header comes from outside and `npyz` trusts it: it multiplies the shape without a check,
//! allocates the length a header claims and parses nested brackets by recursion. So a header is
//! looked at before `npyz` sees it, which then gets the bytes that were looked at: its length, its
//! brackets and its digits are bounded (a product of integers is less than ten to the number of all
//! their digits, so 19 digits cannot overflow an u64), and its claim is held against the length of
//! the file before anything is allocated.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use npyz::{NpyHeader, Order, TypeChar, WriterBuilder};

mod array;
mod entries;
mod rows;

pub use array::read_array;
pub use entries::Entries;
pub use rows::Rows;

use super::Matrix;
use crate::store::{self, ReadError, StoreError};

/// Longest header accepted, bytes: NumPy's own for two dimensions has 118.
const HEADER_MAX: usize = 1024;
/// Most brackets in a header: the dict and the shape need four.
const BRACKETS_MAX: usize = 8;
/// Most digits in a header, such that no product of its integers leaves an u64.
const DIGITS_MAX: usize = 19;
/// Rows in C order that are held before they are put into their columns.
const BAND: usize = 32;

/// Why a `.npy` file cannot serve as a matrix.
#[derive(Debug, thiserror::Error)]
pub enum NpyError {
    /// The file cannot be read.
    #[error(transparent)]
    Unreadable(#[from] ReadError),
    /// The header is none, or not that of a plain array.
    #[error("{} is not a .npy file of plain numbers: {reason}; write it with numpy.save", path.display())]
    NotNpy {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Numbers of another type than f64 or f32.
    #[error("{} holds numbers of type {dtype}, not f64 or f32; convert it with a.astype('<f8') before numpy.save", path.display())]
    Type {
        /// The file.
        path: PathBuf,
        /// NumPy's name of the type found.
        dtype: String,
    },
    /// Not a vector and not a matrix, or without entries.
    #[error("{} has the shape {shape:?}, not (pixels, spots); reshape the array before numpy.save", path.display())]
    Shape {
        /// The file.
        path: PathBuf,
        /// The shape found.
        shape: Vec<u64>,
    },
    /// The header promises more or fewer numbers than the file holds.
    #[error("{} holds {found} bytes of numbers where its header promises {promised}: it is cut short or damaged; write it again", path.display())]
    Length {
        /// The file.
        path: PathBuf,
        /// Bytes after the header.
        found: u64,
        /// Bytes the header asks for.
        promised: u128,
    },
    /// NaN or infinity where only finite numbers make sense.
    #[error("{} has the value {value} at row {row}, column {column}; remove or mend it: only finite numbers can be used", path.display())]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// Row of the first such value, from 0.
        row: usize,
        /// Column of the first such value, from 0.
        column: usize,
        /// The value.
        value: f64,
    },
}

/// Writes `matrix` to `path` as f64, little-endian, C order, shape (rows, columns): Φcam as
/// (pixels, spots) in W. The file appears whole or not at all.
///
/// # Errors
/// [`StoreError`] if the file cannot be written.
pub fn write(path: &Path, matrix: &Matrix) -> Result<(), StoreError> {
    store::write_whole(path, |file| {
        let f64_little_endian = "<f8".parse().map_err(io::Error::other)?;
        let mut writer = npyz::WriteOptions::new()
            .dtype(npyz::DType::Plain(f64_little_endian))
            .shape(&[matrix.nrows() as u64, matrix.ncols() as u64])
            .order(Order::C)
            .writer(file)
            .begin_nd()?;
        for row in 0..matrix.nrows() {
            for column in 0..matrix.ncols() {
                writer.push(&matrix[(row, column)])?;
            }
        }
        writer.finish()
    })
}

/// A file whose header makes sense, and whose length is what the header claims.
struct Opened {
    file: BufReader<File>,
    header: NpyHeader,
    rows: usize,
    columns: usize,
    /// Bytes of a number, 4 or 8.
    bytes: u64,
}

fn open(path: &Path) -> Result<Opened, NpyError> {
    examine(path, store::open(path)?)
}

/// Looks at the header of an open file, which messages call `path`.
fn examine(path: &Path, file: File) -> Result<Opened, NpyError> {
    let unreadable = |source| unreadable(path, source);
    let length = file.metadata().map_err(unreadable)?.len();
    let mut file = BufReader::new(file);
    let checked = checked_header(&mut file)
        .map_err(unreadable)?
        .map_err(|r| not_npy(path, &r))?;
    // Of the bytes that were checked: those on disk may have become others.
    let header = NpyHeader::from_reader(&checked[..]).map_err(|e| not_npy(path, &e.to_string()))?;
    let start = checked.len() as u64;
    file.seek(SeekFrom::Start(start)).map_err(unreadable)?;

    let dtype = header.dtype();
    let bytes = match &dtype {
        npyz::DType::Plain(t)
            if t.type_char() == TypeChar::Float && [4, 8].contains(&t.size_field()) =>
        {
            t.size_field()
        }
        other => {
            return Err(NpyError::Type {
                path: path.into(),
                dtype: one_line(&other.descr()),
            });
        }
    };
    let (rows, columns) = match *header.shape() {
        [rows] if rows > 0 => (rows, 1),
        [rows, columns] if rows > 0 && columns > 0 => (rows, columns),
        _ => {
            return Err(NpyError::Shape {
                path: path.into(),
                shape: header.shape().into(),
            });
        }
    };
    let promised = u128::from(rows) * u128::from(columns) * u128::from(bytes);
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
        header,
        bytes,
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
        file,
        header,
        rows,
        columns,
        bytes,
    } = open(path)?;
    let order = header.order();
    let npy = npyz::NpyFile::with_header(header, file);
    let values = if bytes == 8 {
        npy.data::<f64>().map(|v| fill(rows, columns, order, v))
    } else {
        npy.data::<f32>()
            .map(|v| fill(rows, columns, order, v.map(|x| x.map(f64::from))))
    };
    values
        .map_err(|e| not_npy(path, &e.to_string()))?
        .map_err(|source| unreadable(path, source))
}

/// [`read`], and only finite values.
///
/// # Errors
/// As [`read`], and [`NpyError::NotFinite`] for the first NaN or infinity, rows first.
pub fn read_finite(path: &Path) -> Result<Matrix, NpyError> {
    let matrix = read(path)?;
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

/// Reads the file up to the end of its header without trusting it; the inner error says why it is
/// refused.
fn checked_header(file: &mut impl Read) -> io::Result<Result<Vec<u8>, String>> {
    let mut start = Vec::new();
    file.take(12 + HEADER_MAX as u64).read_to_end(&mut start)?;
    Ok((|| {
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
        if length > HEADER_MAX {
            return Err(format!(
                "its header claims {length} bytes, more than {HEADER_MAX}"
            ));
        }
        let (text, after) = text
            .split_at_checked(length)
            .map(|(text, after)| (text, after.len()))
            .ok_or("its header is cut short")?;
        let brackets = text.iter().filter(|b| b"([{".contains(b)).count();
        let digits = text.iter().filter(|b| b.is_ascii_digit()).count();
        let radix = text
            .windows(2)
            .any(|w| w[0] == b'0' && b"xXoObB".contains(&w[1]));
        if brackets > BRACKETS_MAX || digits > DIGITS_MAX || radix {
            return Err(
                "its header describes more than one plain array, or one too large".to_owned(),
            );
        }
        let end = start.len() - after;
        Ok(start[..end].to_vec())
    })())
}

fn fill(
    rows: usize,
    columns: usize,
    order: Order,
    values: impl Iterator<Item = io::Result<f64>>,
) -> io::Result<Matrix> {
    let mut matrix = Matrix::zeros(rows, columns);
    let mut values = values;
    let mut next = || {
        values
            .next()
            .unwrap_or(Err(io::ErrorKind::UnexpectedEof.into()))
    };
    if order == Order::Fortran {
        for value in matrix.iter_mut() {
            *value = next()?;
        }
        return Ok(matrix);
    }
    // Some rows at a time, so that neighbours in memory are written together.
    let mut band = vec![0.0; BAND.min(rows) * columns];
    for first in (0..rows).step_by(BAND) {
        let count = BAND.min(rows - first);
        for value in &mut band[..count * columns] {
            *value = next()?;
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
