//! What Deflate packed, within what it can have packed.

use std::io::{Read, Result};

use flate2::read::ZlibDecoder;

/// Deflate's best: no n bytes hold more than 1032·n.
pub(super) const RATIO: u64 = 1032;

/// At most `most` bytes of what `packed` becomes, which Deflate bounds too.
pub(super) fn inflated(packed: &[u8], most: u64) -> Result<Vec<u8>> {
    let most = most.min(RATIO * packed.len() as u64);
    let mut bytes = Vec::with_capacity(most as usize);
    ZlibDecoder::new(packed)
        .take(most)
        .read_to_end(&mut bytes)?;
    Ok(bytes)
}
