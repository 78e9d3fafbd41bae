//! Sums over patterns of two levels, and what they say of each element.

use std::collections::HashMap;

use nalgebra::DVector;

use crate::recovery::{Patterns, Sum};

/// Of a mean square, what rounding leaves of a variance.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Patterns by their weights, and what they add up to.
pub(super) struct WeighedPatterns {
    pub(super) moments: Moments,
    /// All that count, or those that were met.
    pub(super) weights: HashMap<Vec<bool>, f64>,
}

impl WeighedPatterns {
    /// Probability of a pattern.
    pub(super) fn share(&self, light: &[bool]) -> f64 {
        self.weights.get(light).copied().unwrap_or(0.0) / self.moments.weight
    }

    /// The likeliest pattern, and its probability.
    pub(super) fn likeliest(&self) -> Option<(&Vec<bool>, f64)> {
        let order = |a: &(&Vec<bool>, &f64), b: &(&Vec<bool>, &f64)| {
            a.1.total_cmp(b.1).then_with(|| a.0.cmp(b.0))
        };
        let (light, _) = self.weights.iter().max_by(order)?;
        Some((light, self.share(light)))
    }

    /// Patterns with their weights in an order of their own, so that sums have the same bits.
    pub(super) fn in_order(&self) -> Vec<(&Vec<bool>, f64)> {
        let mut each: Vec<(&Vec<bool>, f64)> = self.weights.iter().map(|(s, w)| (s, *w)).collect();
        each.sort_unstable_by_key(|of| of.0);
        each
    }

    /// Of the likeliest patterns, which together have `share` of the weight, the one that is
    /// expected to have the most elements right: the largest Σ_j P(element j is what s_j says).
    pub(super) fn nearest(&self, share: f64) -> Option<&Vec<bool>> {
        let mut order: Vec<(&Vec<bool>, f64)> = self.weights.iter().map(|(s, w)| (s, *w)).collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1).then_with(|| a.0.cmp(b.0)));
        let mut before = 0.0;
        let likeliest = order.into_iter().take_while(|(_, weight)| {
            let within = before < share * self.moments.weight;
            before += weight;
            within
        });
        let light = self.moments.light();
        let right = |pattern: &[bool]| -> f64 {
            let each = pattern.iter().zip(light.iter());
            each.map(|(lit, p)| if *lit { *p } else { 1.0 - p }).sum()
        };
        // The likelier of equals.
        likeliest
            .map(|(pattern, _)| (pattern, right(pattern)))
            .reduce(|best, next| if next.1 > best.1 { next } else { best })
            .map(|(pattern, _)| pattern)
    }
}

/// What was summed over patterns and levels.
pub(super) struct Summed {
    pub(super) patterns: WeighedPatterns,
    pub(super) log_evidence: f64,
    pub(super) sum: Sum,
    /// The best that was met.
    pub(super) best: Vec<bool>,
}

impl Summed {
    /// The probabilities, with that of the pattern that is recovered.
    pub(super) fn finish(&self, recovered: &[bool]) -> Patterns {
        let share = self.patterns.share(recovered);
        let moments = &self.patterns.moments;
        moments.finish(share, self.log_evidence, self.sum)
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

    /// Of elements, each `of` one of these.
    pub(super) fn of_elements(&self, of: &[usize]) -> Self {
        let each = |own: &DVector<f64>| DVector::from_fn(of.len(), |j, _| own[of[j]]);
        Self {
            weight: self.weight,
            light: each(&self.light),
            mean: each(&self.mean),
            square: each(&self.square),
            levels: self.levels,
        }
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
            let own = square[j] - 2.0 * x[j] * mean[j] + x[j] * x[j];
            own.max(ROUNDING * square[j])
        })
    }

    /// Means of dark and light level, and their standard deviations.
    pub(super) fn levels(&self) -> [[f64; 2]; 2] {
        let of = |k: usize| {
            let [first, second] = self.levels[k].map(|x| x / self.weight);
            [first, deviation(first, second)]
        };
        let [dark, light] = [of(0), of(1)];
        [[dark[0], light[0]], [dark[1], light[1]]]
    }

    /// Mean of each element's level, and the standard deviation about it.
    fn elements(&self) -> [DVector<f64>; 2] {
        let mean = &self.mean / self.weight;
        let square = &self.square / self.weight;
        let deviation = mean.zip_map(&square, deviation);
        [mean, deviation]
    }

    /// The whole, a pattern's share of it and the evidence known.
    pub(super) fn finish(&self, pattern: f64, log_evidence: f64, sum: Sum) -> Patterns {
        let [mean, deviation] = self.elements();
        let [levels, level_errors] = self.levels();
        Patterns {
            light: self.light(),
            deviation,
            mean,
            levels,
            level_errors,
            pattern,
            exact: None,
            spread: None,
            log_evidence,
            sum,
            if_alike: None,
            settled_if_alike: false,
        }
    }
}

/// Standard deviation of what has this mean and mean square.
fn deviation(mean: f64, square: f64) -> f64 {
    (square - mean * mean).max(ROUNDING * square).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: elements are light with 0.65, 0.45, 0.45, 0.4, so that of 0000, the likeliest, 2.05
    /// are expected to be right and of 1110 2.15; 1000, of 2.35, is none that was met.
    #[test]
    fn most_elements_right_by_hand() {
        let [o, i] = [false, true];
        let patterns = [
            (vec![o, o, o, o], 0.35),
            (vec![i, i, i, o], 0.25),
            (vec![i, i, o, i], 0.2),
            (vec![i, o, i, i], 0.2),
        ];
        let mut moments = Moments::new(4);
        for (light, weight) in &patterns {
            moments.add(light, *weight, [[0.0; 2], [1.0; 2]]);
        }
        let weights = patterns.into_iter().collect();
        let found = WeighedPatterns { moments, weights };
        let near = |share| found.nearest(share).unwrap().clone();
        assert_eq!(near(0.3), [o, o, o, o]);
        assert_eq!(near(0.95), [i, i, i, o]);
    }
}
