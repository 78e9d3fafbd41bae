//! Dense linear algebra: the one door to matrix decompositions.
//!
//! Matrices are [`nalgebra::DMatrix<f64>`] (column-major) on both sides of the door; behind it the
//! decompositions are those of `faer` (and Householder reductions of its own,
//! [`pivoted_qr`](pivoted_qr()) and [`complement`](complement())), on one thread so that their bits
//! do not depend on the number of cores. What this door adds to them:
//!
//! * empty, NaN and infinite input is refused with an error ([`LinalgError`]), never looped over
//!   and never a panic;
//! * the matrix is scaled by a power of two to a largest entry in [1, 2) first, so entries near
//!   1e300 or 1e-160 lose nothing;
//! * the singular value decomposition of a tall or wide matrix never goes through an unpivoted QR
//!   first, which would blur the singular values near the rank by three digits;
//! * every singular value decomposition and every pivoted QR checks itself afterwards (see
//!   [`svd`]);
//! * a large matrix of few directions is decomposed at the cost of those ([`svd_to`],
//!   [`range`](range())), where what is left over, measured, cannot change the numerical rank.
//!
//! [`svd`]: svd()
//! [`svd_to`]: svd_to()

mod cholesky;
mod diagonal;
mod householder;
mod least_squares;
mod pinv;
mod pivoted_qr;
mod product;
mod range;
mod solution;
mod svd;
mod triangle;

pub use cholesky::Cholesky;
pub use diagonal::{columns_over, columns_times, rows_over, rows_times};
pub use householder::{Complement, complement};
pub use least_squares::least_squares;
pub use pinv::{Pinv, pinv};
pub use pivoted_qr::{PivotedQr, pivoted_qr, pivoted_qr_to};
pub use product::{gram_product, product, subtract_product, tr_product, tr_product_of};
pub use range::{Range, range};
pub use solution::{LeastSquares, Route};
pub use svd::{Svd, svd, svd_of_range, svd_to};
pub use triangle::{Gram, Triangle, normal_triangle, pivoted_triangle, triangle, triangle_of};

use nalgebra::DMatrix;

/// Where a numerical rank is cut: singular values at or below the cut count as zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Tolerance {
    /// max(m, n) · eps · σ₁: what rounding of the entries alone can make of an exact zero.
    #[default]
    Auto,
    /// max(m, n) · spacing of doubles at σ₁, 2^(⌊log₂ σ₁⌋ − 52): MATLAB's rule, up to half of
    /// `Auto`. Unlike the others it depends on the unit of A.
    Spacing,
    /// The given fraction of σ₁, in [0, 1).
    Relative(f64),
    /// Keep exactly this many singular values, at least one.
    Rank(usize),
}

/// Why a matrix cannot be decomposed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LinalgError {
    /// A side of the matrix is zero.
    #[error(
        "the matrix is {rows} × {columns} and so has nothing to decompose; give it at least one row and one column"
    )]
    Empty {
        /// Rows of the matrix.
        rows: usize,
        /// Columns of the matrix.
        columns: usize,
    },
    /// An entry is NaN or infinite.
    #[error(
        "the entry in row {row}, column {column} is {value}; every entry must be finite, so remove or repair it first"
    )]
    NotFinite {
        /// Row of the first such entry, from 0.
        row: usize,
        /// Column of the first such entry, from 0.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// Two operands do not fit.
    #[error("{what}: expected {expected}, found {found}; check which matrix was given where")]
    Shape {
        /// What was compared.
        what: &'static str,
        /// The length needed.
        expected: usize,
        /// The length given.
        found: usize,
    },
    /// A tolerance that no matrix can have.
    #[error(
        "a rank cut of {0} σ₁ has no meaning; choose a number from 0 up to, but not including, 1"
    )]
    Tolerance(f64),
    /// A rank the matrix does not have.
    #[error(
        "rank {asked} was asked for, but the matrix has only {available} singular values above zero; choose 1 to {available}"
    )]
    Rank {
        /// The rank asked for.
        asked: usize,
        /// How many non-zero singular values there are.
        available: usize,
    },
    /// The iteration of the decomposition did not converge.
    #[error(
        "the singular value decomposition did not converge; scale rows and columns to comparable size and try again"
    )]
    NoConvergence,
    /// The decomposition failed its own check.
    #[error(
        "the decomposition does not reproduce its matrix: {check} is off by {error:.1e} (relative), allowed {allowed:.1e}; \
         please report the matrix as a bug"
    )]
    Inaccurate {
        /// Which of the checks failed.
        check: &'static str,
        /// Its relative error.
        error: f64,
        /// The error that rounding can explain.
        allowed: f64,
    },
    /// A result is beyond the range of f64.
    #[error("{0} overflows the range of f64; scale the matrix to entries of ordinary size")]
    Overflow(&'static str),
}

/// Refuses two lengths that should be one.
pub(super) fn same_length(
    what: &'static str,
    expected: usize,
    found: usize,
) -> Result<(), LinalgError> {
    if expected == found {
        return Ok(());
    }
    Err(LinalgError::Shape {
        what,
        expected,
        found,
    })
}

/// Refuses what a decomposition of `a` reproduces to worse than 10 max(m, n) roundings.
fn same_to_rounding(a: &DMatrix<f64>, check: &'static str, error: f64) -> Result<(), LinalgError> {
    let allowed = 10.0 * a.nrows().max(a.ncols()) as f64 * f64::EPSILON;
    if error <= allowed {
        return Ok(());
    }
    Err(LinalgError::Inaccurate {
        check,
        error,
        allowed,
    })
}

/// The e by which 2^−e times these entries has its largest in [1, 2); 0 where all are zero. `rows`
/// of them make a column.
fn exponent(entries: &[f64], rows: usize) -> Result<i32, LinalgError> {
    let mut largest = 0.0f64;
    for (index, &value) in entries.iter().enumerate() {
        if !value.is_finite() {
            return Err(LinalgError::NotFinite {
                row: index % rows,
                column: index / rows,
                value,
            });
        }
        largest = largest.max(value.abs());
    }
    if largest == 0.0 {
        return Ok(0);
    }
    Ok(libm::ilogb(largest))
}

/// The matrix times 2^−e, e its [`exponent`], and e.
fn scaled(a: &DMatrix<f64>) -> Result<(DMatrix<f64>, i32), LinalgError> {
    refuse_empty(a.nrows(), a.ncols())?;
    let exponent = exponent(a.as_slice(), a.nrows())?;
    if exponent == 0 {
        return Ok((a.clone(), 0));
    }
    Ok((a.map(times_two_to(-exponent)), exponent))
}

/// x ↦ 2ⁿ x, with the bits of [`libm::scalbn`]: one product where 2ⁿ is a normal number.
pub(super) fn times_two_to(n: i32) -> impl Fn(f64) -> f64 + Copy {
    let is_normal = (-1022..=1023).contains(&n);
    let factor = libm::scalbn(1.0, if is_normal { n } else { 0 });
    move |x| {
        if is_normal {
            x * factor
        } else {
            libm::scalbn(x, n)
        }
    }
}

fn refuse_empty(rows: usize, columns: usize) -> Result<(), LinalgError> {
    if rows == 0 || columns == 0 {
        return Err(LinalgError::Empty { rows, columns });
    }
    Ok(())
}

/// How many of the descending singular values survive `tolerance` for a rows × columns matrix, and
/// the value at or below which they were cut (same unit as σ).
///
/// # Errors
/// [`LinalgError::Tolerance`], [`LinalgError::Rank`].
pub fn cut(
    sigma: &[f64],
    rows: usize,
    columns: usize,
    tolerance: Tolerance,
) -> Result<(usize, f64), LinalgError> {
    let first = sigma.first().copied().unwrap_or(0.0);
    let cutoff = match tolerance {
        Tolerance::Auto => rows.max(columns) as f64 * f64::EPSILON * first,
        Tolerance::Spacing if first > 0.0 => {
            rows.max(columns) as f64 * libm::scalbn(f64::EPSILON, libm::ilogb(first))
        }
        Tolerance::Spacing => 0.0,
        Tolerance::Relative(fraction) if (0.0..1.0).contains(&fraction) => fraction * first,
        Tolerance::Relative(fraction) => return Err(LinalgError::Tolerance(fraction)),
        Tolerance::Rank(asked) => {
            let available = sigma.iter().filter(|&&s| s > 0.0).count();
            if asked == 0 || asked > available {
                return Err(LinalgError::Rank { asked, available });
            }
            return Ok((asked, sigma.get(asked).copied().unwrap_or(0.0)));
        }
    };
    Ok((sigma.iter().take_while(|&&s| s > cutoff).count(), cutoff))
}

#[cfg(test)]
mod kernel;

#[cfg(test)]
mod tests {
    use super::*;

    /// The bits of libm's, at all exponents, of normal and subnormal numbers.
    #[test]
    fn powers_of_two_multiply_as_libm_has_it() {
        let numbers = [
            1.0,
            -std::f64::consts::PI,
            0.0,
            f64::MIN_POSITIVE / 3.0,
            f64::MAX,
            7e-300,
        ];
        for n in -2100..2100 {
            for x in numbers {
                let (own, wanted) = (times_two_to(n)(x), libm::scalbn(x, n));
                assert_eq!(own.to_bits(), wanted.to_bits(), "{x:e} 2^{n}");
            }
        }
    }
}
