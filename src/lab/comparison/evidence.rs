//! What a model is tested with, and how.

use super::eliminated::Eliminated;
use crate::lab::uncertainty::certainty::Certainty;
use crate::matrix::Matrix;

/// A picture that explains the photographs is rejected with this probability.
pub const FIT_LEVEL: f64 = 1e-3;

/// What is compared.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    /// Traced Φcam, pixels × spots, W.
    pub traced: &'a Matrix,
    /// Standard error of each traced entry, W.
    pub stderr: &'a Matrix,
    /// Modelled Φcam, W.
    pub model: &'a Matrix,
    /// What the model may be off by in each entry, W ≥ 0; absent for a converged model.
    pub bound: Option<&'a Matrix>,
    /// Not 0 where an entry's error is not to be trusted: it is left out; absent if all are.
    pub left_out: Option<&'a Matrix>,
    /// What was fitted to the entries and taken out of them; absent if nothing was.
    pub eliminated: Option<&'a Eliminated>,
}

impl Evidence<'_> {
    /// Whether an entry counts: 0 ± 0 where the model is dark too is no evidence of anything.
    pub(super) fn counts(&self, at: usize) -> bool {
        let dark = [self.traced, self.model, self.stderr].map(|of| of[at]) == [0.0; 3];
        !dark && self.left_out.is_none_or(|flags| flags[at] == 0.0)
    }

    /// What is left of a deviation, W, by what was fitted first; none if that is nothing.
    pub(super) fn left_of(&self, deviation: Matrix) -> Option<Matrix> {
        match self.eliminated {
            None => Some(deviation),
            Some(terms) => terms.left_of(&deviation),
        }
    }

    /// What the model may be off by, W.
    pub(super) fn bound(&self, at: usize) -> f64 {
        self.bound.map_or(0.0, |b| b[at])
    }

    /// Rounding of the difference, W.
    pub(super) fn rounding(&self, at: usize) -> f64 {
        ROUNDING * (self.traced[at].abs() + self.model[at].abs())
    }
}

/// Two sums of positive doubles cannot be told apart more finely than this.
const ROUNDING: f64 = 1e-14;

/// How it is tested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Test {
    /// Probability of rejecting a right model.
    pub significance: f64,
    /// What is known of the standard errors.
    pub known: Certainty,
}
