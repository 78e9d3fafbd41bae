//! The sums over patterns of two levels: what they have in common.

use std::collections::HashMap;

use nalgebra::{DMatrix, DVector};

use super::levels::{LevelFit, rule};
use crate::num::control::Control;
use crate::recovery::{Patterns, Sum};

/// χ² = ‖R x − d‖², x_j one of two levels, given or not.
pub(super) struct Ground<'a> {
    pub(super) r: &'a DMatrix<f64>,
    pub(super) d: &'a DVector<f64>,
    /// The light of elements that are all 1.
    pub(super) all: DVector<f64>,
    pub(super) given: Option<[f64; 2]>,
    pub(super) control: Control<'a>,
}

impl<'a> Ground<'a> {
    pub(super) fn new(r: &'a DMatrix<f64>, d: &'a DVector<f64>, given: Option<[f64; 2]>) -> Self {
        let all = r.column_sum();
        Self {
            r,
            d,
            all,
            given,
            control: Control::none(),
        }
    }

    /// The light of the light elements.
    pub(super) fn lit(&self, light: &[bool]) -> DVector<f64> {
        let mut sum = DVector::zeros(self.d.len());
        for (column, _) in self.r.column_iter().zip(light).filter(|(_, light)| **light) {
            sum += column;
        }
        sum
    }
}

impl Ground<'_> {
    /// ln of a pattern's weight, all levels that are possible together where they are not given; none
    /// where only one level is there.
    pub(super) fn log_weight(&self, light: &[bool]) -> Option<f64> {
        let lit = self.lit(light);
        match self.given {
            Some([dark, light]) => {
                let left = self.d - &self.all * dark - lit * (light - dark);
                Some(-0.5 * left.norm_squared())
            }
            None => {
                let fit = LevelFit::new(self.d, &(&self.all - &lit), &lit)?;
                Some(fit.weight(&rule())?.log)
            }
        }
    }
}

/// What was summed over patterns and levels.
pub(super) struct Summed {
    pub(super) moments: Moments,
    /// Weights by pattern: all that count, or those that were met.
    pub(super) weights: HashMap<Vec<bool>, f64>,
    pub(super) log_evidence: f64,
    pub(super) sum: Sum,
    /// The best that was met.
    pub(super) best: Vec<bool>,
    /// Some that were met, with their weights and levels; none where all were summed.
    pub(super) drawn: Vec<(f64, Vec<bool>, [f64; 2])>,
}

impl Summed {
    /// The same with no less evidence than a pattern alone has, of the weight e^`log`: all patterns have
    /// no less, though sampling may not have met it.
    pub(super) fn with_known(self, log: Option<f64>) -> Self {
        let all = self.best.len() as f64 * std::f64::consts::LN_2;
        let known = log.unwrap_or(f64::NEG_INFINITY) - all;
        Self {
            log_evidence: self.log_evidence.max(known),
            ..self
        }
    }

    /// The probabilities, with that of the pattern that is recovered.
    pub(super) fn finish(&self, recovered: &[bool]) -> Patterns {
        let own = self.weights.get(recovered).copied().unwrap_or(0.0);
        let share = own / self.moments.weight;
        self.moments.finish(share, self.log_evidence, self.sum)
    }
}

/// Weighted sums over patterns and levels.
#[derive(Clone)]
pub(super) struct Moments {
    pub(super) weight: f64,
    light: DVector<f64>,
    mean: DVector<f64>,
    square: DVector<f64>,
    levels: [[f64; 2]; 2],
}

impl Moments {
    pub(super) fn new(n: usize) -> Self {
        Self {
            weight: 0.0,
            light: DVector::zeros(n),
            mean: DVector::zeros(n),
            square: DVector::zeros(n),
            levels: [[0.0; 2]; 2],
        }
    }

    /// Adds a pattern; `levels` are the means of dark and light level and of their squares.
    pub(super) fn add(&mut self, light: &[bool], weight: f64, levels: [[f64; 2]; 2]) {
        self.weight += weight;
        for (j, light) in light.iter().enumerate() {
            let [first, second] = levels[usize::from(*light)];
            self.light[j] += weight * f64::from(u8::from(*light));
            self.mean[j] += weight * first;
            self.square[j] += weight * second;
        }
        for (sum, level) in self.levels.iter_mut().zip(levels) {
            sum[0] += weight * level[0];
            sum[1] += weight * level[1];
        }
    }

    /// The sum of several.
    pub(super) fn together(all: &[Self]) -> Self {
        let mut sum = Self::new(all[0].light.len());
        for own in all {
            sum.weight += own.weight;
            sum.light += &own.light;
            sum.mean += &own.mean;
            sum.square += &own.square;
            for (sum, own) in sum.levels.iter_mut().zip(own.levels) {
                sum[0] += own[0];
                sum[1] += own[1];
            }
        }
        sum
    }

    /// All of it times a factor.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self {
            weight: factor * self.weight,
            light: &self.light * factor,
            mean: &self.mean * factor,
            square: &self.square * factor,
            levels: self.levels.map(|level| level.map(|x| x * factor)),
        }
    }

    /// Probability of each element to be light.
    pub(super) fn light(&self) -> DVector<f64> {
        &self.light / self.weight
    }

    /// E (ℓ_j − x_j)² of the elements' levels ℓ.
    pub(super) fn square_about(&self, x: &DVector<f64>) -> DVector<f64> {
        let [mean, square] = [&self.mean, &self.square].map(|sum| sum / self.weight);
        DVector::from_fn(x.len(), |j, _| {
            (square[j] - 2.0 * x[j] * mean[j] + x[j] * x[j]).max(0.0)
        })
    }

    /// The whole, a pattern's share of it and the evidence known.
    pub(super) fn finish(&self, pattern: f64, log_evidence: f64, sum: Sum) -> Patterns {
        let mean = &self.mean / self.weight;
        let square = &self.square / self.weight;
        let spread = |first: f64, second: f64| (second - first * first).max(0.0).sqrt();
        let of = |k: usize| self.levels[k].map(|x| x / self.weight);
        let levels = [of(0), of(1)];
        Patterns {
            light: self.light(),
            deviation: mean.zip_map(&square, spread),
            mean,
            levels: levels.map(|[first, _]| first),
            level_errors: levels.map(|[first, second]| spread(first, second)),
            pattern,
            exact: 1.0,
            spread: 0.0,
            log_evidence,
            sum,
        }
    }
}
