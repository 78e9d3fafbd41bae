//! What else may be known of a problem, checked.

use nalgebra::DMatrix;

use super::scale::finite;
use super::{Problem, Terms};
use crate::recovery::{Nuisance, RecoveryError};

impl<'a> Problem<'a> {
    /// The same with the terms of each element: the joint methods take them in place of C and D.
    ///
    /// # Errors
    /// [`RecoveryError::Shape`], [`RecoveryError::NotFinite`] or [`RecoveryError::OutOfScale`].
    pub fn with_terms(self, terms: Terms<'a>) -> Result<Self, RecoveryError> {
        let Terms { c, d, element } = terms;
        let shape = |name, matrix: &DMatrix<f64>, rows, columns| {
            let (found_rows, found_columns) = matrix.shape();
            let fits = (found_rows, found_columns) == (rows, columns);
            let wrong = RecoveryError::Shape {
                name,
                rows,
                columns,
                found_rows,
                found_columns,
            };
            if fits {
                finite(name, matrix)
            } else {
                Err(wrong)
            }
        };
        let (pixels, spots) = self.phi.shape();
        shape("the terms of c", c, pixels, element.len())?;
        shape("the terms of d", d, element.len(), spots)?;
        let elements = self.elements();
        match element.iter().find(|j| **j >= elements) {
            Some(j) => Err(RecoveryError::Grids {
                covered: *j + 1,
                elements,
            }),
            None => Ok(Problem {
                terms: Some(terms),
                shared: None,
                ..self
            }),
        }
    }

    /// The same with the element grids known, \[nu, nv\] of each hidden surface in the order of the
    /// elements; element iu + iv·nu within each. Methods that compare neighbouring elements need
    /// them.
    ///
    /// # Errors
    /// [`RecoveryError::Grids`] where the grids do not make up the elements.
    pub fn with_grids(self, grids: &'a [[usize; 2]]) -> Result<Self, RecoveryError> {
        let covered = grids.iter().fold(0usize, |sum, [nu, nv]| {
            sum.saturating_add(nu.saturating_mul(*nv))
        });
        let elements = self.elements();
        if covered != elements || grids.iter().any(|[nu, nv]| nu * nv == 0) {
            return Err(RecoveryError::Grids { covered, elements });
        }
        Ok(Problem {
            grids: Some(grids),
            ..self
        })
    }

    /// The same with the centre of each element known, in any unit of length: `joint-gp` compares
    /// elements by their distance. Without them it takes the elements of a grid as squares.
    ///
    /// # Errors
    /// [`RecoveryError::Shape`] where there are not as many as elements,
    /// [`RecoveryError::NotFinite`].
    pub fn with_places(self, places: &'a [[f64; 3]]) -> Result<Self, RecoveryError> {
        if places.len() != self.elements() {
            return Err(RecoveryError::Shape {
                name: "the places of the elements",
                rows: self.elements(),
                columns: 3,
                found_rows: places.len(),
                found_columns: 3,
            });
        }
        let places_only = DMatrix::from_fn(places.len(), 3, |j, k| places[j][k]);
        finite("the places of the elements", &places_only)?;
        Ok(Problem {
            places: Some(places),
            ..self
        })
    }

    /// The same with terms of unknown size to be estimated together with the reflectances; the
    /// joint methods can.
    ///
    /// # Errors
    /// Those of [`Nuisance::check`], and [`RecoveryError::NothingCounts`].
    pub fn with_nuisance(self, nuisance: Nuisance<'a>) -> Result<Self, RecoveryError> {
        nuisance.check(self.phi.shape())?;
        if nuisance
            .left_out
            .is_some_and(|flags| flags.iter().all(|x| *x != 0.0))
        {
            return Err(RecoveryError::NothingCounts);
        }
        Ok(Problem {
            nuisance,
            shared: None,
            ..self
        })
    }
}

impl Nuisance<'_> {
    /// Whether it belongs to photographs of pixels × spots and its numbers have a meaning.
    ///
    /// # Errors
    /// [`RecoveryError::Shape`], [`RecoveryError::NotFinite`] or [`RecoveryError::OutOfScale`] of a
    /// pattern; [`RecoveryError::RelativeDeviation`] and [`RecoveryError::ScaleTwice`] of factors
    /// that are known only roughly.
    pub fn check(&self, (pixels, spots): (usize, usize)) -> Result<(), RecoveryError> {
        let fits = |name, matrix: Option<&DMatrix<f64>>, columns| match matrix {
            Some(matrix) if matrix.shape() == (pixels, columns) => finite(name, matrix),
            Some(matrix) => Err(RecoveryError::Shape {
                name,
                rows: pixels,
                columns,
                found_rows: matrix.nrows(),
                found_columns: matrix.ncols(),
            }),
            None => Ok(()),
        };
        let patterns = self.frame_patterns.map_or(0, DMatrix::ncols);
        fits("the glare pattern (pixels × spots)", self.glare, spots)?;
        let name = "the patterns of a frame (pixels × patterns)";
        fits(name, self.frame_patterns, patterns)?;
        fits("what is left out (pixels × spots)", self.left_out, spots)?;
        let roughly = [
            ("the gain of a frame", self.frame_gain),
            ("the scale", self.scale_error),
        ];
        for (name, known_to) in roughly {
            if let Some(value) = known_to.filter(|x| !(*x > 0.0 && *x <= 1.0)) {
                return Err(RecoveryError::RelativeDeviation { name, value });
            }
        }
        if self.free_scale && self.scale_error.is_some() {
            return Err(RecoveryError::ScaleTwice);
        }
        Ok(())
    }
}
