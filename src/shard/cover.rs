//! Whether shards make up the whole.

use std::ops::Range;

use super::ShardFile;

/// Two shards that cannot both be right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clash {
    /// They share some blocks, not all.
    Overlap(usize, usize),
    /// They hold the same blocks, and other bytes.
    Conflict(usize, usize),
}

/// The shards that are needed, in the order of their blocks, by their place in the list: of those that are equal, the first.
///
/// # Errors
/// [`Clash`] if two disagree on which blocks they hold, or on what is in them.
pub fn select(shards: &[ShardFile]) -> Result<Vec<usize>, Clash> {
    let mut order: Vec<usize> = (0..shards.len()).collect();
    order.sort_by_key(|i| (shards[*i].range.start, shards[*i].range.end, *i));
    let mut chosen: Vec<usize> = Vec::new();
    for i in order {
        let Some(&last) = chosen.last() else {
            chosen.push(i);
            continue;
        };
        let (before, this) = (&shards[last], &shards[i]);
        if before.range == this.range {
            if before.payload != this.payload {
                return Err(Clash::Conflict(last, i));
            }
        } else if this.range.start < before.range.end {
            return Err(Clash::Overlap(last, i));
        } else {
            chosen.push(i);
        }
    }
    Ok(chosen)
}

/// The blocks of `whole` that are in none of the `ranges`, whatever their order and overlap.
pub fn gaps(whole: Range<u64>, ranges: impl IntoIterator<Item = Range<u64>>) -> Vec<Range<u64>> {
    let mut ranges: Vec<Range<u64>> = ranges.into_iter().filter(|r| !r.is_empty()).collect();
    ranges.sort_by_key(|r| r.start);
    let mut gaps = Vec::new();
    let mut at = whole.start;
    for range in ranges {
        let start = range.start.min(whole.end);
        if start > at {
            gaps.push(at..start);
        }
        at = at.max(range.end);
    }
    if at < whole.end {
        gaps.push(at..whole.end);
    }
    gaps
}
