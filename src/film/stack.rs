//! The frames of a run, stacked into the matrix Φcam.
//!
//! Column l of Φcam is the frame of spot l, row p its pixel p. The frames alone decide: nothing
//! else of the run is read, so that a folder of frames can be carried anywhere. Frames that do not
//! belong together, or not all of them, would give a matrix that looks right and is not; they are
//! refused.

mod run;
mod spots;

use std::io;
use std::path::{Path, PathBuf};

use super::exr::{self, FrameError, file_max, read_within};
use super::frame::{FLUX, FLUX_STDERR, Frame, RunMeta, frame_name};
use crate::matrix::Matrix;

/// What the frames of a run say together. Every matrix is pixels × spots, in W; f64 of what f32
/// kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    /// Pixels along x and y of each frame; row of a matrix = column + row·columns of the pixel.
    pub resolution: [usize; 2],
    /// Φcam, the channel `flux`.
    pub phi: Matrix,
    /// Its standard error, the channel `flux.stderr`; nowhere negative.
    pub stderr: Matrix,
    /// Every other channel with its name; `flux.b3` before `flux.b10`.
    pub bounces: Vec<(String, Matrix)>,
    /// Where each spot is, in the length unit of the run.
    pub spot_positions: Vec<[f64; 3]>,
    /// What all frames have in common.
    pub run: RunMeta,
}

/// Why frames do not make a matrix. Each message names the file, the cause and the cure.
#[derive(Debug, thiserror::Error)]
pub enum StackError {
    /// The folder cannot be listed.
    #[error("cannot list {}: {source}; give the output folder of a run", path.display())]
    Unreadable {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// No file has the name of a frame.
    #[error("{} holds no frames (spot-0000.exr, spot-0001.exr, …); give the output folder of `phicam render`", path.display())]
    NoFrames {
        /// The folder.
        path: PathBuf,
    },
    /// A frame cannot be read.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// Two files for one spot.
    #[error("{} and {} are both named for spot {spot}; remove the one that does not belong to the run", first.display(), second.display())]
    Duplicate {
        /// The spot.
        spot: u32,
        /// One file.
        first: PathBuf,
        /// The other.
        second: PathBuf,
    },
    /// The file's name and its header disagree.
    #[error("{} holds the frame of spot {spot}; rename it to {} or render both spots again", path.display(), frame_name(*spot))]
    Misnamed {
        /// The file.
        path: PathBuf,
        /// The spot in its header.
        spot: u32,
    },
    /// Two frames are not of one run.
    #[error("{} has the {property} {found}, but {} has {expected}; stack the frames of one run only", path.display(), first.display())]
    Mismatch {
        /// The frame that differs.
        path: PathBuf,
        /// The first frame of the folder.
        first: PathBuf,
        /// What differs.
        property: &'static str,
        /// Its value in `path`.
        found: String,
        /// Its value in `first`.
        expected: String,
    },
    /// A frame of a spot that the run does not have.
    #[error("{} is of spot {spot}, but the run has only spots 0 to {}; remove it", path.display(), spot_count.saturating_sub(1))]
    Surplus {
        /// The file.
        path: PathBuf,
        /// Its spot.
        spot: u32,
        /// Spots of the run.
        spot_count: u32,
    },
    /// Not every spot has its frame.
    #[error("{} lacks the frames of {count} of {spot_count} spots: {spots}; render them with `phicam render`, which goes on", path.display())]
    Missing {
        /// The folder of the frames.
        path: PathBuf,
        /// How many are missing.
        count: u32,
        /// Spots of the run.
        spot_count: u32,
        /// Which, as `3, 7-9`.
        spots: String,
    },
    /// A frame without a channel that every frame has.
    #[error("{} has no channel {channel}; render its spot again", path.display())]
    NoChannel {
        /// The file.
        path: PathBuf,
        /// The channel.
        channel: String,
    },
    /// NaN, infinity, or a negative standard error.
    #[error(
        "{} has the value {value} in channel {channel} at pixel (column {column}, row {row}), which no rendering gives; \
         delete the file and render its spot again",
        path.display()
    )]
    Value {
        /// The file.
        path: PathBuf,
        /// The channel.
        channel: String,
        /// Column of the pixel, from 0.
        column: usize,
        /// Row of the pixel, from 0.
        row: usize,
        /// The value.
        value: f32,
    },
}

/// Rebuilds Φcam from the frames `dir/frames/spot-NNNN.exr`, or `dir/spot-NNNN.exr` if `dir` has no
/// folder `frames`. Files with other names are not looked at.
///
/// # Errors
/// [`StackError`] if there are no frames, if one cannot be read, if they disagree on scene, size,
/// channels, unit, seed, samples, estimator, sampler, version or number of spots, if a spot is
/// missing, double or contradicts its file name, if a value is NaN or infinite, or a standard error
/// negative.
pub fn stack(dir: &Path) -> Result<Stack, StackError> {
    stack_within(dir, exr::PIXEL_BYTES_MAX as u64)
}

/// The same of frames whose files have at most `most` bytes each: see [`exr::file_max`].
///
/// # Errors
/// Those of [`stack`].
pub fn stack_within(dir: &Path, most: u64) -> Result<Stack, StackError> {
    let inner = dir.join("frames");
    let folder = if inner.is_dir() {
        inner
    } else {
        dir.to_path_buf()
    };
    let files = spots::frame_files(&folder)?;
    let Some((_, first_path)) = files.first() else {
        return Err(StackError::NoFrames { path: folder });
    };
    let first = read_within(first_path, most)?;
    spots::check_spots(&folder, &files, first.meta.run.spot_count)?;

    let pixels = first.pixels();
    let blank = || Matrix::zeros(pixels, files.len());
    let mut stack = Stack {
        resolution: [first.columns, first.rows],
        phi: blank(),
        stderr: blank(),
        bounces: other_channels(&first)
            .into_iter()
            .map(|name| (name, blank()))
            .collect(),
        spot_positions: Vec::with_capacity(files.len()),
        run: first.meta.run.clone(),
    };
    let most = file_max([first.columns, first.rows], first.channels.len());
    for (l, (spot, path)) in files.iter().enumerate() {
        let frame = read_within(path, most)?;
        if let Some((property, found, expected)) = run::difference(&frame, &first) {
            let (path, first) = (path.clone(), first_path.clone());
            return Err(StackError::Mismatch {
                path,
                first,
                property,
                found,
                expected,
            });
        }
        if frame.meta.spot_index != *spot {
            return Err(StackError::Misnamed {
                path: path.clone(),
                spot: frame.meta.spot_index,
            });
        }
        fill(&mut stack.phi, l, path, &frame, FLUX)?;
        fill(&mut stack.stderr, l, path, &frame, FLUX_STDERR)?;
        for (name, matrix) in &mut stack.bounces {
            fill(matrix, l, path, &frame, name)?;
        }
        stack.spot_positions.push(frame.meta.spot_position);
    }
    Ok(stack)
}

/// Names of the channels besides flux and its standard error; `flux.b3` before `flux.b10`.
fn other_channels(frame: &Frame) -> Vec<String> {
    let names = frame.channels.iter().map(|c| c.name.clone());
    let mut names: Vec<String> = names.filter(|n| n != FLUX && n != FLUX_STDERR).collect();
    names.sort_by_key(|n| (n.len(), n.clone()));
    names
}

/// Copies a channel of `frame` into column `l` of `matrix`, finite values only.
fn fill(
    matrix: &mut Matrix,
    l: usize,
    path: &Path,
    frame: &Frame,
    name: &str,
) -> Result<(), StackError> {
    let missing = || StackError::NoChannel {
        path: path.into(),
        channel: name.into(),
    };
    let values = frame.channel(name).ok_or_else(missing)?;
    for (p, &value) in values.iter().enumerate() {
        if !value.is_finite() || (name == FLUX_STDERR && value < 0.0) {
            let (column, row) = (p % frame.columns, p / frame.columns);
            return Err(StackError::Value {
                path: path.into(),
                channel: name.into(),
                column,
                row,
                value,
            });
        }
        matrix[(p, l)] = f64::from(value);
    }
    Ok(())
}

#[cfg(test)]
mod tests;
