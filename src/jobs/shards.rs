//! Shards that make up every block of a plan once.

use std::ops::Range;
use std::path::PathBuf;
use std::thread::sleep;
use std::time::Duration;

use super::JobError;
use super::blocks::BlockFile;
use super::folder::{PlanFolder, gaps};
use super::indices::array_syntax;
use crate::store::ensure_writable;

/// How often the folder is listed before a shard counts as missing, and how long it waits between:
/// a network file system may show a file of another machine late.
const LOOKS: usize = 3;
const BETWEEN: Duration = Duration::from_millis(700);
/// Gaps that are named one by one.
const NAMED: usize = 20;

/// Shards that make up every block of a plan once, in the order of their blocks.
#[derive(Debug)]
pub struct Shards {
    /// Their folder.
    pub place: PathBuf,
    files: Vec<BlockFile>,
}

impl Shards {
    /// The shards of `plan`, once all are there.
    ///
    /// # Errors
    /// [`JobError`] if blocks are missing after some looks, if two shards contradict each other, or
    /// if a file is no shard of the plan.
    pub fn whole(plan: &PlanFolder) -> Result<Self, JobError> {
        let mut looks = 1;
        loop {
            let files = plan.all().and_then(select);
            let ranges = |files: &Vec<BlockFile>| -> Vec<_> {
                files.iter().map(|f| f.range.clone()).collect()
            };
            let gaps = |files: &Vec<BlockFile>| gaps(0..plan.file.blocks, ranges(files));
            if looks == LOOKS || files.as_ref().is_ok_and(|f| gaps(f).is_empty()) {
                let files = files?;
                let gaps = gaps(&files);
                if !gaps.is_empty() {
                    return Err(lack(plan, ranges(&files), &gaps));
                }
                let place = plan.shards();
                return Ok(Self { place, files });
            }
            looks += 1;
            sleep(BETWEEN);
            // A file written here makes a network file system ask its server again what the folder
            // holds; where none may be written, looking again has to do.
            let _ = ensure_writable(&plan.shards());
        }
    }

    /// The parts that lie in `range`, in order.
    pub fn parts(
        &self,
        range: Range<u64>,
    ) -> impl Iterator<Item = Result<(Range<u64>, Vec<u8>), JobError>> {
        self.files.iter().flat_map(move |s| s.parts(range.clone()))
    }

    /// The most threads that worked on one.
    pub fn threads(&self) -> usize {
        let threads = self.files.iter().map(|s| s.provenance.threads);
        threads.max().unwrap_or(0)
    }

    /// The time that all took together, s.
    pub fn seconds(&self) -> f64 {
        self.files.iter().map(|s| s.provenance.seconds).sum()
    }
}

/// The shards that are needed, in the order of their blocks: of those that are equal, the first.
///
/// # Errors
/// [`JobError::Refused`] if two disagree on which blocks they hold, or on what is in them.
pub fn select(mut shards: Vec<BlockFile>) -> Result<Vec<BlockFile>, JobError> {
    shards.sort_by_key(|s| (s.range.start, s.range.end));
    let mut chosen: Vec<BlockFile> = Vec::new();
    for this in shards {
        let Some(last) = chosen.last().filter(|l| this.range.start < l.range.end) else {
            chosen.push(this);
            continue;
        };
        let [(a, of_a), (b, of_b)] = [last, &this].map(|s| (s.path.display(), &s.range));
        if of_a != of_b {
            return Err(JobError::refused(
                format!(
                    "{a} (blocks {}..{}) and {b} (blocks {}..{}) overlap: a block would count twice",
                    of_a.start, of_a.end, of_b.start, of_b.end
                ),
                "move one of them out of the folder",
            ));
        }
        if last.payload != this.payload {
            return Err(JobError::refused(
                format!("{a} and {b} hold the same blocks, and not the same bits"),
                "find out which machine is wrong, and move its shards out of the folder",
            ));
        }
    }
    Ok(chosen)
}

/// That blocks are missing: in which shards, and which blocks.
fn lack(plan: &PlanFolder, ranges: Vec<Range<u64>>, gaps: &[Range<u64>]) -> JobError {
    let indices = plan.missing(ranges);
    let named = gaps
        .iter()
        .take(NAMED)
        .map(|g| format!("{}..{}", g.start, g.end));
    let more = if gaps.len() > NAMED { ", …" } else { "" };
    let dir = plan.path.display();
    JobError::Missing(format!(
        "{} of {} shards of {dir} are not there, or not whole: {} (blocks {}{more})\n  cure: phicam shard {dir} --index K for each of them, or phicam slurm {dir}, then merge again",
        indices.len(),
        plan.file.shards,
        array_syntax(&indices),
        named.collect::<Vec<_>>().join(", ")
    ))
}
