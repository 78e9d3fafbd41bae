//! An array from its chunks.

use super::super::super::array::MOST_ENTRIES;
use super::fault::{CUT, Fault};
use super::file::File;
use super::filters::Filters;
use super::tree::Tree;

/// Most bytes of a chunk: those of the largest array.
const MOST_BYTES: usize = 8 * MOST_ENTRIES;

/// How an array is cut into chunks: boxes of one size along a grid, the last ones padded.
pub(super) struct Grid<'g> {
    /// Lengths of the array; the last index runs fastest.
    shape: &'g [usize],
    /// Lengths of a chunk.
    chunk: &'g [usize],
    /// Chunks along each index.
    cells: Vec<usize>,
    /// Bytes of an element, and of a chunk.
    element: usize,
    bytes: usize,
}

impl<'g> Grid<'g> {
    /// For an array of `shape` with at least one entry of `element` bytes each; `lengths` are those
    /// of a chunk, and the bytes of an element.
    ///
    /// # Errors
    /// [`Fault`] for lengths that are none of chunks of the array.
    pub(super) fn new(
        shape: &'g [usize],
        lengths: &'g [usize],
        element: usize,
    ) -> Result<Self, Fault> {
        let misfit = Fault::Damaged("has chunks that do not fit it");
        let (last, chunk) = lengths.split_last().ok_or(misfit)?;
        if *last != element || chunk.len() != shape.len() || chunk.contains(&0) {
            return Err(misfit);
        }
        let bytes = lengths.iter().try_fold(1usize, |n, l| n.checked_mul(*l));
        let bytes = bytes.filter(|n| *n <= MOST_BYTES).ok_or(misfit)?;
        Ok(Self {
            shape,
            chunk,
            cells: shape
                .iter()
                .zip(chunk)
                .map(|(s, c)| s.div_ceil(*c))
                .collect(),
            element,
            bytes,
        })
    }

    /// The bytes of the whole array, from the chunks that the tree at `address` finds.
    ///
    /// # Errors
    /// [`Fault`] if any chunk is missing, there twice, or damaged, and if the array is larger than
    /// the bytes of the file can be.
    pub(super) fn gathered(
        &self,
        file: &File<'_>,
        address: u64,
        filters: &Filters,
    ) -> Result<Vec<u8>, Fault> {
        let tree = Tree {
            file: *file,
            kind: 1,
            key: 8 + 8 * (self.shape.len() + 1),
        };
        let count: usize = self.cells.iter().product();
        let all = (count as u64).saturating_mul(self.bytes as u64);
        if all > filters.most(file.len()) {
            return Err(Fault::Damaged("is larger than its file can hold"));
        }
        let entries: usize = self.shape.iter().product();
        let mut array = vec![0; entries * self.element];
        let mut found = vec![false; count];
        tree.walk(address, &mut |mut key, address| {
            let head = (|| Some((key.count(4)?, key.number(4)?)))();
            let (length, left_out) = head.ok_or(CUT)?;
            let mut start = Vec::with_capacity(self.shape.len());
            for _ in self.shape {
                start.push(key.count(8).ok_or(CUT)?);
            }
            let cell = self.cell(&start).filter(|cell| !found[*cell]);
            let cell = cell.ok_or(Fault::Damaged("has a chunk twice, or outside of it"))?;
            found[cell] = true;
            let stored = file.at(address).and_then(|mut bytes| bytes.take(length));
            let stored = stored.ok_or(CUT)?;
            let chunk = filters.undone(stored, left_out, self.element, self.bytes)?;
            self.place(&mut array, &start, &chunk);
            Ok(())
        })?;
        if found.contains(&false) {
            return Err(Fault::Damaged("has chunks that were never written"));
        }
        Ok(array)
    }

    /// The number of the chunk that begins at `start`, or `None` if none does.
    fn cell(&self, start: &[usize]) -> Option<usize> {
        let mut cell = 0;
        for (axis, at) in start.iter().enumerate() {
            let along = at / self.chunk[axis];
            if at % self.chunk[axis] != 0 || along >= self.cells[axis] {
                return None;
            }
            cell = cell * self.cells[axis] + along;
        }
        Some(cell)
    }

    /// Copies what of the chunk at `start` lies within the array, row by row.
    fn place(&self, array: &mut [u8], start: &[usize], chunk: &[u8]) {
        let inside = |axis: usize| self.chunk[axis].min(self.shape[axis] - start[axis]);
        let last = self.shape.len() - 1;
        let run = inside(last) * self.element;
        let rows: usize = (0..last).map(inside).product();
        let mut index = vec![0; last];
        for _ in 0..rows {
            let (mut from, mut to) = (0, 0);
            for axis in 0..last {
                from = from * self.chunk[axis] + index[axis];
                to = to * self.shape[axis] + start[axis] + index[axis];
            }
            let from = from * self.chunk[last] * self.element;
            let to = (to * self.shape[last] + start[last]) * self.element;
            array[to..to + run].copy_from_slice(&chunk[from..from + run]);
            for axis in (0..last).rev() {
                index[axis] += 1;
                if index[axis] < inside(axis) {
                    break;
                }
                index[axis] = 0;
            }
        }
    }
}
