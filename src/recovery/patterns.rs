//! How likely each element is to be light, where there are two levels.

use nalgebra::DVector;
use serde::{Serialize, Serializer};

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

/// As its error, null where all patterns were summed, and whether it is to be believed.
impl Serialize for Sum {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Told {
            disagreement: Option<f64>,
            converged: bool,
        }
        let disagreement = match *self {
            Self::Exhaustive => None,
            Self::Sampled { disagreement, .. } => Some(disagreement),
        };
        let converged = self.converged();
        Told {
            disagreement,
            converged,
        }
        .serialize(serializer)
    }
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
/// beforehand (but for `if_alike`), and so every pair of levels 0 ≤ dark < light ≤ 1 where they are
/// not given; then elements may also differ from their level, by a normal deviate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Patterns {
    /// Probability of each element to be light.
    #[serde(skip)]
    pub light: DVector<f64>,
    /// Mean of each element's level over all patterns and levels.
    #[serde(skip)]
    pub mean: DVector<f64>,
    /// Standard deviation of each about it.
    #[serde(skip)]
    pub deviation: DVector<f64>,
    /// Means of the dark and of the light level.
    pub levels: [f64; 2],
    /// Their standard deviations; 0 where they were given.
    pub level_errors: [f64; 2],
    /// Probability of the pattern that was recovered and, where `exact` is asked, of exact levels.
    pub pattern: f64,
    /// Probability that the elements do not differ from their levels, ½ beforehand. None where that
    /// was not asked: of given levels, and of patterns that the picture does not go by.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<f64>,
    /// The likeliest standard deviation by which they do, if they do; none likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spread: Option<f64>,
    /// ln of the probability density of the photographs if the levels are exact, over that of the
    /// numbers that fit them best.
    pub log_evidence: f64,
    /// How it was found.
    #[serde(flatten)]
    pub sum: Sum,
    /// The same where fields of one element or of 2 × 2 are alike by an unknown degree beforehand,
    /// as those of a board or a letter are and those of a fair coin for each element are not. None
    /// where that is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub if_alike: Option<Box<Self>>,
    /// Whether the picture goes by `if_alike`: it is the likeliest pattern there, and settled. Its
    /// standard errors and `exact` are then of the same assumption.
    pub settled_if_alike: bool,
}

impl Patterns {
    /// A probability below which exactly two reflectances are not to be taken for granted.
    pub const UNLIKELY: f64 = 0.5;

    /// What was assumed for the picture and its standard errors.
    pub fn assumed(&self) -> &Self {
        match &self.if_alike {
            Some(alike) if self.settled_if_alike => alike,
            _ => self,
        }
    }

    /// What is said where neighbours may be alike, if that holds: of levels that are exact, unless
    /// the picture goes by it. None where it is not known, or they are not.
    pub fn told_if_alike(&self) -> Option<&Self> {
        let exact = self.exact.is_none_or(|p| p >= Self::UNLIKELY);
        let alike = self.if_alike.as_deref();
        alike.filter(|_| self.settled_if_alike || exact)
    }

    /// What the evidence takes for granted: that neighbours may be alike, where what that says is
    /// known. None where it is not and the sum is not to be believed.
    pub fn believed(&self) -> Option<&Self> {
        match &self.if_alike {
            Some(alike) => Some(alike),
            None => Some(self).filter(|own| own.sum.converged()),
        }
    }
}
