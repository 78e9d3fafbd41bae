//! The Moore–Penrose inverse.

use nalgebra::{DMatrix, DVector};

use super::{LinalgError, Tolerance, columns_over, product, svd_to};

/// A⁺ and how it was cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Pinv {
    /// A⁺ = V_k Σ_k⁻¹ U_kᵀ, n × m for an m × n matrix, in the inverse unit of A.
    pub matrix: DMatrix<f64>,
    /// k: how many singular values were inverted; 0 for a zero matrix, whose A⁺ is zero.
    pub rank: usize,
    /// Singular values, descending: all min(m, n), or those above rounding
    /// ([`svd_to`](super::svd_to)).
    pub sigma: DVector<f64>,
    /// Singular values at or below this were taken as zero.
    pub cutoff: f64,
}

/// The Moore–Penrose inverse of an m × n matrix, the one matrix A⁺ with AA⁺A = A, A⁺AA⁺ = A⁺ and
/// AA⁺, A⁺A symmetric, singular values cut at `tolerance`.
///
/// # Errors
/// Those of [`svd`](super::svd()), [`LinalgError::Tolerance`], [`LinalgError::Rank`], and
/// [`LinalgError::Overflow`] where 1/σ exceeds f64.
pub fn pinv(a: &DMatrix<f64>, tolerance: Tolerance) -> Result<Pinv, LinalgError> {
    let decomposed = svd_to(a, tolerance)?;
    let (rank, cutoff) = decomposed.cut(tolerance)?;
    // Division, not multiplication by 1/σ: 1/σ of a subnormal σ would overflow before the entry is
    // small enough.
    let v = columns_over(decomposed.vt.rows(0, rank).transpose(), &decomposed.sigma);
    let matrix = product(&v, &decomposed.u.columns(0, rank).transpose());
    if matrix.iter().any(|x| !x.is_finite()) {
        return Err(LinalgError::Overflow("the pseudo-inverse"));
    }
    Ok(Pinv {
        matrix,
        rank,
        sigma: decomposed.sigma,
        cutoff,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::linalg::cut;
    use crate::num::linalg::kernel::{bench_g12, hilbert};

    /// Largest violation of the four Penrose conditions, each relative to the size that rounding
    /// gives it: A⁺ carries an error of eps·cond·‖A⁺‖, so AA⁺ and A⁺A are symmetric, and the
    /// products return, to eps·cond.
    fn penrose(a: &DMatrix<f64>, p: &Pinv) -> f64 {
        let condition = p.sigma[0] / p.sigma[p.rank - 1];
        let rounding = a.nrows().max(a.ncols()) as f64 * f64::EPSILON * condition;
        let x = &p.matrix;
        let (ax, xa) = (a * x, x * a);
        let cut = p.sigma.rows(p.rank, p.sigma.len() - p.rank).norm();
        [
            ((&ax * a - a).norm() - cut) / a.norm(),
            (&xa * x - x).norm() / x.norm(),
            (&ax - ax.transpose()).norm(),
            (&xa - xa.transpose()).norm(),
        ]
        .into_iter()
        .fold(0.0f64, f64::max)
            / rounding
    }

    #[test]
    fn penrose_conditions_hold() {
        let cases = [
            DMatrix::from_element(64, 120, 1.0),
            DMatrix::from_fn(5, 3, |i, j| ((i * 7 + j * 3) % 11) as f64 - 4.0),
            hilbert(6, 6),
            hilbert(9, 30),
            bench_g12(3.0),
            bench_g12(6.0),
            bench_g12(3.0) * 1e300,
            bench_g12(3.0) * 1e-160,
        ];
        for (index, a) in cases.iter().enumerate() {
            // A cut well above rounding keeps the projectors well defined.
            let p = pinv(a, Tolerance::Relative(1e-10)).unwrap();
            let scale = 1.0 / a.amax();
            let unit = Pinv {
                matrix: &p.matrix / scale,
                sigma: &p.sigma * scale,
                ..p
            };
            assert!(
                penrose(&(a * scale), &unit) < 1.0,
                "case {index}: {}",
                penrose(&(a * scale), &unit)
            );
        }
    }

    #[test]
    fn planted_inverse_of_all_ones() {
        // (1_m 1_nᵀ)⁺ = 1_n 1_mᵀ/(m n).
        let p = pinv(&DMatrix::from_element(64, 120, 1.0), Tolerance::Auto).unwrap();
        assert_eq!(p.rank, 1);
        assert!(p.matrix.iter().all(|x| (x * 7680.0 - 1.0).abs() < 1e-13));
    }

    #[test]
    fn rank_is_cut_as_asked() {
        let a = DMatrix::from_diagonal(&DVector::from_row_slice(&[1.0, 1e-3, 1e-9, 0.0]));
        assert_eq!(pinv(&a, Tolerance::Auto).unwrap().rank, 3);
        assert_eq!(pinv(&a, Tolerance::Relative(1e-6)).unwrap().rank, 2);
        let one = pinv(&a, Tolerance::Rank(1)).unwrap();
        assert_eq!((one.rank, one.cutoff), (1, 1e-3));
        assert_eq!(
            pinv(&a, Tolerance::Rank(4)),
            Err(LinalgError::Rank {
                asked: 4,
                available: 3
            })
        );
        assert_eq!(
            pinv(&a, Tolerance::Rank(0)),
            Err(LinalgError::Rank {
                asked: 0,
                available: 3
            })
        );
        assert!(pinv(&a, Tolerance::Relative(f64::NAN)).is_err());
        assert_eq!(
            pinv(&a, Tolerance::Relative(1.0)),
            Err(LinalgError::Tolerance(1.0))
        );
        let zero = pinv(&DMatrix::zeros(2, 3), Tolerance::Auto).unwrap();
        assert_eq!((zero.rank, zero.matrix), (0, DMatrix::zeros(3, 2)));
    }

    #[test]
    fn bench_kernel_is_numerically_rank_deficient() {
        let p = pinv(&bench_g12(3.0), Tolerance::Auto).unwrap();
        assert!(p.rank > 20 && p.rank < 64, "rank {}", p.rank);
    }

    /// Doubles lie 2⁻⁵¹ apart at σ₁ = 3, so the rule of `Spacing` cuts at 2 · 2⁻⁵⁰ for a side of 4,
    /// that of `Auto` at 3 · 2⁻⁵⁰; at a power of two both are one.
    #[test]
    fn spacing_is_the_distance_of_doubles() {
        let unit = libm::exp2(-50.0);
        let sigma = [3.0, 3.5 * unit, 2.5 * unit, 2.0 * unit];
        assert_eq!(cut(&sigma, 4, 3, Tolerance::Spacing), Ok((3, 2.0 * unit)));
        assert_eq!(cut(&sigma, 4, 3, Tolerance::Auto), Ok((2, 3.0 * unit)));
        let power = [4.0, unit];
        assert_eq!(
            cut(&power, 2, 2, Tolerance::Spacing),
            cut(&power, 2, 2, Tolerance::Auto)
        );
        assert_eq!(cut(&[0.0], 1, 1, Tolerance::Spacing), Ok((0, 0.0)));
    }
}
