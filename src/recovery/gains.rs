//! Deviations of the light that are known only roughly, as they were estimated.
//!
//! > Φ\[p,l\] = (1 + ε)(1 + ε_l) s Σ_j C\[p,j\] ρ_j D\[j,l\] + …,   ε_l ~ N(0, σ_g²),   ε ~ N(0, σ_s²)

use nalgebra::{DMatrix, DVector};

use crate::num::statistics::squares_or_largest;

/// Relative deviations of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Deviations {
    /// ε̂: of each frame, or the one of all.
    pub size: DVector<f64>,
    /// Their standard errors; of one picture's prior at most `known_to`.
    pub standard_error: DVector<f64>,
    /// σ, to which they are known beforehand.
    pub known_to: f64,
    /// Whether the standard errors hold the picture for known, as those of methods that know of no
    /// error of theirs must: they are too small then.
    pub picture_given: bool,
}

impl Deviations {
    /// Largest |ε̂|/σ.
    pub fn largest(&self) -> f64 {
        self.size.amax() / self.known_to
    }

    /// How many of them the photographs determine, Σ (1 − e²/σ²), e their standard errors.
    pub fn freedom(&self) -> f64 {
        let known = |e: &f64| (1.0 - (e / self.known_to).powi(2)).max(0.0);
        self.standard_error.iter().map(known).sum()
    }

    /// Probability of as large a Σ ε̂²/σ², or of as large an |ε̂|/σ, if the factors are as they
    /// were said to be, with as many degrees of freedom as factors are determined, which is the
    /// mean of the sum. None where less than one is.
    pub fn probability(&self) -> Option<f64> {
        let freedom = self.freedom();
        let chi2 = self.size.norm_squared() / (self.known_to * self.known_to);
        (freedom >= 1.0).then(|| squares_or_largest(chi2, self.largest(), freedom))
    }
}

/// What was estimated of factors that are known only roughly.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Gains {
    /// ε_l of each frame.
    pub frames: Option<Deviations>,
    /// ε, one for all photographs.
    pub whole: Option<Deviations>,
    /// Linear problems that were solved until the factors no longer changed.
    pub steps: usize,
    /// Whether they no longer changed: by no more than 1e-4 of σ.
    pub settled: bool,
    /// Mean standard error of the reflectances over what it would be with these factors known;
    /// absent of methods without standard errors. Of `joint-gp`, which then averages over other
    /// spreads and lengths, it can be below 1.
    pub widened: Option<f64>,
}

impl Gains {
    /// Degrees of freedom that they use up.
    pub(super) fn freedom(&self) -> f64 {
        let both = [&self.frames, &self.whole];
        both.into_iter().flatten().map(Deviations::freedom).sum()
    }

    /// Light with these factors, pixels × spots.
    pub(super) fn times(&self, mut light: DMatrix<f64>) -> DMatrix<f64> {
        let whole = self.whole.as_ref().map_or(0.0, |of| of.size[0]);
        for (l, mut frame) in light.column_iter_mut().enumerate() {
            let own = self.frames.as_ref().map_or(0.0, |of| of.size[l]);
            frame *= (1.0 + whole) * (1.0 + own);
        }
        light
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of three known to 0.1, errors 0.1, 0.06 and 0: 0, 0.64 and 1 are determined.
    #[test]
    fn what_is_determined_by_hand() {
        let factors = Deviations {
            size: DVector::from_column_slice(&[0.0, 0.05, -0.12]),
            standard_error: DVector::from_column_slice(&[0.1, 0.06, 0.0]),
            known_to: 0.1,
            picture_given: false,
        };
        assert!((factors.freedom() - 1.64).abs() < 1e-12);
        assert!((factors.largest() - 1.2).abs() < 1e-12);
        let two = Deviations {
            standard_error: DVector::from_column_slice(&[0.1, 0.0, 0.0]),
            ..factors
        };
        // χ² of two degrees: e^(−x/2) = 0.43; the larger of two beyond 1.2, by tables, is less.
        let expected = 2.0 * (1.0 - (1.0 - 0.230_139_34f64).powi(2));
        assert!((two.probability().unwrap() - expected).abs() < 1e-7);
        let even = Deviations {
            size: DVector::from_column_slice(&[0.0, 0.15, -0.15]),
            ..two
        };
        let expected = 2.0 * libm::exp(-0.5 * 4.5);
        assert!((even.probability().unwrap() - expected).abs() < 1e-9);
    }
}
