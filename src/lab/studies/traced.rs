//! Matrices in the outputs of tasks, and the spots that a task traces.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::matrix::Matrix;
use crate::scene::Scene;
use crate::transport::Traced;

/// A matrix as bytes: rows, columns, and the entries by columns.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(try_from = "Entries", into = "Entries")]
pub struct Kept(pub(super) Matrix);

#[derive(Serialize, Deserialize)]
struct Entries {
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

impl From<Kept> for Entries {
    fn from(Kept(matrix): Kept) -> Self {
        Self {
            rows: matrix.nrows(),
            columns: matrix.ncols(),
            values: matrix.as_slice().to_vec(),
        }
    }
}

impl TryFrom<Entries> for Kept {
    type Error = &'static str;

    fn try_from(found: Entries) -> Result<Self, Self::Error> {
        let Entries {
            rows,
            columns,
            values,
        } = found;
        match rows.checked_mul(columns) {
            Some(entries) if entries == values.len() => {
                Ok(Self(Matrix::from_vec(rows, columns, values)))
            }
            _ => Err("a matrix with another number of entries"),
        }
    }
}

/// Φcam as traced for some of the spots, with its standard error, pixels × spots, W.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TracedSpots {
    flux: Kept,
    stderr: Kept,
}

impl TracedSpots {
    pub(super) fn of(traced: Traced) -> Self {
        Self {
            flux: Kept(traced.flux),
            stderr: Kept(traced.stderr),
        }
    }

    pub(super) fn shaped(&self, shape: (usize, usize)) -> bool {
        [&self.flux, &self.stderr].map(|m| m.0.shape()) == [shape; 2]
    }

    /// Flux and standard error of all spots, from parts side by side.
    pub(super) fn join<'a>(
        pixels: usize,
        parts: impl Iterator<Item = &'a Self> + Clone,
    ) -> [Matrix; 2] {
        let joined = |f: fn(&Self) -> &Kept| side_by_side(pixels, parts.clone().map(|c| &f(c).0));
        [joined(|c| &c.flux), joined(|c| &c.stderr)]
    }
}

/// Matrices of `pixels` rows as one, side by side.
pub(super) fn side_by_side<'a>(pixels: usize, parts: impl Iterator<Item = &'a Matrix>) -> Matrix {
    let values: Vec<f64> = parts.flat_map(|m| m.iter().copied()).collect();
    Matrix::from_vec(pixels, values.len() / pixels, values)
}

/// Tasks that the spots of a render are shared out to, where every spot has paths of its own.
pub(super) const SHARES: usize = 8;

/// The spots of share `k` of `shares`.
pub(super) fn share(scene: &Scene, k: usize, shares: usize) -> Range<usize> {
    let spots = scene.laser.spots.len();
    k * spots / shares..(k + 1) * spots / shares
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::bytes::{encode, read};

    /// Infinities and not-a-numbers are entries like others; a shape that is not that of the
    /// entries is refused.
    #[test]
    fn a_matrix_comes_back_as_it_was() {
        let own = Matrix::from_row_slice(2, 3, &[1.0, f64::NAN, -0.0, f64::INFINITY, 0.1, 5e-324]);
        let bytes = encode(0, &Kept(own.clone())).unwrap();
        let Kept(found) = read(&bytes).unwrap();
        assert_eq!(found.shape(), (2, 3));
        assert!(
            found
                .iter()
                .zip(own.iter())
                .all(|(a, b)| a.to_bits() == b.to_bits())
        );
        for (rows, columns) in [(3, 3), (usize::MAX, 2), (6, 0)] {
            let values = own.as_slice().to_vec();
            let forged = Entries {
                rows,
                columns,
                values,
            };
            let bytes = encode(0, &forged).unwrap();
            assert!(read::<Kept>(&bytes).is_err(), "{rows} × {columns}");
        }
    }
}
