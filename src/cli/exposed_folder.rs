//! The folder of the photographs of `phicam expose`. What is finished in it stays until what takes
//! its place is whole.
//!
//! | file | content |
//! | --- | --- |
//! | phi.npy, phi.stderr.npy | linearised flux and its standard deviation, pixels × spots, W |
//! | saturated.npy | 1 where an entry is saturated in every exposure, −1 where the converter cut it off below, 0.5 where it is only near either, else 0 |
//! | counts/spot-NNNN.exr, .png | mean counts, a channel for each exposure time; the longest as 16-bit grey |
//! | exposure.json | sensor, exposure, what came of it |

use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::Value;

use crate::cli::cleanup::{remove_abandoned, remove_named, remove_numbered};
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::replacement::{move_in, remove_folder};
use crate::film::{self, Channel, Frame, frame_name};
use crate::folder::Record;
use crate::folder::names::{COUNTS, EXPOSED, EXPOSURE, PHI, SATURATED, STDERR, is_frame};
use crate::matrix::{Matrix, npy};
use crate::report;
use crate::scene::Scene;
use crate::sensor::{Exposed, Range, Sensor};
use crate::store::{self, ensure_writable, flush};

/// Its files; the last says that all are there.
const FILES: [&str; 4] = [SATURATED, STDERR, PHI, EXPOSURE];

/// Bytes that an account may have.
const MOST_ACCOUNT: u64 = 1 << 20;

const OTHER_CURE: &str =
    "give the same settings, choose another folder (-o), or replace them (--replace)";

/// Photographs that take the place of others, until they are whole.
const REPLACEMENT: &str = ".exposed-new";
/// The same while they are moved to their places; nothing of the others is left.
const INCOMING: &str = ".exposed-incoming";

/// A folder of photographs.
#[derive(Debug)]
pub(super) struct ExposedFolder {
    path: PathBuf,
}

impl ExposedFolder {
    /// The folder `path`, which need not be there.
    pub(super) fn at(path: &Path) -> Self {
        let path = path.to_owned();
        Self { path }
    }

    /// What stands in the way of its files shows before anything is written. The folder of a run is
    /// not overwritten.
    pub(super) fn refuse_obstacles(&self) -> Result<(), Failure> {
        output::refuse_run(&self.path)?;
        output::refuse_obstacles(&self.path, &[COUNTS], &FILES)
    }

    /// Refuses, before anything is computed, to replace photographs whose account differs from
    /// `with` in what they were exposed with; says in what.
    pub(super) fn refuse_other_settings(&self, with: &impl Serialize) -> Result<(), Failure> {
        let account = store::read(&self.path.join(EXPOSURE), MOST_ACCOUNT);
        let there: Option<Value> = account.ok().and_then(|b| serde_json::from_slice(&b).ok());
        let (Some(Value::Object(there)), Value::Object(with)) =
            (there, serde_json::from_str(&output::json(with)?)?)
        else {
            return Ok(());
        };
        let differs = |(key, ours): &(&String, &Value)| there.get(*key) != Some(*ours);
        let keys: Vec<&str> = with.iter().filter(differs).map(|(key, _)| &**key).collect();
        if keys.is_empty() {
            return Ok(());
        }
        let (path, keys) = (self.path.display(), keys.join(", "));
        let cause = format!("{path} holds photographs with other settings ({EXPOSURE}: {keys})");
        Err(Failure::new(cause, OTHER_CURE))
    }

    /// Refuses to replace photographs of other settings, of other light or of unknown origin: those
    /// that are there have to have the account `json`.
    pub(super) fn refuse_other(&self, json: &str) -> Result<(), Failure> {
        let there = FILES.map(|name| self.path.join(name).exists());
        let account = store::read(&self.path.join(EXPOSURE), json.len() as u64);
        if !there.contains(&true) || account.is_ok_and(|own| own == json.as_bytes()) {
            return Ok(());
        }
        let path = self.path.display();
        let cause = match there {
            [.., true] => format!("{path} holds photographs with other settings ({EXPOSURE})"),
            _ => format!("{path} holds photographs, but no {EXPOSURE} that says which"),
        };
        Err(Failure::new(cause, OTHER_CURE))
    }

    /// Goes on where a process was ended while it put new photographs in the place of others, and
    /// removes what was not whole. Whether something was put in place.
    pub(super) fn finish_replacement(&self) -> Result<bool, Failure> {
        let staged = self.path.join(REPLACEMENT);
        let half_moved = self.path.join(INCOMING).is_dir();
        let half_removed = !self.path.join(EXPOSURE).exists() && staged.join(EXPOSURE).exists();
        if half_moved {
            self.move_in()?;
        } else if half_removed {
            self.replace()?;
        }
        remove_folder(&staged)?;
        Ok(half_moved || half_removed)
    }

    /// Writes the photographs beside those that are there, then puts them in their place.
    pub(super) fn write(
        &self,
        exposed: &Exposed,
        (scene, record): (&Scene, &Record),
        sensor: &Sensor,
        json: &str,
    ) -> Result<(), Failure> {
        let staged = self.path.join(REPLACEMENT);
        let counts = staged.join(COUNTS);
        ensure_writable(&counts)?;
        let (pixels, spots) = exposed.flux.shape();
        for spot in 0..spots {
            write_counts(&counts, exposed, (scene, record), sensor, spot)?;
        }
        flush(&counts)?;
        let mask = Matrix::from_iterator(
            pixels,
            spots,
            exposed.range.iter().map(|range| match range {
                Range::Within => 0.0,
                Range::Saturated => 1.0,
                Range::Near => 0.5,
                Range::Floored => -1.0,
            }),
        );
        npy::write(&staged.join(SATURATED), &mask)?;
        npy::write(&staged.join(STDERR), &exposed.stderr)?;
        npy::write(&staged.join(PHI), &exposed.flux)?;
        output::write(&staged.join(EXPOSURE), json)?;
        self.replace()
    }

    /// Lets the run in `dir` vouch for the photographs in its folder [`EXPOSED`].
    pub(super) fn vouch(dir: &Path) -> Result<(), Failure> {
        let Some(mut record) = Record::read(dir)? else {
            return Ok(());
        };
        let spots = record.spots;
        let count = |name: &str| {
            let stem = name.strip_suffix(".exr").or(name.strip_suffix(".png"));
            stem.is_some_and(|stem| is_frame(&format!("{stem}.exr"), spots))
        };
        record.vouch_all(dir, EXPOSED, |name| FILES.contains(&name))?;
        record.vouch_all(dir, &format!("{EXPOSED}/{COUNTS}"), count)?;
        Ok(record.write(dir)?)
    }

    /// Removes the old photographs and moves the new ones to their place. A process that ends
    /// midway leaves what [`Self::finish_replacement`] goes on with.
    fn replace(&self) -> Result<(), Failure> {
        self.remove_files()?;
        fs::rename(self.path.join(REPLACEMENT), self.path.join(INCOMING))?;
        self.move_in()
    }

    fn move_in(&self) -> Result<(), Failure> {
        move_in(&self.path.join(INCOMING), &self.path, &[COUNTS], &FILES)
    }

    /// Removes the photographs, the account first, so that nobody takes what is left for whole.
    fn remove_files(&self) -> Result<(), Failure> {
        remove_named(&self.path, &[EXPOSURE])?;
        let counts = self.path.join(COUNTS);
        remove_numbered(&counts, "exr")?;
        remove_numbered(&counts, "png")?;
        remove_named(&self.path, &FILES)?;
        remove_abandoned(&self.path)
    }

    /// Removes the photographs, also those that are not whole, and the folder if that empties it.
    pub(super) fn remove(&self) -> Result<(), Failure> {
        self.remove_files()?;
        remove_folder(&self.path.join(REPLACEMENT))?;
        remove_folder(&self.path.join(INCOMING))?;
        let _ = fs::remove_dir(&self.path);
        Ok(())
    }
}

/// The frame of one spot: its counts at each exposure time as EXR, those of the longest as PNG.
fn write_counts(
    folder: &Path,
    exposed: &Exposed,
    (scene, record): (&Scene, &Record),
    sensor: &Sensor,
    spot: usize,
) -> Result<(), Failure> {
    let single = exposed.counts.len() == 1;
    let channel = |(k, counts): (usize, &Matrix)| Channel {
        name: if single {
            film::frame::COUNTS.to_owned()
        } else {
            format!("{}.{k}", film::frame::COUNTS)
        },
        values: counts.column(spot).iter().map(|x| *x as f32).collect(),
    };
    let frame = Frame {
        columns: scene.camera.columns,
        rows: scene.camera.rows,
        channels: exposed.counts.iter().enumerate().map(channel).collect(),
        meta: record.meta(scene, spot),
    };
    let path: PathBuf = folder.join(frame_name(spot as u32));
    film::exr::write(&path, &frame)?;
    let values: Vec<f64> = exposed.counts[0].column(spot).iter().copied().collect();
    let white = match sensor.figures().bits {
        Some(_) => 65535.0,
        None => exposed.counts[0].max(),
    };
    let png = report::counts_png([frame.columns, frame.rows], &values, white)?;
    output::write(&path.with_extension("png"), &png)
}
