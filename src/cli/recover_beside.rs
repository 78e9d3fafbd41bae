//! What the photographs of a recovery hold beside the light of the hidden surface, and what of them
//! does not count.

use std::path::Path;

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
        of: &Photographs,
        console: Console,
    ) -> Result<Self, Failure> {
        let glare = args.joint.glare_pattern.as_ref();
        Ok(Self {
            glare: glare.map(|file| of.read(file)).transpose()?,
            patterns: patterns(args, of)?,
            left_out: left_out(args, of, console)?,
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
    if pixels != of.pixels || count > MOST_PATTERNS {
        let cause = format!(
            "{} is {pixels} × {count}, but {} has {} pixels",
            file.display(),
            of.name,
            of.pixels
        );
        let cure = format!("give pixels × patterns, at most {MOST_PATTERNS} of them");
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

/// Entries that do not count: those asked for, else those of the run whose Φcam it is.
fn left_out(
    args: &RecoverArgs,
    of: &Photographs,
    console: Console,
) -> Result<Option<Matrix>, Failure> {
    let of_run = args.dir.as_ref().map(|dir| dir.join(LEFT_OUT));
    let of_run = of_run.filter(|file| args.phi.is_none() && file.exists());
    let Some(file) = args.left_out.as_ref().or(of_run.as_ref()) else {
        return Ok(None);
    };
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
