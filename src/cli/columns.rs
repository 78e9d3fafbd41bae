//! Columns of Φcam that are traced together, block after block.

use std::ops::{ControlFlow, Range};
use std::time::Instant;

use super::checkpoint::{Checkpoint, Parts};
use super::failure::Failure;
use super::interrupt::stop_flag;
use super::progress::Tracing;
use crate::scene::Scene;
use crate::shard::Identity;
use crate::transport::{Control, Estimator, NUMERICS, Plan, Tally, trace};

/// Time between two looks at what is finished where blocks are shorter, s.
const LOOK: f64 = 0.25;
/// Numbers of one part of a [`Tally`]: half a gibibyte.
const MOST_NUMBERS: usize = 1 << 26;

/// Columns that are traced together at most: one where they share nothing, else as many as memory bears.
pub(super) fn together(scene: &Scene, estimator: Estimator) -> usize {
    let column = scene.camera.pixels() * (scene.max_bounces as usize + 1);
    match estimator.serves_all_spots() {
        false => 1,
        true => (MOST_NUMBERS / column).max(1),
    }
}

/// What a render depends on.
pub(super) fn identity(scene: &Scene, plan: &Plan) -> Identity {
    Identity::default()
        .with("work", "render")
        .with("scene", &scene.name)
        .with("scene's digest", &scene.hash)
        .with("estimator", plan.estimator.name())
        .with("sampler", plan.sampling.name())
        .with("seed", plan.seed)
        .with("samples", plan.budget.samples())
        .with("block size", plan.budget.size)
        .with("columns together", together(scene, plan.estimator))
        .with(Identity::NUMERICS, NUMERICS)
}

/// The columns `spots` and their sample blocks, which count from `first` in the work that they belong to.
#[derive(Clone, Debug)]
pub(super) struct Columns<'a> {
    pub scene: &'a Scene,
    pub plan: &'a Plan,
    pub spots: Range<usize>,
    pub first: u64,
}

impl Columns<'_> {
    /// Sample blocks of these columns.
    pub(super) fn blocks(&self) -> Range<u64> {
        self.first..self.first + u64::from(self.plan.budget.blocks)
    }

    /// Nothing yet, beginning at block `start`.
    pub(super) fn tally(&self, start: u64) -> Tally {
        let start = self.local(start..start).start;
        Tally::new(self.scene, self.plan, self.spots.len(), start)
    }

    /// Adds parts made by [`Columns::parts`].
    pub(super) fn add(&self, tally: &mut Tally, parts: Parts) -> Result<(), Failure> {
        for (range, bytes) in parts {
            tally.add_part(self.local(range), &bytes)?;
        }
        Ok(())
    }

    /// The parts of `tally`.
    pub(super) fn parts(&self, tally: &Tally) -> Parts {
        let whole = |r: Range<u32>| self.first + u64::from(r.start)..self.first + u64::from(r.end);
        tally
            .parts()
            .map(|(range, bytes)| (whole(range), bytes))
            .collect()
    }

    /// Traces on from where `tally` ends to block `end`, shown by `tracing`, with `before` as what `checkpoint` holds besides. What comes back is shorter if it was
    /// stopped; what is there is then in the checkpoint.
    pub(super) fn trace(
        &self,
        tally: Tally,
        end: u64,
        tracing: &mut Tracing,
        (checkpoint, before): (&mut Checkpoint, &Parts),
    ) -> Result<Tally, Failure> {
        let all = |tally: &Tally| {
            let mut parts = before.clone();
            parts.extend(self.parts(tally));
            parts
        };
        let end = self.local(self.first..end).end;
        let bar = tracing.bar();
        let tick = |samples| bar.inc(samples);
        let control = Control {
            progress: &tick,
            stop: stop_flag(),
        };
        let mut pace = (Instant::now(), tally.range().end);
        let after = &mut |tally: &Tally| {
            let there = tally.range().end;
            let each = pace.0.elapsed().as_secs_f64() / f64::from(there - pace.1);
            pace = (Instant::now(), there);
            tracing.look(tally);
            if there < end {
                checkpoint.look(|| all(tally))?;
            }
            ControlFlow::Continue((LOOK / each) as u32)
        };
        let tally = trace(
            self.scene,
            self.plan,
            self.spots.clone(),
            tally,
            end,
            control,
            after,
        );
        checkpoint.outcome()?;
        if tally.range().end < end {
            checkpoint.leave(&all(&tally))?;
        }
        Ok(tally)
    }

    fn local(&self, range: Range<u64>) -> Range<u32> {
        let blocks = self.plan.budget.blocks;
        let local =
            |b: u64| u32::try_from(b.saturating_sub(self.first)).map_or(blocks, |b| b.min(blocks));
        local(range.start)..local(range.end)
    }
}
