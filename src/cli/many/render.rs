//! Φcam in blocks.

use std::ops::Range;
use std::path::Path;

use rayon::prelude::*;

use super::shards::Shards;
use crate::cli::checkpoint::{Checkpoint, Parts};
use crate::cli::columns::{self, Columns, together};
use crate::cli::failure::Failure;
use crate::cli::folder::{Folder, Keep};
use crate::cli::output::{self, Talk};
use crate::cli::progress::Tracing;
use crate::cli::record::Record;
use crate::cli::render::{complete, refuse_beyond_f32, refuse_too_large};
use crate::cli::{Outcome, settings};
use crate::matrix::Matrix;
use crate::scene::Scene;
use crate::shard::{Identity, Settings};
use crate::transport::Plan;

/// A render. Its blocks are the sample blocks of the first columns of Φcam that are traced together, then those of the next.
#[derive(Debug)]
pub(super) struct Render {
    pub scene: Scene,
    plan: Plan,
}

impl Render {
    /// Refuses what cannot be rendered, or not be put together afterwards.
    pub(super) fn new(scene: Scene, plan: Plan) -> Result<Self, Failure> {
        settings::suited(&scene, &plan)?;
        refuse_too_large(&scene)?;
        Ok(Self { scene, plan })
    }

    pub(super) fn read(
        scene: Scene,
        (estimator, sampler): (&str, &str),
        seed: u64,
        samples: u64,
    ) -> Result<Self, Failure> {
        let plan = settings::named(estimator, sampler, seed, samples)?;
        Self::new(scene, plan)
    }

    pub(super) fn settings(&self) -> Settings {
        Settings::Render {
            estimator: self.plan.estimator.name().to_owned(),
            sampler: self.plan.sampling.name().to_owned(),
            seed: self.plan.seed,
            samples: self.plan.budget.samples(),
        }
    }

    pub(super) fn identity(&self) -> Identity {
        columns::identity(&self.scene, &self.plan)
    }

    pub(super) fn blocks(&self) -> u64 {
        self.groups().len() as u64 * u64::from(self.plan.budget.blocks)
    }

    /// The columns that are traced together, in order.
    fn groups(&self) -> impl ExactSizeIterator<Item = Columns<'_>> {
        let spots = self.scene.laser.spots.len();
        let most = together(&self.scene, self.plan.estimator);
        let groups = 0..spots.div_ceil(most);
        groups.map(move |g| Columns {
            scene: &self.scene,
            plan: &self.plan,
            spots: g * most..spots.min((g + 1) * most),
            first: g as u64 * u64::from(self.plan.budget.blocks),
        })
    }

    pub(super) fn compute(
        &self,
        range: Range<u64>,
        mut done: Parts,
        checkpoint: &mut Checkpoint,
        talk: Talk,
    ) -> Result<Parts, Failure> {
        let plan = &self.plan;
        let all_spots = plan.estimator.serves_all_spots();
        let block = self.scene.camera.pixels() as u64 * u64::from(plan.budget.size);
        let begin = done.last().map_or(range.start, |(part, _)| part.end);
        let own = |columns: &Columns<'_>, from: u64| {
            let blocks = columns.blocks();
            from.max(blocks.start)..range.end.min(blocks.end)
        };
        let samples: u64 = self
            .groups()
            .map(|columns| {
                let todo = own(&columns, begin);
                let each = if all_spots {
                    1
                } else {
                    columns.spots.len() as u64
                };
                block * each * todo.end.saturating_sub(todo.start)
            })
            .sum();
        let mut tracing = Tracing::start(talk, &self.scene.name, samples);
        let mut parts = Parts::new();
        for columns in self.groups() {
            let todo = own(&columns, range.start);
            if todo.is_empty() {
                continue;
            }
            let rest = done.split_off(done.partition_point(|(part, _)| part.end <= todo.end));
            let mine = std::mem::replace(&mut done, rest);
            let mut tally = columns.tally(todo.start);
            columns.add(&mut tally, mine)?;
            let tally = columns.trace(tally, todo.end, &mut tracing, (checkpoint, &parts))?;
            let whole = columns.first + u64::from(tally.range().end) == todo.end;
            parts.extend(columns.parts(&tally));
            if !whole {
                break;
            }
            if todo.end < range.end && checkpoint.look(|| parts.clone()).is_break() {
                checkpoint.leave(&parts)?;
                break;
            }
        }
        tracing.end();
        Ok(parts)
    }

    pub(super) fn merge(
        &self,
        shards: &Shards,
        output: &Path,
        json: bool,
        talk: Talk,
    ) -> Result<Outcome, Failure> {
        let Self { scene, plan } = self;
        let mut record = Record::new(scene, plan, 0, shards.threads(), shards.seconds());
        if let Some(there) = Record::read(output)? {
            if !there.same_settings(&record) {
                let cause = format!(
                    "{} holds a run with other settings ({})",
                    output.display(),
                    there.settings()
                );
                return Err(Failure::new(cause, "merge into another folder (-o)"));
            }
            if let Some(there) = complete(scene, plan, output)? {
                return told(&there, output, json);
            }
        }
        let folder = Folder::open(output, scene, &record, Keep::Finished, talk)?;
        let (pixels, spots) = (scene.camera.pixels(), scene.laser.spots.len());
        let [mut flux, mut stderr] = [(); 2].map(|()| Matrix::zeros(pixels, spots));
        for columns in self.groups() {
            let mut tally = columns.tally(columns.first);
            for part in shards.parts(columns.blocks()) {
                columns.add(&mut tally, vec![part?])?;
            }
            let traced = tally.traced().ok_or_else(|| {
                let cause = format!(
                    "the shards in {} do not make up every block",
                    shards.place().display()
                );
                Failure::new(cause, "merge again, and do not change the folder meanwhile")
            })?;
            refuse_beyond_f32(&traced)?;
            columns
                .spots
                .clone()
                .into_par_iter()
                .enumerate()
                .try_for_each(|(column, spot)| {
                    folder.write_frame(scene, &record, spot, &traced, column)
                })?;
            let (first, n) = (columns.spots.start, columns.spots.len());
            flux.columns_mut(first, n).copy_from(&traced.flux);
            stderr.columns_mut(first, n).copy_from(&traced.stderr);
        }
        folder.write_phi(&flux, &stderr)?;
        record.finished = spots;
        record.write(output)?;
        folder.remove_partial()?;
        told(&record, output, json)
    }
}

fn told(record: &Record, dir: &Path, json: bool) -> Result<Outcome, Failure> {
    output::print(&match json {
        true => output::json(record)?,
        false => format!(
            "{}: {} spots merged ({}): frames, phi.npy and phi.stderr.npy\n",
            dir.display(),
            record.spots,
            record.settings()
        ),
    })?;
    Ok(Outcome::Done)
}
