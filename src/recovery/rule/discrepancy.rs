//! Morozov's discrepancy principle with equivalent degrees of freedom.
//!
//! A regularised inverse with filter factors f_i maps Φ to Φ P, P = Σ f_i v_i v_iᵀ (v_i the right
//! singular vectors of D). Of independent noise with variances σ²\[p,l\] it leaves over
//!
//! > target² = Σ_pl σ²\[p,l\] (1 − P_ll),
//!
//! exactly E‖N(1 − P)‖² where directions are kept or dropped, and for damped ones the
//! equivalent-degrees-of-freedom form of it (Hall and Titterington 1987), whose root exists in
//! expectation. ‖N(1 − P)‖² scatters about it by at most √(2 Σ σ⁴ (1 − P_ll)); two of those are
//! allowed:
//!
//! > ‖Φ P − Φ‖² ≤ limit² = target² + 2 √(2 Σ σ⁴ (1 − P_ll))
//!
//! and the strongest regularisation that satisfies it is taken; where none does the weakest, if
//! that is within four of them.

use super::Data;
use crate::recovery::{Choice, Method, Problem, RecoveryError, Spectrum};

/// Everything of Φ and its noise that the residual depends on.
pub(in crate::recovery) struct Discrepancy<'s> {
    parameter: &'static str,
    data: Data<'s>,
    /// Σ σ² and Σ σ⁴ in all, and along each v_i: Σ_l (Σ_p σ²) v_il².
    variance: f64,
    variance_along: Vec<f64>,
    fourth: f64,
    fourth_along: Vec<f64>,
}

/// Squares of the three norms of [`Choice::Discrepancy`].
#[derive(Debug, Clone, Copy)]
pub(in crate::recovery) struct Level {
    residual: f64,
    target: f64,
    limit: f64,
}

impl Level {
    pub(in crate::recovery) fn accepted(&self) -> bool {
        self.residual <= self.limit
    }

    pub(in crate::recovery) fn choice(&self) -> Choice {
        Choice::Discrepancy {
            residual: self.residual.sqrt(),
            target: self.target.sqrt(),
            limit: self.limit.sqrt(),
        }
    }
}

impl<'s> Discrepancy<'s> {
    /// For filters on the directions of `spectrum`. Errors name `parameter` as what could be given
    /// instead.
    pub(in crate::recovery) fn new(
        method: Method,
        parameter: &'static str,
        problem: &Problem<'_>,
        spectrum: &'s Spectrum,
    ) -> Result<Self, RecoveryError> {
        let stderr = match (problem.noise(), problem.stderr) {
            (Some(stderr), _) => stderr,
            (None, Some(_)) => return Err(RecoveryError::NoNoise { method, parameter }),
            (None, None) => return Err(RecoveryError::NoNoiseModel { method, parameter }),
        };
        let powers = |exponent: i32| -> Vec<f64> {
            stderr
                .column_iter()
                .map(|c| c.iter().map(|s| s.powi(exponent)).sum())
                .collect()
        };
        let project = |per_spot: &[f64]| -> Vec<f64> {
            spectrum
                .data
                .row_iter()
                .map(|v| v.iter().zip(per_spot).map(|(v, s)| v * v * s).sum())
                .collect()
        };
        let (second, fourth) = (powers(2), powers(4));
        let all = Discrepancy {
            parameter,
            data: Data::new(problem, spectrum),
            variance: second.iter().sum(),
            variance_along: project(&second),
            fourth: fourth.iter().sum(),
            fourth_along: project(&fourth),
        };
        let none = all.level(&vec![0.0; spectrum.len()]);
        if none.accepted() {
            return Err(RecoveryError::NoSignal {
                signal: none.residual.sqrt(),
                limit: none.limit.sqrt(),
                parameter,
            });
        }
        Ok(all)
    }

    /// Residual, target and limit for filter factors in [0, 1].
    pub(in crate::recovery) fn level(&self, filter: &[f64]) -> Level {
        let left = |whole: f64, along: &[f64]| {
            (whole - along.iter().zip(filter).map(|(x, f)| x * f).sum::<f64>()).max(0.0)
        };
        let target = left(self.variance, &self.variance_along);
        let limit = target + 2.0 * (2.0 * left(self.fourth, &self.fourth_along)).sqrt();
        Level {
            residual: self.data.residual(filter),
            target,
            limit,
        }
    }

    /// The weakest regularisation where none is accepted: right photographs leave so much over once
    /// in forty. Within four deviations it is taken.
    ///
    /// # Errors
    /// [`RecoveryError::NoiseUnderstated`] beyond.
    pub(in crate::recovery) fn weakest(&self, weakest: Level) -> Result<Choice, RecoveryError> {
        let surely = Level {
            limit: weakest.target + 2.0 * (weakest.limit - weakest.target),
            ..weakest
        };
        if surely.accepted() {
            return Ok(surely.choice());
        }
        Err(RecoveryError::NoiseUnderstated {
            residual: surely.residual.sqrt(),
            limit: surely.limit.sqrt(),
            parameter: self.parameter,
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::num::linalg::svd;
    use crate::recovery::bench::{Bench, normal_stream};

    /// The target is the mean of ‖N(1 − P)‖² over noise, and two allowed deviations cover at least
    /// 95 of 100 draws.
    #[test]
    fn target_and_limit_describe_pure_noise() {
        let bench = Bench::new(3.0, 4, 4);
        let laser = svd(&bench.d).unwrap();
        let spectrum = Spectrum::of(&laser, 16);
        let stderr = DMatrix::from_fn(16, 120, |p, l| 1.0 + (p % 3) as f64 + (l % 4) as f64);
        let mut normal = normal_stream(21);
        let (trials, kept) = (400, 6);
        let (mut sum, mut squares, mut inside) = (0.0, 0.0, 0);
        let mut target = 0.0;
        for _ in 0..trials {
            let noise = stderr.map(|s| s * normal());
            // A huge planted signal along v_1 keeps "no signal" away and is removed by P exactly.
            let phi = &noise + DMatrix::from_element(16, 1, 1e6) * laser.vt.rows(0, 1);
            let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
            let all = Discrepancy::new(Method::Tsvd, "rank", &problem, &spectrum).unwrap();
            let level = all.level(&spectrum.truncated(kept));
            target = level.target;
            sum += level.residual;
            squares += level.residual * level.residual;
            inside += usize::from(level.accepted());
        }
        let mean = sum / f64::from(trials);
        let spread = (squares / f64::from(trials) - mean * mean).sqrt();
        assert!(
            (mean - target).abs() < 5.0 * spread / f64::from(trials).sqrt(),
            "{mean} {target} {spread}"
        );
        assert!(inside >= 380, "{inside}");
    }

    /// Where none is accepted the weakest is taken within four deviations of its target, and is an
    /// error beyond.
    #[test]
    fn the_weakest_is_taken_within_four_deviations() {
        let bench = Bench::new(3.0, 4, 4);
        let laser = svd(&bench.d).unwrap();
        let spectrum = Spectrum::of(&laser, 16);
        let phi = &bench.c * &bench.d;
        let stderr = phi.map(|_| 1e-3 * phi.amax());
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let all = Discrepancy::new(Method::Tsvd, "rank", &problem, &spectrum).unwrap();
        let of = |deviations: f64| Level {
            residual: 100.0 + 0.5 * deviations * 20.0,
            target: 100.0,
            limit: 120.0,
        };
        for (deviations, is_taken) in [(2.1, true), (3.9, true), (4.1, false)] {
            assert!(!of(deviations).accepted());
            assert_eq!(
                all.weakest(of(deviations)).is_ok(),
                is_taken,
                "{deviations}"
            );
        }
    }

    /// Of fewer spots than elements the weakest regularisation leaves nothing over, where no noise
    /// is left: it is accepted, and its rounding is no misfit.
    #[test]
    fn what_leaves_nothing_over_is_accepted() {
        let bench = Bench::new(3.0, 4, 4);
        let mut normal = normal_stream(3);
        for spots in [3, 7, 10] {
            let d = bench.d.columns(0, spots).into_owned();
            let phi = (&bench.c * &d).map(|x| 1e-12 * x * (1.0 + 1e-4 * normal()));
            let laser = svd(&d).unwrap();
            let spectrum = Spectrum::of(&laser, spots);
            let stderr = phi.map(|x| 1e-9 * x);
            let problem = Problem::new(&phi, &bench.c, &d, Some(&stderr)).unwrap();
            let all = Discrepancy::new(Method::Tsvd, "rank", &problem, &spectrum).unwrap();
            let level = all.level(&spectrum.truncated(spots));
            assert!(level.accepted(), "{spots}: {level:?}");
        }
    }
}
