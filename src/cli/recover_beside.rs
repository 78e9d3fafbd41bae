//! What the photographs of a recovery hold beside the light of the hidden surface, and what of them
//! does not count.

use std::path::{Path, PathBuf};

use super::args::RecoverArgs;
use super::console::Console;
use super::failure::Failure;
use super::load_run::{read_undamaged, refuse_other_shape};
use super::run_folder::LEFT_OUT;
use crate::lab::polynomials;
use crate::matrix::{Matrix, npy};
use crate::recovery::Nuisance;

/// Patterns that may be estimated in each frame.
const MOST_PATTERNS: usize = 64;
/// Patterns of all frames together that may be estimated beside a background: a matrix of as many
/// columns, 128 MiB.
const MOST_COUPLED: usize = 4096;

/// The size of Φcam.
pub(super) struct Photographs {
    /// What has it.
    pub name: String,
    /// Columns and rows of a photograph, where they are known.
    pub grid: Option<[usize; 2]>,
    pub pixels: usize,
    pub spots: usize,
}

impl Photographs {
    /// A matrix of the same size.
    fn read(&self, path: &Path) -> Result<Matrix, Failure> {
        // By its header, before memory is taken for its numbers.
        let expected = (self.pixels, self.spots);
        refuse_other_shape(path, npy::shape(path)?, expected, &self.name)?;
        read_undamaged(path)
    }
}

/// The matrices that the arguments name.
pub(super) struct Beside {
    glare: Option<Matrix>,
    patterns: Option<Matrix>,
    left_out: Option<Matrix>,
}

impl Beside {
    /// Reads them.
    pub(super) fn read(
        args: &RecoverArgs,
        phi: &Path,
        of: &Photographs,
        console: Console,
    ) -> Result<Self, Failure> {
        let glare = args.joint.glare_pattern.as_ref();
        let patterns = patterns(args, of)?;
        // A background ties the terms of all frames together.
        let of_frame = patterns.as_ref().map_or(0, Matrix::ncols);
        if args.joint.background && of_frame.saturating_mul(of.spots) > MOST_COUPLED {
            let cause = format!(
                "--background and {of_frame} patterns in each of {} frames are too many to estimate together",
                of.spots
            );
            let cure = format!(
                "leave --background out, or use fewer patterns: {MOST_COUPLED} in all frames together"
            );
            return Err(Failure::new(cause, cure));
        }
        Ok(Self {
            glare: glare.map(|file| of.read(file)).transpose()?,
            patterns,
            left_out: left_out(args, phi, of, console)?,
        })
    }

    /// What is to be estimated.
    pub(super) fn nuisance(&self, args: &RecoverArgs) -> Nuisance<'_> {
        Nuisance {
            frame_constant: args.joint.frame_constant,
            frame_patterns: self.patterns.as_ref(),
            background: args.joint.background,
            glare: self.glare.as_ref(),
            free_scale: args.joint.free_scale,
            frame_gain: args.joint.frame_gain,
            scale_error: args.joint.scale_error,
            left_out: self.left_out.as_ref(),
        }
    }
}

/// Patterns whose strength in each frame is estimated: those of a polynomial, then those of a file.
fn patterns(args: &RecoverArgs, of: &Photographs) -> Result<Option<Matrix>, Failure> {
    let smooth = match (args.joint.frame_polynomial, of.grid) {
        (Some(degree), Some(grid)) => Some(polynomials(grid, usize::from(degree))),
        (Some(_), None) => {
            let cause = "nothing says how the pixels lie in the photograph";
            let cure = "give --pixels COLUMNSxROWS, or the polynomials as --frame-patterns";
            return Err(Failure::new(cause, cure));
        }
        (None, _) => None,
    };
    let Some(file) = &args.joint.frame_patterns else {
        return Ok(smooth);
    };
    let (pixels, count) = npy::shape(file)?;
    if pixels != of.pixels {
        let cause = format!(
            "{} is {pixels} × {count}, but {} has {} pixels",
            file.display(),
            of.name,
            of.pixels
        );
        return Err(Failure::new(cause, "give pixels × patterns"));
    }
    if count > MOST_PATTERNS {
        let cause = format!("{} holds {count} patterns", file.display());
        let cure = format!("give at most {MOST_PATTERNS}");
        return Err(Failure::new(cause, cure));
    }
    let own = read_undamaged(file)?;
    Ok(Some(match smooth {
        None => own,
        Some(smooth) => {
            let all: Vec<_> = smooth.column_iter().chain(own.column_iter()).collect();
            Matrix::from_columns(&all)
        }
    }))
}

/// The file that says which entries do not count: the one asked for, else the one beside Φcam.
pub(super) fn mask(args: &RecoverArgs, phi: &Path) -> Option<PathBuf> {
    let beside = phi.with_file_name(LEFT_OUT);
    let beside = beside.exists().then_some(beside);
    args.left_out.clone().or(beside)
}

/// Entries that do not count.
fn left_out(
    args: &RecoverArgs,
    phi: &Path,
    of: &Photographs,
    console: Console,
) -> Result<Option<Matrix>, Failure> {
    let Some(file) = mask(args, phi) else {
        return Ok(None);
    };
    let file = &file;
    let flags = of.read(file)?;
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
