//! Inverses that exist from one side only.
//!
//! * left: D_L = (DᵀD)⁻¹Dᵀ, D_L D = 1, where the columns of D (spots) are independent, so with no
//!   more spots than elements;
//! * right: D_R = Dᵀ(DDᵀ)⁻¹, D D_R = 1, where its rows (elements) are, so with no more elements
//!   than spots.
//!
//! Neither product is formed, which would square the condition. Both are D⁺ where they exist, D_L
//! giving the one exact solution of X D = Φ of least norm and D_R the one solution of least
//! squares, and both come from the pivoted QR of Dᵀ; unlike `pinv` these methods refuse where they
//! do not exist.

use super::{Inverse, Quotient, decompose};
use crate::num::linalg::{PivotedQr, pivoted_qr_to};
use crate::recovery::{Choice, Method, Options, Problem, RecoveryError};

/// From which side D is inverted.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
}

pub(super) fn inverse(
    problem: &Problem<'_>,
    options: &Options,
    side: Side,
) -> Result<Inverse, RecoveryError> {
    let (elements, spots) = problem.d.shape();
    let (method, needed) = match side {
        Side::Left => (Method::LeftInverse, spots),
        Side::Right => (Method::RightInverse, elements),
    };
    let laser = decompose(method, problem, options.tolerance)?;
    let (rank, cutoff) = laser.cut(options.tolerance)?;
    if rank < needed {
        return Err(RecoveryError::NotFullRank {
            method,
            rank,
            needed,
            elements,
            spots,
        });
    }
    let qr = pivoted_qr_to(&problem.d.transpose(), options.tolerance)?;
    let solve: Quotient = match side {
        Side::Left => PivotedQr::minimum_norm,
        Side::Right => PivotedQr::basic,
    };
    let choice = Choice::Tolerance { cutoff };
    Inverse::solved(problem, options, laser.sigma, (qr, rank), solve, choice)
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::num::linalg::{Tolerance, pinv};
    use crate::recovery::bench::Bench;
    use crate::recovery::recover as by_method;

    /// The laws D_L D = 1 and D D_R = 1 and, both being D⁺, the four Penrose conditions, through
    /// the map Φ → X of the method itself: with C = 1 and one pixel, Φ = e_l gives row l of D^#.
    #[test]
    fn each_inverts_from_its_side() {
        let bench = Bench::new(6.0, 3, 1);
        let wide = bench.d.clone();
        let few = wide.columns(0, 120).select_columns(&[0, 17, 45, 90]);
        for (method, d) in [(Method::RightInverse, wide), (Method::LeftInverse, few)] {
            let (elements, spots) = d.shape();
            let c = DMatrix::from_element(1, elements, 1.0);
            let mut sharp = DMatrix::zeros(spots, elements);
            for l in 0..spots {
                let phi = DMatrix::from_fn(1, spots, |_, i| f64::from(u8::from(i == l)));
                let problem = Problem::new(&phi, &c, &d, None).unwrap();
                let found = by_method(method, &problem, &Options::default()).unwrap();
                sharp.row_mut(l).copy_from(&found.reflectance.transpose());
            }
            let known = pinv(&d, Tolerance::Auto).unwrap();
            let rounding = 100.0 * f64::EPSILON * known.sigma[0] / known.sigma[known.rank - 1];
            let [ds, sd] = [&d * &sharp, &sharp * &d];
            let identity = match method {
                Method::LeftInverse => &sd,
                _ => &ds,
            };
            let size = identity.nrows();
            assert!((identity - DMatrix::identity(size, size)).amax() < rounding);
            assert!((&ds - ds.transpose()).amax() < rounding);
            assert!((&sd - sd.transpose()).amax() < rounding);
            assert!((&ds * &d - &d).norm() < rounding * d.norm());
            assert!((&sd * &sharp - &sharp).norm() < rounding * sharp.norm());
            assert!((sharp - &known.matrix).norm() < rounding * known.matrix.norm());
        }
    }

    #[test]
    fn where_the_rank_does_not_allow_it_they_say_so() {
        let bench = Bench::new(3.0, 8, 2);
        let phi = bench.phi(&bench.board(2));
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        // 64 elements under 120 spots: never a left inverse; a right one only if no direction is
        // lost in rounding.
        for (method, needed) in [(Method::LeftInverse, 120), (Method::RightInverse, 64)] {
            let error = by_method(method, &problem, &Options::default()).unwrap_err();
            let said = error.to_string();
            assert!(
                matches!(error, RecoveryError::NotFullRank { needed: n, rank, .. } if n == needed && rank < 64),
                "{said}"
            );
            assert!(
                said.contains("pinv") && said.contains("120 spots"),
                "{said}"
            );
        }
    }
}
