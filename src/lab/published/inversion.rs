//! The published inversion without noise, by its projector.
//!
//! X = Φ·G12⁺ with Φ = (B ∘ G23)·G12 is (B ∘ G23)·P, P = G12·G12⁺ = U_k U_kᵀ over the k singular
//! directions that the tolerance keeps. Computed so, the rounding of Φ, which G12⁺ multiplies by
//! the condition, is left out, and r·k numbers take the place of r².

use super::outcome::{Outcome, Trial};
use crate::lab::recovered::inversion::noiseless;
use crate::model::Published;
use crate::num::linalg::{LinalgError, Svd, Tolerance, cut, svd};

/// Recovers boards of `boards` checks a side under each of `tolerances`: (B ∘ G23)·P ⊘ G23, mean
/// over the pixels.
pub(super) fn recovered(
    case: &Published,
    tolerances: &[Tolerance],
    boards: &[usize],
) -> Result<Vec<Trial>, LinalgError> {
    let (g12, g23) = (case.g12(), case.g23());
    let Svd { u, sigma, .. } = svd(&g12)?;
    let sigma = sigma.as_slice();
    let trial = |tolerance: &Tolerance| {
        let (rank, cutoff) = cut(sigma, g12.nrows(), g12.ncols(), *tolerance)?;
        let kept = u.columns(0, rank).into_owned();
        let outcome = |checks: &usize| {
            let board = case.board(*checks);
            Outcome::new(noiseless(&g23, &board, &kept), &board)
        };
        let found = boards.iter().map(outcome).collect();
        Ok(Trial::new(sigma, rank, cutoff, found))
    };
    tolerances.iter().map(trial).collect()
}

#[cfg(test)]
mod tests {
    use super::super::case::published;
    use super::*;
    use crate::model::{Kernel, Stagger};
    use crate::recovery::{Method, Options, Problem, recover};

    /// Far from the cut only the rounding of Φ, multiplied by the condition, is between projector
    /// and recovery.
    #[test]
    fn it_is_the_recovery_by_the_pseudo_inverse() {
        for (elements, kernel) in [(2, Kernel::Physical), (4, Kernel::Published)] {
            let case = published(kernel, elements, 10, 3.0, Stagger::OneInch);
            let own = recovered(&case, &[Tolerance::Spacing], &[2]).unwrap();
            let (phi, c, d) = (case.phi(&case.board(2)), case.g23(), case.g12());
            let problem = Problem::new(&phi, &c, &d, None).unwrap();
            let options = Options {
                tolerance: Tolerance::Spacing,
                ..Options::default()
            };
            let found = recover(Method::Pinv, &problem, &options).unwrap();
            assert_eq!(found.rank, own[0].rank);
            let bound = 100.0 * f64::EPSILON * own[0].condition;
            assert!(bound < 1e-3, "{bound:e}");
            for (a, b) in own[0].found[0].values.iter().zip(found.reflectance.iter()) {
                assert!((a - b).abs() < bound, "{elements}: {a} for {b}, {bound:e}");
            }
        }
    }
}
