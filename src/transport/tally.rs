//! What blocks of samples add up to.

use std::ops::Range;

use rayon::prelude::*;

use super::render::{Plan, Traced};
use crate::matrix::Matrix;
use crate::num::tree::Tree;
use crate::scene::Scene;

/// Numbers that are worked off by one thread at a time.
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

    /// Both numbers of blocks together. With n₁ and n₂ blocks of totals T₁ and T₂ (Chan, Golub, LeVeque, *Updating formulae and a pairwise
    /// algorithm for computing sample variances*, COMPSTAT 1982):
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

/// The blocks of some columns of Φcam that are finished, as the largest nodes of the fixed binary tree over all blocks of the plan.
///
/// Neither the threads nor the pieces in which the blocks are worked off, on one machine or many, can change a bit of what comes out.
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
    /// Its range is no node of the tree of blocks, or does not follow what is there.
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
    /// A sum that no light adds up to.
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

    /// Whether it is made for `columns` columns of this.
    pub(super) fn is_of(&self, scene: &Scene, plan: &Plan, columns: usize) -> bool {
        let own = [self.orders, self.pixels, self.columns];
        self.blocks == plan.budget.blocks
            && own == [scene.max_bounces as usize, scene.camera.pixels(), columns]
    }

    /// No light at all.
    pub(super) fn dark(&self) -> Traced {
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

    /// The parts: ranges of blocks, with their sums as little-endian f64, first \[order\]\[pixel\]\[column\], then the scatter
    /// \[pixel\]\[column\].
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

    /// Adds what every pixel has of the same blocks: one tree a pixel, whose nodes hold a single pixel each.
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

    /// Means and standard errors over K blocks, Σx/K and √(M/(K(K − 1))), once all are there. The error of a single block is not known: it is
    /// infinite.
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
        // The same order of additions as where the frames are read back, so that the bits are the same.
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
mod tests {
    use super::*;
    use std::ops::ControlFlow;

    use crate::num::stream::Sampling;
    use crate::num::summation::mean_and_stderr;
    use crate::transport::{Budget, Estimator};

    const PIXELS: usize = 37;
    const COLUMNS: usize = 5;
    const ORDERS: usize = 2;

    fn value(b: u32, n: usize, p: usize, l: usize) -> f64 {
        let i = b as usize * 7919 + n * 104_729 + p * 31 + l;
        1.0 + 0.1 * p as f64 + 1e-9 * libm::sin(i as f64)
    }

    fn tally(blocks: u32, part: Range<u32>) -> Tally {
        let mut tally = Tally {
            orders: ORDERS,
            pixels: PIXELS,
            columns: COLUMNS,
            blocks,
            tree: Tree::new(blocks, part.start),
        };
        for b in part {
            let entries = (0..ORDERS).flat_map(|n| (0..PIXELS).map(move |p| (n, p)));
            let sums = entries
                .flat_map(|(n, p)| (0..COLUMNS).map(move |l| value(b, n, p, l)))
                .collect();
            tally
                .add(b..b + 1, Moments::of_block(sums, ORDERS))
                .unwrap();
        }
        tally
    }

    /// Against the two-pass formula for each entry, with blocks that differ in the ninth digit, of a number that is no power of two.
    #[test]
    fn means_and_standard_errors_are_the_two_pass_ones() {
        let blocks = 11;
        let traced = tally(blocks, 0..blocks).traced().unwrap();
        for (p, l) in (0..PIXELS).flat_map(|p| (0..COLUMNS).map(move |l| (p, l))) {
            let totals: Vec<f64> = (0..blocks)
                .map(|b| value(b, 0, p, l) + value(b, 1, p, l))
                .collect();
            let (mean, stderr) = mean_and_stderr(&totals);
            assert!((traced.flux[(p, l)] - mean).abs() <= 1e-15 * mean.abs() * 4.0);
            let found = traced.stderr[(p, l)];
            assert!((found - stderr).abs() <= 1e-6 * stderr, "{found} {stderr}");
        }
    }

    #[test]
    fn parts_go_through_bytes_and_come_out_as_the_whole() {
        let whole = tally(11, 0..11);
        let mut merged = tally(11, 0..0);
        for part in [0..3, 3..4, 4..11] {
            for (range, bytes) in tally(11, part).parts() {
                merged.add_part(range, &bytes).unwrap();
            }
        }
        assert_eq!(merged, whole);
        assert_eq!(tally(11, 0..10).traced(), None);
    }

    #[test]
    fn what_cannot_be_a_part_is_refused() {
        let mut tally = tally(11, 0..4);
        let bytes = vec![0u8; tally.part_bytes()];
        let misplaced = tally.add_part(5..6, &bytes).unwrap_err();
        assert_eq!(
            misplaced,
            TallyError::Misplaced {
                range: 5..6,
                after: 4
            }
        );
        let short = tally.add_part(4..8, &bytes[8..]).unwrap_err();
        assert!(matches!(short, TallyError::Length { .. }), "{short}");
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            let mut bytes = bytes.clone();
            bytes[80..88].copy_from_slice(&f64::to_le_bytes(bad));
            assert_eq!(
                tally.add_part(4..8, &bytes),
                Err(TallyError::NoFlux { range: 4..8 })
            );
        }
        assert_eq!(tally.add_part(4..8, &bytes), Ok(()));
    }

    /// Every estimator, cut anywhere, gives the bits of the whole; and what the control stops can be gone on with.
    #[test]
    fn traced_in_pieces_or_at_once_the_bits_are_the_same() {
        let text = Scene::load("bench").unwrap().text;
        let text = text
            .replace("per_side = 30", "per_side = 2")
            .replace("pixels = [16, 16]", "pixels = [3, 4]");
        let scene = Scene::from_toml("toy", &text).unwrap();
        let never = std::sync::atomic::AtomicBool::new(false);
        let control = super::super::Control {
            progress: &|_| (),
            stop: &never,
        };
        for (estimator, sampling) in Estimator::ALL
            .into_iter()
            .flat_map(|e| [(e, Sampling::Pcg), (e, Sampling::Sobol)])
        {
            let budget = Budget::new(32 * 37, sampling).unwrap();
            let plan = Plan {
                estimator,
                sampling,
                seed: 3,
                budget,
            };
            let whole = super::super::render(&scene, &plan, 0..5, control).unwrap();
            let mut merged = Tally::new(&scene, &plan, 5, 0);
            for part in [0..1, 1..7, 7..8, 8..32] {
                let start = Tally::new(&scene, &plan, 5, part.start);
                let mut looks = 0;
                let once = &mut |_: &Tally| {
                    looks += 1;
                    if looks == 1 {
                        ControlFlow::Break(())
                    } else {
                        ControlFlow::Continue(1)
                    }
                };
                let piece =
                    super::super::trace(&scene, &plan, 0..5, start, part.end, control, once);
                let go_on = &mut |_: &Tally| ControlFlow::Continue(1);
                let piece =
                    super::super::trace(&scene, &plan, 0..5, piece, part.end, control, go_on);
                assert_eq!(piece.range(), part);
                for (range, bytes) in piece.parts() {
                    merged.add_part(range, &bytes).unwrap();
                }
            }
            assert_eq!(
                merged.traced().unwrap(),
                whole,
                "{estimator:?} {sampling:?}"
            );
        }
    }
}
