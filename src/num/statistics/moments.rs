//! Running mean and variance.

/// Count, mean and sum of squared deviations of a sequence of numbers, by Welford's recurrence
///
/// > mean ← mean + (x − mean)/n,   M₂ ← M₂ + (x − old mean)(x − new mean)
///
/// which does not cancel where the spread is small beside the mean.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moments {
    count: u64,
    mean: f64,
    m2: f64,
}

impl Moments {
    /// No numbers yet.
    pub fn new() -> Self {
        Moments::default()
    }

    /// Takes one more number.
    pub fn push(&mut self, x: f64) {
        self.count += 1;
        let from_old = x - self.mean;
        self.mean += from_old / self.count as f64;
        self.m2 += from_old * (x - self.mean);
    }

    /// The moments of both sequences together (Chan, Golub and LeVeque). The bits depend on the order of merging: fix it.
    pub fn merge(self, other: Moments) -> Moments {
        if self.count == 0 || other.count == 0 {
            return if self.count == 0 { other } else { self };
        }
        let count = self.count + other.count;
        let share = other.count as f64 / count as f64;
        let apart = other.mean - self.mean;
        Moments {
            count,
            mean: self.mean + apart * share,
            m2: self.m2 + other.m2 + apart * apart * self.count as f64 * share,
        }
    }

    /// How many numbers.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Their mean; `None` of no numbers.
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then_some(self.mean)
    }

    /// M₂, the sum of squared deviations from the mean; 0 of no numbers.
    pub fn m2(&self) -> f64 {
        self.m2
    }

    /// The unbiased variance M₂/(n − 1); `None` of fewer than two.
    pub fn variance(&self) -> Option<f64> {
        (self.count > 1).then(|| self.m2 / (self.count - 1) as f64)
    }

    /// The variance of the mean of independent numbers, M₂/(n (n − 1)); `None` of fewer than two.
    pub fn variance_of_mean(&self) -> Option<f64> {
        self.variance().map(|v| v / self.count as f64)
    }
}

impl Extend<f64> for Moments {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, numbers: I) {
        numbers.into_iter().for_each(|x| self.push(x));
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(numbers: I) -> Self {
        let mut moments = Moments::new();
        moments.extend(numbers);
        moments
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_sequence() {
        // 1..=n: mean (n + 1)/2, M₂ = n(n² − 1)/12.
        let m: Moments = (1..=100).map(f64::from).collect();
        assert_eq!((m.count(), m.mean()), (100, Some(50.5)));
        assert!((m.m2() - 83_325.0).abs() < 1e-9);
        assert!((m.variance_of_mean().unwrap() - 83_325.0 / 9900.0).abs() < 1e-12);
    }

    #[test]
    fn a_large_offset_does_not_cancel() {
        // 1e9 + {4, 7, 13, 16}: variance 30; by Σx² − n x̄² nothing of it would be left right.
        let m: Moments = [4.0, 7.0, 13.0, 16.0]
            .into_iter()
            .map(|x| 1e9 + x)
            .collect();
        assert!((m.variance().unwrap() - 30.0).abs() < 1e-6);
    }

    #[test]
    fn merging_is_pushing() {
        let x = |i: i32| 3.0 + f64::from((i * 37) % 101);
        let whole: Moments = (0..1000).map(x).collect();
        for cut in [0, 1, 500, 999, 1000] {
            let merged = (0..cut)
                .map(x)
                .collect::<Moments>()
                .merge((cut..1000).map(x).collect());
            assert_eq!(merged.count(), 1000);
            assert!((merged.mean().unwrap() / whole.mean().unwrap() - 1.0).abs() < 1e-14);
            assert!((merged.m2() / whole.m2() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn too_few_numbers_have_no_variance() {
        assert_eq!(
            (Moments::new().mean(), Moments::new().variance()),
            (None, None)
        );
        let one: Moments = [5.0].into_iter().collect();
        assert_eq!((one.mean(), one.variance_of_mean()), (Some(5.0), None));
    }
}
