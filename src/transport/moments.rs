//! Sums over blocks of a whole matrix.

use rayon::prelude::*;

use super::render::Traced;
use crate::matrix::Matrix;
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

    /// Numbers of one order.
    fn one_order(self) -> usize {
        self.pixels.div_ceil(TILE) * TILE * self.width()
    }

    fn place(self, order: usize, pixel: usize, column: usize) -> usize {
        let row = (pixel / TILE * self.orders + order) * TILE + pixel % TILE;
        row * self.width() + column
    }
}

/// Mean and scatter of block estimates, entry by entry, in the memory of a few matrices whatever their number.
///
/// With d_b = x_b − x_1 the mean is x_1 + Σd_b/K and the standard error √((Σd_b² − (Σd_b)²/K)/(K(K − 1))): the differences are as small as
/// the scatter itself, so that nothing cancels that would be missed. Blocks are added in their order. A single block has no known error: it is infinite.
#[derive(Debug)]
pub(super) struct Moments {
    layout: Layout,
    blocks: f64,
    first: Vec<f64>,
    /// Σd of every order.
    sums: Vec<f64>,
    /// Σd² of the total over orders: \[pixel, whole tiles of them\]\[column\].
    squares: Vec<f64>,
}

impl Moments {
    pub(super) fn new(layout: Layout) -> Self {
        Self {
            layout,
            blocks: 0.0,
            first: Vec::new(),
            sums: layout.zeros(),
            squares: vec![0.0; layout.one_order()],
        }
    }

    /// Adds the estimate of one block.
    pub(super) fn add(&mut self, mut block: Vec<f64>) {
        self.blocks += 1.0;
        if self.first.is_empty() {
            self.first = block;
            return;
        }
        let layout = self.layout;
        let order = TILE * layout.width();
        block
            .par_chunks_mut(layout.tile())
            .zip(self.first.par_chunks(layout.tile()))
            .zip(self.sums.par_chunks_mut(layout.tile()))
            .zip(self.squares.par_chunks_mut(order))
            .for_each(|(((block, first), sums), squares)| {
                for (x, first) in block.iter_mut().zip(first) {
                    *x -= first;
                }
                for (sum, d) in sums.iter_mut().zip(&*block) {
                    *sum += d;
                }
                for (i, square) in squares.iter_mut().enumerate() {
                    let total: f64 = (0..layout.orders).map(|n| block[n * order + i]).sum();
                    *square += total * total;
                }
            });
    }

    /// Means and standard errors.
    pub(super) fn traced(&self) -> Traced {
        let (layout, k) = (self.layout, self.blocks);
        let matrix =
            |f: &dyn Fn(usize, usize) -> f64| Matrix::from_fn(layout.pixels, layout.columns, f);
        let bounces: Vec<Matrix> = (0..layout.orders)
            .map(|n| {
                matrix(&|p, l| {
                    let place = layout.place(n, p, l);
                    self.first.get(place).copied().unwrap_or(0.0) + self.sums[place] / k.max(1.0)
                })
            })
            .collect();
        // The same order of additions as where the frames are read back, so that the bits are the same.
        let flux = matrix(&|p, l| bounces.iter().map(|b| b[(p, l)]).sum());
        let stderr = matrix(&|p, l| {
            if k < 2.0 {
                return f64::INFINITY;
            }
            let sum = layout.total(&self.sums, p, l);
            let scatter = (self.squares[p * layout.width() + l] - sum * sum / k).max(0.0);
            (scatter / (k * (k - 1.0))).sqrt()
        });
        Traced {
            bounces,
            flux,
            stderr,
        }
    }
}

impl Layout {
    /// Sum over the orders of an entry.
    fn total(self, sums: &[f64], pixel: usize, column: usize) -> f64 {
        (0..self.orders)
            .map(|n| sums[self.place(n, pixel, column)])
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::summation::mean_and_stderr;

    /// Against the two-pass formula for each entry, with blocks that differ in the ninth digit.
    #[test]
    fn means_and_standard_errors_are_the_two_pass_ones() {
        let layout = Layout {
            pixels: 37,
            columns: 5,
            orders: 2,
        };
        let value = |b: usize, n: usize, p: usize, l: usize| {
            let i = b * 7919 + n * 104_729 + p * 31 + l;
            1.0 + 0.1 * p as f64 + 1e-9 * libm::sin(i as f64)
        };
        let blocks = 9;
        let mut moments = Moments::new(layout);
        for b in 0..blocks {
            let mut block = layout.zeros();
            for (n, p, l) in (0..2)
                .flat_map(|n| (0..37).map(move |p| (n, p)))
                .flat_map(|(n, p)| (0..5).map(move |l| (n, p, l)))
            {
                block[layout.place(n, p, l)] = value(b, n, p, l);
            }
            moments.add(block);
        }
        let traced = moments.traced();
        for (p, l) in (0..37).flat_map(|p| (0..5).map(move |l| (p, l))) {
            let totals: Vec<f64> = (0..blocks)
                .map(|b| value(b, 0, p, l) + value(b, 1, p, l))
                .collect();
            let (mean, stderr) = mean_and_stderr(&totals);
            assert!((traced.flux[(p, l)] - mean).abs() <= 1e-15 * mean.abs() * 4.0);
            let found = traced.stderr[(p, l)];
            assert!((found - stderr).abs() <= 1e-6 * stderr, "{found} {stderr}");
        }
    }
}
