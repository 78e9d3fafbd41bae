//! What blocks of samples add up to.

mod error;
mod moments;

use std::ops::Range;

use super::plan::{Plan, Traced};
use super::reach::MayBeLit;
use super::spread::Spread;
use super::tails::UNLIT;
use crate::matrix::Matrix;
use crate::num::tree::Tree;
use crate::scene::Scene;
pub use error::TallyError;
pub use moments::Moments;
use moments::{HELD, add_orders};

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
            tails: nothing(),
        }
    }

    /// Blocks that are there.
    pub fn range(&self) -> Range<u32> {
        self.tree.range()
    }

    /// Bytes of one part.
    pub fn part_bytes(&self) -> usize {
        8 * self.columns * self.pixels * (self.orders + Spread::NUMBERS)
    }

    /// The parts: ranges of blocks, with their sums as little-endian f64, first
    /// \[order\]\[pixel\]\[column\], then scatter, third sum, largest and dark blocks of every
    /// \[pixel\]\[column\].
    pub fn parts(&self) -> impl Iterator<Item = (Range<u32>, Vec<u8>)> {
        self.tree.nodes().iter().map(|(range, moments)| {
            let spreads = moments.spreads.iter().flat_map(|s| s.numbers());
            let numbers = moments.sums.iter().copied().chain(spreads);
            let bytes = numbers.flat_map(f64::to_le_bytes).collect();
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
        let (sums, spreads) = numbers.split_at(self.orders * self.pixels * self.columns);
        let sums: Vec<f64> = sums.iter().map(|b| f64::from_le_bytes(*b)).collect();
        let (spreads, _) = spreads.as_chunks::<{ Spread::NUMBERS }>();
        let spread = |four: &[[u8; 8]; 4]| Spread::from_numbers(four.map(f64::from_le_bytes));
        let spreads: Option<Vec<Spread>> = spreads.iter().map(spread).collect();
        match spreads.filter(|_| sums.iter().all(|x| x.is_finite() && *x >= 0.0)) {
            Some(spreads) => self.add(range, Moments { sums, spreads }),
            None => Err(TallyError::NoFlux { range }),
        }
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
            let mut spreads = Vec::with_capacity(entries);
            for (p, row) in rows.iter().enumerate() {
                let (_, own) = &row.nodes()[i];
                for (n, own) in own.sums.chunks(self.columns).enumerate() {
                    let at = n * entries + p * self.columns;
                    sums[at..at + self.columns].copy_from_slice(own);
                }
                spreads.extend_from_slice(&own.spreads);
            }
            self.add(range.clone(), Moments { sums, spreads })?;
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
        let mut held = vec![[0.0; HELD]; nodes.len()];
        for at in 0..entries {
            if at % HELD == 0 {
                for (held, (_, moments)) in held.iter_mut().zip(nodes) {
                    add_orders(&moments.sums, entries, at, held);
                }
            }
            for (_, moments) in nodes {
                scatter += moments.spreads[at].scatter;
            }
            let whole: f64 = held.iter().map(|totals| totals[at % HELD]).sum();
            square += whole * whole;
            for (totals, (range, _)) in held.iter().zip(nodes) {
                let apart = totals[at % HELD] / count(range) - whole / n;
                scatter += count(range) * apart * apart;
            }
        }
        (square > 0.0).then(|| (n / (n - 1.0) * scatter / square).sqrt())
    }

    /// Means and standard errors over K blocks, Σx/K and √(M/(K(K − 1))), once all are there, and
    /// how far these are to be trusted; `spots` are those of its columns. The error of a single
    /// block is not known: it is infinite.
    ///
    /// An entry without light that a path may reach is in truth below −ln 0.05 · m/K ≈ 3m/K with 95
    /// % confidence, m what a lit block would bring (the rule of three; Hanley, Lippman-Hand, JAMA
    /// 249, 1983). That is its standard error, with m the largest block of its column, or the
    /// laser's power where all of the column is dark.
    pub fn traced(&self, scene: &Scene, spots: Range<usize>) -> Option<Traced> {
        let mut known = None;
        self.means(scene.laser.power, &mut |pixel, column| {
            let may_be_lit = known.get_or_insert_with(|| MayBeLit::new(scene, spots.clone()));
            may_be_lit.entry(pixel, column)
        })
    }

    fn means(
        &self,
        power: f64,
        may_be_lit: &mut dyn FnMut(usize, usize) -> bool,
    ) -> Option<Traced> {
        let Moments { sums, spreads } = self.tree.root()?;
        let k = f64::from(self.blocks);
        let (pixels, columns) = (self.pixels, self.columns);
        let entries = pixels * columns;
        let at = |p: usize, l: usize| p * columns + l;
        let bounces: Vec<Matrix> = (0..self.orders)
            .map(|n| Matrix::from_fn(pixels, columns, |p, l| sums[n * entries + at(p, l)]) / k)
            .collect();
        // The same order of additions as where the frames are read back, so that the bits are the
        // same.
        let flux = Matrix::from_fn(pixels, columns, |p, l| {
            bounces.iter().map(|b| b[(p, l)]).sum()
        });
        let mut stderr = Matrix::from_fn(pixels, columns, |p, l| match self.blocks {
            0 | 1 => f64::INFINITY,
            _ => (spreads[at(p, l)].scatter / (k * (k - 1.0))).sqrt(),
        });
        let mut tails = Matrix::zeros(pixels, columns);
        for l in 0..columns {
            let most = (0..pixels)
                .map(|p| spreads[at(p, l)].largest)
                .fold(0.0, f64::max);
            let lit = if most > 0.0 { most } else { power };
            for p in 0..pixels {
                let spread = spreads[at(p, l)];
                if spread.largest > 0.0 {
                    tails[(p, l)] = f64::from(spread.code(k, flux[(p, l)]));
                } else if may_be_lit(p, l) {
                    stderr[(p, l)] = 3.0 * lit / k;
                    tails[(p, l)] = f64::from(UNLIT);
                }
            }
        }
        let mut traced = Traced {
            bounces,
            flux,
            stderr,
            tails,
        };
        traced.flag_neighbours();
        Some(traced)
    }
}

#[cfg(test)]
mod tests;
