//! Memory is refused before it is taken: what does not fit into the [`Room`] there is.

use super::failure::Failure;
use crate::store::Room;

pub(super) const GIB: f64 = (1u64 << 30) as f64;

/// The memory that may be taken beside the threads of this process.
pub(super) fn room() -> Option<Room> {
    Room::now(available_threads())
}

/// Threads of a pool that nobody gave a number; the environment may, as to every program of rayon.
pub(super) fn available_threads() -> usize {
    let given = std::env::var("RAYON_NUM_THREADS").ok();
    let given = given.and_then(|n| n.parse().ok()).filter(|n| *n > 0);
    given.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
}

/// A number by its name, its value, and the need as a function of it: the largest that fits is told.
pub(super) type Cure<'a> = (&'a str, u64, &'a dyn Fn(f64) -> f64);

/// Refuses what needs more memory than there is, and tells of each cure how much would fit.
pub(super) fn refuse(what: &str, need: f64, cures: &[Cure<'_>]) -> Result<(), Failure> {
    let Some(room) = room().filter(|room| need > room.bytes) else {
        return Ok(());
    };
    let fitting = cures.iter().filter_map(|(words, most, need)| {
        let fits = largest(*most, |n| need(n) <= room.bytes)?;
        Some(format!("{fits} {words}"))
    });
    let fitting: Vec<String> = fitting.collect();
    let cure = if fitting.is_empty() {
        "free some memory, or use a larger machine".to_owned()
    } else {
        format!(
            "at most {} would fit, all else the same; or use a larger machine",
            fitting.join(", or ")
        )
    };
    let cause = format!(
        "{what} need up to {} of memory, and {} may be taken ({})",
        size(need),
        size(room.bytes),
        room.by
    );
    Err(Failure::new(cause, cure))
}

/// The largest number from 1 to `most` that `fits`; what fits for a number does for smaller ones.
fn largest(most: u64, fits: impl Fn(f64) -> bool) -> Option<u64> {
    let (mut low, mut high) = (0, most);
    while low < high {
        let middle = low + (high - low).div_ceil(2);
        if fits(middle as f64) {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    (low > 0).then_some(low)
}

/// GiB with two digits behind the point, which is what one compares by.
pub(super) fn size(bytes: f64) -> String {
    format!("{:.2} GiB", bytes / GIB)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_that_fits_is_told() {
        for most in [1, 2, 7, 1 << 40] {
            for limit in [0, 1, 3, 6, 7, 1 << 39] {
                let fits = largest(most, |n| n <= limit as f64);
                assert_eq!(fits, Some(most.min(limit)).filter(|n| *n > 0));
            }
        }
    }
}
