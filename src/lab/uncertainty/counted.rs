//! Noise of counts, and how far it is from normal.
//!
//! Of light x the variance σ² = a + b x + c x² is that of counts of b each, beside normal noise:
//! b x is Poisson's, whose third and fourth cumulants are b² x and b³ x. A deviate over σ has the
//! skewness and the excess
//!
//! > γ = b² x/σ³,   κ = b³ x/σ⁴:   1/√n and 1/n of n counts alone,
//!
//! so that of 3 counts one lies 4 standard errors off 17 times as often as a normal number does.

use super::light_law::LightLaw;

/// What is known of such noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counted {
    /// That of σ².
    pub law: LightLaw,
    /// The mean κ of all entries.
    pub excess: f64,
}

impl Counted {
    /// Of these standard errors, W; none where nothing is counted.
    pub(in crate::lab) fn new<'a>(
        law: LightLaw,
        stderr: impl Iterator<Item = &'a f64>,
    ) -> Option<Self> {
        let own = Self { law, excess: 0.0 };
        let counted = stderr.filter(|s| **s > 0.0);
        let (sum, count) =
            counted.fold((0.0, 0.0), |(sum, n), s| (sum + own.excess_of(*s), n + 1.0));
        (law.0[1] > 0.0 && count > 0.0).then_some(Self {
            excess: sum / count,
            ..own
        })
    }

    /// κ of an entry of this standard error, W.
    pub(in crate::lab) fn excess_of(self, stderr: f64) -> f64 {
        self.law.0[1] / stderr * self.skewness(stderr)
    }

    /// γ of an entry of this standard error, W.
    pub(super) fn skewness(self, stderr: f64) -> f64 {
        let LightLaw([a, b, c]) = self.law;
        let of_light = (stderr * stderr - a).max(0.0);
        // The larger root of b x + c x².
        let light = 2.0 * of_light / (b + (b * b + 4.0 * c * of_light).max(0.0).sqrt());
        b * b * light / (stderr * stderr * stderr)
    }

    /// The same of light over `scale`.
    pub(in crate::lab) fn over(self, scale: f64) -> Self {
        Self {
            law: self.law.over(scale),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of counts alone γ = 1/√n and κ = 1/n; beside normal noise a and c of itself by the
    /// cumulants.
    #[test]
    fn cumulants_by_hand() {
        let counts = [4.0f64, 25.0];
        let stderr = counts.map(f64::sqrt);
        let own = Counted::new(LightLaw([0.0, 1.0, 0.0]), stderr.iter()).unwrap();
        for (n, s) in counts.iter().zip(stderr) {
            assert!((own.skewness(s) - 1.0 / n.sqrt()).abs() < 1e-15);
        }
        assert!((own.excess - 0.5 * (0.25 + 0.04)).abs() < 1e-15);
        let (x, [a, b, c]) = (30.0, [2.0, 0.5f64, 0.01]);
        let s = f64::sqrt(a + b * x + c * x * x);
        let own = Counted::new(LightLaw([a, b, c]), [s].iter()).unwrap();
        assert!((own.skewness(s) - b * b * x / s.powi(3)).abs() < 1e-15);
        assert!((own.excess - b.powi(3) * x / s.powi(4)).abs() < 1e-15);
        assert!((own.over(3.0).skewness(s / 3.0) - own.skewness(s)).abs() < 1e-15);
        assert!(Counted::new(LightLaw([a, 0.0, c]), [s].iter()).is_none());
    }
}
