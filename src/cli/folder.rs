//! The folder of a run: what may be written into it, and what is read back from it.
//!
//! | file | content |
//! | --- | --- |
//! | scene.toml, run.json | the scene, whole; what was rendered and how |
//! | files/ | copies of the meshes, pictures and materials that the scene names |
//! | frames/spot-NNNN.exr | one frame a spot |
//! | phi.npy, phi.stderr.npy | Φcam and its standard error, pixels × spots, W |
//! | partial/spot-NNNN.npy | finished spots of an unfinished run in f64: one column per bounce count, last the standard error |
//! | partial/spots-NNNN-MMMM.phs | finished blocks of the spots NNNN to MMMM − 1, which are traced together |

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::cleanup::{
    remove_exposed, remove_files, remove_named, remove_numbered, remove_recovered,
};
use super::failure::Failure;
use super::output::{self, Console};
use super::record::Record;
use crate::film::{self, Channel, Frame, FrameMeta, RunMeta, frame_name};
use crate::jobs::{self, BlockFile, Identity, Spots};
use crate::matrix::{Matrix, npy};
use crate::scene::{COPIES, Scene};
use crate::store::{StoreError, ensure_writable};
use crate::transport::{Plan, Traced};

pub(super) const PHI: &str = "phi.npy";
pub(super) const STDERR: &str = "phi.stderr.npy";
pub(super) const SUMMARY: &str = "summary.json";
pub(super) const REPORT: &str = "report.html";
pub(super) const SCENE: &str = "scene.toml";
/// The analytic side.
pub(super) const MODEL: &str = "model";
/// Deviations of traced from modelled entries, in [`MODEL`].
pub(super) const Z: &str = "z.npy";
/// Recovered reflectances.
pub(super) const RECOVERED: &str = "recovered";
/// Photographs of `phicam expose`: [`PHI`], [`STDERR`] and these.
pub(super) const EXPOSED: &str = "exposed";
pub(super) const EXPOSURE: &str = "exposure.json";
pub(super) const SATURATED: &str = "saturated.npy";
pub(super) const COUNTS: &str = "counts";

/// What is kept of an earlier render into the same folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Resume {
    /// Nothing: all spots are rendered.
    Nothing,
    /// Other spots, and none of those asked for.
    OtherSpots,
    /// Every finished spot.
    Finished,
}

/// An open run folder.
#[derive(Debug)]
pub(super) struct Folder {
    pub path: PathBuf,
}

impl Folder {
    /// The folder of a run that is there.
    pub(super) fn at(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
        }
    }

    /// Makes sure that the run `record` may be written to `path`, and that it can be. Nothing is
    /// changed before every check has passed.
    pub(super) fn open(
        path: &Path,
        scene: &Scene,
        record: &Record,
        keep: Resume,
        console: Console,
    ) -> Result<Self, Failure> {
        let folder = Self {
            path: path.to_owned(),
        };
        folder.refuse_foreign(scene, console)?;
        let earlier = Record::read(path)?;
        let same = earlier.as_ref().is_some_and(|e| e.same_settings(record));
        if let Some(e) = earlier.filter(|_| !same) {
            if keep != Resume::Nothing {
                let cause = format!(
                    "{} holds a run with other settings ({})",
                    path.display(),
                    e.plan
                );
                return Err(Failure::new(
                    cause,
                    "use the same settings, or another folder (-o)",
                ));
            }
            ensure_writable(path)?;
            console.say(format!(
                "replacing the earlier run in {} ({})",
                path.display(),
                e.plan
            ));
            folder.remove_frames()?;
        } else {
            ensure_writable(path)?;
        }
        if keep == Resume::Nothing {
            folder.remove_partial()?;
        }
        record.write(path)?;
        ensure_writable(&folder.frames())?;
        folder.remove_abandoned()?;
        folder.write_scene(scene)?;
        Ok(folder)
    }

    /// A folder that holds another scene, or frames of unknown origin, or something else under the
    /// name of an output, is not written to.
    pub(super) fn refuse_foreign(&self, scene: &Scene, console: Console) -> Result<(), Failure> {
        refuse_obstacles(
            &self.path,
            &["frames", "partial", MODEL, RECOVERED, COPIES],
            &[SCENE, PHI, STDERR, Record::FILE, SUMMARY, REPORT],
        )?;
        let path = self.path.display();
        let cure = "choose another folder (-o), or remove this one";
        if let Some(record) = Record::read(&self.path)? {
            if record.scene_hash != scene.hash {
                let cause = format!("{path} holds a run of another scene (`{}`)", record.scene);
                return Err(Failure::new(cause, cure));
            }
            return Ok(());
        }
        let own = self.path.join(SCENE);
        if own.exists() {
            // What cannot be read as a scene is not this one either.
            if !console
                .load_scene(&own.to_string_lossy())
                .is_ok_and(|s| s.hash == scene.hash)
            {
                return Err(Failure::new(
                    format!("{path} belongs to another scene ({SCENE})"),
                    cure,
                ));
            }
        }
        let holds =
            |dir: &str| fs::read_dir(self.path.join(dir)).is_ok_and(|mut d| d.next().is_some());
        if holds("frames") || holds("partial") || self.path.join(PHI).exists() {
            let cause = format!(
                "{path} holds frames or a {PHI}, but no {} that says of which scene",
                Record::FILE
            );
            return Err(Failure::new(cause, cure));
        }
        Ok(())
    }

    /// Writes the scene, whole: with copies of the files that it names.
    pub(super) fn write_scene(&self, scene: &Scene) -> Result<(), Failure> {
        let copies = self.path.join(COPIES);
        for file in &scene.files {
            ensure_writable(&copies)?;
            let to = copies.join(file.copy_name());
            if to.canonicalize().is_ok_and(|to| to == file.path) {
                continue;
            }
            let bytes = fs::read(&file.path).map_err(|e| {
                let cause = format!("cannot read `{}` again: {e}", file.name);
                Failure::new(
                    cause,
                    "leave the scene's files in place while phicam starts",
                )
            })?;
            if !file.holds(&bytes) {
                let cause = format!("`{}` has changed since the scene was read", file.name);
                return Err(Failure::new(cause, "start again"));
            }
            output::write(&to, &bytes)?;
        }
        output::write(&self.path.join(SCENE), &scene.text)
    }

    pub(super) fn frames(&self) -> PathBuf {
        self.path.join("frames")
    }

    fn partial(&self, spot: usize) -> PathBuf {
        self.path
            .join("partial")
            .join(format!("spot-{spot:04}.npy"))
    }

    /// Keeps a finished spot (column `column` of `traced`) until the run is complete, and returns
    /// what it keeps.
    pub(super) fn keep(
        &self,
        spot: usize,
        traced: &Traced,
        column: usize,
    ) -> Result<Matrix, Failure> {
        ensure_writable(&self.path.join("partial"))?;
        let columns = traced.bounces.iter().chain([&traced.stderr]);
        let columns: Vec<_> = columns.map(|m| m.column(column).into_owned()).collect();
        let kept = Matrix::from_columns(&columns);
        npy::write(&self.partial(spot), &kept)?;
        Ok(kept)
    }

    /// The file for the finished blocks of `spots`.
    pub(super) fn checkpoint(&self, spots: &Range<usize>) -> Result<PathBuf, Failure> {
        ensure_writable(&self.path.join("partial"))?;
        Ok(self.checkpoint_path(spots))
    }

    fn checkpoint_path(&self, spots: &Range<usize>) -> PathBuf {
        let name = format!(
            "spots-{:04}-{:04}.{}",
            spots.start,
            spots.end,
            jobs::EXTENSION
        );
        self.path.join("partial").join(name)
    }

    /// Spots of which `plan` has finished blocks there.
    pub(super) fn checkpoints(&self, scene: &Scene, plan: &Plan) -> Vec<Range<usize>> {
        let entries = fs::read_dir(self.path.join("partial"));
        let names = entries
            .into_iter()
            .flatten()
            .filter_map(|e| e.ok()?.file_name().into_string().ok());
        let spots = |name: String| {
            let own = name.strip_suffix(jobs::EXTENSION)?.strip_suffix('.')?;
            let (from, to) = own.strip_prefix("spots-")?.split_once('-')?;
            Some(from.parse().ok()?..to.parse().ok()?)
        };
        let blocks = u64::from(plan.budget.blocks);
        let mut found: Vec<Range<usize>> = names
            .filter_map(spots)
            .filter(|r| r.start < r.end && r.end <= scene.laser.spots.len())
            .filter(|r| {
                BlockFile::open(
                    &self.checkpoint_path(r),
                    &own_identity(scene, plan, r),
                    blocks,
                )
                .is_ok()
            })
            .collect();
        found.sort_by_key(|r| r.start);
        found
    }

    /// Forgets the finished blocks of `spots`, once these are whole.
    pub(super) fn remove_checkpoint(&self, spots: &Range<usize>) -> Result<(), Failure> {
        let path = self.checkpoint_path(spots);
        let name = path
            .file_name()
            .and_then(|n| n.to_str())
            .unwrap_or_default();
        remove_named(&self.path.join("partial"), &[name])
    }

    /// A finished spot of the run `record`: one column per bounce count, then the standard error;
    /// `None` unless both this and its frame are there and whole.
    pub(super) fn kept(&self, spot: usize, scene: &Scene, record: &Record) -> Option<Matrix> {
        let matrix = npy::read_finite(&self.partial(spot)).ok()?;
        let shape = (scene.camera.pixels(), scene.max_bounces as usize + 1);
        let frame = film::exr::read(&self.frames().join(frame_name(spot as u32))).ok()?;
        let own = frame.meta == meta(scene, record, spot);
        (own && matrix.shape() == shape).then_some(matrix)
    }

    /// Removes from a run that is complete what an ended process has left beside it.
    pub(super) fn tidy(&self) -> Result<(), Failure> {
        self.remove_partial()?;
        self.remove_abandoned()
    }

    fn remove_abandoned(&self) -> Result<(), Failure> {
        let nothing = |_: &str, _: &str| false;
        remove_files(&self.path, nothing)?;
        remove_files(&self.frames(), nothing)
    }

    pub(super) fn remove_partial(&self) -> Result<(), Failure> {
        let partial = self.path.join("partial");
        remove_files(&partial, |stem, ext| {
            stem.starts_with("spots-") && ext == jobs::EXTENSION
        })?;
        remove_numbered(&partial, "npy")
    }

    /// Removes what was rendered, and what was found from it.
    fn remove_frames(&self) -> Result<(), Failure> {
        self.remove_partial()?;
        remove_numbered(&self.frames(), "exr")?;
        remove_recovered(&self.path.join(RECOVERED))?;
        remove_exposed(&self.path.join(EXPOSED))?;
        remove_named(&self.path.join(MODEL), &[Z])?;
        remove_named(&self.path, &[PHI, STDERR, Record::FILE, SUMMARY, REPORT])
    }

    /// Writes the frame of a spot from column `column` of `traced`.
    pub(super) fn write_frame(
        &self,
        scene: &Scene,
        record: &Record,
        spot: usize,
        traced: &Traced,
        column: usize,
    ) -> Result<(), Failure> {
        let channel = |name: String, m: &Matrix| Channel {
            name,
            values: m.column(column).iter().map(|x| *x as f32).collect(),
        };
        let mut channels = vec![
            channel(film::frame::FLUX.into(), &traced.flux),
            channel(film::frame::FLUX_STDERR.into(), &traced.stderr),
        ];
        for (n, m) in traced.bounces.iter().enumerate() {
            channels.push(channel(film::frame::bounce_channel(n + 1), m));
        }
        let frame = Frame {
            columns: scene.camera.columns,
            rows: scene.camera.rows,
            channels,
            meta: meta(scene, record, spot),
        };
        Ok(film::exr::write(
            &self.frames().join(frame_name(spot as u32)),
            &frame,
        )?)
    }

    /// Writes Φcam and its standard error.
    pub(super) fn write_phi(&self, phi: &Matrix, stderr: &Matrix) -> Result<(), Failure> {
        npy::write(&self.path.join(STDERR), stderr)?;
        Ok(npy::write(&self.path.join(PHI), phi)?)
    }
}

/// Refuses what stands in `dir` where `folders` and `files` have to stand: before the long work,
/// not after it.
pub(super) fn refuse_obstacles(
    dir: &Path,
    folders: &[&str],
    files: &[&str],
) -> Result<(), Failure> {
    let paths = |names: &[&str]| -> Vec<PathBuf> { names.iter().map(|n| dir.join(n)).collect() };
    if let Some(path) = paths(folders)
        .into_iter()
        .find(|p| p.exists() && !p.is_dir())
    {
        return Err(StoreError::NotAFolder { path }.into());
    }
    if let Some(path) = paths(files)
        .into_iter()
        .find(|p| p.exists() && !p.is_file())
    {
        return Err(StoreError::NotAFile { path }.into());
    }
    Ok(())
}

/// What the finished blocks of `spots` depend on.
pub(super) fn own_identity(scene: &Scene, plan: &Plan, spots: &Range<usize>) -> Identity {
    Spots::identity(scene, plan).with("spots", format!("{}..{}", spots.start, spots.end))
}

/// What the frame of `spot` says of its origin.
pub(super) fn meta(scene: &Scene, record: &Record, spot: usize) -> FrameMeta {
    FrameMeta {
        run: RunMeta {
            scene_name: scene.name.clone(),
            scene_hash: scene.hash.clone(),
            unit: scene.unit.symbol().to_owned(),
            spot_count: record.spots as u32,
            seed: record.plan.seed,
            samples: record.plan.budget.samples(),
            estimator: record.plan.estimator.to_string(),
            sampler: record.plan.sampling.to_string(),
            version: record.version.clone(),
        },
        spot_index: spot as u32,
        spot_position: scene.laser.spots[spot].target.position.to_array(),
    }
}
