//! Memory is refused before it is taken: what does not fit into the [`Room`] there is.

use super::room::Room;

/// Bytes of a GiB.
pub const GIB: f64 = (1u64 << 30) as f64;

/// What does not fit, and what would: cause and cure.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoRoom(String);

impl NoRoom {
    /// By cause and cure.
    pub(crate) fn new(cause: &str, cure: &str) -> Self {
        Self(format!("{cause}\n  cure: {cure}"))
    }
}

/// The memory that may be taken beside the threads of this process, of which each pool has as many
/// as the one that asks.
pub fn room() -> Option<Room> {
    Room::now(rayon::current_num_threads())
}

/// A number by its name, its value, and the need as a function of it: the largest that fits is
/// told.
pub type Cure<'a> = (&'a str, u64, &'a dyn Fn(f64) -> f64);

/// Refuses what needs more memory than there is, and tells of each cure how much would fit.
///
/// # Errors
/// [`NoRoom`].
pub fn refuse(what: &str, need: f64, cures: &[Cure<'_>]) -> Result<(), NoRoom> {
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
    Err(NoRoom::new(&cause, &cure))
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
pub fn size(bytes: f64) -> String {
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
