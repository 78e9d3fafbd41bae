//! How likely each element is to be light, where there are two levels.

use nalgebra::DVector;
use serde::Serialize;

/// How the probabilities of patterns were found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sum {
    /// Over all patterns.
    Exhaustive,
    /// Of the likeliest patterns one by one, of the others by chance.
    Sampled {
        /// Patterns that were drawn.
        draws: usize,
        /// Share of the probability that was summed pattern by pattern.
        listed: f64,
        /// By how much an element's probability may be off: twice its standard error, what two
        /// samplings differ in, or the share of patterns that both are likely to have missed.
        disagreement: f64,
    },
}

impl Sum {
    /// Largest [`Sum::Sampled::disagreement`] at which probabilities are to be believed.
    pub const AGREEMENT: f64 = 0.1;

    /// Whether the probabilities are to be believed.
    pub fn converged(self) -> bool {
        match self {
            Self::Exhaustive => true,
            Self::Sampled { disagreement, .. } => disagreement <= Self::AGREEMENT,
        }
    }
}

/// What the photographs say of a picture of two levels, every pattern being equally likely
/// beforehand, and so every pair of levels 0 ≤ dark < light ≤ 1 where they are not given; then
/// elements may also differ from their level, by a normal deviate.
#[derive(Debug, Clone, PartialEq)]
pub struct Patterns {
    /// Probability of each element to be light.
    pub light: DVector<f64>,
    /// Mean of each element's level over all patterns and levels.
    pub mean: DVector<f64>,
    /// Standard deviation of each about it.
    pub deviation: DVector<f64>,
    /// Means of the dark and of the light level.
    pub levels: [f64; 2],
    /// Their standard deviations; 0 where they were given.
    pub level_errors: [f64; 2],
    /// Probability of the pattern that was recovered, its levels exact, by all.
    pub pattern: f64,
    /// Probability that the elements do not differ from their levels, ½ beforehand; 1 where the
    /// levels were given.
    pub exact: f64,
    /// The likeliest standard deviation by which they do, if they do; 0 where the levels were
    /// given.
    pub spread: f64,
    /// ln of the probability density of the photographs if the levels are exact, over that of the
    /// numbers that fit them best.
    pub log_evidence: f64,
    /// How it was found.
    pub sum: Sum,
    /// What it is where neighbours may be alike: what hangs on every pattern being as likely. None
    /// where that is not known.
    pub if_alike: Option<IfAlike>,
}

/// Pattern and levels where neighbours are alike by an unknown degree beforehand, as those of a
/// board or a letter are and those of a fair coin for each element are not; the levels exact.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IfAlike {
    /// Probability of the pattern that was recovered.
    pub pattern: f64,
    /// Means of the dark and of the light level.
    pub levels: [f64; 2],
    /// Their standard deviations; 0 where they were given.
    pub level_errors: [f64; 2],
    /// Mean of each element's level over all patterns and levels.
    #[serde(skip)]
    pub mean: DVector<f64>,
    /// Standard deviation of each about it.
    #[serde(skip)]
    pub deviation: DVector<f64>,
}
