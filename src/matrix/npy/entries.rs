//! Single entries of a matrix that stays on disk.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use super::{NpyError, Opened, examine, not_npy, unreadable};

/// Bytes of an f64.
const BYTES: u64 = 8;
/// Entries of a column no farther apart than this, in bytes, are read with what lies between them:
/// a page of memory costs about what a call of the system does.
const GAP: u64 = 4096;
/// Most bytes read at once.
const SPAN: u64 = 64 * 1024;

/// An open file of a matrix of f64, little-endian and in C order (as [`write`](super::write) leaves
/// it), of which any entries can be read without the rest. NaN and infinity are passed on.
pub struct Entries {
    path: PathBuf,
    file: File,
    /// Where the first number stands.
    start: u64,
    shape: (usize, usize),
}

impl Entries {
    /// Looks at the header of `file`, which messages call `path`; no number is read.
    ///
    /// # Errors
    /// Those of [`read`](super::read), and [`NpyError::NotNpy`] for another type or order of the
    /// numbers.
    pub fn of(file: File, path: &Path) -> Result<Self, NpyError> {
        let Opened {
            file,
            layout,
            rows,
            columns,
        } = examine(path, file)?;
        let plain = layout.bytes as u64 == BYTES && !layout.big_endian;
        if !plain || (layout.fortran && columns > 1) {
            let reason =
                "it is not of little-endian f64 in C order (a = numpy.ascontiguousarray(a, '<f8'))";
            return Err(not_npy(path, reason));
        }
        Ok(Self {
            path: path.into(),
            file: file.into_inner(),
            start: layout.start,
            shape: (rows, columns),
        })
    }

    /// Rows and columns.
    pub fn shape(&self) -> (usize, usize) {
        self.shape
    }

    /// Entries `first` to `first + count − 1` of row `row`.
    ///
    /// # Errors
    /// [`NpyError::Unreadable`], also where the file has become shorter than it was.
    ///
    /// # Panics
    /// If the matrix has no such entry.
    pub fn row(&mut self, row: usize, first: usize, count: usize) -> Result<Vec<f64>, NpyError> {
        let (rows, columns) = self.shape;
        let inside = row < rows && first <= columns && count <= columns - first;
        assert!(
            inside,
            "row {row}, {count} entries from {first} on, of {rows} × {columns}"
        );
        let mut bytes = vec![0; count * BYTES as usize];
        self.bytes(row, first, &mut bytes)?;
        let numbers = bytes.chunks_exact(BYTES as usize);
        Ok(numbers.map(number).collect())
    }

    /// The entries of column `column` in the rows `rows`, which grow.
    ///
    /// # Errors
    /// [`NpyError::Unreadable`], also where the file has become shorter than it was.
    ///
    /// # Panics
    /// If the rows do not grow, or the matrix has no such entry.
    pub fn column(&mut self, column: usize, rows: &[usize]) -> Result<Vec<f64>, NpyError> {
        let (height, columns) = self.shape;
        let inside = column < columns && rows.last().is_none_or(|r| *r < height);
        assert!(
            inside && rows.is_sorted_by(|a, b| a < b),
            "column {column}, {} rows, of {height} × {columns}",
            rows.len()
        );
        let apart = |from: usize, to: usize| (to - from) as u64 * columns as u64 * BYTES;
        let mut values = Vec::with_capacity(rows.len());
        let mut bytes = Vec::new();
        let mut rest = rows;
        while let [first, ..] = *rest {
            let near = rest
                .windows(2)
                .take_while(|w| apart(w[0], w[1]) <= GAP && apart(first, w[1]) <= SPAN - BYTES);
            let (together, later) = rest.split_at(1 + near.count());
            let last = together[together.len() - 1];
            bytes.resize((apart(first, last) + BYTES) as usize, 0);
            self.bytes(first, column, &mut bytes)?;
            values.extend(together.iter().map(|r| {
                let at = apart(first, *r) as usize;
                number(&bytes[at..at + BYTES as usize])
            }));
            rest = later;
        }
        Ok(values)
    }

    /// The bytes from an entry on.
    fn bytes(&mut self, row: usize, column: usize, bytes: &mut [u8]) -> Result<(), NpyError> {
        // No further than the file is long, which was held against the shape.
        let at = self.start + (row as u64 * self.shape.1 as u64 + column as u64) * BYTES;
        read_at(&mut self.file, at, bytes).map_err(|source| unreadable(&self.path, source))
    }
}

/// One call of the system, not two: single entries are read by the hundred thousand.
#[cfg(unix)]
fn read_at(file: &mut File, at: u64, bytes: &mut [u8]) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, at)
}

#[cfg(not(unix))]
fn read_at(file: &mut File, at: u64, bytes: &mut [u8]) -> io::Result<()> {
    use std::io::{Read, Seek, SeekFrom};
    file.seek(SeekFrom::Start(at))?;
    file.read_exact(bytes)
}

fn number(bytes: &[u8]) -> f64 {
    f64::from_le_bytes(std::array::from_fn(|i| bytes[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::{Matrix, npy};

    fn written(matrix: &Matrix) -> (tempfile::TempDir, PathBuf) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.npy");
        npy::write(&path, matrix).unwrap();
        (dir, path)
    }

    fn entries(path: &Path) -> Result<Entries, NpyError> {
        Entries::of(File::open(path).unwrap(), path)
    }

    #[test]
    fn entries_are_those_of_the_whole() {
        // Rows of 24 bytes, of less than a page, and of more than one.
        for columns in [3, 500, 600] {
            let a = Matrix::from_fn(90, columns, |i, j| (i * 1000 + j) as f64);
            let (_dir, path) = written(&a);
            let mut entries = entries(&path).unwrap();
            assert_eq!(entries.shape(), (90, columns));
            let all: Vec<usize> = (0..90).collect();
            for rows in [&all[..], &[0, 1, 7, 8, 88, 89], &[5], &[]] {
                let expected: Vec<f64> = rows.iter().map(|r| a[(*r, 2)]).collect();
                assert_eq!(entries.column(2, rows).unwrap(), expected);
            }
            for (row, first, count) in [(0, 0, columns), (89, 1, columns - 1), (4, 2, 0)] {
                let expected: Vec<f64> = (first..first + count).map(|c| a[(row, c)]).collect();
                assert_eq!(entries.row(row, first, count).unwrap(), expected);
            }
        }
    }

    #[test]
    fn what_is_not_finite_is_passed_on() {
        let a = Matrix::from_row_slice(1, 3, &[f64::NAN, f64::INFINITY, -0.0]);
        let (_dir, path) = written(&a);
        let row = entries(&path).unwrap().row(0, 0, 3).unwrap();
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&row), bits(&[f64::NAN, f64::INFINITY, -0.0]));
    }

    #[test]
    fn other_layouts_are_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.npy");
        let file = |descr: &str, fortran: &str, bytes: usize| {
            let mut header =
                format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': (2, 3), }}");
            header += &" ".repeat(117 - header.len());
            let start = [b"\x93NUMPY\x01\x00\x76\x00", header.as_bytes(), b"\n"].concat();
            std::fs::write(&path, [start, vec![0; bytes]].concat()).unwrap();
            entries(&path).map(|e| e.shape())
        };
        assert_eq!(file("<f8", "False", 48).unwrap(), (2, 3));
        for (descr, fortran, bytes) in [
            ("<f8", "True", 48),
            (">f8", "False", 48),
            ("<f4", "False", 24),
        ] {
            let refused = file(descr, fortran, bytes);
            assert!(
                matches!(refused, Err(NpyError::NotNpy { .. })),
                "{refused:?}"
            );
        }
        assert!(matches!(
            file("<i8", "False", 48),
            Err(NpyError::Type { .. })
        ));
        for bytes in [47, 49] {
            let refused = file("<f8", "False", bytes);
            assert!(
                matches!(refused, Err(NpyError::Length { .. })),
                "{refused:?}"
            );
        }
    }

    #[test]
    fn a_file_cut_short_while_it_is_open_is_an_error() {
        let (_dir, path) = written(&Matrix::zeros(10, 10));
        let mut entries = entries(&path).unwrap();
        let file = File::options().write(true).open(&path).unwrap();
        file.set_len(400).unwrap();
        for refused in [entries.row(9, 0, 10), entries.column(0, &[1, 9])] {
            assert!(
                matches!(refused, Err(NpyError::Unreadable(_))),
                "{refused:?}"
            );
        }
    }
}
