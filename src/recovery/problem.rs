//! What is to be inverted, and how.

use nalgebra::{DMatrix, DVector};

use super::{Nuisance, RecoveryError, Rule};
use crate::num::linalg::Tolerance;

/// Φ\[p,l\] = Σ_j C\[p,j\] ρ_j D\[j,l\] + noise, checked: shapes that fit, finite entries.
#[derive(Debug, Clone, Copy)]
pub struct Problem<'a> {
    pub(super) phi: &'a DMatrix<f64>,
    pub(super) c: &'a DMatrix<f64>,
    pub(super) d: &'a DMatrix<f64>,
    pub(super) stderr: Option<&'a DMatrix<f64>>,
    pub(super) grids: Option<&'a [[usize; 2]]>,
    pub(super) nuisance: Nuisance<'a>,
}

impl<'a> Problem<'a> {
    /// The photographs `phi` (pixels × spots, W), the camera side `c` (pixels × elements), the laser side `d` (elements × spots; C times D in W),
    /// and the standard errors of the entries of Φ (same shape, W) where they are known. The errors of different entries are taken as independent.
    ///
    /// # Errors
    /// [`RecoveryError::Shape`], [`RecoveryError::NotFinite`], [`RecoveryError::NegativeStandardError`].
    pub fn new(
        phi: &'a DMatrix<f64>,
        c: &'a DMatrix<f64>,
        d: &'a DMatrix<f64>,
        stderr: Option<&'a DMatrix<f64>>,
    ) -> Result<Self, RecoveryError> {
        let (pixels, spots) = phi.shape();
        let elements = c.ncols();
        let expect = |name, matrix: &DMatrix<f64>, rows, columns| match matrix.shape()
            == (rows, columns)
            && !matrix.is_empty()
        {
            true => Ok(()),
            false => Err(RecoveryError::Shape {
                name,
                rows,
                columns,
                found_rows: matrix.nrows(),
                found_columns: matrix.ncols(),
            }),
        };
        expect("phi", phi, pixels.max(1), spots.max(1))?;
        expect("c (pixels × elements)", c, pixels, elements.max(1))?;
        expect("d (elements × spots)", d, elements, spots)?;
        for (name, matrix) in [("phi", phi), ("c", c), ("d", d)]
            .into_iter()
            .chain(stderr.map(|s| ("stderr", s)))
        {
            if let Some(at) = matrix.iter().position(|x| !x.is_finite()) {
                let (row, column) = (at % matrix.nrows(), at / matrix.nrows());
                return Err(RecoveryError::NotFinite {
                    name,
                    row,
                    column,
                    value: matrix[at],
                });
            }
        }
        if let Some(stderr) = stderr {
            expect("stderr", stderr, pixels, spots)?;
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
            nuisance: Nuisance::default(),
        })
    }

    /// The same with the element grids known, \[nu, nv\] of each hidden surface in the order of the elements; element iu + iv·nu within each.
    /// Methods that compare neighbouring elements need them.
    ///
    /// # Errors
    /// [`RecoveryError::Grids`] where the grids do not make up the elements.
    pub fn with_grids(self, grids: &'a [[usize; 2]]) -> Result<Self, RecoveryError> {
        let covered = grids.iter().fold(0usize, |sum, [nu, nv]| {
            sum.saturating_add(nu.saturating_mul(*nv))
        });
        let elements = self.c.ncols();
        if covered != elements || grids.iter().any(|[nu, nv]| nu * nv == 0) {
            return Err(RecoveryError::Grids { covered, elements });
        }
        Ok(Problem {
            grids: Some(grids),
            ..self
        })
    }

    /// The same with terms of unknown size to be estimated together with the reflectances; the joint methods can.
    ///
    /// # Errors
    /// [`RecoveryError::Shape`] or [`RecoveryError::NotFinite`] of a glare pattern.
    pub fn with_nuisance(self, nuisance: Nuisance<'a>) -> Result<Self, RecoveryError> {
        if let Some(pattern) = nuisance.glare {
            let (rows, columns) = self.phi.shape();
            let (found_rows, found_columns) = pattern.shape();
            if (found_rows, found_columns) != (rows, columns) {
                return Err(RecoveryError::Shape {
                    name: "the glare pattern (pixels × spots)",
                    rows,
                    columns,
                    found_rows,
                    found_columns,
                });
            }
            if let Some(at) = pattern.iter().position(|x| !x.is_finite()) {
                return Err(RecoveryError::NotFinite {
                    name: "the glare pattern",
                    row: at % rows,
                    column: at / rows,
                    value: pattern[at],
                });
            }
        }
        Ok(Problem { nuisance, ..self })
    }

    /// Refuses photographs that are black throughout.
    pub(super) fn refuse_darkness(&self) -> Result<(), RecoveryError> {
        match self.phi.iter().any(|&x| x != 0.0) {
            true => Ok(()),
            false => Err(RecoveryError::Dark),
        }
    }

    /// The standard errors, where they are given and not all zero.
    pub(super) fn noise(&self) -> Option<&'a DMatrix<f64>> {
        self.stderr.filter(|s| s.iter().any(|&x| x > 0.0))
    }

    /// C diag(ρ) D, W.
    pub(super) fn light(&self, reflectance: &DVector<f64>) -> DMatrix<f64> {
        let mut left = self.c.clone();
        for (mut column, &rho) in left.column_iter_mut().zip(reflectance.iter()) {
            column *= rho;
        }
        left * self.d
    }

    /// ‖Φ − C diag(ρ) D‖, Frobenius, W.
    pub(super) fn residual(&self, reflectance: &DVector<f64>) -> f64 {
        (self.phi - self.light(reflectance)).norm()
    }
}

/// By what the joint methods weigh the entries of Φ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WeightRule {
    /// By the noise: separable weights fitted to 1/σ², where standard errors are given.
    #[default]
    Noise,
    /// All alike.
    Unweighted,
}

/// How much the methods that work pixel by pixel tell of their uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Uncertainty {
    /// All: standard errors, their covariance matrix and the resolution matrix, r × r each; about p·r² + l·(p·k² + k·r²) operations for p pixels,
    /// l spots, r elements and k the few numerical ranks of 1/C.
    #[default]
    Full,
    /// Standard errors alone: p·l·r operations and no matrix of elements × elements.
    StandardError,
}

/// Choices of the methods; the default leaves each to its own rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Where `pinv`, the divisions and `joint-unbounded` cut the rank.
    pub tolerance: Tolerance,
    /// How many singular directions `tsvd` keeps; by `rule` where not given.
    pub rank: Option<usize>,
    /// The damping λ of `tikhonov` as a fraction of D's largest singular value (of `tikhonov-gradient`: of the largest in standard form); by `rule` where
    /// not given.
    pub damping: Option<f64>,
    /// How `tsvd`, `tikhonov` and `tikhonov-gradient` choose what is not given.
    pub rule: Rule,
    /// How much the methods that work pixel by pixel tell of their uncertainty.
    pub uncertainty: Uncertainty,
    /// Largest number of entries of the compressed Khatri–Rao product that `joint` forms (8 bytes each, up to three copies);
    /// above it the Gram matrix is used, whose condition is squared.
    pub budget: usize,
    /// Weights of the joint methods.
    pub weighting: WeightRule,
    /// The strength λ of `joint-tv` as a fraction of σ₁², σ₁ the largest singular value of the weighted operator; by the discrepancy principle where not given.
    pub total_variation: Option<f64>,
    /// The reflectances \[dark, light\] of `joint-two-valued`; estimated with the pattern where not given.
    pub levels: Option<[f64; 2]>,
    /// Confidence level, in (0, 1), of the bands to be computed ([`Bands`](super::Bands)); none where not given.
    pub bands: Option<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            tolerance: Tolerance::Auto,
            rank: None,
            damping: None,
            rule: Rule::Discrepancy,
            uncertainty: Uncertainty::Full,
            budget: 1 << 24,
            weighting: WeightRule::Noise,
            total_variation: None,
            levels: None,
            bands: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrices() -> [DMatrix<f64>; 4] {
        [(2, 3), (2, 4), (4, 3), (2, 3)]
            .map(|(rows, columns)| DMatrix::from_element(rows, columns, 1.0))
    }

    #[test]
    fn good_matrices_pass() {
        let [phi, c, d, stderr] = matrices();
        assert!(Problem::new(&phi, &c, &d, Some(&stderr)).is_ok());
    }

    #[test]
    fn each_bad_entry_is_refused_by_place() {
        for which in 0..4 {
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut all = matrices();
                all[which][(1, 2)] = value;
                let [phi, c, d, stderr] = &all;
                let error = Problem::new(phi, c, d, Some(stderr)).unwrap_err();
                assert!(
                    matches!(
                        error,
                        RecoveryError::NotFinite {
                            row: 1,
                            column: 2,
                            ..
                        }
                    ),
                    "{error}"
                );
            }
        }
        let [phi, c, d, mut stderr] = matrices();
        stderr[(1, 0)] = -1e-20;
        let error = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap_err();
        assert!(matches!(
            error,
            RecoveryError::NegativeStandardError {
                pixel: 1,
                spot: 0,
                ..
            }
        ));
    }

    #[test]
    fn grids_must_make_up_the_elements() {
        let [phi, c, d, stderr] = matrices();
        let problem = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap();
        assert!(problem.with_grids(&[[2, 2]]).is_ok());
        assert!(problem.with_grids(&[[3, 1], [1, 1]]).is_ok());
        let wrong: [&[[usize; 2]]; 5] = [
            &[],
            &[[2, 1]],
            &[[2, 3]],
            &[[2, 2], [0, 5]],
            &[[usize::MAX, 2]],
        ];
        for grids in wrong {
            let error = problem.with_grids(grids).unwrap_err();
            assert!(
                matches!(error, RecoveryError::Grids { elements: 4, .. }),
                "{error}"
            );
        }
    }

    #[test]
    fn shapes_must_fit() {
        let [phi, c, d, stderr] = matrices();
        for (phi, c, d, stderr) in [
            (&phi.transpose(), &c, &d, &stderr),
            (&phi, &d, &c, &stderr),
            (&phi, &c, &d.transpose(), &stderr),
            (&phi, &c, &d, &stderr.transpose()),
            (
                &DMatrix::zeros(0, 0),
                &DMatrix::zeros(0, 0),
                &DMatrix::zeros(0, 0),
                &stderr,
            ),
        ] {
            assert!(matches!(
                Problem::new(phi, c, d, Some(stderr)),
                Err(RecoveryError::Shape { .. })
            ));
        }
    }
}
