//! What a range of blocks came to, as a file.

mod digesting;

use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{Identity, JobError};
use crate::store::{self, ReadError, ReadFault, StoreError, write_whole};
use digesting::Digesting;

/// Ranges of blocks, each following the one before, and what they came to.
pub type Parts = Vec<(Range<u64>, Vec<u8>)>;

/// The end of the parts, which begin where `range` does.
pub fn end(parts: &Parts, range: &Range<u64>) -> u64 {
    parts.last().map_or(range.start, |(part, _)| part.end)
}

/// What the name of a shard ends in.
pub const EXTENSION: &str = "phs";

const MAGIC: [u8; 8] = *b"phicam\0\0";
const LAYOUT: u32 = 2;
/// Magic, layout and the length of the header.
const HEAD: u64 = 16;
/// A SHA-256 digest.
const TRAILER: u64 = 32;
/// The longest header: far more parts than any plan has.
const LONGEST_HEADER: u64 = 64 << 20;

/// Where blocks were computed; for the reader of a report, no part of what they are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Version of the program.
    pub version: String,
    /// Threads at work.
    pub threads: usize,
    /// Wall time of the work, s.
    pub seconds: f64,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    plan_id: String,
    identity: Identity,
    from: u64,
    to: u64,
    parts: Vec<Part>,
    provenance: Provenance,
}

/// A range of blocks and the length of what they came to.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Part {
    from: u64,
    to: u64,
    bytes: u64,
}

/// Writes `parts`; the file appears whole or not at all.
///
/// # Errors
/// [`StoreError`] if it cannot be written.
pub fn write(
    path: &Path,
    identity: &Identity,
    parts: &[(Range<u64>, Vec<u8>)],
    provenance: Provenance,
) -> Result<(), StoreError> {
    let part = |(range, bytes): &(Range<u64>, Vec<u8>)| Part {
        from: range.start,
        to: range.end,
        bytes: bytes.len() as u64,
    };
    let header = Header {
        plan_id: identity.id().to_string(),
        identity: identity.clone(),
        from: parts.first().map_or(0, |(range, _)| range.start),
        to: parts.last().map_or(0, |(range, _)| range.end),
        parts: parts.iter().map(part).collect(),
        provenance,
    };
    write_whole(path, |file| {
        let header = serde_json::to_vec(&header)?;
        let length = u32::try_from(header.len()).map_err(io::Error::other)?;
        let (layout, length) = (LAYOUT.to_le_bytes(), length.to_le_bytes());
        let mut digest = Sha256::new();
        let pieces = [&MAGIC[..], &layout, &length, &header];
        for piece in pieces.into_iter().chain(parts.iter().map(|p| &p.1[..])) {
            file.write_all(piece)?;
            digest.update(piece);
        }
        file.write_all(&digest.finalize())
    })
}

/// A file of blocks that was read through and found whole. Its parts stay on disk until they are
/// asked for.
#[derive(Debug)]
pub struct BlockFile {
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

/// Where a part is, and the digest of its bytes when the file was found whole: it may be replaced
/// before they are read.
#[derive(Debug)]
struct Place {
    blocks: Range<u64>,
    start: u64,
    length: usize,
    digest: [u8; 32],
}

/// Bytes that are read and digested at once.
const STRETCH: usize = 1 << 16;

impl BlockFile {
    /// Reads a file of blocks of `identity`, which has the blocks 0..`total`, through to its end.
    /// Of its parts no more than 64 KiB is in memory.
    ///
    /// # Errors
    /// [`JobError`] if it is not one, not whole, or one of another plan.
    pub fn open(path: &Path, identity: &Identity, total: u64) -> Result<Self, JobError> {
        let unreadable = |source| unreadable(path, source);
        let spoilt = |what: String| spoilt(path, what);
        let file = match store::open(path) {
            Err(e) if matches!(e.fault, ReadFault::NotAFile(_)) => return Err(no_shard(path)),
            other => other?,
        };
        let length = file.metadata().map_err(unreadable)?.len();
        let mut file = Digesting {
            file: BufReader::with_capacity(STRETCH, file),
            digest: Sha256::new(),
            read: 0,
        };
        let header = file.header(path, length)?;
        let promised = header.parts.iter().map(|p| p.bytes);
        let expected = promised.fold(file.read + TRAILER, u64::saturating_add);
        if length < expected {
            return Err(cut_off(path, length, expected));
        }
        if length > expected {
            let more = length - expected;
            return Err(spoilt(format!(
                "has {length} bytes, {more} more than its header says"
            )));
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
            let what = "is damaged: its bytes are not those that were written";
            return Err(spoilt(what.to_owned()));
        }
        refuse_foreign(path, &header, identity)?;
        let range = header.from..header.to;
        let follow = parts.iter().try_fold(range.start, |end, part| {
            let Range { start, end: to } = part.blocks;
            (start == end && start < to).then_some(to)
        });
        if parts.is_empty() || follow != Some(range.end) || range.end > total {
            let Range { start, end } = range;
            return Err(spoilt(format!(
                "holds blocks {start}..{end} of {total}, in parts that do not make them up"
            )));
        }
        Ok(Self {
            path: path.to_owned(),
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
    ) -> impl Iterator<Item = Result<(Range<u64>, Vec<u8>), JobError>> {
        let inside =
            move |part: &&Place| part.blocks.start >= range.start && part.blocks.end <= range.end;
        self.parts.iter().filter(inside).map(|part| {
            let mut file = store::open(&self.path)?;
            let mut bytes = vec![0; part.length];
            file.seek(SeekFrom::Start(part.start))
                .and_then(|_| file.read_exact(&mut bytes))
                .map_err(|e| unreadable(&self.path, e))?;
            if Sha256::digest(&bytes)[..] != part.digest {
                let what = "is damaged: it was replaced while it was read";
                return Err(spoilt(&self.path, what.to_owned()));
            }
            Ok((part.blocks.clone(), bytes))
        })
    }
}

fn unreadable(path: &Path, source: io::Error) -> JobError {
    ReadError::system(path, source).into()
}

fn spoilt(path: &Path, what: String) -> JobError {
    let path = path.to_owned();
    JobError::Spoilt { path, what }
}

fn cut_off(path: &Path, found: u64, expected: u64) -> JobError {
    let what = format!("is cut off: it has {found} of {expected} bytes");
    spoilt(path, what)
}

fn no_shard(path: &Path) -> JobError {
    let path = path.display();
    JobError::Refused(format!(
        "{path} is no shard of phicam; move it out of the folder"
    ))
}

/// Refuses what is not part of the plan, and says in what it differs.
fn refuse_foreign(path: &Path, header: &Header, plan: &Identity) -> Result<(), JobError> {
    let found = &header.identity;
    match found.difference(plan) {
        None if found.id() == plan.id() && header.plan_id == plan.id().to_string() => Ok(()),
        None => {
            let what = "is damaged: what it says of its plan is out of order";
            Err(spoilt(path, what.to_owned()))
        }
        Some((name, found, expected)) => Err(JobError::Foreign {
            path: path.to_owned(),
            name,
            found,
            expected,
        }),
    }
}
