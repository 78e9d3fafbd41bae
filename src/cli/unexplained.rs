//! Photographs of a run or an import, for what takes their reflectances for unknown.

use std::path::Path;

use super::failure::Failure;
use super::load_run::{read_left_out, read_matrix, read_stderr};
use super::record::Record;
use super::run_folder::{PHI, STDERR};
use crate::lab::{Unexplained, polynomials};
use crate::matrix::Matrix;
use crate::scene::Scene;

/// The matrices of [`Unexplained`].
pub(super) struct Photographs {
    phi: Matrix,
    stderr: Option<Matrix>,
    left_out: Option<Matrix>,
    patterns: Option<Matrix>,
}

impl Photographs {
    /// Those of the folder `dir`; other light in each frame is a polynomial of degree `polynomial`.
    pub(super) fn read(
        dir: &Path,
        (scene, record): (&Scene, &Record),
        left_out: Option<&Path>,
        polynomial: Option<u8>,
    ) -> Result<Self, Failure> {
        let phi = read_matrix(&dir.join(PHI), scene)?;
        let file = dir.join(STDERR);
        // Of imported photographs the noise may be unknown.
        let is_unknown = record.is_imported() && !file.exists();
        let stderr = if is_unknown {
            None
        } else {
            Some(read_stderr(&file, scene)?)
        };
        let left_out = match left_out {
            Some(file) => Some(read_matrix(file, scene)?),
            None => read_left_out(dir, scene)?,
        };
        let size = [scene.camera.columns, scene.camera.rows];
        let patterns = polynomial.map(|degree| polynomials(size, usize::from(degree)));
        Ok(Self {
            phi,
            stderr,
            left_out,
            patterns,
        })
    }

    pub(super) fn unexplained(&self) -> Unexplained<'_> {
        Unexplained {
            phi: &self.phi,
            stderr: self.stderr.as_ref(),
            left_out: self.left_out.as_ref(),
            patterns: self.patterns.as_ref(),
        }
    }
}
