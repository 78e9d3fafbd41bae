//! The columns of a render, traced batch by batch.

use std::ops::Range;

use rayon::prelude::*;

use super::checkpoint::{Checkpoint, Parts};
use super::columns::{Columns, together};
use super::failure::Failure;
use super::folder::{Folder, own_identity};
use super::interrupt::warned;
use super::output::Talk;
use super::progress::Tracing;
use super::record::Record;
use super::render::refuse_beyond_f32;
use crate::matrix::Matrix;
use crate::scene::Scene;
use crate::transport::{Plan, Tally};

/// A render at work.
pub(super) struct Work<'a> {
    pub scene: &'a Scene,
    pub plan: &'a Plan,
    pub folder: &'a Folder,
    pub record: &'a Record,
    pub pool: &'a rayon::ThreadPool,
    /// Whether blocks that an earlier process has finished are gone on with.
    pub resume: bool,
}

impl Work<'_> {
    /// Traces the spots of `todo`; blocks, frames and kept columns are written as soon as they are finished.
    pub(super) fn trace(
        &self,
        todo: &[usize],
        kept: &mut [Option<Matrix>],
        talk: Talk,
    ) -> Result<(), Failure> {
        let Self { scene, plan, .. } = *self;
        let batches = self.batches(todo, kept);
        let pixels = scene.camera.pixels() as u64;
        let columns = match plan.estimator.serves_all_spots() {
            false => todo.len(),
            true => batches.len(),
        };
        let samples = pixels * plan.budget.samples() * columns as u64;
        let mut tracing = Tracing::start(talk, &scene.name, samples);
        // Those that a begun batch traces once more count when it is finished.
        let again = |spot: usize| batches.iter().any(|range| range.contains(&spot));
        let apart = (0..).zip(kept.iter()).filter(|(spot, _)| !again(*spot));
        apart
            .filter_map(|(_, column)| column.as_ref())
            .for_each(|column| tracing.finished(column));
        let last = batches.len();
        for (number, range) in batches.into_iter().enumerate() {
            let columns = Columns {
                scene,
                plan,
                spots: range.clone(),
                first: 0,
            };
            let threads = self.pool.current_num_threads();
            let path = self.folder.checkpoint(&range)?;
            let mut checkpoint = Checkpoint::new(path, own_identity(scene, plan, &range), threads);
            let mut tally = columns.tally(0);
            let blocks = columns.blocks();
            if self.resume {
                columns.add(&mut tally, checkpoint.resume(&blocks, blocks.end))?;
                self.say_resumed(&tally, &range, (talk, &tracing));
                let traced = u64::from(tally.range().end) * u64::from(plan.budget.size);
                let each = if plan.estimator.serves_all_spots() {
                    1
                } else {
                    range.len() as u64
                };
                tracing.skip(pixels * traced * each);
            }
            let nothing = Parts::new();
            let tally = self.pool.install(|| {
                columns.trace(tally, blocks.end, &mut tracing, (&mut checkpoint, &nothing))
            })?;
            let there = tally.range().end;
            let Some(traced) = tally.traced() else {
                let of = plan.budget.blocks;
                return Err(Failure::Stopped(match there {
                    0 => String::new(),
                    _ => format!(" and {there} of {of} blocks of the next"),
                }));
            };
            refuse_beyond_f32(&traced)?;
            let write = |(column, spot): (usize, usize)| {
                self.folder
                    .write_frame(scene, self.record, spot, &traced, column)?;
                self.folder.keep(spot, &traced, column)
            };
            let written = || -> Result<Vec<Matrix>, Failure> {
                range
                    .clone()
                    .into_par_iter()
                    .enumerate()
                    .map(write)
                    .collect()
            };
            let columns = self.pool.install(written)?;
            for (spot, column) in range.clone().zip(columns) {
                tracing.finished(&column);
                kept[spot] = Some(column);
            }
            self.folder.remove_checkpoint(&range)?;
            if warned() && number + 1 < last {
                return Err(Failure::Stopped(String::new()));
            }
        }
        tracing.end();
        Ok(())
    }

    fn say_resumed(&self, tally: &Tally, range: &Range<usize>, (talk, tracing): (Talk, &Tracing)) {
        let there = tally.range().end;
        if there > 0 {
            let said = format!(
                "going on after {there} of {} blocks of the spots {} to {}",
                self.plan.budget.blocks,
                range.start,
                range.end - 1
            );
            tracing.say(talk, said);
        }
    }

    /// Runs of neighbouring spots to be traced together: one spot each where nothing is shared, as many as memory bears where paths serve all
    /// spots. Where an earlier process has left blocks of some of them, these stay together, with those of them that are finished: to write these
    /// again costs less than to trace the others anew.
    fn batches(&self, todo: &[usize], kept: &[Option<Matrix>]) -> Vec<Range<usize>> {
        let most = together(self.scene, self.plan.estimator);
        let begun = match self.resume {
            true => self.folder.checkpoints(self.scene, self.plan),
            false => Vec::new(),
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
