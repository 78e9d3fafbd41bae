//! What photographs hold beside the light of the hidden surface.

use phicam::lab::polynomials;
use phicam::matrix::Matrix;
use phicam::recovery::Nuisance;
use pyo3::prelude::*;

use crate::arrays::maybe;
use crate::errors::input;

/// It, as keywords.
#[derive(FromPyObject)]
pub struct Given<'py> {
    #[pyo3(item)]
    frame_constant: bool,
    #[pyo3(item)]
    frame_polynomial: Option<u8>,
    #[pyo3(item)]
    frame_patterns: Option<Bound<'py, PyAny>>,
    #[pyo3(item)]
    background: bool,
    #[pyo3(item)]
    glare_pattern: Option<Bound<'py, PyAny>>,
    #[pyo3(item)]
    free_scale: bool,
    #[pyo3(item)]
    frame_gain: Option<f64>,
    #[pyo3(item)]
    scale_error: Option<f64>,
    #[pyo3(item)]
    left_out: Option<Bound<'py, PyAny>>,
    #[pyo3(item)]
    pixels: Option<(usize, usize)>,
}

/// The same with its matrices read.
pub struct Beside {
    frame_constant: bool,
    patterns: Option<Matrix>,
    background: bool,
    glare: Option<Matrix>,
    free_scale: bool,
    frame_gain: Option<f64>,
    scale_error: Option<f64>,
    left_out: Option<Matrix>,
}

impl Given<'_> {
    /// Columns and rows of a photograph, where they are known.
    pub fn frame(&self) -> Option<[usize; 2]> {
        self.pixels.map(Into::into)
    }

    /// Reads its matrices.
    pub fn read(&self) -> PyResult<Beside> {
        let own = pattern(self.frame_patterns.as_ref(), "frame_patterns")?;
        Ok(Beside {
            frame_constant: self.frame_constant,
            patterns: joined(self.frame_polynomial, self.frame(), own)?,
            background: self.background,
            glare: pattern(self.glare_pattern.as_ref(), "glare_pattern")?,
            free_scale: self.free_scale,
            frame_gain: self.frame_gain,
            scale_error: self.scale_error,
            left_out: maybe(self.left_out.as_ref(), "left_out")?,
        })
    }
}

impl Beside {
    /// What is to be estimated.
    pub fn nuisance(&self) -> Nuisance<'_> {
        Nuisance {
            frame_constant: self.frame_constant,
            frame_patterns: self.patterns.as_ref(),
            background: self.background,
            glare: self.glare.as_ref(),
            free_scale: self.free_scale,
            frame_gain: self.frame_gain,
            scale_error: self.scale_error,
            left_out: self.left_out.as_ref(),
        }
    }
}

/// A pattern that is not 0 everywhere, which would change nothing.
fn pattern(array: Option<&Bound<'_, PyAny>>, name: &str) -> PyResult<Option<Matrix>> {
    match maybe(array, name)? {
        Some(found) if found.iter().all(|x| *x == 0.0) => {
            let cause = format!("{name} is 0 everywhere");
            Err(input(
                cause,
                "leave it out, or give the pattern that was meant",
            ))
        }
        found => Ok(found),
    }
}

/// The polynomials of a degree over the photograph, and what else is given of patterns.
fn joined(
    degree: Option<u8>,
    pixels: Option<[usize; 2]>,
    own: Option<Matrix>,
) -> PyResult<Option<Matrix>> {
    let smooth = match (degree, pixels) {
        (None, _) => return Ok(own),
        (Some(degree), Some(pixels)) => polynomials(pixels, usize::from(degree)),
        (Some(_), None) => {
            let cause = "nothing says how the pixels lie in the photograph";
            return Err(input(cause, "give pixels=(columns, rows)"));
        }
    };
    let Some(own) = own else {
        return Ok(Some(smooth));
    };
    if own.nrows() != smooth.nrows() {
        let cause = format!(
            "frame_patterns has {} rows, and there are {} pixels",
            own.nrows(),
            smooth.nrows()
        );
        return Err(input(cause, "give pixels × patterns"));
    }
    let all: Vec<_> = smooth.column_iter().chain(own.column_iter()).collect();
    Ok(Some(Matrix::from_columns(&all)))
}
