//! Shards from disk.

use std::fs::{self, File};
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::{
    HEAD, Header, Identity, LAYOUT, LONGEST_HEADER, MAGIC, Provenance, ShardError, TRAILER,
};

/// A shard that was read through and found whole. Its parts stay on disk until they are asked for.
#[derive(Debug)]
pub struct ShardFile {
    /// The file.
    pub path: PathBuf,
    /// Its blocks.
    pub range: Range<u64>,
    /// Where it comes from.
    pub provenance: Provenance,
    /// SHA-256 of its parts and their ranges: equal for all that computed the same.
    pub payload: [u8; 32],
    parts: Vec<Place>,
}

/// Where a part is, and what its bytes were when the file was found whole: it may be replaced before they are asked for.
#[derive(Debug)]
struct Place {
    blocks: Range<u64>,
    start: u64,
    length: usize,
    digest: [u8; 32],
}

/// Bytes that are read and digested at once.
const STRETCH: usize = 1 << 16;

impl ShardFile {
    /// Reads a shard of `identity`, whose blocks are 0..`total`, through to its end. Of its parts no more than a stretch is in memory.
    ///
    /// # Errors
    /// [`ShardError`] if it is not one, not whole, or one of another plan.
    pub fn open(path: &Path, identity: &Identity, total: u64) -> Result<Self, ShardError> {
        let at = || path.to_owned();
        let unreadable = |source| ShardError::Unreadable { path: at(), source };
        let damaged = |what: &str| ShardError::Damaged {
            path: at(),
            what: what.to_owned(),
        };
        // Before it is opened: opening a pipe waits for somebody to write.
        if !fs::metadata(path).map_err(unreadable)?.is_file() {
            return Err(ShardError::NotAShard { path: at() });
        }
        let file = File::open(path).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        let mut file = Digesting::new(file);
        let header = file.header(path, length)?;
        let promised: u64 = header
            .parts
            .iter()
            .fold(0, |sum, p| sum.saturating_add(p.bytes));
        let start = file.read;
        let expected = start.saturating_add(promised).saturating_add(TRAILER);
        if length < expected {
            return Err(ShardError::Truncated {
                path: at(),
                found: length,
                expected,
            });
        }
        if length > expected {
            return Err(ShardError::TooLong {
                path: at(),
                found: length,
                expected,
            });
        }
        let mut payload = Sha256::new();
        let mut parts = Vec::with_capacity(header.parts.len());
        for part in &header.parts {
            let start = file.read;
            let digest = file.digest_part(part.bytes).map_err(unreadable)?;
            payload.update([part.from, part.to].map(u64::to_le_bytes).concat());
            payload.update(digest);
            parts.push(Place {
                blocks: part.from..part.to,
                start,
                length: part.bytes as usize,
                digest,
            });
        }
        if !file.closes().map_err(unreadable)? {
            return Err(damaged("its bytes are not those that were written"));
        }
        refuse_foreign(path, &header, identity)?;
        let range = header.from..header.to;
        let follow = parts.iter().try_fold(range.start, |end, part| {
            let Range { start, end: to } = part.blocks;
            (start == end && start < to).then_some(to)
        });
        if parts.is_empty() || follow != Some(range.end) || range.end > total {
            return Err(ShardError::Range {
                path: at(),
                range,
                total,
            });
        }
        Ok(Self {
            path: at(),
            range,
            provenance: header.provenance,
            payload: payload.finalize().into(),
            parts,
        })
    }

    /// The parts that lie in `range`, in order.
    pub fn parts(
        &self,
        range: Range<u64>,
    ) -> impl Iterator<Item = Result<(Range<u64>, Vec<u8>), ShardError>> {
        let inside =
            move |part: &&Place| part.blocks.start >= range.start && part.blocks.end <= range.end;
        self.parts.iter().filter(inside).map(|part| {
            let read = || {
                let mut file = File::open(&self.path)?;
                file.seek(SeekFrom::Start(part.start))?;
                let mut bytes = vec![0; part.length];
                file.read_exact(&mut bytes)?;
                Ok(bytes)
            };
            let path = || self.path.clone();
            let bytes = read().map_err(|source| ShardError::Unreadable {
                path: path(),
                source,
            })?;
            if Sha256::digest(&bytes)[..] != part.digest {
                let what = "it was replaced while it was read".to_owned();
                return Err(ShardError::Damaged { path: path(), what });
            }
            Ok((part.blocks.clone(), bytes))
        })
    }
}

/// A file that is digested while it is read.
struct Digesting {
    file: BufReader<File>,
    digest: Sha256,
    read: u64,
}

impl Digesting {
    fn new(file: File) -> Self {
        Self {
            file: BufReader::with_capacity(STRETCH, file),
            digest: Sha256::new(),
            read: 0,
        }
    }

    fn take(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        self.file.read_exact(bytes)?;
        self.digest.update(&*bytes);
        self.read += bytes.len() as u64;
        Ok(())
    }

    /// The header of a file of `length` bytes.
    fn header(&mut self, path: &Path, length: u64) -> Result<Header, ShardError> {
        let at = || path.to_owned();
        let unreadable = |source| ShardError::Unreadable { path: at(), source };
        let truncated = |expected| ShardError::Truncated {
            path: at(),
            found: length,
            expected,
        };
        if length == 0 {
            return Err(ShardError::Empty { path: at() });
        }
        let mut head = [0; HEAD as usize];
        let there = length.min(HEAD) as usize;
        self.take(&mut head[..there]).map_err(unreadable)?;
        let magic = there.min(MAGIC.len());
        if head[..magic] != MAGIC[..magic] {
            return Err(ShardError::NotAShard { path: at() });
        }
        if length < HEAD {
            return Err(truncated(HEAD + TRAILER));
        }
        let number = |from: usize| {
            u32::from_le_bytes([head[from], head[from + 1], head[from + 2], head[from + 3]])
        };
        if number(8) != LAYOUT {
            return Err(ShardError::Layout {
                path: at(),
                found: number(8),
                known: LAYOUT,
            });
        }
        let header = u64::from(number(12));
        if HEAD + header + TRAILER > length {
            return Err(truncated(HEAD + header + TRAILER));
        }
        let damaged = |what: String| ShardError::Damaged { path: at(), what };
        if header > LONGEST_HEADER {
            return Err(damaged(format!(
                "its header of {header} bytes is longer than any"
            )));
        }
        let mut bytes = vec![0; header as usize];
        self.take(&mut bytes).map_err(unreadable)?;
        serde_json::from_slice(&bytes)
            .map_err(|e| damaged(format!("its header cannot be read ({e})")))
    }

    fn digest_part(&mut self, bytes: u64) -> io::Result<[u8; 32]> {
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
    fn closes(mut self) -> io::Result<bool> {
        let mut trailer = [0; TRAILER as usize];
        self.file.read_exact(&mut trailer)?;
        Ok(self.digest.finalize()[..] == trailer)
    }
}

/// Refuses what is not part of the plan, and says in what it differs.
fn refuse_foreign(path: &Path, header: &Header, plan: &Identity) -> Result<(), ShardError> {
    let (path, found) = (path.to_owned(), &header.identity);
    match found.difference(plan) {
        None if found.id() == plan.id() && header.plan_id == plan.id().to_string() => Ok(()),
        None => Err(ShardError::Damaged {
            path,
            what: "what it says of its plan is out of order".to_owned(),
        }),
        Some((name, found, expected)) if name == Identity::NUMERICS => Err(ShardError::Numerics {
            path,
            found,
            expected,
        }),
        Some((name, found, expected)) => Err(ShardError::Foreign {
            path,
            name,
            found,
            expected,
        }),
    }
}
