//! A file of blocks that is digested while it is read.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use sha2::{Digest, Sha256};

use super::{
    HEAD, Header, LAYOUT, LONGEST_HEADER, MAGIC, STRETCH, TRAILER, cut_off, no_shard, spoilt,
    unreadable,
};
use crate::jobs::JobError;

/// A file that is digested while it is read.
pub(super) struct Digesting {
    pub(super) file: BufReader<File>,
    pub(super) digest: Sha256,
    pub(super) read: u64,
}

impl Digesting {
    pub(super) fn take(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        self.file.read_exact(bytes)?;
        self.digest.update(&*bytes);
        self.read += bytes.len() as u64;
        Ok(())
    }

    /// The header of a file of `length` bytes.
    pub(super) fn header(&mut self, path: &Path, length: u64) -> Result<Header, JobError> {
        if length == 0 {
            let what = "is empty: whoever wrote it never finished";
            return Err(spoilt(path, what.to_owned()));
        }
        let mut head = [0; HEAD as usize];
        let there = length.min(HEAD) as usize;
        self.take(&mut head[..there])
            .map_err(|e| unreadable(path, e))?;
        let magic = there.min(MAGIC.len());
        if head[..magic] != MAGIC[..magic] {
            return Err(no_shard(path));
        }
        if length < HEAD {
            return Err(cut_off(path, length, HEAD + TRAILER));
        }
        let number = |from: usize| {
            u32::from_le_bytes([head[from], head[from + 1], head[from + 2], head[from + 3]])
        };
        let (layout, header) = (number(8), u64::from(number(12)));
        if layout != LAYOUT {
            let path = path.display();
            return Err(JobError::Refused(format!(
                "{path} has layout {layout}, and this version of phicam reads layout {LAYOUT}; use the version that wrote it, or compute this shard again"
            )));
        }
        if HEAD + header + TRAILER > length {
            return Err(cut_off(path, length, HEAD + header + TRAILER));
        }
        if header > LONGEST_HEADER {
            let what = format!("is damaged: its header of {header} bytes is longer than any");
            return Err(spoilt(path, what));
        }
        let mut bytes = vec![0; header as usize];
        self.take(&mut bytes).map_err(|e| unreadable(path, e))?;
        serde_json::from_slice(&bytes)
            .map_err(|e| spoilt(path, format!("is damaged: its header cannot be read ({e})")))
    }

    pub(super) fn digest_part(&mut self, bytes: u64) -> io::Result<[u8; 32]> {
        let mut part = Sha256::new();
        let mut stretch = [0; STRETCH];
        let mut left = bytes;
        while left > 0 {
            let n = left.min(STRETCH as u64) as usize;
            self.take(&mut stretch[..n])?;
            part.update(&stretch[..n]);
            left -= n as u64;
        }
        Ok(part.finalize().into())
    }

    /// Whether the closing digest is that of all before.
    pub(super) fn closes(mut self) -> io::Result<bool> {
        let mut trailer = [0; TRAILER as usize];
        self.file.read_exact(&mut trailer)?;
        Ok(self.digest.finalize()[..] == trailer)
    }
}
