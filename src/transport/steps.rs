//! Piecewise constant distributions.

/// A distribution on [0, 1) that is constant on steps of equal width, and its inverse distribution function.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    /// Cumulative probability, from 0 to exactly 1; steps + 1 entries.
    sums: Vec<f64>,
    /// 1/probability of each step.
    inverse: Vec<f64>,
    /// By k of as many equal parts of [0, 1): the step in which k/n falls.
    guide: Vec<u32>,
}

impl Steps {
    /// Probabilities in proportion to `weights`, uniform if all of them vanish.
    pub(super) fn new(weights: impl Iterator<Item = f64>) -> Self {
        let mut sums = vec![0.0];
        for w in weights {
            sums.push(sums[sums.len() - 1] + w);
        }
        let n = sums.len() - 1;
        let total = sums[n];
        if total > 0.0 {
            sums.iter_mut().for_each(|s| *s /= total);
            sums[n] = 1.0;
        } else {
            sums = (0..=n).map(|i| i as f64 / n as f64).collect();
        }
        let inverse = sums.windows(2).map(|s| 1.0 / (s[1] - s[0])).collect();
        let step = |k: usize| sums.partition_point(|s| *s <= k as f64 / n as f64) - 1;
        let guide = (0..n).map(|k| step(k).min(n - 1) as u32).collect();
        Self {
            sums,
            inverse,
            guide,
        }
    }

    /// Probability of a step.
    pub(super) fn share(&self, step: usize) -> f64 {
        self.sums[step + 1] - self.sums[step]
    }

    /// The step and the place in [0, 1) at which the distribution function is x ∈ [0, 1).
    pub(super) fn invert(&self, x: f64) -> (usize, f64) {
        let n = self.guide.len();
        let part = ((x * n as f64) as usize).min(n - 1);
        let mut i = self.guide[part] as usize;
        // The guide may be one rounding too far: x·n ≥ k does not prove x ≥ k/n.
        while i > 0 && self.sums[i] > x {
            i -= 1;
        }
        while self.sums[i + 1] <= x {
            i += 1;
        }
        let t = ((x - self.sums[i]) * self.inverse[i]).clamp(0.0, 1.0 - f64::EPSILON);
        (i, (i as f64 + t) / n as f64)
    }

    /// Smallest m for which every edge of a step is a multiple of 2⁻ᵐ, if there is one up to `most`.
    pub(super) fn digits(&self, most: u32) -> Option<u32> {
        let whole = |m: u32| {
            let scale = f64::from(1u32 << m);
            self.sums
                .iter()
                .all(|s| ((s * scale).round() - s * scale).abs() < 1e-9)
        };
        (0..=most.min(30)).find(|m| whole(*m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The map is continuous and onto: equal steps in u give places whose step never falls, and the ends of the unit interval stay
    /// inside.
    #[test]
    fn distribution_functions_invert() {
        let steps = Steps::new([0.0, 2.0, 0.0, 1.0, 0.0].into_iter());
        let mut last = 0.0;
        for k in 0..1000 {
            let (i, x) = steps.invert(f64::from(k) / 1000.0);
            assert!(i == 1 || i == 3, "an empty step was chosen");
            assert!(x >= last && x < 1.0);
            last = x;
        }
        let (i, x) = steps.invert(1.0 - f64::EPSILON);
        assert!(i == 3 && x < 0.8);
        // Two thirds of the weight lie in step 1: u = 1/3 is its middle.
        assert!((steps.invert(1.0 / 3.0).1 - 0.3).abs() < 1e-12);
        assert!((steps.share(3) - 1.0 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn edges_on_dyadic_lines_are_told_from_others() {
        let digits = |w: &[f64]| Steps::new(w.iter().copied()).digits(16);
        assert_eq!(digits(&[1.0]), Some(0));
        assert_eq!(digits(&[0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0]), Some(2));
        assert_eq!(digits(&[3.0, 5.0]), Some(3));
        assert_eq!(digits(&[1.0, 1.0, 1.0]), None);
    }
}
