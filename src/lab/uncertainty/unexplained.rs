//! Photographs whose reflectances are unknown, without other light and in units of their noise.

use nalgebra::DVector;

use super::certainty::Certainty;
use crate::matrix::Matrix;
use crate::num::linalg::{LinalgError, product, svd, tr_product};
use crate::recovery::RecoveryError;
use crate::scene::Scene;

/// Directions of the patterns that are weaker than this part of the strongest are none.
const DEPENDENT: f64 = 1e-12;

/// Elements above which fewer are taken unless they are asked for, and those.
const MANY: usize = 256;
const FEWER: [usize; 2] = [12, 12];

/// The elements in place of the scene's where it has many, and how many it has.
pub fn fewer(scene: &Scene) -> Option<([usize; 2], usize)> {
    let each = scene.hidden().map(|(_, s)| s.elements[0] * s.elements[1]);
    let own = each.sum();
    (own > MANY).then_some((FEWER, own))
}

/// Photographs whose reflectances are unknown.
#[derive(Clone, Copy, Debug)]
pub struct Unexplained<'a> {
    /// Φcam, pixels × spots, W.
    pub phi: &'a Matrix,
    /// Its standard errors up to a common factor, the same shape; all alike where they are unknown.
    pub stderr: Option<&'a Matrix>,
    /// What is known of these errors. They are taken for independent, and where they are not that
    /// is said.
    pub certainty: Certainty,
    /// Entries that do not count, the same shape: those that are not 0.
    pub left_out: Option<&'a Matrix>,
    /// Patterns of other light, pixels × patterns, each with a strength of its own in each frame.
    pub patterns: Option<&'a Matrix>,
}

/// The same with matrices of its own.
#[derive(Clone, Debug)]
pub struct Photographs {
    /// As [`Unexplained::phi`].
    pub phi: Matrix,
    /// As [`Unexplained::stderr`].
    pub stderr: Option<Matrix>,
    /// As [`Unexplained::certainty`].
    pub certainty: Certainty,
    /// As [`Unexplained::left_out`].
    pub left_out: Option<Matrix>,
    /// As [`Unexplained::patterns`].
    pub patterns: Option<Matrix>,
}

impl Photographs {
    /// Themselves.
    pub fn unexplained(&self) -> Unexplained<'_> {
        Unexplained {
            phi: &self.phi,
            stderr: self.stderr.as_ref(),
            certainty: self.certainty,
            left_out: self.left_out.as_ref(),
            patterns: self.patterns.as_ref(),
        }
    }
}

impl Unexplained<'_> {
    /// √w of each pixel of frame l: 1/σ, 0 where the entry does not count or nothing is known of
    /// its error.
    pub(in crate::lab) fn roots(&self, l: usize) -> DVector<f64> {
        let root = |p: usize| match self.stderr.map(|s| s[(p, l)]) {
            _ if self.left_out.is_some_and(|flags| flags[(p, l)] != 0.0) => 0.0,
            None => 1.0,
            Some(sigma) if sigma > 0.0 => 1.0 / sigma,
            Some(_) => 0.0,
        };
        DVector::from_fn(self.phi.nrows(), |p, _| root(p))
    }

    /// The same where this is the frame's light, W: of counts by its errors, not by those of the
    /// noisy entries.
    pub(in crate::lab) fn roots_of(&self, l: usize, light: &DVector<f64>) -> DVector<f64> {
        let roots = self.roots(l);
        let Some(stderr) = self.stderr else {
            return roots;
        };
        DVector::from_fn(roots.len(), |p, _| {
            let own = self.certainty.stderr(light[p], stderr[(p, l)]);
            if roots[p] > 0.0 { 1.0 / own } else { 0.0 }
        })
    }

    /// Refuses photographs of which nothing counts, or nothing but darkness.
    ///
    /// # Errors
    /// [`RecoveryError`].
    pub(in crate::lab) fn check(&self) -> Result<(), RecoveryError> {
        let (mut any, mut lit) = (false, false);
        for (l, column) in self.phi.column_iter().enumerate() {
            for (x, root) in column.iter().zip(&self.roots(l)) {
                any |= *root > 0.0;
                lit |= *root > 0.0 && *x != 0.0;
            }
        }
        match (any, lit) {
            (false, _) => Err(RecoveryError::NothingCounts),
            (_, false) => Err(RecoveryError::Dark),
            _ => Ok(()),
        }
    }

    /// Entries that count.
    pub(in crate::lab) fn counted(&self) -> usize {
        let of_frame = |l: usize| self.roots(l).iter().filter(|q| **q > 0.0).count();
        (0..self.phi.ncols()).map(of_frame).sum()
    }

    /// The frame's weights and other light.
    pub(in crate::lab) fn whitening(&self, l: usize) -> Result<Whitening, LinalgError> {
        Whitening::new(self.roots(l), self.patterns)
    }
}

/// Takes columns of one frame's pixels to √w times them, less what the patterns of other light
/// could be of that.
#[derive(Clone, Debug)]
pub(in crate::lab) struct Whitening {
    roots: DVector<f64>,
    /// Orthonormal, pixels × directions.
    directions: Matrix,
}

impl Whitening {
    /// By √w of each pixel, 0 where its entry does not count, and patterns of other light.
    pub(in crate::lab) fn new(
        roots: DVector<f64>,
        patterns: Option<&Matrix>,
    ) -> Result<Self, LinalgError> {
        let directions = match patterns.filter(|f| f.ncols() > 0) {
            Some(patterns) => directions(patterns, &roots)?,
            None => Matrix::zeros(roots.len(), 0),
        };
        Ok(Self { roots, directions })
    }

    /// Of each column.
    pub(in crate::lab) fn apply(&self, columns: &Matrix) -> Matrix {
        self.beside(Matrix::from_fn(columns.nrows(), columns.ncols(), |p, s| {
            self.roots[p] * columns[(p, s)]
        }))
    }

    /// What the patterns leave of columns that are weighted.
    pub(in crate::lab) fn beside(&self, weighted: Matrix) -> Matrix {
        let once = |m: Matrix| {
            let patterns = tr_product(&self.directions, &m);
            m - product(&self.directions, &patterns)
        };
        if self.directions.ncols() == 0 {
            weighted
        } else {
            once(once(weighted))
        }
    }

    /// Orthonormal directions of the patterns, weighted, pixels × directions.
    pub(in crate::lab) fn directions(&self) -> &Matrix {
        &self.directions
    }

    /// How much of each row the patterns take: the diagonal of their projector.
    pub(in crate::lab) fn leverage(&self) -> DVector<f64> {
        let rows = self.directions.row_iter();
        DVector::from_iterator(self.roots.len(), rows.map(|row| row.norm_squared()))
    }

    /// Entries that count, less the directions of the patterns.
    pub(in crate::lab) fn count(&self) -> f64 {
        let counted = self.roots.iter().filter(|q| **q > 0.0).count();
        counted as f64 - self.directions.ncols() as f64
    }
}

/// Orthonormal directions of the weighted patterns, pixels × directions.
fn directions(patterns: &Matrix, roots: &DVector<f64>) -> Result<Matrix, LinalgError> {
    let lengths: Vec<f64> = patterns.column_iter().map(|f| f.amax()).collect();
    let weighted = Matrix::from_fn(patterns.nrows(), patterns.ncols(), |p, k| {
        roots[p] * patterns[(p, k)] / if lengths[k] > 0.0 { lengths[k] } else { 1.0 }
    });
    if weighted.amax() == 0.0 {
        return Ok(Matrix::zeros(roots.len(), 0));
    }
    let found = svd(&weighted)?;
    let least = DEPENDENT * found.sigma[0];
    let kept = found.sigma.iter().take_while(|s| **s > least).count();
    Ok(found.u.columns(0, kept).into_owned())
}
