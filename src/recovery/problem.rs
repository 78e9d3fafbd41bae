//! What is to be inverted.

use nalgebra::{DMatrix, DVector};

use super::soft::Soft;
use super::{Nuisance, RecoveryError, Shared};
use crate::num::control::Control;
use crate::num::linalg::{
    Range, Svd, Tolerance, columns_times, product, range, rows_times, subtract_product, svd_to,
};

/// The light of element j as a sum of products: A_j = Σ_s c\[p,s\] d\[s,l\] over its terms s, where
/// C\[p,j\] D\[j,l\] alone is only near it.
#[derive(Debug, Clone, Copy)]
pub struct Terms<'a> {
    /// Pixels × terms.
    pub c: &'a DMatrix<f64>,
    /// Terms × spots; with `c` W.
    pub d: &'a DMatrix<f64>,
    /// The element of each term.
    pub element: &'a [usize],
}

/// Φ\[p,l\] = Σ_j C\[p,j\] ρ_j D\[j,l\] + noise, checked: shapes that fit, finite entries.
#[derive(Debug, Clone, Copy)]
pub struct Problem<'a> {
    pub(super) phi: &'a DMatrix<f64>,
    pub(super) c: &'a DMatrix<f64>,
    pub(super) d: &'a DMatrix<f64>,
    pub(super) stderr: Option<&'a DMatrix<f64>>,
    pub(super) grids: Option<&'a [[usize; 2]]>,
    pub(super) places: Option<&'a [[f64; 3]]>,
    pub(super) nuisance: Nuisance<'a>,
    terms: Option<Terms<'a>>,
    /// Factors about estimates of them, where the problem is linear in both.
    pub(super) soft: Option<&'a Soft>,
    pub(super) shared: Option<&'a Shared>,
    pub(super) control: Control<'a>,
}

impl<'a> Problem<'a> {
    /// The photographs `phi` (pixels × spots, W), the camera side `c` (pixels × elements), the
    /// laser side `d` (elements × spots; C times D in W), and the standard errors of the entries of
    /// Φ (same shape, W) where they are known. The errors of different entries are taken as
    /// independent.
    ///
    /// # Errors
    /// [`RecoveryError::Shape`], [`RecoveryError::NotFinite`], [`RecoveryError::OutOfScale`],
    /// [`RecoveryError::NegativeStandardError`].
    pub fn new(
        phi: &'a DMatrix<f64>,
        c: &'a DMatrix<f64>,
        d: &'a DMatrix<f64>,
        stderr: Option<&'a DMatrix<f64>>,
    ) -> Result<Self, RecoveryError> {
        let (pixels, spots) = phi.shape();
        let elements = c.ncols();
        let expect = |name, matrix: &DMatrix<f64>, rows, columns| {
            if matrix.shape() == (rows, columns) && !matrix.is_empty() {
                Ok(())
            } else {
                Err(RecoveryError::Shape {
                    name,
                    rows,
                    columns,
                    found_rows: matrix.nrows(),
                    found_columns: matrix.ncols(),
                })
            }
        };
        expect("phi", phi, pixels.max(1), spots.max(1))?;
        expect("c (pixels × elements)", c, pixels, elements.max(1))?;
        expect("d (elements × spots)", d, elements, spots)?;
        for (name, matrix) in [("phi", phi), ("c", c), ("d", d)]
            .into_iter()
            .chain(stderr.map(|s| ("stderr", s)))
        {
            finite(name, matrix)?;
        }
        if let Some(stderr) = stderr {
            expect("stderr", stderr, pixels, spots)?;
            // Each entry is divided by its own, so that the least counts as well as the largest.
            let positive = stderr.iter().copied().filter(|x| *x > 0.0);
            refuse_scale("stderr", positive.fold(0.0, least))?;
            if let Some(at) = stderr.iter().position(|&x| x < 0.0) {
                return Err(RecoveryError::NegativeStandardError {
                    pixel: at % pixels,
                    spot: at / pixels,
                    value: stderr[at],
                });
            }
        }
        Ok(Problem {
            phi,
            c,
            d,
            stderr,
            grids: None,
            places: None,
            nuisance: Nuisance::default(),
            terms: None,
            soft: None,
            shared: None,
            control: Control::none(),
        })
    }

    /// The same, recovered until it is told to stop. Each method is 100 units of the work.
    pub fn under(self, control: Control<'a>) -> Self {
        Problem { control, ..self }
    }

    /// The same, its operators shared among all copies of it: to be asked for last, for a problem
    /// with other terms, nuisance or grids made from it shares none.
    pub fn sharing(self, shared: &'a Shared) -> Self {
        Problem {
            shared: Some(shared),
            ..self
        }
    }

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

    /// The sides of the operator, and the element of each of their terms.
    pub(super) fn sides(&self) -> (&'a DMatrix<f64>, &'a DMatrix<f64>, Vec<usize>) {
        match self.terms {
            Some(Terms { c, d, element }) => (c, d, element.to_vec()),
            None => (self.c, self.d, (0..self.elements()).collect()),
        }
    }

    /// The same without factors that are known only roughly.
    pub(super) fn without_gains(&self) -> Self {
        let nuisance = Nuisance {
            frame_gain: None,
            scale_error: None,
            ..self.nuisance
        };
        Problem {
            nuisance,
            shared: None,
            ..*self
        }
    }

    /// The same with a free scale of all light.
    pub(super) fn with_free_scale(&self) -> Self {
        let nuisance = Nuisance {
            free_scale: true,
            ..self.nuisance
        };
        Problem {
            nuisance,
            shared: None,
            ..*self
        }
    }

    /// The same with other photographs and another right side of the operator, and with factors
    /// about estimates of them.
    pub(super) fn about<'b>(
        &self,
        phi: &'b DMatrix<f64>,
        d: &'b DMatrix<f64>,
        soft: &'b Soft,
    ) -> Problem<'b>
    where
        'a: 'b,
    {
        let own: Problem<'b> = *self;
        Problem {
            phi,
            d: if own.terms.is_some() { own.d } else { d },
            terms: own.terms.map(|terms| Terms { d, ..terms }),
            soft: Some(soft),
            shared: None,
            ..own
        }
    }

    /// The same along other directions of its photographs: `phi` and the camera side of its terms
    /// turned by one orthogonal matrix, with the errors and the light beside it along them.
    pub(super) fn along<'b>(
        &self,
        phi: &'b DMatrix<f64>,
        c: &'b DMatrix<f64>,
        stderr: &'b DMatrix<f64>,
        nuisance: Nuisance<'b>,
    ) -> Problem<'b>
    where
        'a: 'b,
    {
        let own: Problem<'b> = *self;
        Problem {
            phi,
            c: if own.terms.is_some() { own.c } else { c },
            terms: own.terms.map(|terms| Terms { c, ..terms }),
            stderr: Some(stderr),
            nuisance,
            shared: None,
            ..own
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
    /// [`RecoveryError::Shape`], [`RecoveryError::NotFinite`] or [`RecoveryError::OutOfScale`] of a
    /// glare pattern; [`RecoveryError::RelativeDeviation`] and [`RecoveryError::ScaleTwice`] of
    /// factors that are known only roughly.
    pub fn with_nuisance(self, nuisance: Nuisance<'a>) -> Result<Self, RecoveryError> {
        let (pixels, spots) = self.phi.shape();
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
        let patterns = nuisance.frame_patterns.map_or(0, DMatrix::ncols);
        fits("the glare pattern (pixels × spots)", nuisance.glare, spots)?;
        fits(
            "the patterns of a frame (pixels × patterns)",
            nuisance.frame_patterns,
            patterns,
        )?;
        fits(
            "what is left out (pixels × spots)",
            nuisance.left_out,
            spots,
        )?;
        if nuisance
            .left_out
            .is_some_and(|flags| flags.iter().all(|x| *x != 0.0))
        {
            return Err(RecoveryError::NothingCounts);
        }
        let roughly = [
            ("the gain of a frame", nuisance.frame_gain),
            ("the scale", nuisance.scale_error),
        ];
        for (name, known_to) in roughly {
            if let Some(value) = known_to.filter(|x| !(*x > 0.0 && *x <= 1.0)) {
                return Err(RecoveryError::RelativeDeviation { name, value });
            }
        }
        if nuisance.free_scale && nuisance.scale_error.is_some() {
            return Err(RecoveryError::ScaleTwice);
        }
        Ok(Problem {
            nuisance,
            shared: None,
            ..self
        })
    }

    /// Φ, pixels × spots, W.
    pub fn photographed(&self) -> &'a DMatrix<f64> {
        self.phi
    }

    /// Elements, r.
    pub fn elements(&self) -> usize {
        self.c.ncols()
    }

    /// The best single factor ⟨Φ, C D⟩/‖C D‖² of what a surface of reflectance 1 throughout
    /// photographs. Where C and D are not negative, as light is, no surface makes it more than 1.
    pub fn brightness(&self) -> f64 {
        let (c, d, _) = self.sides();
        let white = self.counted(c * d);
        self.phi.dot(&white) / white.norm_squared()
    }

    /// Refuses photographs that are black throughout.
    pub(super) fn refuse_darkness(&self) -> Result<(), RecoveryError> {
        let entries =
            (0..self.phi.ncols()).flat_map(|l| (0..self.phi.nrows()).map(move |p| (p, l)));
        let mut counted = entries.filter(|(p, l)| self.nuisance.counts(*p, *l));
        if counted.any(|at| self.phi[at] != 0.0) {
            Ok(())
        } else {
            Err(RecoveryError::Dark)
        }
    }

    /// The standard errors, where they are given and not all zero.
    pub(super) fn noise(&self) -> Option<&'a DMatrix<f64>> {
        self.stderr.filter(|s| s.iter().any(|&x| x > 0.0))
    }

    /// Number of entries that count.
    pub(super) fn entries(&self) -> usize {
        let left_out = self.nuisance.left_out;
        let none = left_out.map_or(0, |flags| flags.iter().filter(|x| **x != 0.0).count());
        self.phi.len() - none
    }

    /// Entries, pixels × spots, with 0 where one does not count.
    pub fn counted(&self, mut entries: DMatrix<f64>) -> DMatrix<f64> {
        if let Some(flags) = self.nuisance.left_out {
            entries.zip_apply(flags, |x, flag| {
                if flag != 0.0 {
                    *x = 0.0;
                }
            });
        }
        entries
    }

    /// The laser side decomposed as far as a cut at `tolerance` needs it.
    pub(super) fn laser(&self, tolerance: Tolerance) -> Result<Svd, RecoveryError> {
        let decomposed = svd_to(self.d, tolerance)?;
        if decomposed.sigma[0] == 0.0 {
            return Err(RecoveryError::RankZero {
                side: "laser side D",
            });
        }
        Ok(decomposed)
    }

    /// Σ_j ρ_j A_j, W.
    pub(super) fn light(&self, reflectance: &DVector<f64>) -> DMatrix<f64> {
        let (c, d, element) = self.sides();
        let of_terms: Vec<f64> = element.iter().map(|j| reflectance[*j]).collect();
        // The lesser side is copied.
        if c.len() < d.len() {
            columns_times(c.clone(), &of_terms) * d
        } else {
            c * rows_times(d.clone(), &of_terms)
        }
    }

    /// ‖Φ − Σ_j ρ_j A_j‖, Frobenius, W.
    pub(super) fn misfit(&self, reflectance: &DVector<f64>) -> Result<f64, RecoveryError> {
        Ok(match self.terms {
            None if self.nuisance.left_out.is_none() => {
                self.residual(&Lit::new(self.d, reflectance)?)
            }
            _ => self.counted(self.phi - self.light(reflectance)).norm(),
        })
    }

    /// ‖Φ − C diag(ρ) D‖, Frobenius, W.
    pub(super) fn residual(&self, lit: &Lit) -> f64 {
        let mut left = self.phi.clone();
        match &lit.along {
            Some(along) => subtract_product(&mut left, &product(self.c, &lit.elements), along),
            None => subtract_product(&mut left, self.c, &lit.elements),
        }
        left.norm()
    }
}

/// diag(ρ) D, where D is large and of few directions as the product of two thin factors, which is D
/// to rounding.
pub(super) struct Lit {
    /// diag(ρ) D or diag(ρ) Q, r rows.
    elements: DMatrix<f64>,
    /// B of D = Q B.
    along: Option<DMatrix<f64>>,
}

impl Lit {
    pub(super) fn new(d: &DMatrix<f64>, reflectance: &DVector<f64>) -> Result<Self, RecoveryError> {
        let (elements, along) = match range(d)? {
            Some(Range { q, b, .. }) => (q, Some(b)),
            None => (d.clone(), None),
        };
        Ok(Lit {
            elements: rows_times(elements, reflectance),
            along,
        })
    }
}

/// Sizes whose squares, and products of squares of two matrices, stay well within f64.
const SCALE: std::ops::RangeInclusive<f64> = 1e-60..=1e60;

/// Refuses entries that are not finite, or whose squares are not.
fn finite(name: &'static str, matrix: &DMatrix<f64>) -> Result<(), RecoveryError> {
    match matrix.iter().position(|x| !x.is_finite()) {
        Some(at) => Err(RecoveryError::NotFinite {
            name,
            row: at % matrix.nrows(),
            column: at / matrix.nrows(),
            value: matrix[at],
        }),
        None => refuse_scale(name, matrix.amax()),
    }
}

/// Refuses a matrix by the size of an entry that decides its scale; zero has none.
fn refuse_scale(name: &'static str, value: f64) -> Result<(), RecoveryError> {
    if value == 0.0 || SCALE.contains(&value) {
        Ok(())
    } else {
        Err(RecoveryError::OutOfScale { name, value })
    }
}

/// The lesser of two numbers, where 0 stands for none yet.
fn least(least: f64, x: f64) -> f64 {
    if least > 0.0 { least.min(x) } else { x }
}

#[cfg(test)]
mod tests;
