//! Shards onto disk.

use std::io::{self, Write};
use std::ops::Range;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::{HEAD, Header, Identity, LAYOUT, MAGIC, Part, Provenance};
use crate::store::{StoreError, write_whole};

/// Writes what the blocks of the `parts`, each following the one before, came to; the file appears whole or not at all.
///
/// # Errors
/// [`StoreError`] if it cannot be written.
pub fn write(
    path: &Path,
    identity: &Identity,
    parts: &[(Range<u64>, Vec<u8>)],
    provenance: Provenance,
) -> Result<(), StoreError> {
    let header = Header {
        plan_id: identity.id().to_string(),
        identity: identity.clone(),
        from: parts.first().map_or(0, |(range, _)| range.start),
        to: parts.last().map_or(0, |(range, _)| range.end),
        parts: parts
            .iter()
            .map(|(range, bytes)| Part {
                from: range.start,
                to: range.end,
                bytes: bytes.len() as u64,
            })
            .collect(),
        provenance,
    };
    write_whole(path, |file| {
        let header = serde_json::to_vec(&header)?;
        let length = u32::try_from(header.len()).map_err(io::Error::other)?;
        let mut out = Hashing {
            file,
            digest: Sha256::new(),
        };
        let mut head = Vec::with_capacity(HEAD as usize);
        head.extend(MAGIC);
        head.extend(LAYOUT.to_le_bytes());
        head.extend(length.to_le_bytes());
        out.write_all(&head)?;
        out.write_all(&header)?;
        for (_, bytes) in parts {
            out.write_all(bytes)?;
        }
        let Hashing { file, digest } = out;
        file.write_all(&digest.finalize())
    })
}

struct Hashing<'a> {
    file: &'a mut dyn Write,
    digest: Sha256,
}

impl Write for Hashing<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.file.write(bytes)?;
        self.digest.update(&bytes[..n]);
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
