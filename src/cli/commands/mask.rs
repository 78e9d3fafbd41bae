//! Masks: which entries of photographs do not count.

use std::path::{Path, PathBuf};

use super::beside::PhotographSize;
use super::recover_memory;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::load_run::{refuse_damaged, refuse_other_shape};
use crate::cli::run_folder::{LEFT_OUT, SATURATED};
use crate::matrix::Matrix;
use crate::matrix::npy::{self, NpyError};
use crate::scene::Scene;
use crate::store::{self, memory};

/// Most bytes of a mask's file before its entries: the longest header that is read, and its ends.
const HEADER_MAX: u64 = 2048;

/// The file that says which entries do not count: the one asked for, else the one beside Φcam.
pub(super) fn mask(asked: Option<&Path>, phi: &Path) -> Option<PathBuf> {
    let beside = phi.with_file_name(LEFT_OUT);
    let beside = beside.exists().then_some(beside);
    asked.map(Path::to_path_buf).or(beside)
}

/// Rows of a mask that are read at a time.
const MASK_ROWS: usize = 256;

/// Refuses photographs of `phicam expose` whose values mean nothing in places, by the mask beside
/// them: they are too low or too high by an unknown amount, and no standard error says so. `cure`
/// is what else may be done.
pub(super) fn refuse_clipped(phi: &Path, scene: &Scene, cure: &str) -> Result<(), Failure> {
    let mask = phi.with_file_name(SATURATED);
    if !mask.exists() {
        return Ok(());
    }
    let mut rows = recover_memory::open(&mask, scene)?;
    let (pixels, spots) = rows.shape();
    let mut marked = 0;
    for first in (0..pixels).step_by(MASK_ROWS) {
        let part = rows.read(first, MASK_ROWS)?;
        marked += part.iter().filter(|x| x.abs() >= 1.0).count();
    }
    if marked == 0 {
        return Ok(());
    }
    let cause = format!(
        "{marked} of {} entries of {} are saturated or cut off, says {}: neither their values nor their standard errors mean anything",
        pixels * spots,
        phi.display(),
        mask.display()
    );
    let cure = format!(
        "expose for a shorter time or in --brackets; --left-out {} leaves them out{cure}",
        mask.display()
    );
    Err(Failure::new(cause, cure))
}

/// Entries that do not count, by [`mask`].
pub(super) fn left_out(
    asked: Option<&Path>,
    phi: &Path,
    of: &PhotographSize,
    console: Console,
) -> Result<Option<Matrix>, Failure> {
    let Some(file) = &mask(asked, phi) else {
        return Ok(None);
    };
    let flags = read_mask(file, of)?;
    let count = flags.iter().filter(|x| **x != 0.0).count();
    if count == 0 {
        return Ok(None);
    }
    console.say(format!(
        "{count} of {} entries are left out, says {}",
        flags.len(),
        file.display()
    ));
    Ok(Some(flags))
}

/// A mask of photographs `of` a size, whose entries may be truths or integers, too: those that are
/// not 0 do not count.
pub(super) fn read_mask(path: &Path, of: &PhotographSize) -> Result<Matrix, Failure> {
    let entries = of.pixels * of.spots;
    // The file, and its numbers twice.
    memory::refuse("the photographs", 24.0 * entries as f64, &[])?;
    let Err(NpyError::Type { .. }) = npy::shape(path) else {
        return of.read(path);
    };
    // At most 8 bytes an entry.
    let most = 8 * entries as u64 + HEADER_MAX;
    let array = npy::read_array(&path.display().to_string(), &store::read(path, most)?)?;
    let shape = match array.shape[..] {
        [rows] => (rows, 1),
        [rows, columns] => (rows, columns),
        _ => {
            let cause = format!("{} has the shape {:?}", path.display(), array.shape);
            return Err(Failure::new(cause, "give a mask of pixels × spots"));
        }
    };
    refuse_other_shape(path, shape, (of.pixels, of.spots), &of.name)?;
    refuse_damaged(path)?;
    Ok(Matrix::from_row_slice(shape.0, shape.1, &array.values))
}
