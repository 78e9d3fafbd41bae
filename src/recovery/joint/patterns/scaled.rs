//! Patterns of given levels where the light has a common factor that is known beforehand
//! ([`super::factor`]): the search for the likeliest, and the problem linear in the factor about
//! one, from which lattices draw. As all linear problems it is right near its pattern alone: a dark
//! one has little light for the factor to multiply.

use nalgebra::{DMatrix, DVector};

use super::factor::Factor;
use super::pattern_likelihood::PatternLikelihood;
use super::pattern_search::{Found, Levels, Search};
use super::pattern_sums::WeighedPatterns;
use crate::recovery::{Deviations, RecoveryError};

/// Problems about a pattern that are searched at most for a likelier one.
const MOST_STEPS: usize = 8;

/// Where a search ended.
pub(super) struct Near {
    /// The likeliest pattern.
    pub(super) light: Vec<bool>,
    /// The problem linear about it.
    pub(super) linear: (DMatrix<f64>, DVector<f64>),
    /// What is found of that.
    pub(super) found: Found,
}

/// The problem of given levels whose factor is known to `sigma`.
#[derive(Clone, Copy)]
pub(super) struct Scaled<'a> {
    likelihood: &'a PatternLikelihood<'a>,
    levels: [f64; 2],
    sigma: f64,
}

impl<'a> Scaled<'a> {
    /// None where levels are not given, or the light has no such factor.
    pub(super) fn of(likelihood: &'a PatternLikelihood<'a>) -> Option<Self> {
        let (levels, sigma) = likelihood.given.zip(likelihood.scale_error)?;
        Some(Self {
            likelihood,
            levels,
            sigma,
        })
    }

    /// R x of a pattern.
    fn light(&self, light: &[bool]) -> DVector<f64> {
        let of = self.likelihood;
        of.light(&of.lit(light), self.levels)
    }

    fn factor(&self, light: &[bool]) -> Factor {
        Factor::new(&self.light(light), self.likelihood.d, self.sigma)
    }

    /// R and d linear in s about a pattern, s integrated over: with m̂ its light,
    ///
    /// > d + (ŝ − 1) m̂ = ŝ R x + (s − 1) m̂ + ν,   of covariance 1 + σ² m̂ m̂ᵀ.
    pub(super) fn about(&self, light: &[bool]) -> (DMatrix<f64>, DVector<f64>) {
        let (of, m) = (self.likelihood, self.light(light));
        let off = Factor::new(&m, of.d, self.sigma).off;
        let size = m.norm_squared();
        // (1 + σ² m mᵀ)^(−½) = 1 − less m mᵀ.
        let root = (1.0 + self.sigma * self.sigma * size).sqrt();
        let less = if size > 0.0 {
            (1.0 - root.recip()) / size
        } else {
            0.0
        };
        let d = of.d + &m * off;
        let r = of.r * (1.0 + off);
        let along = r.tr_mul(&m) * less;
        let d = &d - &m * (less * m.dot(&d));
        (r - &m * along.transpose(), d)
    }

    /// The likeliest pattern that is found: from those of the best fits with any factor and without
    /// one, by searches linear about the likeliest before.
    pub(super) fn search(&self) -> Result<Near, RecoveryError> {
        let of = self.likelihood;
        let best = |r: &DMatrix<f64>, d: &DVector<f64>, levels| -> Result<Found, RecoveryError> {
            Search::new(r, d, levels).under(of.control).best()
        };
        let log = |light: &Vec<bool>| self.factor(light).log;
        let ratio = best(of.r, of.d, Levels::Ratio(self.levels))?.best.light;
        let own = best(of.r, of.d, Levels::Given(self.levels))?.best.light;
        let mut at = if log(&own) > log(&ratio) { own } else { ratio };
        let mut steps = 0;
        loop {
            let linear = self.about(&at);
            let found = best(&linear.0, &linear.1, Levels::Given(self.levels))?;
            if steps == MOST_STEPS || log(&found.best.light) <= log(&at) {
                let light = at;
                return Ok(Near {
                    light,
                    linear,
                    found,
                });
            }
            at = found.best.light;
            steps += 1;
        }
    }

    /// ŝ − 1 of the pattern that is shown, with an error that other patterns are part of, if known.
    pub(super) fn deviation(
        &self,
        shown: &[bool],
        patterns: Option<&WeighedPatterns>,
    ) -> Deviations {
        let own = self.factor(shown);
        let mut square = own.variance;
        if let Some(patterns) = patterns {
            let (mut sum, mut all) = (0.0, 0.0);
            for (light, weight) in patterns.in_order() {
                let other = self.factor(light);
                sum += weight * ((other.off - own.off).powi(2) + other.variance);
                all += weight;
            }
            square = sum / all;
        }
        Deviations {
            size: DVector::from_element(1, own.off),
            standard_error: DVector::from_element(1, square.sqrt()),
            known_to: self.sigma,
            picture_given: patterns.is_none(),
        }
    }
}
