//! The spots of a render, traced batch by batch.

use std::ops::Range;

use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::interrupt::warned;
use crate::cli::partial::{self, Kept, together};
use crate::cli::process::process;
use crate::cli::progress::Tracing;
use crate::cli::run_folder::RunFolder;
use crate::folder::Record;
use crate::jobs::{Checkpoint, Parts, Spots};
use crate::matrix::Matrix;
use crate::scene::Scene;
use crate::transport::{Plan, Tally};

/// The spots of a render that are to be traced, batch by batch.
pub(super) struct Batches<'a> {
    pub scene: &'a Scene,
    pub plan: &'a Plan,
    pub folder: &'a RunFolder,
    pub record: &'a Record,
    pub pool: &'a rayon::ThreadPool,
}

impl Batches<'_> {
    /// Traces the spots of `todo`, beginning with those of which an earlier process has left blocks
    /// (`begun`); what is finished of a batch is put on disk while it is traced, and its frames
    /// when it is whole. If it was stopped, so many blocks of the next spots are finished as well.
    pub(super) fn trace(
        &self,
        todo: &[usize],
        begun: &[Kept],
        kept: &mut [Option<Matrix>],
        console: Console,
    ) -> Result<Option<u32>, Failure> {
        let Self { scene, plan, .. } = *self;
        let ranges = self.ranges(todo, begun, kept);
        let batches: Vec<Spots<'_>> = ranges.iter().map(|r| together(scene, plan, r)).collect();
        let blocks = u64::from(plan.budget.blocks);
        let paths = batches.iter().map(|spots| spots.paths(blocks)).sum();
        let mut tracing = Tracing::start(console, &scene.name, paths);
        // Those that a begun batch traces once more count when it is finished.
        let mut again = vec![false; kept.len()];
        ranges.into_iter().flatten().for_each(|s| again[s] = true);
        let apart = kept.iter().zip(&again).filter(|(_, again)| !**again);
        apart
            .filter_map(|(column, _)| column.as_ref())
            .for_each(|column| tracing.finished(column));
        for (number, spots) in batches.iter().enumerate() {
            let tally = self.trace_batch(spots, &mut tracing, console)?;
            let Some(traced) = tally.traced(scene, spots.range.clone()) else {
                return Ok(Some(tally.range().end));
            };
            let write = || {
                self.folder
                    .write_frames(scene, self.record, &spots.range, &traced)
            };
            for (spot, column) in spots.range.clone().zip(self.pool.install(write)?) {
                tracing.finished(&column);
                kept[spot] = Some(column);
            }
            if warned() && number + 1 < batches.len() {
                return Ok(Some(0));
            }
        }
        tracing.end();
        Ok(None)
    }

    /// The blocks of one batch, which are then on disk; fewer if it was stopped.
    fn trace_batch(
        &self,
        spots: &Spots<'_>,
        tracing: &mut Tracing,
        console: Console,
    ) -> Result<Tally, Failure> {
        let Range { start, end } = spots.range;
        let blocks = spots.blocks();
        let identity = partial::identity(self.scene, self.plan, &spots.range);
        let path = self.folder.partial().file(&spots.range)?;
        let mut checkpoint = Checkpoint::new(path, identity, process(self.pool));
        let done = checkpoint.resume(&blocks, blocks.end);
        let tally = spots.tally(0, done.into_iter().map(Ok))?;
        let there = u64::from(tally.range().end);
        if there > 0 {
            let all = blocks.end;
            let last = end - 1;
            tracing.say(
                console,
                format!("going on after {there} of {all} blocks of the spots {start} to {last}"),
            );
        }
        tracing.skip(spots.paths(there));
        let tally = tracing.run(|control, look| {
            let kept = (&mut checkpoint, &Parts::new());
            let trace = || spots.trace(tally, blocks.end, control, look, kept);
            self.pool.install(trace)
        })?;
        checkpoint.keep(&spots.parts(&tally))?;
        Ok(tally)
    }

    /// Runs of neighbouring spots to be traced together: as many as [`Spots::at_a_time`] says.
    /// Where an earlier process has left blocks of some of them, these stay together, with those of
    /// them that are finished: to write these again costs less than to trace the others anew.
    fn ranges(&self, todo: &[usize], begun: &[Kept], kept: &[Option<Matrix>]) -> Vec<Range<usize>> {
        let most = Spots::at_a_time(self.scene, self.plan.estimator);
        let mut free: Vec<bool> = vec![false; kept.len()];
        todo.iter().for_each(|s| free[*s] = true);
        let mut ranges: Vec<Range<usize>> = Vec::new();
        for range in begun.iter().map(|b| &b.spots) {
            let needed = range.clone().any(|s| free[s]);
            let ours = range.clone().all(|s| free[s] || kept[s].is_some());
            let apart = ranges.last().is_none_or(|r| r.end <= range.start);
            if needed && ours && apart {
                range.clone().for_each(|s| free[s] = false);
                ranges.push(range.clone());
            }
        }
        let begun = ranges.len();
        for &spot in todo.iter().filter(|s| free[**s]) {
            match ranges[begun..].last_mut() {
                Some(last) if last.end == spot && last.len() < most => last.end = spot + 1,
                _ => ranges.push(spot..spot + 1),
            }
        }
        ranges.sort_by_key(|r| r.start);
        ranges
    }
}
