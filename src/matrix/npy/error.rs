//! Why a file cannot serve as a matrix.

use std::path::PathBuf;

use crate::store::ReadError;

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
    #[error("{} holds numbers of type {dtype}, not f64 or f32; {} before numpy.save", path.display(), conversion(dtype))]
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

/// How an array of this type becomes one of plain numbers.
pub(super) fn conversion(dtype: &str) -> &'static str {
    if dtype.contains('c') {
        "of complex numbers save the part that is meant, such as a.real,"
    } else {
        "convert it with a.astype('<f8')"
    }
}
