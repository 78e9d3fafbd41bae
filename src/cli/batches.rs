//! The spots of a render, traced batch by batch.

use std::ops::Range;

use rayon::prelude::*;

use super::console::Console;
use super::failure::Failure;
use super::interrupt::warned;
use super::partial;
use super::process::process;
use super::progress::Tracing;
use super::record::Record;
use super::run_folder::RunFolder;
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
    /// Whether to go on from the blocks that an earlier process has finished.
    pub resume: bool,
}

impl Batches<'_> {
    /// Traces the spots of `todo`; blocks, frames and kept spots are written as soon as they are
    /// finished. If it was stopped, so many blocks of the next spots are finished as well.
    pub(super) fn trace(
        &self,
        todo: &[usize],
        kept: &mut [Option<Matrix>],
        console: Console,
    ) -> Result<Option<u32>, Failure> {
        let Self { scene, plan, .. } = *self;
        let partial = self.folder.partial();
        let spots = |range| Spots {
            scene,
            plan,
            range,
            first: 0,
        };
        let batches: Vec<Spots<'_>> = self.ranges(todo, kept).into_iter().map(spots).collect();
        let blocks = u64::from(plan.budget.blocks);
        let paths = batches.iter().map(|spots| spots.paths(blocks)).sum();
        let mut tracing = Tracing::start(console, &scene.name, paths);
        // Those that a begun batch traces once more count when it is finished.
        let again = |spot: usize| batches.iter().any(|spots| spots.range.contains(&spot));
        let apart = (0..).zip(kept.iter()).filter(|(spot, _)| !again(*spot));
        apart
            .filter_map(|(_, column)| column.as_ref())
            .for_each(|column| tracing.finished(column));
        for (number, spots) in batches.iter().enumerate() {
            let tally = self.trace_batch(spots, &mut tracing, console)?;
            let Some(traced) = tally.traced(scene, spots.range.clone()) else {
                return Ok(Some(tally.range().end));
            };
            let keep = |(column, spot)| partial.keep(spot, &traced, column);
            let columns = self.pool.install(|| {
                self.folder
                    .write_frames(scene, self.record, &spots.range, &traced)?;
                let spots = spots.range.clone().into_par_iter().enumerate();
                spots.map(keep).collect::<Result<Vec<Matrix>, Failure>>()
            });
            for (spot, column) in spots.range.clone().zip(columns?) {
                tracing.finished(&column);
                kept[spot] = Some(column);
            }
            partial.remove_checkpoint(&spots.range)?;
            if warned() && number + 1 < batches.len() {
                return Ok(Some(0));
            }
        }
        tracing.end();
        Ok(None)
    }

    /// The blocks of one batch; fewer if it was stopped, and those are then in its checkpoint.
    fn trace_batch(
        &self,
        spots: &Spots<'_>,
        tracing: &mut Tracing,
        console: Console,
    ) -> Result<Tally, Failure> {
        let Range { start, end } = spots.range;
        let blocks = spots.blocks();
        let identity = partial::identity(self.scene, self.plan, &spots.range);
        let path = self.folder.partial().checkpoint(&spots.range)?;
        let mut checkpoint = Checkpoint::new(path, identity, process(self.pool));
        let done = if self.resume {
            checkpoint.resume(&blocks, blocks.end)
        } else {
            Parts::new()
        };
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
        if u64::from(tally.range().end) < blocks.end {
            checkpoint.keep(&spots.parts(&tally))?;
        }
        Ok(tally)
    }

    /// Runs of neighbouring spots to be traced together: one spot each where nothing is shared, as
    /// many as memory bears where paths serve all spots. Where an earlier process has left blocks
    /// of some of them, these stay together, with those of them that are finished: to write these
    /// again costs less than to trace the others anew.
    fn ranges(&self, todo: &[usize], kept: &[Option<Matrix>]) -> Vec<Range<usize>> {
        let most = Spots::together(self.scene, self.plan.estimator);
        let begun = if self.resume {
            self.folder.partial().checkpoints(self.scene, self.plan)
        } else {
            Vec::new()
        };
        let mut free: Vec<bool> = vec![false; kept.len()];
        todo.iter().for_each(|s| free[*s] = true);
        let mut ranges: Vec<Range<usize>> = Vec::new();
        for range in begun {
            let needed = range.clone().any(|s| free[s]);
            let ours = range.clone().all(|s| free[s] || kept[s].is_some());
            let apart = ranges.last().is_none_or(|r| r.end <= range.start);
            if needed && ours && apart {
                range.clone().for_each(|s| free[s] = false);
                ranges.push(range);
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
