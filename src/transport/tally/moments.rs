//! Sums of blocks, and how the blocks are spread.

use std::ops::Range;

use rayon::prelude::*;

use crate::transport::spread::Spread;

/// Numbers that one thread handles at a time.
const STRETCH: usize = 1 << 14;

/// Sums and spread of the estimates of n blocks, entry by entry.
#[derive(Clone, Debug, PartialEq)]
pub struct Moments {
    /// Σx of the light that met each number of surfaces: \[order\]\[pixel\]\[column\], W.
    pub(in crate::transport) sums: Vec<f64>,
    /// Of the totals over orders: \[pixel\]\[column\].
    pub(in crate::transport) spreads: Vec<Spread>,
}

impl Moments {
    /// One block, whose estimates are `sums`.
    pub(in crate::transport) fn of_block(sums: Vec<f64>, orders: usize) -> Self {
        let entries = sums.len() / orders;
        let mut spreads = Vec::with_capacity(entries);
        for from in (0..entries).step_by(HELD) {
            let mut held = [0.0; HELD];
            let held = &mut held[..HELD.min(entries - from)];
            add_orders(&sums, entries, from, held);
            spreads.extend(held.iter().copied().map(Spread::of_block));
        }
        Self { sums, spreads }
    }

    /// Both numbers of blocks together: S = S₁ + S₂, and [`Spread::join`] with δ = T₂/n₂ − T₁/n₁, T
    /// the totals over orders.
    pub(in crate::transport) fn join(
        (left, mut a): (Range<u32>, Self),
        (right, b): (Range<u32>, Self),
    ) -> Self {
        let counts = [left, right].map(|r| f64::from(r.end - r.start));
        let entries = a.spreads.len();
        a.spreads
            .par_chunks_mut(STRETCH)
            .zip(b.spreads.par_chunks(STRETCH))
            .enumerate()
            .for_each(|(stretch, (spreads, more))| {
                let parts = spreads.chunks_mut(HELD).zip(more.chunks(HELD));
                let [mut t, mut u] = [[0.0; HELD]; 2];
                for (part, (spreads, more)) in parts.enumerate() {
                    let from = stretch * STRETCH + part * HELD;
                    let (t, u) = (&mut t[..spreads.len()], &mut u[..spreads.len()]);
                    add_orders(&a.sums, entries, from, t);
                    add_orders(&b.sums, entries, from, u);
                    let both = spreads.iter_mut().zip(more).zip(t.iter().zip(&*u));
                    for ((own, more), (t, u)) in both {
                        *own = own.join(*more, counts, u / counts[1] - t / counts[0]);
                    }
                }
            });
        a.sums
            .par_chunks_mut(STRETCH)
            .zip(b.sums.par_chunks(STRETCH))
            .for_each(|(sums, more)| sums.iter_mut().zip(more).for_each(|(s, x)| *s += x));
        a
    }
}

/// Entries whose totals are held at a time.
pub(super) const HELD: usize = 64;

/// Sets `totals` to Σ over orders of the entries from `from` on.
#[inline]
pub(super) fn add_orders(sums: &[f64], entries: usize, from: usize, totals: &mut [f64]) {
    totals.fill(0.0);
    for order in sums.chunks_exact(entries) {
        let light = totals.iter_mut().zip(&order[from..]);
        light.for_each(|(total, x)| *total += x);
    }
}
