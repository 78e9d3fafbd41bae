//! How the sums of a block lie in memory while they are made.

use rayon::prelude::*;

use super::tally::Moments;
use crate::num::lanes::padded;

/// Pixels that are worked off together.
pub(super) const TILE: usize = 16;

/// How the block sums of all orders lie in memory: \[tile\]\[order\]\[pixel in tile\]\[column\], rows padded to whole groups of lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub pixels: usize,
    pub columns: usize,
    pub orders: usize,
}

impl Layout {
    /// Numbers in a row.
    pub(super) fn width(self) -> usize {
        padded(self.columns)
    }

    /// Numbers in a tile.
    pub(super) fn tile(self) -> usize {
        (self.orders * TILE * self.width()).max(1)
    }

    /// A matrix of every order, all 0.
    pub(super) fn zeros(self) -> Vec<f64> {
        vec![0.0; self.pixels.div_ceil(TILE) * self.tile()]
    }

    fn place(self, order: usize, pixel: usize, column: usize) -> usize {
        let row = (pixel / TILE * self.orders + order) * TILE + pixel % TILE;
        row * self.width() + column
    }

    /// The same numbers as the estimate of one block.
    pub(super) fn moments(self, sums: &[f64]) -> Moments {
        let mut flat = vec![0.0; self.orders * self.pixels * self.columns];
        flat.par_chunks_mut(self.columns.max(1))
            .enumerate()
            .for_each(|(row, out)| {
                let place = self.place(row / self.pixels, row % self.pixels, 0);
                out.copy_from_slice(&sums[place..place + self.columns]);
            });
        Moments::of_block(flat, self.orders)
    }
}
