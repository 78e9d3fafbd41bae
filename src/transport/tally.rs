//! What blocks of samples add up to.

use std::ops::Range;

use rayon::prelude::*;

use super::plan::{Plan, Traced};
use crate::matrix::Matrix;
use crate::num::tree::Tree;
use crate::scene::Scene;

/// Numbers that one thread handles at a time.
const STRETCH: usize = 1 << 14;

/// Sums and scatter of the estimates of n blocks, entry by entry.
#[derive(Clone, Debug, PartialEq)]
pub struct Moments {
    /// Σx of the light that met each number of surfaces: \[order\]\[pixel\]\[column\], W.
    pub(super) sums: Vec<f64>,
    /// Σ(t − t̄)², t the total over orders: \[pixel\]\[column\], W².
    pub(super) scatter: Vec<f64>,
}

impl Moments {
    /// One block, whose estimates are `sums`, has no scatter yet.
    pub(super) fn of_block(sums: Vec<f64>, orders: usize) -> Self {
        let scatter = vec![0.0; sums.len() / orders];
        Self { sums, scatter }
    }

    /// Both numbers of blocks together. With n₁ and n₂ blocks of totals T₁ and T₂ (Chan, Golub,
    /// LeVeque, *Updating formulae and a pairwise algorithm for computing sample variances*,
    /// COMPSTAT 1982):
    ///
    /// ```text
    /// S = S₁ + S₂      M = M₁ + M₂ + (T₂/n₂ − T₁/n₁)² · n₁·n₂/(n₁ + n₂)
    /// ```
    pub(super) fn join((left, mut a): (Range<u32>, Self), (right, b): (Range<u32>, Self)) -> Self {
        let (n1, n2) = (
            f64::from(left.end - left.start),
            f64::from(right.end - right.start),
        );
        let weight = n1 * n2 / (n1 + n2);
        let entries = a.scatter.len().max(1);
        let orders = a.sums.len() / entries;
        a.scatter
            .par_chunks_mut(STRETCH)
            .zip(b.scatter.par_chunks(STRETCH))
            .enumerate()
            .for_each(|(stretch, (scatter, more))| {
                for (i, (m, more)) in scatter.iter_mut().zip(more).enumerate() {
                    let at = stretch * STRETCH + i;
                    let total =
                        |sums: &[f64]| -> f64 { (0..orders).map(|n| sums[n * entries + at]).sum() };
                    let apart = total(&b.sums) / n2 - total(&a.sums) / n1;
                    *m += more + apart * apart * weight;
                }
            });
        a.sums
            .par_chunks_mut(STRETCH)
            .zip(b.sums.par_chunks(STRETCH))
            .for_each(|(sums, more)| sums.iter_mut().zip(more).for_each(|(s, x)| *s += x));
        a
    }
}

/// The blocks of some columns of Φcam that are finished, as the largest nodes of the fixed binary
/// tree over all blocks of the plan.
///
/// Neither the number of threads nor the ranges in which the blocks are traced, on one machine or
/// many, change a bit of the result.
#[derive(Clone, Debug, PartialEq)]
pub struct Tally {
    orders: usize,
    pixels: usize,
    columns: usize,
    blocks: u32,
    tree: Tree<Moments>,
}

/// Why a part does not fit into a [`Tally`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TallyError {
    /// Its range is not a node of the tree of blocks, or does not follow the blocks that are there.
    #[error("blocks {}..{} are no part that follows block {after}; render these blocks again", range.start, range.end)]
    Misplaced {
        /// What was given.
        range: Range<u32>,
        /// The end of what is there.
        after: u32,
    },
    /// Its length is not that of its columns.
    #[error("blocks {}..{} have {found} bytes of sums in place of {expected}; render these blocks again", range.start, range.end)]
    Length {
        /// What was given.
        range: Range<u32>,
        /// Bytes given.
        found: usize,
        /// Bytes due.
        expected: usize,
    },
    /// It holds a number that is not a flux.
    #[error("blocks {}..{} hold a sum that is not a finite flux of at least 0; render these blocks again", range.start, range.end)]
    NoFlux {
        /// What was given.
        range: Range<u32>,
    },
}

impl Tally {
    /// Nothing yet, for `columns` columns, beginning at block `start`.
    pub fn new(scene: &Scene, plan: &Plan, columns: usize, start: u32) -> Self {
        Self {
            orders: scene.max_bounces as usize,
            pixels: scene.camera.pixels(),
            columns,
            blocks: plan.budget.blocks,
            tree: Tree::new(plan.budget.blocks, start),
        }
    }

    /// Whether it was made for `columns` columns of this scene and plan.
    pub(super) fn is_of(&self, scene: &Scene, plan: &Plan, columns: usize) -> bool {
        let own = [self.orders, self.pixels, self.columns];
        self.blocks == plan.budget.blocks
            && own == [scene.max_bounces as usize, scene.camera.pixels(), columns]
    }

    /// No light at all.
    pub(super) fn zeros(&self) -> Traced {
        let nothing = || Matrix::zeros(self.pixels, self.columns);
        Traced {
            bounces: (0..self.orders).map(|_| nothing()).collect(),
            flux: nothing(),
            stderr: nothing(),
        }
    }

    /// Blocks that are there.
    pub fn range(&self) -> Range<u32> {
        self.tree.range()
    }

    /// Bytes of one part.
    pub fn part_bytes(&self) -> usize {
        8 * self.columns * self.pixels * (self.orders + 1)
    }

    /// The parts: ranges of blocks, with their sums as little-endian f64, first
    /// \[order\]\[pixel\]\[column\], then the scatter \[pixel\]\[column\].
    pub fn parts(&self) -> impl Iterator<Item = (Range<u32>, Vec<u8>)> {
        self.tree.nodes().iter().map(|(range, moments)| {
            let numbers = moments.sums.iter().chain(&moments.scatter);
            let bytes = numbers.flat_map(|x| x.to_le_bytes()).collect();
            (range.clone(), bytes)
        })
    }

    /// Adds a part made by [`Tally::parts`], of the same columns and the same plan: the next one.
    ///
    /// # Errors
    /// [`TallyError`] if it is anything else.
    pub fn add_part(&mut self, range: Range<u32>, bytes: &[u8]) -> Result<(), TallyError> {
        let expected = self.part_bytes();
        if bytes.len() != expected {
            let found = bytes.len();
            return Err(TallyError::Length {
                range,
                found,
                expected,
            });
        }
        let (numbers, _) = bytes.as_chunks::<8>();
        let mut sums: Vec<f64> = numbers.iter().map(|b| f64::from_le_bytes(*b)).collect();
        if !sums.iter().all(|x| x.is_finite() && *x >= 0.0) {
            return Err(TallyError::NoFlux { range });
        }
        let scatter = sums.split_off(self.orders * self.pixels * self.columns);
        self.add(range, Moments { sums, scatter })
    }

    /// Adds the node that follows.
    pub(super) fn add(&mut self, range: Range<u32>, moments: Moments) -> Result<(), TallyError> {
        let after = self.range().end;
        self.tree
            .push(range, moments, Moments::join)
            .map_err(|range| TallyError::Misplaced { range, after })
    }

    /// Adds what every pixel has of the same blocks: one tree a pixel, whose nodes hold a single
    /// pixel each.
    pub(super) fn add_rows(&mut self, rows: &[Tree<Moments>]) -> Result<(), TallyError> {
        let Some(first) = rows.first() else {
            return Ok(());
        };
        let entries = self.pixels * self.columns;
        for (i, (range, _)) in first.nodes().iter().enumerate() {
            let mut sums = vec![0.0; self.orders * entries];
            let mut scatter = Vec::with_capacity(entries);
            for (p, row) in rows.iter().enumerate() {
                let (_, own) = &row.nodes()[i];
                for (n, own) in own.sums.chunks(self.columns).enumerate() {
                    let at = n * entries + p * self.columns;
                    sums[at..at + self.columns].copy_from_slice(own);
                }
                scatter.extend_from_slice(&own.scatter);
            }
            self.add(range.clone(), Moments { sums, scatter })?;
        }
        Ok(())
    }

    /// ‖σ‖/‖Φ‖ (Frobenius) of the n blocks that are there, σ the standard error of their mean,
    /// entry by entry: with their totals T and their scatter M
    ///
    /// ```text
    /// √(n/(n − 1)) · √ΣM / √ΣT²      M = Σᵢ Mᵢ + Σᵢ nᵢ (Tᵢ/nᵢ − T/n)² over the parts i
    /// ```
    ///
    /// `None` of fewer than two blocks, or of no light.
    pub fn relative_error(&self) -> Option<f64> {
        let nodes = self.tree.nodes();
        let count = |range: &Range<u32>| f64::from(range.end - range.start);
        let n: f64 = nodes.iter().map(|(range, _)| count(range)).sum();
        if n < 2.0 {
            return None;
        }
        let entries = self.pixels * self.columns;
        let (mut scatter, mut square) = (0.0, 0.0);
        let mut totals = vec![0.0; nodes.len()];
        for at in 0..entries {
            for (total, (_, moments)) in totals.iter_mut().zip(nodes) {
                *total = (0..self.orders)
                    .map(|k| moments.sums[k * entries + at])
                    .sum();
                scatter += moments.scatter[at];
            }
            let whole: f64 = totals.iter().sum();
            square += whole * whole;
            for (total, (range, _)) in totals.iter().zip(nodes) {
                let apart = total / count(range) - whole / n;
                scatter += count(range) * apart * apart;
            }
        }
        (square > 0.0).then(|| (n / (n - 1.0) * scatter / square).sqrt())
    }

    /// Means and standard errors over K blocks, Σx/K and √(M/(K(K − 1))), once all are there. The
    /// error of a single block is not known: it is infinite.
    pub fn traced(&self) -> Option<Traced> {
        let Moments { sums, scatter } = self.tree.root()?;
        let k = f64::from(self.blocks);
        let (pixels, columns) = (self.pixels, self.columns);
        let entries = pixels * columns;
        let matrix =
            |values: &[f64]| Matrix::from_fn(pixels, columns, |p, l| values[p * columns + l]);
        let bounces: Vec<Matrix> = (0..self.orders)
            .map(|n| matrix(&sums[n * entries..(n + 1) * entries]) / k)
            .collect();
        // The same order of additions as where the frames are read back, so that the bits are the
        // same.
        let flux = Matrix::from_fn(pixels, columns, |p, l| {
            bounces.iter().map(|b| b[(p, l)]).sum()
        });
        let stderr = match self.blocks {
            0 | 1 => Matrix::from_element(pixels, columns, f64::INFINITY),
            _ => matrix(scatter).map(|m| (m / (k * (k - 1.0))).sqrt()),
        };
        Some(Traced {
            bounces,
            flux,
            stderr,
        })
    }
}

#[cfg(test)]
mod tests;
