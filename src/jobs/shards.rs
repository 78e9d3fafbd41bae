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
    /// The shards of `plan` that are there, and what is wrong with those that are not whole.
    ///
    /// # Errors
    /// [`JobError`] if two shards contradict each other, or if a file is no shard of the plan.
    pub fn there(plan: &PlanFolder) -> Result<(Self, Vec<JobError>), JobError> {
        let (files, wrong) = plan.all()?;
        let found = Self {
            place: plan.shards(),
            files: select(files)?,
        };
        Ok((found, wrong))
    }

    /// The same, once all blocks are there.
    ///
    /// # Errors
    /// [`JobError`] as [`there`](Self::there), or if blocks are missing after some looks.
    pub fn whole(plan: &PlanFolder) -> Result<(Self, Vec<JobError>), JobError> {
        let mut looks = 1;
        loop {
            let found = Self::there(plan);
            let gaps = |found: &Self| gaps(0..plan.file.blocks, found.ranges());
            if looks == LOOKS || found.as_ref().is_ok_and(|(f, _)| gaps(f).is_empty()) {
                let (found, wrong) = found?;
                let gaps = gaps(&found);
                if !gaps.is_empty() {
                    return Err(lack(plan, &found, &gaps, &wrong));
                }
                return Ok((found, wrong));
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

    /// Their ranges of blocks.
    pub fn ranges(&self) -> impl Iterator<Item = Range<u64>> {
        self.files.iter().map(|s| s.range.clone())
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

/// That blocks are missing: in which shards, which blocks, and what is wrong with the files that
/// held them.
fn lack(plan: &PlanFolder, found: &Shards, gaps: &[Range<u64>], wrong: &[JobError]) -> JobError {
    let indices = plan.missing(found.ranges());
    let wrong = wrong.iter().take(NAMED).map(|e| format!("\n  {e}"));
    let named = gaps
        .iter()
        .take(NAMED)
        .map(|g| format!("{}..{}", g.start, g.end));
    let more = if gaps.len() > NAMED { ", …" } else { "" };
    let dir = plan.path.display();
    JobError::Missing(format!(
        "{} of {} shards of {dir} are not there, or not whole: {} (blocks {}{more}){}\n  cure: phicam shard {dir} --index K for each of them, or phicam slurm {dir}, then merge again",
        indices.len(),
        plan.file.shards,
        array_syntax(&indices),
        named.collect::<Vec<_>>().join(", "),
        wrong.collect::<String>()
    ))
}
