//! Φ/D as matrix languages divide by a matrix that is not square.
//!
//! X D = Φ ⇔ Dᵀ Xᵀ = Φᵀ, in the least-squares sense, by a QR of Dᵀ with column pivoting. Entries of
//! R's diagonal at or below max(r, l) · eps · |R₁₁| count as zero (the tolerance that MATLAB prints
//! when it warns of rank deficiency), which gives the rank k. Then
//!
//! * `rdivide`: the basic solution, as MATLAB: only k elements, those of the first k pivots, differ
//!   from zero in any pixel;
//! * `rdivide-min-norm`: the solution of least norm, as Octave and LAPACK's `gelsy`. (`gelsy`
//!   itself decides the rank by an estimate of the condition of R; here both share one rank, so
//!   that they differ in nothing but the solution chosen.)

use super::{Inverse, Quotient, decompose};
use crate::num::linalg::{PivotedQr, Tolerance, pivoted_qr_to};
use crate::recovery::{Choice, Method, Options, Problem, RecoveryError};

/// Which of the many solutions of a deficient system.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Solution {
    Basic,
    LeastNorm,
}

pub(super) fn inverse(
    problem: &Problem<'_>,
    options: &Options,
    solution: Solution,
) -> Result<Inverse, RecoveryError> {
    let method = match solution {
        Solution::Basic => Method::Rdivide,
        Solution::LeastNorm => Method::RdivideMinNorm,
    };
    let laser = decompose(method, problem, Tolerance::Auto)?;
    let qr = pivoted_qr_to(&problem.d.transpose(), options.tolerance)?;
    let (rank, cutoff) = qr.rank(options.tolerance)?;
    let choice = match options.tolerance {
        Tolerance::Rank(_) => Choice::Given,
        _ => Choice::Tolerance { cutoff },
    };
    let solve: Quotient = match solution {
        Solution::Basic => PivotedQr::basic,
        Solution::LeastNorm => PivotedQr::minimum_norm,
    };
    Inverse::solved(problem, options, laser.sigma, (qr, rank), solve, choice)
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::num::linalg::pivoted_qr;
    use crate::recovery::bench::{Bench, relative_noise};
    use crate::recovery::recover as by_method;
    use crate::recovery::{Parameter, Recovered};

    fn both(problem: &Problem<'_>, options: &Options) -> [Recovered; 2] {
        [Method::Rdivide, Method::RdivideMinNorm].map(|m| by_method(m, problem, options).unwrap())
    }

    #[test]
    fn a_system_solved_by_hand() {
        // Two equal elements of weight 2 and one of weight 1, three equal spots: X D = Φ sees 2
        // x₁ + 2 x₂ + x₃ = 9 only. Basic: the first longest row of D takes it all, x = (4.5, 0,
        // 0); least norm: 9 (2, 2, 1)/9.
        let d = DMatrix::from_fn(3, 3, |j, _| [2.0, 2.0, 1.0][j]);
        let c = DMatrix::from_element(1, 3, 1.0);
        let phi = DMatrix::from_element(1, 3, 9.0);
        let problem = Problem::new(&phi, &c, &d, None).unwrap();
        let [basic, least] = both(&problem, &Options::default());
        for (found, want) in [(basic, [4.5, 0.0, 0.0]), (least, [2.0, 2.0, 1.0])] {
            let want = nalgebra::DVector::from_row_slice(&want);
            assert!(
                (&found.reflectance - want).amax() < 1e-14,
                "{}",
                found.reflectance
            );
            assert_eq!((found.rank, found.parameter), (1, Parameter::Rank(1)));
        }
    }

    /// On the bench, deficient in rounding: at most rank non-zeros, and what is left over of Φ is
    /// the same for both.
    #[test]
    fn basic_and_least_norm_differ_only_in_the_solution() {
        let bench = Bench::new(3.0, 8, 8);
        let (phi, _) = relative_noise(&bench.phi(&bench.board(2)), 1e-3, 5);
        for tolerance in [
            Tolerance::Auto,
            Tolerance::Relative(1e-6),
            Tolerance::Rank(5),
        ] {
            let options = Options {
                tolerance,
                ..Options::default()
            };
            // One pixel with C = 1: the recovered values are X itself.
            let one = phi.rows(3, 1).into_owned();
            let c = DMatrix::from_element(1, 64, 1.0);
            let problem = Problem::new(&one, &c, &bench.d, None).unwrap();
            let [basic, least] = both(&problem, &options);
            assert_eq!(basic.rank, least.rank);
            let used = basic.reflectance.iter().filter(|x| **x != 0.0).count();
            assert!(used <= basic.rank, "{used} {}", basic.rank);
            // At the automatic cut rounding is amplified to the size of the solution itself: norms
            // are no longer known.
            let exact = tolerance != Tolerance::Auto;
            assert!(!exact || least.reflectance.norm() < basic.reflectance.norm());
            assert!(least.reflectance.iter().all(|x| *x != 0.0));
            // Rounding of X and what the cut leaves of D reach the residual by |X|.
            let Some(cut) = cutoff(&basic, &bench.d) else {
                panic!("{:?}", basic.choice)
            };
            let allowed = 1e-12 * one.norm() + 100.0 * cut * basic.reflectance.norm();
            assert!((basic.residual - least.residual).abs() <= allowed);
        }
    }

    /// Where the cut was, in the unit of D.
    fn cutoff(found: &Recovered, d: &DMatrix<f64>) -> Option<f64> {
        match found.choice {
            Choice::Tolerance { cutoff } => Some(cutoff),
            Choice::Given => pivoted_qr(&d.transpose())
                .ok()
                .map(|qr| qr.diagonal()[found.rank]),
            _ => None,
        }
    }

    #[test]
    fn full_rank_leaves_one_answer() {
        let bench = Bench::new(6.0, 3, 4);
        let (phi, stderr) = relative_noise(&bench.phi(&bench.board(3)), 1e-3, 6);
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let known = by_method(Method::Pinv, &problem, &Options::default()).unwrap();
        let condition = known.sigma[0] / known.sigma[8];
        for found in both(&problem, &Options::default()) {
            let error = (&found.reflectance - &known.reflectance).norm() / known.reflectance.norm();
            assert!(error < 100.0 * f64::EPSILON * condition, "{error:e}");
            let covariance =
                (found.covariance.unwrap() - known.covariance.as_ref().unwrap()).norm();
            let scale = known.covariance.as_ref().unwrap().norm();
            assert!(covariance < 100.0 * f64::EPSILON * condition * scale);
        }
    }
}
