//! Estimator [`Independent`](super::Estimator::Independent): every (pixel, spot) entry has paths of
//! its own.
//!
//! Each entry is the estimate of [`shared`](super::shared) for a single spot, from random numbers
//! that no other entry uses. The errors of all entries are independent, at the price of one path an
//! entry.

use super::shared::PixelRow;

/// The estimate of one block for all spots, one after the other: \[order\]\[column\], W.
pub(super) fn block(row: &mut PixelRow<'_>, block: u32) -> Vec<f64> {
    let spots = row.context.spots.range.clone();
    let columns = spots.len();
    let orders = row.context.scene.max_bounces as usize;
    let (mut sums, mut entry) = (vec![0.0; orders * columns], vec![0.0; orders]);
    for (column, spot) in spots.enumerate() {
        row.estimate(spot as u32, block, column..column + 1, &mut entry);
        for (order, flux) in entry.iter().enumerate() {
            sums[order * columns + column] = *flux;
        }
    }
    sums
}
