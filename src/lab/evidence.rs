//! What a model is tested with, and how.

use super::eliminated::Eliminated;
use crate::matrix::Matrix;
use crate::transport::Estimator;

/// A picture that explains the photographs is rejected with this probability.
pub const FIT_LEVEL: f64 = 1e-3;

/// How the errors of traced entries hang together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Errors {
    /// Every entry has its own random numbers.
    Independent,
    /// Entries of one pixel share theirs: only different rows are independent.
    WithinRows,
    /// All entries share theirs.
    Everywhere,
}

/// A part that is common, times the spots, above which errors are no longer independent: 5 % of the
/// error of their mean.
const NOTICED: f64 = 0.1;

impl Errors {
    /// Every way.
    pub const ALL: [Errors; 3] = [Self::Independent, Self::WithinRows, Self::Everywhere];

    /// The name by which it is asked for.
    pub fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::WithinRows => "pixel",
            Self::Everywhere => "all",
        }
    }

    /// Those of an estimator.
    pub fn of(estimator: Estimator) -> Self {
        match estimator {
            Estimator::Independent => Self::Independent,
            Estimator::Shared => Self::WithinRows,
            Estimator::Factored => Self::Everywhere,
        }
    }

    /// Those of photographs of `spots` spots, a part `common` of whose variance all spots of a
    /// pixel have in common: the error of their mean is √(1 + c (l − 1)) times that of independent
    /// ones.
    pub fn of_common(common: f64, spots: usize) -> Self {
        Self::of_photographs(common * spots as f64 > NOTICED)
    }

    /// Those of photographs, all spots of a pixel of which share some or not.
    pub fn of_photographs(shares_by_pixel: bool) -> Self {
        if shares_by_pixel {
            Self::WithinRows
        } else {
            Self::Independent
        }
    }

    /// Which entries share their errors, in words: a recovery adds up entries as if none did.
    pub fn shared(self) -> Option<&'static str> {
        match self {
            Self::Independent => None,
            Self::WithinRows => Some("all spots of a pixel share theirs"),
            Self::Everywhere => Some("all entries share theirs"),
        }
    }
}

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
    /// Whether an entry counts.
    pub(super) fn counts(&self, at: usize) -> bool {
        self.left_out.is_none_or(|flags| flags[at] == 0.0)
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
    /// Replicates from which each standard error was estimated.
    pub replicates: u32,
    /// How the errors hang together.
    pub errors: Errors,
}

/// Degrees of freedom of a standard error from so many replicates.
pub(super) fn freedom(replicates: u32) -> f64 {
    f64::from(replicates.max(2) - 1)
}

impl Test {
    /// Degrees of freedom of each standard error.
    pub(super) fn freedom(&self) -> f64 {
        freedom(self.replicates)
    }
}
