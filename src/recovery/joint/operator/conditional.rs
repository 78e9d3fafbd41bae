//! Factors with a normal prior, eliminated softly.
//!
//! In rows whose noise has unit variance a pattern m of size ε ~ N(0, w²) makes the covariance
//! 1 + w² m mᵀ. Rows times its inverse root
//!
//! > (1 + w² m mᵀ)^(−½) = 1 − (1 − 1/√(1 + w²|m|²)) m̂ m̂ᵀ
//!
//! have unit variance again: w → ∞ takes the pattern out, as of unknown size; w → 0 leaves all. The
//! least squares of those rows are those of x and ε together with (ε/w)² added, their normal matrix
//! the Schur complement H_xx − H_xε H_εε⁻¹ H_εx, and
//!
//! > ε | x ~ N(v mᵀ(y − A x), v),   v = w²/(1 + w²|m|²),
//! > ln det(1 + w² m mᵀ) = ln(1 + w²|m|²)

use nalgebra::{DMatrix, DVector, DVectorView};

use crate::num::linalg::{Triangle, product};
use crate::recovery::soft::Soft;

/// ε given x: mean `at_zero` − `slope` x, and variances.
#[derive(Debug, Clone)]
pub(super) struct Conditional {
    pub(super) at_zero: DVector<f64>,
    pub(super) slope: DMatrix<f64>,
    /// In units of the noise.
    pub(super) variance: DVector<f64>,
    /// ln det of the covariance of the data, over that of noise alone.
    pub(super) log_det: f64,
}

impl Conditional {
    /// Of single factors, in order.
    pub(super) fn of(all: &[One]) -> Self {
        let n = all.first().map_or(0, |one| one.along.len() - 1);
        Self {
            at_zero: DVector::from_fn(all.len(), |k, _| all[k].along[n]),
            slope: DMatrix::from_fn(all.len(), n, |k, j| all[k].along[j]),
            variance: DVector::from_fn(all.len(), |k, _| all[k].variance),
            log_det: all.iter().map(|one| one.log_det).sum(),
        }
    }

    /// ε̂.
    pub(super) fn given(&self, x: &DVector<f64>) -> DVector<f64> {
        &self.at_zero - &self.slope * x
    }

    /// Standard errors where x has the covariance `of_x`, the noise's variance `noise`².
    pub(super) fn errors(&self, of_x: &DMatrix<f64>, noise: f64) -> DVector<f64> {
        let along = product(&self.slope, of_x);
        DVector::from_fn(self.variance.len(), |k, _| {
            let of_x = along.row(k).dot(&self.slope.row(k)).max(0.0);
            (self.variance[k] * noise * noise + of_x).sqrt()
        })
    }
}

/// One factor.
#[derive(Debug, Clone)]
pub(super) struct One {
    /// v mᵀ (A | y).
    along: DVector<f64>,
    variance: f64,
    log_det: f64,
}

impl One {
    /// `along` is mᵀ(A | y).
    pub(super) fn new(along: DVector<f64>, of: &Softening) -> Self {
        One {
            along: along * of.variance,
            variance: of.variance,
            log_det: of.log_det,
        }
    }
}

/// (1 + w² m mᵀ)^(−½) = 1 − taken·m mᵀ, and what goes with it.
#[derive(Debug, Clone)]
pub(super) struct Softening {
    pub(super) taken: f64,
    variance: f64,
    log_det: f64,
}

impl Softening {
    /// From |m|² and w.
    pub(super) fn new(square: f64, width: f64) -> Self {
        let seen = width * width * square;
        Softening {
            taken: if seen > 0.0 {
                (1.0 - 1.0 / (1.0 + seen).sqrt()) / square
            } else {
                0.0
            },
            variance: width * width / (1.0 + seen),
            log_det: libm::log1p(seen),
        }
    }
}

/// Makes `rows`, (A | y) of unit noise, those of a problem without the pattern m of size N(0, w²).
pub(super) fn soften(rows: &mut DMatrix<f64>, m: &DVectorView<'_, f64>, width: f64) -> One {
    let of = Softening::new(m.norm_squared(), width);
    let along = rows.tr_mul(m);
    rows.ger(-of.taken, m, &along, 1.0);
    One::new(along, &of)
}

/// The same of the one factor of all photographs, in the reduced problem.
pub(super) fn soften_whole(triangle: &mut Triangle, soft: Option<&Soft>) -> Option<Conditional> {
    let soft = soft?;
    let (z, known_to) = soft.whole.as_ref()?;
    let m = &triangle.r * z;
    let n = triangle.r.ncols();
    let mut rows = triangle.r.clone().insert_column(n, 0.0);
    rows.set_column(n, &triangle.d);
    let one = soften(&mut rows, &m.as_view(), known_to / soft.noise);
    triangle.r.copy_from(&rows.columns(0, n));
    triangle.d.copy_from(&rows.column(n));
    Some(Conditional::of(&[one]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the inverse of the covariance written out: the same normal equations, and ln det.
    #[test]
    fn rows_are_whitened_for_the_covariance_written_out() {
        let rows = DMatrix::from_fn(7, 4, |i, j| ((i * 5 + j * 3) % 7) as f64 - 2.5);
        let m = DVector::from_fn(7, |i, _| ((i * 3) % 5) as f64 - 1.0);
        for width in [1e-3, 0.4, 30.0] {
            let covariance = DMatrix::identity(7, 7) + &m * m.transpose() * (width * width);
            let expected = rows.transpose() * covariance.clone().try_inverse().unwrap() * &rows;
            let mut own = rows.clone();
            let one = soften(&mut own, &m.as_view(), width);
            assert!((own.transpose() * &own - expected).amax() < 1e-10);
            assert!((one.log_det - libm::log(covariance.determinant())).abs() < 1e-10);
            // Ridge regression of the last column on m.
            let ridge = m.dot(&rows.column(3)) / (m.norm_squared() + 1.0 / (width * width));
            assert!((Conditional::of(&[one]).at_zero[0] - ridge).abs() < 1e-12);
        }
    }
}
