//! How it is to be inverted.

use crate::num::linalg::Tolerance;
use crate::num::named::named;

named! {
    /// How the parameter of `tsvd`, `tikhonov` and `tikhonov-gradient` is chosen where it is not
    /// given.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Rule {
        /// Morozov's discrepancy principle: the strongest regularisation whose residual the noise
        /// explains. Needs the standard errors of Φ.
        #[default]
        Discrepancy = "discrepancy":
            "The strongest regularisation whose residual the noise explains",
        /// Generalised cross-validation: the regularisation that best predicts entries left out.
        /// Needs no noise model; takes the errors as equal and independent.
        Gcv = "gcv": "Generalised cross-validation; needs no noise model",
        /// The corner of the L-curve, log ‖solution‖ over log ‖residual‖. Needs no noise model.
        LCurve = "l-curve": "The corner of the L-curve; needs no noise model",
    }
}

named! {
    /// By what the joint methods weigh the entries of Φ.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub enum WeightRule {
        /// By the noise, where standard errors are given: separable weights fitted to 1/σ², and
        /// 1/σ² of each entry where that is no product of one by pixel and one by spot.
        #[default]
        Noise = "noise": "By the noise, where it is known",
        /// By 1/σ² of each entry, where standard errors are given: by normal equations that hold
        /// what the noise leaves, or by all rows where they do not and these are few enough.
        Entries = "entries":
            "By the noise of each entry, as joint-gp and more than 512 elements have it",
        /// All alike.
        Unweighted = "none": "All alike",
    }
}

/// How much the methods that work pixel by pixel tell of their uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Uncertainty {
    /// All: standard errors, their covariance matrix and the resolution matrix, r × r each; about
    /// p·r² + l·(p·k² + k·r²) operations for p pixels, l spots, r elements and k the few numerical
    /// ranks of 1/C.
    #[default]
    Full,
    /// Standard errors alone: p·l·r operations and no matrix of elements × elements.
    StandardError,
}

impl Uncertainty {
    /// Elements whose covariance and resolution are still told: 32 MiB each.
    pub const MOST_CORRELATED: usize = 2048;

    /// How much of it fits so many elements.
    pub fn of(elements: usize) -> Self {
        if elements <= Self::MOST_CORRELATED {
            Self::Full
        } else {
            Self::StandardError
        }
    }
}

/// Choices of the methods; the default leaves each to its own rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Where `pinv`, the divisions and `joint-unbounded` cut the rank.
    pub tolerance: Tolerance,
    /// How many singular directions `tsvd` keeps; by `rule` where not given.
    pub rank: Option<usize>,
    /// The damping λ of `tikhonov` as a fraction of D's largest singular value (of
    /// `tikhonov-gradient`: of the largest in standard form); by `rule` where not given.
    pub damping: Option<f64>,
    /// How `tsvd`, `tikhonov` and `tikhonov-gradient` choose what is not given.
    pub rule: Rule,
    /// How much the methods that work pixel by pixel tell of their uncertainty.
    pub uncertainty: Uncertainty,
    /// Largest number of entries of the compressed Khatri–Rao product that `joint` forms (8 bytes
    /// each, up to three copies). Above it the rows that are lost in rounding are left out, and
    /// where that is not enough the Gram matrix is used, whose condition is squared.
    pub budget: usize,
    /// Weights of the joint methods.
    pub weighting: WeightRule,
    /// The strength λ of `joint-tv` as a fraction of σ₁², σ₁ the largest singular value of the
    /// weighted operator; by the largest evidence where not given.
    pub total_variation: Option<f64>,
    /// The reflectances \[dark, light\] of `joint-two-valued`; estimated with the pattern where not
    /// given.
    pub levels: Option<[f64; 2]>,
    /// Whether `joint-two-valued` sums over patterns, searches widely for the best one, and takes
    /// the likeliest where neighbours are alike if that is settled; seconds in place of tenths.
    pub probabilities: bool,
    /// Whether these sums allow for elements that differ from their level, where levels are not
    /// given.
    pub spreads: bool,
    /// Confidence level, in (0, 1), of the bands to be computed ([`Bands`](super::Bands)); none
    /// where not given.
    pub bands: Option<f64>,
    /// Columns and rows of a photograph, pixel column + row·columns. Where the noise is unknown
    /// `joint-gp` takes what it leaves over for noise: with these of neighbours that err alike,
    /// without of pixels that err independently.
    pub frame: Option<[usize; 2]>,
    /// Whether `joint-gp` takes it for noise of single pixels and a field that neighbours share
    /// ([`ErrorField`](super::ErrorField)), in place of noise that so many pixels share. For light
    /// from elsewhere that no polynomial has; where the geometry alone is a little off, the other
    /// comes nearer to the picture.
    pub error_field: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            tolerance: Tolerance::Auto,
            rank: None,
            damping: None,
            rule: Rule::Discrepancy,
            uncertainty: Uncertainty::Full,
            budget: 1 << 24,
            weighting: WeightRule::Noise,
            total_variation: None,
            levels: None,
            probabilities: true,
            spreads: true,
            bands: None,
            frame: None,
            error_field: false,
        }
    }
}
