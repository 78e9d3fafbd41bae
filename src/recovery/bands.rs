//! Bands around recovered reflectances, and how often they cover.
//!
//! Measured: share of 4 × 4 elements of a board of levels 0.1 and 0.9 within their 95 % bands, 200
//! seeds, 120 spots at half-width 6, 8 × 8 pixels, normal noise relative to each entry. (Errors of
//! the elements of a seed go together, so the shares scatter by about 1.5 %.)
//!
//! | method | kind | noise 1e-2 | noise 1e-3 | mean width at 1e-3 |
//! | --- | --- | --- | --- | --- |
//! | `joint-unbounded` | Gaussian | 0.939 | 0.939 | 0.62 |
//! | `pinv` | Gaussian | 0.947 | 0.947 | 1.2 |
//! | `joint` | profile | 0.998 | 0.988 | 0.19 |
//! | `nnls` | profile | 0.996 | 0.984 | 0.22 |
//! | `tsvd` | Gaussian around its mean | 0.008 | 0.108 | 0.016 |
//! | `tikhonov` | Gaussian around its mean | 0.038 | 0.003 | 0.015 |
//!
//! Regularised methods are biased by far more than their noise: their bands say how well the
//! estimate repeats, not where the reflectance is.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::{Method, Options, Problem, RecoveryError, WeightRule};
use crate::num::quadratic::{Bounds, extent};
use crate::num::statistics::sidak_threshold;

/// What a band is, and so what it promises of each element taken alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum BandKind {
    /// ρ̂ ± z σ of an unbiased linear estimate: covers with exactly its confidence under normal
    /// noise of the stated standard errors.
    Gaussian,
    /// ρ̂ ± z σ of a linear estimate with a bias (directions dropped or damped), or of an
    /// approximation of first order (free scale). The bias is left out, so it covers the estimate's
    /// mean, **not** the reflectance, with its confidence.
    GaussianAroundMean,
    /// All values of ρ_j with which some reflectances within the bounds fit nearly as well as the
    /// best,
    ///
    /// > { ρ_j : min χ² with ρ_j held ≤ min χ² + z² }.
    ///
    /// Exact where no bound holds (it is ρ̂ ± z σ then). With bounds it is the interval of Rust and
    /// Burrus (1972), whose coverage of at least the confidence was long conjectured; there are
    /// problems of several unknowns where it falls somewhat short (Batlle, Stanley, Patil, Kuusela
    /// and Owhadi 2023), so no guarantee is given: count it ([`Bands::covered`]). Limits are
    /// certified from outside: an inexact solver makes a band wider.
    Profile,
}

/// An interval for each element.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bands {
    /// Probability that each alone shall cover.
    pub confidence: f64,
    /// \[lower, upper\] of each element.
    pub intervals: Vec<[f64; 2]>,
    /// What they are.
    pub kind: BandKind,
}

impl Bands {
    /// How many elements' `truth` lies within its interval. Elements beyond either list are not
    /// counted.
    pub fn covered(&self, truth: &[f64]) -> usize {
        let within = |([lower, upper], x): (&[f64; 2], &f64)| lower <= x && x <= upper;
        self.intervals
            .iter()
            .zip(truth)
            .filter(|&pair| within(pair))
            .count()
    }
}

/// The z with P(|N(0, 1)| ≤ z) = confidence.
fn deviate(confidence: f64) -> f64 {
    sidak_threshold(1.0 - confidence, 1)
}

/// Refuses a confidence without meaning, and methods that know of no error.
pub(super) fn allowed(method: Method, confidence: f64) -> Result<(), RecoveryError> {
    if !(confidence > 0.0 && confidence < 1.0) {
        return Err(RecoveryError::BadParameter {
            method,
            name: "the confidence level of bands",
            value: confidence,
            cure: "give a probability between 0 and 1, e.g. 0.95",
        });
    }
    match method {
        Method::JointTv | Method::JointTwoValued => Err(RecoveryError::NotForMethod {
            method,
            what: "has no bands: what its assumption adds is not known from the data",
            cure: "ask for bands of joint, nnls or a linear method",
        }),
        _ => Ok(()),
    }
}

/// The refusal of bands without a noise model.
pub(super) fn without_noise(method: Method) -> RecoveryError {
    RecoveryError::NotForMethod {
        method,
        what: "needs to know the noise for its bands",
        cure: "give the standard error of phi (phi.stderr.npy)",
    }
}

/// `estimate` ± z σ.
pub(super) fn gaussian(
    estimate: &DVector<f64>,
    sigma: &DVector<f64>,
    kind: BandKind,
    confidence: f64,
) -> Bands {
    let z = deviate(confidence);
    let pairs = estimate.iter().zip(sigma.iter());
    Bands {
        confidence,
        intervals: pairs.map(|(x, s)| [x - z * s, x + z * s]).collect(),
        kind,
    }
}

/// What [`profile`] needs: residuals in standard deviations, and a scale.
pub(super) fn profile_allowed(
    method: Method,
    problem: &Problem<'_>,
    options: &Options,
) -> Result<(), RecoveryError> {
    if problem.noise().is_none() {
        return Err(without_noise(method));
    }
    let refuse = |what, cure| Err(RecoveryError::NotForMethod { method, what, cure });
    if options.weighting == WeightRule::Unweighted {
        return refuse(
            "has bands only where entries are weighted by their noise",
            "leave the weighting to the noise",
        );
    }
    if problem.nuisance.free_scale {
        return refuse(
            "has no bands with a free scale",
            "give the scale, or ask for the bands of joint-unbounded",
        );
    }
    Ok(())
}

/// The profile of χ² = ‖R x − d‖² around its minimum `best` between bounds.
pub(super) fn profile(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    bounds: &Bounds,
    best: &DVector<f64>,
    confidence: f64,
) -> Result<Bands, RecoveryError> {
    let z = deviate(confidence);
    let intervals = (0..best.len())
        .map(|j| extent(r, d, bounds, best, z * z, j))
        .collect::<Result<_, _>>()?;
    Ok(Bands {
        confidence,
        intervals,
        kind: BandKind::Profile,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::bench::{Bench, normal_stream};
    use crate::recovery::recover;

    fn bands(method: Method, elements: usize, noise: f64, seed: u64) -> (Bands, usize) {
        let bench = Bench::new(6.0, elements, 8);
        let board = bench.board(2);
        let exact = bench.phi(&board);
        let stderr = &exact * noise;
        let mut normal = normal_stream(seed);
        let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let options = Options {
            bands: Some(0.95),
            ..Options::default()
        };
        let bands = recover(method, &problem, &options).unwrap().bands.unwrap();
        let covered = bands.covered(board.as_slice());
        (bands, covered)
    }

    /// 200 seeds of 16 elements. Were the elements of a seed independent, the share would scatter
    /// by 0.4 %; two in a hundred are allowed.
    #[test]
    fn bands_of_an_unbiased_method_cover_as_often_as_they_say() {
        let mut covered = 0;
        for seed in 0..200 {
            let (bands, count) = bands(Method::JointUnbounded, 4, 1e-3, seed);
            assert_eq!(bands.kind, BandKind::Gaussian);
            covered += count;
        }
        let share = covered as f64 / 3200.0;
        assert!((share - 0.95).abs() < 0.02, "{share}");
    }

    #[test]
    fn dropped_directions_are_confessed() {
        assert_eq!(bands(Method::Pinv, 2, 1e-3, 1).0.kind, BandKind::Gaussian);
        assert_eq!(
            bands(Method::Tsvd, 4, 1e-2, 1).0.kind,
            BandKind::GaussianAroundMean
        );
    }

    /// Inside the bounds the profile is ρ̂ ± z σ; at the edges of the board it is cut by them.
    #[test]
    fn the_profile_is_the_gaussian_band_where_no_bound_holds() {
        let bench = Bench::new(6.0, 2, 8);
        let exact = bench.phi(&DVector::from_row_slice(&[0.4, 0.5, 0.6, 0.5]));
        let stderr = &exact * 1e-3;
        let mut normal = normal_stream(5);
        let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let options = Options {
            bands: Some(0.95),
            ..Options::default()
        };
        let of = |method| recover(method, &problem, &options).unwrap();
        let free = of(Method::JointUnbounded);
        for method in [Method::Joint, Method::Nnls] {
            let bounded = of(method).bands.unwrap();
            assert_eq!(bounded.kind, BandKind::Profile);
            for (a, b) in bounded
                .intervals
                .iter()
                .zip(&free.bands.as_ref().unwrap().intervals)
            {
                // Covariance by the noise itself against separable weights: the noise of this bench
                // is not quite separable.
                assert!((a[0] - b[0]).abs() < 0.05 * (b[1] - b[0]), "{a:?} {b:?}");
                assert!((a[1] - b[1]).abs() < 0.05 * (b[1] - b[0]), "{a:?} {b:?}");
            }
        }
        let ends: Vec<[f64; 2]> = (0..8)
            .flat_map(|seed| bands(Method::Joint, 2, 1e-2, seed).0.intervals)
            .collect();
        assert!(ends.iter().all(|[a, b]| *a >= 0.0 && *b <= 1.0 && a < b));
        assert!(ends.iter().any(|i| i[0] == 0.0) && ends.iter().any(|i| i[1] == 1.0));
    }

    #[test]
    fn what_has_no_bands_says_why() {
        let bench = Bench::new(6.0, 2, 4);
        let phi = bench.phi(&bench.board(2));
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        for (method, confidence) in [
            (Method::Joint, 0.95),
            (Method::JointUnbounded, 0.95),
            (Method::JointTwoValued, 0.95),
            (Method::Pinv, 1.0),
            (Method::Pinv, f64::NAN),
        ] {
            let options = Options {
                bands: Some(confidence),
                ..Options::default()
            };
            let error = recover(method, &problem, &options).unwrap_err();
            assert!(
                matches!(
                    error,
                    RecoveryError::NotForMethod { .. } | RecoveryError::BadParameter { .. }
                ),
                "{method} {error}"
            );
        }
    }
}
