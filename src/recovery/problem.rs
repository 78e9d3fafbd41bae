//! What is to be inverted.

mod known;
mod lit_elements;
mod scale;
mod variants;

use nalgebra::{DMatrix, DVector};

use super::soft::Soft;
use super::{Nuisance, RecoveryError, Shared};
use crate::num::control::Control;
use crate::num::linalg::{
    Svd, Tolerance, columns_times, product, rows_times, subtract_product, svd_to,
};
pub(super) use lit_elements::LitElements;
use scale::{finite, least, refuse_scale};

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

    /// The sides of the operator, and the element of each of their terms.
    pub(super) fn sides(&self) -> (&'a DMatrix<f64>, &'a DMatrix<f64>, Vec<usize>) {
        match self.terms {
            Some(Terms { c, d, element }) => (c, d, element.to_vec()),
            None => (self.c, self.d, (0..self.elements()).collect()),
        }
    }

    /// The same of other photographs, of the same shape; operators are not shared with it.
    pub fn photographing(self, phi: &'a DMatrix<f64>) -> Self {
        Problem {
            phi,
            shared: None,
            ..self
        }
    }

    /// The same without the entries whose flag, of the same shape as Φ, is not 0, and with all
    /// others; operators are not shared with it.
    pub fn leaving_out<'b>(&self, flags: &'b DMatrix<f64>) -> Problem<'b>
    where
        'a: 'b,
    {
        Problem {
            nuisance: Nuisance {
                left_out: Some(flags),
                ..self.nuisance
            },
            shared: None,
            ..*self
        }
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
    pub fn light(&self, reflectance: &DVector<f64>) -> DMatrix<f64> {
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
                self.residual(&LitElements::new(self.d, reflectance)?)
            }
            _ => self.counted(self.phi - self.light(reflectance)).norm(),
        })
    }

    /// ‖Φ − C diag(ρ) D‖, Frobenius, W.
    pub(super) fn residual(&self, lit: &LitElements) -> f64 {
        let mut left = self.phi.clone();
        match &lit.along {
            Some(along) => subtract_product(&mut left, &product(self.c, &lit.elements), along),
            None => subtract_product(&mut left, self.c, &lit.elements),
        }
        left.norm()
    }
}

#[cfg(test)]
mod tests;
