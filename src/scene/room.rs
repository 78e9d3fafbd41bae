//! What does not fit into memory is refused before it is taken.

use super::error::{Fault, keys};
use crate::store::Room;
use crate::store::memory::size;

/// Refuses `what`, which needs up to `need` bytes, where less may be taken. `finer` says how it
/// would need less.
pub(super) fn refuse_larger(what: &str, need: f64, finer: &str) -> Result<(), Fault> {
    let Some(room) = Room::now(0).filter(|room| need > room.bytes) else {
        return Ok(());
    };
    let cause = format!(
        "{what} needs up to {} of memory, and {} may be taken ({})",
        size(need),
        size(room.bytes),
        room.by
    );
    let cure = format!("{finer}, free some memory, or use a larger machine");
    Err(Fault::new(keys![], cause, cure))
}
