//! The folder of a run: what may be written into it, and what is read back from it.
//!
//! | file | content |
//! | --- | --- |
//! | scene.toml, run.json | the scene, whole; what was rendered and how |
//! | files/ | copies of the meshes, pictures and materials that the scene names |
//! | frames/spot-NNNN.exr | one frame a spot |
//! | phi.npy, phi.stderr.npy | Φcam and its standard error, pixels × spots, W |
//! | phi.tails.npy | how far that is to be trusted: [`tails`](crate::transport::tails), pixels × spots |
//! | partial/ | what is finished of an unfinished run: see [`super::partial`] |

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::cleanup::{remove_files, remove_named, remove_numbered};
use super::console::Console;
use super::failure::Failure;
use super::output;
use super::partial::{PARTIAL, Partial};
use super::record::Record;
use crate::film::{self, Channel, Frame, FrameMeta, RunMeta, frame_name};
use crate::lab::Tails;
use crate::matrix::{Matrix, npy};
use crate::recovery::Method;
use crate::scene::{COPIES, Scene};
use crate::store::{StoreError, ensure_writable};
use crate::transport::Traced;

pub(super) const PHI: &str = "phi.npy";
pub(super) const STDERR: &str = "phi.stderr.npy";
/// Entries whose standard error is not to be trusted: 0 where it is, f64, pixels × spots.
pub(super) const TAILS: &str = "phi.tails.npy";
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
pub(super) struct RunFolder {
    pub path: PathBuf,
}

impl RunFolder {
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
        resume: Resume,
        console: Console,
    ) -> Result<Self, Failure> {
        let folder = Self {
            path: path.to_owned(),
        };
        folder.refuse_foreign(scene, console)?;
        let earlier = Record::read(path)?;
        let same = earlier.as_ref().is_some_and(|e| e.same_settings(record));
        if let Some(e) = earlier.filter(|_| !same) {
            if resume != Resume::Nothing {
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
        if resume == Resume::Nothing {
            folder.partial().remove()?;
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
            &["frames", PARTIAL, MODEL, RECOVERED, COPIES],
            &[SCENE, PHI, STDERR, TAILS, Record::FILE, SUMMARY, REPORT],
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
        if holds("frames") || holds(PARTIAL) || self.path.join(PHI).exists() {
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
            let bytes = file
                .again()
                .map_err(|(cause, cure)| Failure::new(cause, cure))?;
            output::write(&to, &bytes)?;
        }
        output::write(&self.path.join(SCENE), &scene.text)
    }

    pub(super) fn frames(&self) -> PathBuf {
        self.path.join("frames")
    }

    /// Its unfinished part.
    pub(super) fn partial(&self) -> Partial {
        Partial::of(&self.path)
    }

    /// A finished spot of the run `record`: one column per bounce count, then the standard error
    /// and its code; `None` unless both this and its frame are there and whole.
    pub(super) fn kept(&self, spot: usize, scene: &Scene, record: &Record) -> Option<Matrix> {
        let frame = film::exr::read(&self.frames().join(frame_name(spot as u32))).ok()?;
        let own = frame.meta == meta(scene, record, spot);
        self.partial().read(spot, scene).filter(|_| own)
    }

    /// Removes from a run that is complete what an ended process has left beside it.
    pub(super) fn tidy(&self) -> Result<(), Failure> {
        self.partial().remove()?;
        self.remove_abandoned()
    }

    fn remove_abandoned(&self) -> Result<(), Failure> {
        let nothing = |_: &str, _: &str| false;
        remove_files(&self.path, nothing)?;
        remove_files(&self.frames(), nothing)
    }

    /// Removes what was rendered, and what was found from it.
    fn remove_frames(&self) -> Result<(), Failure> {
        self.partial().remove()?;
        remove_numbered(&self.frames(), "exr")?;
        remove_recovered(&self.path.join(RECOVERED))?;
        remove_exposed(&self.path.join(EXPOSED))?;
        remove_named(&self.path.join(MODEL), &[Z])?;
        remove_named(
            &self.path,
            &[PHI, STDERR, TAILS, Record::FILE, SUMMARY, REPORT],
        )
    }

    /// Writes the frames of `spots` from the columns of `traced`, on the threads of the pool.
    pub(super) fn write_frames(
        &self,
        scene: &Scene,
        record: &Record,
        spots: &Range<usize>,
        traced: &Traced,
    ) -> Result<(), Failure> {
        refuse_beyond_f32(traced)?;
        let frames = spots.clone().into_par_iter().enumerate();
        frames.try_for_each(|(column, spot)| self.write_frame(scene, record, spot, traced, column))
    }

    /// Writes the frame of a spot from column `column` of `traced`.
    fn write_frame(
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

    /// Writes Φcam, its standard error and how far that is to be trusted, and that the run is
    /// complete.
    pub(super) fn finish(
        &self,
        record: &mut Record,
        [phi, stderr, tails]: [&Matrix; 3],
    ) -> Result<(), Failure> {
        record.tails = Some(Tails::of(tails));
        npy::write(&self.path.join(TAILS), tails)?;
        npy::write(&self.path.join(STDERR), stderr)?;
        npy::write(&self.path.join(PHI), phi)?;
        record.write(&self.path)?;
        self.partial().remove()
    }
}

/// Frames hold f32: a flux beyond its range would be stored as infinity.
fn refuse_beyond_f32(traced: &Traced) -> Result<(), Failure> {
    let most = traced.flux.amax().max(traced.stderr.amax());
    if most <= f64::from(f32::MAX) {
        return Ok(());
    }
    let cause = format!("a flux of {most:.1e} W is more than the f32 of a frame can hold");
    Err(Failure::new(cause, "lower the laser's power in the scene"))
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

/// Removes the photographs of `phicam expose` from `dir`, and `dir` if that empties it.
pub(super) fn remove_exposed(dir: &Path) -> Result<(), Failure> {
    let counts = dir.join(COUNTS);
    remove_numbered(&counts, "exr")?;
    remove_numbered(&counts, "png")?;
    remove_named(dir, &[PHI, STDERR, SATURATED, EXPOSURE])?;
    let _ = fs::remove_dir(dir);
    Ok(())
}

/// Removes the matrices, tables and pictures METHOD.npy, METHOD-0.png, METHOD.stderr.npy,
/// picard.csv, … and those of the truth from `dir`, and `dir` if that empties it.
pub(super) fn remove_recovered(dir: &Path) -> Result<(), Failure> {
    remove_files(dir, |stem, ext| {
        let (name, what) = stem.split_once('.').unwrap_or((stem, ""));
        let name = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let name = name.strip_suffix('-').unwrap_or(name);
        let pictures = ["truth", "overview", "picard", "picard-joint", "determined"];
        let known = pictures.contains(&name) || name.parse::<Method>().is_ok();
        let ours = known
            && [
                "",
                "stderr",
                "covariance",
                "resolution",
                "bias",
                "lower",
                "upper",
                "texture",
            ]
            .contains(&what);
        ours && matches!(ext, "npy" | "png" | "csv" | "svg" | "ply")
    })?;
    let _ = fs::remove_dir(dir);
    Ok(())
}
