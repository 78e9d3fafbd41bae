//! Φcam in blocks: the sample blocks of the first spots that are traced together, then those of the
//! next.

use std::ops::{ControlFlow, Range};

use super::blocks::{Parts, end};
use super::checkpoint::Checkpoint;
use super::{Identity, JobError};
use crate::scene::Scene;
use crate::transport::{Control, Estimator, NUMERICS, Plan, Tally, trace};

/// Time between two looks at what is finished where blocks are shorter, s.
const LOOK: f64 = 0.25;
/// Numbers of one part of a [`Tally`]: half a gibibyte.
const MOST_NUMBERS: usize = 1 << 26;

/// Neighbouring spots that are traced together. Their sample blocks count from `first` in the work
/// that they belong to.
#[derive(Clone, Debug)]
pub struct Spots<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// How it is rendered.
    pub plan: &'a Plan,
    /// The spots.
    pub range: Range<usize>,
    /// Their first block.
    pub first: u64,
}

impl<'a> Spots<'a> {
    /// Spots that are traced together at most: one where they share nothing, else as many as memory
    /// bears.
    pub fn together(scene: &Scene, estimator: Estimator) -> usize {
        let orders = scene.max_bounces as usize;
        Self::together_of(scene.camera.pixels(), orders, estimator)
    }

    /// The same for so many pixels and bounce counts.
    pub fn together_of(pixels: usize, orders: usize, estimator: Estimator) -> usize {
        if !estimator.serves_all_spots() {
            return 1;
        }
        (MOST_NUMBERS / (pixels * (orders + 4)).max(1)).max(1)
    }

    /// All spots of a render, in the order of their blocks.
    pub fn all(scene: &'a Scene, plan: &'a Plan) -> impl ExactSizeIterator<Item = Self> {
        let spots = scene.laser.spots.len();
        let most = Self::together(scene, plan.estimator);
        let groups = 0..spots.div_ceil(most);
        groups.map(move |g| Self {
            scene,
            plan,
            range: g * most..spots.min((g + 1) * most),
            first: g as u64 * u64::from(plan.budget.blocks),
        })
    }

    /// What a render depends on.
    pub fn identity(scene: &Scene, plan: &Plan) -> Identity {
        Identity::default()
            .with("work", "render")
            .with("scene", &scene.name)
            .with("scene's digest", &scene.hash)
            .with("estimator", plan.estimator.name())
            .with("sampler", plan.sampling.name())
            .with("seed", plan.seed)
            .with("samples", plan.budget.samples())
            .with("block size", plan.budget.size)
            .with("columns together", Self::together(scene, plan.estimator))
            .with(Identity::NUMERICS, NUMERICS)
    }

    /// Their sample blocks.
    pub fn blocks(&self) -> Range<u64> {
        self.first..self.first + u64::from(self.plan.budget.blocks)
    }

    /// Paths of so many blocks.
    pub fn paths(&self, blocks: u64) -> u64 {
        let shared = self.plan.estimator.serves_all_spots();
        let each = if shared { 1 } else { self.range.len() };
        let paths = self.scene.camera.pixels() * self.plan.budget.size as usize * each;
        paths as u64 * blocks
    }

    /// The blocks from `start` on that are in `parts` made by [`Spots::parts`].
    ///
    /// # Errors
    /// [`JobError`] if these are no parts of these spots that follow one another, or that of a
    /// part.
    pub fn tally(
        &self,
        start: u64,
        parts: impl IntoIterator<Item = Result<(Range<u64>, Vec<u8>), JobError>>,
    ) -> Result<Tally, JobError> {
        let start = self.local(start..start).start;
        let mut tally = Tally::new(self.scene, self.plan, self.range.len(), start);
        for part in parts {
            let (range, bytes) = part?;
            tally
                .add_part(self.local(range), &bytes)
                .map_err(JobError::work)?;
        }
        Ok(tally)
    }

    /// The parts of `tally`.
    pub fn parts(&self, tally: &Tally) -> Parts {
        let whole = |r: Range<u32>| self.first + u64::from(r.start)..self.first + u64::from(r.end);
        tally
            .parts()
            .map(|(range, bytes)| (whole(range), bytes))
            .collect()
    }

    /// Traces on from where `tally` ends to block `end`; `look` sees what is there now and then.
    /// `checkpoint` keeps it, after the parts `before`. What comes back is shorter if it was
    /// stopped.
    ///
    /// # Errors
    /// [`JobError`] if it cannot be traced, or not be kept.
    pub fn trace(
        &self,
        tally: Tally,
        end: u64,
        control: Control<'_>,
        look: &mut dyn FnMut(&Tally),
        (checkpoint, before): (&mut Checkpoint, &Parts),
    ) -> Result<Tally, JobError> {
        let end = self.local(self.first..end).end;
        let process = checkpoint.process;
        let mut pace = ((process.clock)(), tally.range().end);
        let mut failed = None;
        let after = &mut |tally: &Tally| {
            let (now, there) = ((process.clock)(), tally.range().end);
            let each = now.saturating_sub(pace.0).as_secs_f64() / f64::from(there - pace.1);
            pace = (now, there);
            look(tally);
            let all = || before.iter().cloned().chain(self.parts(tally)).collect();
            let go_on = there == end
                || checkpoint.look(all).unwrap_or_else(|error| {
                    failed = Some(error);
                    false
                });
            if go_on {
                ControlFlow::Continue((LOOK / each) as u32)
            } else {
                ControlFlow::Break(())
            }
        };
        let (scene, plan, spots) = (self.scene, self.plan, self.range.clone());
        let tally = trace(scene, plan, spots, tally, end, control, after);
        failed.map_or(Ok(()), Err)?;
        tally.map_err(JobError::work)
    }

    /// Computes the blocks `range` of a render, of which `done` has the first. What comes back is
    /// shorter if it was stopped, and is then in `checkpoint`.
    ///
    /// # Errors
    /// [`JobError`] if it cannot be traced, or not be kept.
    pub fn compute(
        scene: &'a Scene,
        plan: &'a Plan,
        range: &Range<u64>,
        mut done: Parts,
        checkpoint: &mut Checkpoint,
        control: Control<'_>,
        look: &mut dyn FnMut(&Tally),
    ) -> Result<Parts, JobError> {
        let mut parts = Parts::new();
        for spots in Self::all(scene, plan) {
            let todo = spots.within(range);
            if todo.is_empty() {
                continue;
            }
            let rest = done.split_off(done.partition_point(|(part, _)| part.end <= todo.end));
            let mine = std::mem::replace(&mut done, rest);
            let tally = spots.tally(todo.start, mine.into_iter().map(Ok))?;
            let tally = spots.trace(tally, todo.end, control, look, (checkpoint, &parts))?;
            parts.extend(spots.parts(&tally));
            let whole = end(&parts, range) == todo.end;
            if !whole || todo.end < range.end && !checkpoint.look(|| parts.clone())? {
                checkpoint.keep(&parts)?;
                break;
            }
        }
        Ok(parts)
    }

    /// Their blocks that are in `range`.
    pub fn within(&self, range: &Range<u64>) -> Range<u64> {
        let own = self.blocks();
        own.start.max(range.start)..own.end.min(range.end)
    }

    fn local(&self, range: Range<u64>) -> Range<u32> {
        let blocks = self.plan.budget.blocks;
        let local =
            |b: u64| u32::try_from(b.saturating_sub(self.first)).map_or(blocks, |b| b.min(blocks));
        local(range.start)..local(range.end)
    }
}
