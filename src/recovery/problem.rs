//! What is to be inverted, how, and what can be wrong with it.

use nalgebra::DMatrix;

use crate::num::linalg::{LinalgError, Tolerance};
use crate::num::quadratic::QuadraticError;

/// Φ\[p,l\] = Σ_j C\[p,j\] ρ_j D\[j,l\] + noise, checked: shapes that fit, finite entries.
#[derive(Debug, Clone, Copy)]
pub struct Problem<'a> {
    pub(super) phi: &'a DMatrix<f64>,
    pub(super) c: &'a DMatrix<f64>,
    pub(super) d: &'a DMatrix<f64>,
    pub(super) stderr: Option<&'a DMatrix<f64>>,
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
        Ok(Problem { phi, c, d, stderr })
    }

    /// The standard errors, where they are given and not all zero.
    pub(super) fn noise(&self) -> Option<&'a DMatrix<f64>> {
        self.stderr.filter(|s| s.iter().any(|&x| x > 0.0))
    }

    /// ‖Φ − C diag(ρ) D‖, Frobenius, W.
    pub(super) fn residual(&self, reflectance: &nalgebra::DVector<f64>) -> f64 {
        let mut left = self.c.clone();
        for (mut column, &rho) in left.column_iter_mut().zip(reflectance.iter()) {
            column *= rho;
        }
        (self.phi - left * self.d).norm()
    }
}

/// Choices of the methods; the default leaves each to its own rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Where `pinv` and `joint` cut the rank.
    pub tolerance: Tolerance,
    /// How many singular directions `tsvd` keeps; by the discrepancy principle where not given.
    pub rank: Option<usize>,
    /// The damping λ of `tikhonov` as a fraction of D's largest singular value; by the discrepancy principle where not given.
    pub damping: Option<f64>,
    /// Largest number of entries of the compressed Khatri–Rao product that `joint` forms (8 bytes each, up to three copies);
    /// above it the Gram matrix is used, whose condition is squared.
    pub budget: usize,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            tolerance: Tolerance::Auto,
            rank: None,
            damping: None,
            budget: 1 << 24,
        }
    }
}

/// Why nothing was recovered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RecoveryError {
    /// Matrices that do not belong together.
    #[error(
        "{name} is {found_rows} × {found_columns}, but {rows} × {columns} is needed; \
         phi is pixels × spots, c pixels × elements, d elements × spots, all of the same bench"
    )]
    Shape {
        /// Which matrix.
        name: &'static str,
        /// Rows needed.
        rows: usize,
        /// Columns needed.
        columns: usize,
        /// Rows given.
        found_rows: usize,
        /// Columns given.
        found_columns: usize,
    },
    /// An entry is NaN or infinite.
    #[error(
        "{name}[{row}, {column}] is {value}; photographs and model must be finite, so render or repair that entry first"
    )]
    NotFinite {
        /// Which matrix.
        name: &'static str,
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// A standard error below zero.
    #[error(
        "the standard error of pixel {pixel}, spot {spot} is {value} W; standard errors are never negative, so check which file was given"
    )]
    NegativeStandardError {
        /// Row, from 0.
        pixel: usize,
        /// Column, from 0.
        spot: usize,
        /// The entry, W.
        value: f64,
    },
    /// A pixel that cannot see an element, where the method divides.
    #[error(
        "the model says that pixel {pixel} receives nothing from element {element}, and {method} divides by it; \
         leave that pixel out, or use joint, which does not divide"
    )]
    Unseen {
        /// The method's name.
        method: super::Method,
        /// Row of C, from 0.
        pixel: usize,
        /// Column of C, from 0.
        element: usize,
    },
    /// Nothing of the model is left to invert.
    #[error(
        "the {side} has rank zero, so no photograph could tell elements apart; check that light reaches the hidden surface"
    )]
    RankZero {
        /// Which side of the model.
        side: &'static str,
    },
    /// A parameter without meaning.
    #[error("{name} = {value} has no meaning for {method}; {cure}")]
    BadParameter {
        /// The method's name.
        method: super::Method,
        /// The parameter.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        cure: &'static str,
    },
    /// No noise model and no parameter.
    #[error(
        "{method} needs to know the noise to choose its {parameter}; give the standard error of phi (phi.stderr.npy), \
         or give the {parameter} yourself"
    )]
    NoNoiseModel {
        /// The method's name.
        method: super::Method,
        /// What would have to be given.
        parameter: &'static str,
    },
    /// The discrepancy principle has no answer: the data lie further from the model than the noise allows.
    #[error(
        "even with the least regularisation the residual is {residual:.3e} W where the noise allows {limit:.3e} W: the standard errors \
         are too small or the model does not describe these photographs; correct either, or give the {parameter} yourself"
    )]
    NoiseUnderstated {
        /// Frobenius norm of the residual, W.
        residual: f64,
        /// The largest norm that the noise explains, W.
        limit: f64,
        /// What would have to be given.
        parameter: &'static str,
    },
    /// The discrepancy principle has no answer: the data are no more than noise.
    #[error(
        "the photographs ({signal:.3e} W in all) do not rise above their noise ({limit:.3e} W), so there is nothing to recover; \
         take more samples, or give the {parameter} yourself"
    )]
    NoSignal {
        /// Frobenius norm of Φ, W.
        signal: f64,
        /// The norm that noise alone explains, W.
        limit: f64,
        /// What would have to be given.
        parameter: &'static str,
    },
    /// A decomposition failed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// The bounded solver failed.
    #[error(transparent)]
    Quadratic(#[from] QuadraticError),
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
