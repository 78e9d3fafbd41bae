//! Some rows of a matrix at a time.

use std::fs::File;
use std::io::{BufReader, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::{Layout, NpyError, Opened, fill, finite, not_npy, open, unreadable};
use crate::matrix::Matrix;

/// An open file of a matrix in C order, whose rows can be read where they are wanted.
pub struct Rows {
    path: PathBuf,
    shape: (usize, usize),
    file: BufReader<File>,
    layout: Layout,
}

impl Rows {
    /// Opens `path` and looks at its header; no number is read.
    ///
    /// # Errors
    /// Those of [`read`](super::read), and [`NpyError::NotNpy`] for Fortran order, whose rows are
    /// scattered over the file.
    pub fn open(path: &Path) -> Result<Self, NpyError> {
        let Opened {
            file,
            mut layout,
            rows,
            columns,
        } = open(path)?;
        if layout.fortran && columns > 1 {
            let reason = "it is in Fortran order, so that its rows cannot be read one by one (a = numpy.ascontiguousarray(a))";
            return Err(not_npy(path, reason));
        }
        layout.fortran = false;
        Ok(Rows {
            path: path.into(),
            shape: (rows, columns),
            file,
            layout,
        })
    }

    /// Rows and columns of the file.
    pub fn shape(&self) -> (usize, usize) {
        self.shape
    }

    /// Up to `count` rows from row `first` on, all finite; fewer at the end of the file, none
    /// beyond it.
    ///
    /// # Errors
    /// [`NpyError::Unreadable`], [`NpyError::NotFinite`].
    pub fn read(&mut self, first: usize, count: usize) -> Result<Matrix, NpyError> {
        let (rows, columns) = self.shape;
        let count = count.min(rows.saturating_sub(first));
        if count == 0 {
            return Ok(Matrix::zeros(0, columns));
        }
        // No further than the file is long, which was held against the shape.
        let at = self.layout.start + (first * columns * self.layout.bytes) as u64;
        let matrix = self
            .file
            .seek(SeekFrom::Start(at))
            .and_then(|_| fill(count, columns, &mut self.file, self.layout))
            .map_err(|source| unreadable(&self.path, source))?;
        finite(&self.path, first, matrix)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::npy;

    #[test]
    fn rows_are_those_of_the_whole() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.npy");
        let a = Matrix::from_fn(70, 3, |i, j| (i * 10 + j) as f64);
        npy::write(&path, &a).unwrap();
        let mut rows = Rows::open(&path).unwrap();
        assert_eq!(rows.shape(), (70, 3));
        for (first, count, found) in [(0, 70, 70), (33, 20, 20), (5, 1, 1), (60, 40, 10)] {
            assert_eq!(rows.read(first, count).unwrap(), a.rows(first, found));
        }
        assert_eq!(rows.read(70, 4).unwrap().nrows(), 0);
    }

    #[test]
    fn what_is_not_finite_is_told_by_its_row_in_the_file() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.npy");
        let mut a = Matrix::from_element(9, 2, 1.0);
        a[(7, 1)] = f64::NAN;
        npy::write(&path, &a).unwrap();
        let mut rows = Rows::open(&path).unwrap();
        assert!(rows.read(0, 5).is_ok());
        assert!(matches!(
            rows.read(5, 4),
            Err(NpyError::NotFinite {
                row: 7,
                column: 1,
                ..
            })
        ));
    }
}
