//! Φcam in blocks.

use std::ops::Range;
use std::path::Path;

use super::work::Work;
use crate::cli::commands::render::complete;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::progress::Tracing;
use crate::cli::run_folder::{Claim, RunFolder};
use crate::cli::{Outcome, settings, suspicious};
use crate::folder::Record;
use crate::jobs::need;
use crate::jobs::{Checkpoint, Identity, Parts, Shards, Spots, end};
use crate::matrix::Matrix;
use crate::scene::Scene;
use crate::transport::Plan;
use crate::transport::tails::flag_neighbours;

/// A render. Its blocks are the sample blocks of the first columns of Φcam that are traced
/// together, then those of the next.
#[derive(Debug)]
pub(super) struct Render {
    pub scene: Scene,
    plan: Plan,
}

impl Render {
    /// Refuses what cannot be rendered, or not be put together afterwards.
    pub(super) fn new(scene: Scene, plan: Plan) -> Result<Self, Failure> {
        settings::suited(&scene, &plan)?;
        need::frames(&scene)?;
        Ok(Self { scene, plan })
    }
}

impl Work for Render {
    fn scene(&self) -> Option<&Scene> {
        Some(&self.scene)
    }

    fn warn(&self, console: Console) -> Result<(), Failure> {
        let Self { scene, plan } = self;
        console.warn(scene);
        let needs = [need::shard(scene, plan), need::merge(scene, plan)];
        for refused in needs.iter().filter_map(|need| need.as_ref().err()) {
            console.say(format!("warning: not on this machine: {refused}"));
        }
        suspicious::warn(scene, plan, console)
    }

    fn identity(&self) -> Identity {
        Spots::identity(&self.scene, &self.plan)
    }

    fn blocks(&self) -> u64 {
        let groups = Spots::all(&self.scene, &self.plan).len() as u64;
        groups * u64::from(self.plan.budget.blocks)
    }

    fn compute(
        &self,
        range: &Range<u64>,
        done: Parts,
        checkpoint: &mut Checkpoint,
        console: Console,
    ) -> Result<Parts, Failure> {
        let todo = end(&done, range)..range.end;
        let Self { scene, plan } = self;
        need::shard(scene, plan)?;
        let paths = |spots: Spots<'_>| spots.paths(spots.within(&todo).count() as u64);
        let paths = Spots::all(scene, plan).map(paths).sum();
        let mut tracing = Tracing::start(console, &scene.name, paths);
        let parts = tracing.run(|control, look| {
            Spots::compute(scene, plan, range, done, checkpoint, control, look)
        })?;
        tracing.end();
        Ok(parts)
    }

    fn merge(
        &self,
        shards: &Shards,
        output: &Path,
        json: bool,
        console: Console,
    ) -> Result<Outcome, Failure> {
        let Self { scene, plan } = self;
        need::merge(scene, plan)?;
        let mut record = Record::new(scene, plan, 0, shards.threads(), shards.seconds());
        let claim = Claim {
            what: "phicam merge",
            spots: None,
            replace: false,
        };
        let folder = RunFolder::open(output, scene, &record, &claim, console)?;
        if let Some(there) = complete(scene, plan, output)? {
            return told(&there, output, json);
        }
        let (pixels, spots) = (scene.camera.pixels(), scene.laser.spots.len());
        let [mut flux, mut stderr, mut tails] = [(); 3].map(|()| Matrix::zeros(pixels, spots));
        for group in Spots::all(scene, plan) {
            let tally = group.tally(group.first, shards.parts(group.blocks()))?;
            let traced = tally.traced(scene, group.range.clone()).ok_or_else(|| {
                let cause = format!(
                    "the shards in {} do not make up every block",
                    shards.place.display()
                );
                Failure::new(cause, "merge again, and do not change the folder meanwhile")
            })?;
            let _ = folder.write_frames(scene, &record, &group.range, &traced)?;
            let (first, n) = (group.range.start, group.range.len());
            flux.columns_mut(first, n).copy_from(&traced.flux);
            stderr.columns_mut(first, n).copy_from(&traced.stderr);
            tails.columns_mut(first, n).copy_from(&traced.tails);
        }
        flag_neighbours(&mut tails, &flux, &stderr);
        folder.finish(scene, &mut record, [&flux, &stderr, &tails])?;
        told(&record, output, json)
    }
}

fn told(record: &Record, dir: &Path, json: bool) -> Result<Outcome, Failure> {
    output::print(&if json {
        record.json()?
    } else {
        format!(
            "{}: {} spots merged ({}): frames, phi.npy, phi.stderr.npy and phi.tails.npy\n{}",
            dir.display(),
            record.spots,
            record.origin,
            record.error_bars()
        )
    })?;
    Ok(Outcome::Done)
}
