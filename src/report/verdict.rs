//! The verdict of a run in one sentence.

use super::axis::significant;
use crate::study::{Agreement, RunResults};

/// What the agreement test says, with its numbers; `DISAGREE` in capitals where it fails.
pub(super) fn verdict(results: &RunResults) -> String {
    let Some(a) = &results.agreement else {
        return match results.model {
            Some(_) => "traced light was not compared with the model".to_owned(),
            None => "no model to compare with: the scene hides nothing".to_owned(),
        };
    };
    sentence(a)
}

/// The sentence for one agreement test.
pub(super) fn sentence(a: &Agreement) -> String {
    let word = if a.agrees { "agree" } else { "DISAGREE" };
    format!(
        "traced and {} model {word}: χ²/dof {} over {} entries, largest |z| {} of {} allowed",
        a.kernel,
        significant(a.chi2_per_dof, 4),
        a.entries,
        significant(a.largest_z, 2),
        significant(a.z_limit, 2),
    )
}
