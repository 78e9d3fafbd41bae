//! The thin singular value decomposition, scaled and checked, of all directions or of those above
//! rounding.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::svd::{ComputeSvdVectors, SvdParams, svd as faer_svd, svd_scratch};
use faer::{Auto, Mat, MatRef, Par, Spec};
use nalgebra::{DMatrix, DVector};

use super::{LinalgError, Tolerance, columns_times, cut, product, range, same_to_rounding, scaled};

/// A = U Σ Vᵀ, thin: k = min(m, n), or fewer where those beyond are rounding.
#[derive(Debug, Clone, PartialEq)]
pub struct Svd {
    /// Left singular vectors, m × k, orthonormal columns.
    pub u: DMatrix<f64>,
    /// Singular values, descending, ≥ 0, in the unit of A.
    pub sigma: DVector<f64>,
    /// Right singular vectors as rows, k × n.
    pub vt: DMatrix<f64>,
    /// What no singular value beyond these k exceeds: 0 where all min(m, n) are there.
    pub rest: f64,
}

impl Svd {
    /// ‖A_j‖ of each column of A, √(Σ_i σ_i² V_ij²).
    pub fn column_norms(&self) -> DVector<f64> {
        let mut squares = DVector::zeros(self.vt.ncols());
        for (sigma, v) in self.sigma.iter().zip(self.vt.row_iter()) {
            for (sum, v) in squares.iter_mut().zip(v.iter()) {
                *sum += (sigma * v) * (sigma * v);
            }
        }
        squares.map(f64::sqrt)
    }

    /// The numerical rank of A at a tolerance, and the singular value at or below which counts as
    /// zero.
    ///
    /// # Errors
    /// Those of [`cut`].
    pub fn cut(&self, tolerance: Tolerance) -> Result<(usize, f64), LinalgError> {
        let (rows, columns) = (self.u.nrows(), self.vt.ncols());
        cut(self.sigma.as_slice(), rows, columns, tolerance)
    }
}

/// The thin singular value decomposition of an m × n matrix.
///
/// Before it is returned it must reproduce the matrix to rounding: with N = max(m, n),
///
/// > |Σσ² − ‖A‖²| ≤ 10 N eps ‖A‖²,   ‖A − U Σ Vᵀ‖ ≤ 10 N eps ‖A‖   (Frobenius norms)
///
/// # Errors
/// [`LinalgError::Empty`], [`LinalgError::NotFinite`], [`LinalgError::NoConvergence`],
/// [`LinalgError::Inaccurate`] if a check fails, [`LinalgError::Overflow`] if a singular value
/// exceeds f64.
pub fn svd(a: &DMatrix<f64>) -> Result<Svd, LinalgError> {
    let (scaled, exponent) = scaled(a)?;
    let mut result = decompose(&scaled)?;
    check(&scaled, &result)?;
    result.sigma.apply(|s| *s = libm::scalbn(*s, exponent));
    if result.sigma.iter().any(|s| !s.is_finite()) {
        return Err(LinalgError::Overflow("the largest singular value"));
    }
    Ok(result)
}

/// The singular value decomposition as far as a cut at `tolerance` needs it: of large matrices with
/// few directions only those above rounding, in time proportional to their number.
///
/// From the [`Range`](super::Range) A = Q B + E and the decomposition of B. As σ_i(B)² ≤ σ_i(A)² ≤
/// σ_i(B)² + ‖E‖² with ‖E‖ measured, the rank at the cut is that of A itself wherever both ends of
/// this interval lie on the same side of it; where one does not, where a rank is asked for whose
/// last direction is below the rounding max(m, n) · eps · σ₁, or where the range is too large to
/// pay, all of A is decomposed as by [`svd`](svd()). Kept singular vectors differ from those of A
/// by no more than ‖E‖/σ_k, as those of any other decomposition do by rounding of its own.
///
/// # Errors
/// Those of [`svd`](svd()), and [`LinalgError::Tolerance`].
pub fn svd_to(a: &DMatrix<f64>, tolerance: Tolerance) -> Result<Svd, LinalgError> {
    match svd_of_range(a, tolerance)? {
        Some(found) => Ok(found),
        None => svd(a),
    }
}

/// The decomposition of [`svd_to`] by the range of A; `None` where all of A would have to be
/// decomposed.
///
/// # Errors
/// Those of [`svd_to`].
pub fn svd_of_range(a: &DMatrix<f64>, tolerance: Tolerance) -> Result<Option<Svd>, LinalgError> {
    let Some(found) = range(a)? else {
        return Ok(None);
    };
    let small = svd(&found.b)?;
    let kept = small.sigma.iter().take_while(|&&s| s > found.rest).count();
    if !certain(
        &small.sigma.as_slice()[..kept],
        found.rest,
        a.shape(),
        tolerance,
    )? {
        return Ok(None);
    }
    let next = small.sigma.get(kept).copied().unwrap_or(0.0);
    Ok(Some(Svd {
        u: product(&found.q, &small.u.columns(0, kept).into_owned()),
        sigma: small.sigma.rows(0, kept).into_owned(),
        vt: small.vt.rows(0, kept).into_owned(),
        rest: libm::hypot(next, found.rest),
    }))
}

/// Whether singular values from `sigma` up to the root of `sigma`² + `rest`², and others of no more
/// than `rest`, leave no doubt about the cut.
pub(super) fn certain(
    sigma: &[f64],
    rest: f64,
    (rows, columns): (usize, usize),
    tolerance: Tolerance,
) -> Result<bool, LinalgError> {
    let (rank, cutoff) = match tolerance {
        Tolerance::Rank(asked) => {
            let (rank, _) = cut(sigma, rows, columns, Tolerance::Auto)?;
            return Ok((1..=rank).contains(&asked));
        }
        other => cut(sigma, rows, columns, other)?,
    };
    let above = |s: &&f64| libm::hypot(**s, rest) > cutoff;
    Ok(rest <= cutoff && sigma.iter().take_while(above).count() == rank)
}

fn decompose(a: &DMatrix<f64>) -> Result<Svd, LinalgError> {
    let (m, n) = a.shape();
    let k = m.min(n);
    // A QR before the bidiagonalisation costs three digits where the matrix is numerically rank
    // deficient.
    let mut params = <SvdParams as Auto<f64>>::auto();
    params.qr_ratio_threshold = f64::INFINITY;
    let params: Spec<SvdParams, f64> = params.into();
    let thin = ComputeSvdVectors::Thin;
    let mut memory = MemBuffer::new(svd_scratch::<f64>(m, n, thin, thin, Par::Seq, params));
    let mut u = Mat::<f64>::zeros(m, k);
    let mut v = Mat::<f64>::zeros(n, k);
    let mut sigma = Diag::<f64>::zeros(k);
    faer_svd(
        MatRef::from_column_major_slice(a.as_slice(), m, n),
        sigma.as_mut(),
        Some(u.as_mut()),
        Some(v.as_mut()),
        Par::Seq,
        MemStack::new(&mut memory),
        params,
    )
    .map_err(|_| LinalgError::NoConvergence)?;
    Ok(Svd {
        u: DMatrix::from_fn(m, k, |i, j| u[(i, j)]),
        sigma: DVector::from_fn(k, |i, _| sigma[i]),
        vt: DMatrix::from_fn(k, n, |i, j| v[(j, i)]),
        rest: 0.0,
    })
}

/// The two a-posteriori checks of [`svd`] on the scaled matrix.
fn check(a: &DMatrix<f64>, svd: &Svd) -> Result<(), LinalgError> {
    let norm = a.norm();
    if norm == 0.0 {
        return Ok(());
    }
    let off = (svd.sigma.norm_squared() / (norm * norm) - 1.0).abs();
    same_to_rounding(a, "the sum of squared singular values", off)?;
    let off = (a - columns_times(svd.u.clone(), &svd.sigma) * &svd.vt).norm();
    same_to_rounding(a, "the product of the factors", off / norm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::linalg::kernel::{bench_g12, hilbert};

    fn orthonormality(svd: &Svd) -> f64 {
        let k = svd.sigma.len();
        let identity = DMatrix::<f64>::identity(k, k);
        (svd.u.transpose() * &svd.u - &identity)
            .amax()
            .max((&svd.vt * svd.vt.transpose() - identity).amax())
    }

    #[test]
    fn planted_diagonal_is_found_descending() {
        let a = DMatrix::from_row_slice(2, 3, &[0.0, 3.0, 0.0, -7.0, 0.0, 0.0]);
        let svd = svd(&a).unwrap();
        assert!((svd.sigma[0] - 7.0).abs() < 1e-14 && (svd.sigma[1] - 3.0).abs() < 1e-14);
        assert_eq!((svd.u.shape(), svd.vt.shape()), ((2, 2), (2, 3)));
    }

    #[test]
    fn all_ones_has_one_singular_value() {
        // 1·1ᵀ of 64 × 120: σ₁ = √(64·120), all others zero.
        let svd = svd(&DMatrix::from_element(64, 120, 1.0)).unwrap();
        let exact = 7680f64.sqrt();
        assert!((svd.sigma[0] / exact - 1.0).abs() < 1e-14);
        assert!(svd.sigma[1] < 120.0 * f64::EPSILON * exact);
        assert!(orthonormality(&svd) < 1e-13);
    }

    #[test]
    fn scale_is_a_power_of_two_and_costs_nothing() {
        let a = bench_g12(3.0);
        let base = svd(&a).unwrap();
        for exponent in [980, -520, -900] {
            let moved = svd(&a.map(|x| libm::scalbn(x, exponent))).unwrap();
            assert_eq!(moved.u, base.u);
            assert_eq!(moved.sigma, base.sigma.map(|s| libm::scalbn(s, exponent)));
        }
        for factor in [1e300, 1e-160] {
            let moved = svd(&(&a * factor)).unwrap();
            assert!((moved.sigma[0] / factor / base.sigma[0] - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn ill_conditioned_matrices_keep_orthonormal_factors() {
        for a in [
            hilbert(12, 12),
            hilbert(40, 9),
            hilbert(9, 40),
            bench_g12(3.0),
            bench_g12(6.0),
        ] {
            assert!(orthonormality(&svd(&a).unwrap()) < 1e-13);
        }
        // The 12 × 12 Hilbert matrix: σ₁ = 1.7953720595619977 (its largest eigenvalue), determinant
        // 2.6e-78.
        let sigma = svd(&hilbert(12, 12)).unwrap().sigma;
        assert!((sigma[0] - 1.795_372_059_561_997_7).abs() < 1e-14);
    }

    #[test]
    fn a_tall_smooth_kernel_keeps_its_tail_small() {
        // Analytic kernel: exact singular values fall below 1e-25 σ₁ by the 60th. Rounding of the
        // entries lifts them to about eps/√1024 each; an unpivoted QR first would make it 6e-15.
        let kernel = |i: usize, j: usize| 3.0 * (i as f64 / 1024.0 - j as f64 / 120.0);
        let tall = DMatrix::from_fn(1024, 120, |i, j| (1.0 + kernel(i, j).powi(2)).powi(-2));
        for a in [tall.transpose(), tall] {
            let sigma = svd(&a).unwrap().sigma;
            assert!(
                sigma[60] < f64::EPSILON * sigma[0],
                "{:e}",
                sigma[60] / sigma[0]
            );
        }
    }

    #[test]
    fn a_wrong_factor_is_noticed() {
        let a = bench_g12(3.0);
        let mut wrong = decompose(&a).unwrap();
        assert!(check(&a, &wrong).is_ok());
        wrong.u[(3, 0)] += 1e-9;
        assert!(matches!(
            check(&a, &wrong),
            Err(LinalgError::Inaccurate { .. })
        ));
        let mut wrong = decompose(&a).unwrap();
        wrong.sigma[0] *= 1.0 + 1e-9;
        assert!(matches!(
            check(&a, &wrong),
            Err(LinalgError::Inaccurate { .. })
        ));
    }

    #[test]
    fn bad_input_is_refused() {
        let mut a = DMatrix::from_element(3, 4, 1.0);
        a[(1, 2)] = f64::NAN;
        assert!(matches!(
            svd(&a),
            Err(LinalgError::NotFinite {
                row: 1,
                column: 2,
                ..
            })
        ));
        a[(1, 2)] = f64::NEG_INFINITY;
        assert!(matches!(
            svd(&a),
            Err(LinalgError::NotFinite {
                row: 1,
                column: 2,
                ..
            })
        ));
        assert_eq!(
            svd(&DMatrix::zeros(0, 4)),
            Err(LinalgError::Empty {
                rows: 0,
                columns: 4
            })
        );
        assert!(matches!(
            svd(&DMatrix::from_element(9, 9, f64::MAX)),
            Err(LinalgError::Overflow(_))
        ));
        assert_eq!(svd(&DMatrix::zeros(3, 2)).unwrap().sigma, DVector::zeros(2));
    }
}
