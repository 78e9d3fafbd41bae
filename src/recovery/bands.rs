//! Bands around recovered reflectances, and how often they cover.
//!
//! Linear estimates have ρ̂ ± z σ, each element alone. Estimates between bounds have no such law: the
//! χ² that an element costs where it is held at its true value follows χ² of one degree of freedom
//! only where no bound is near. A light element among
//! eight dark ones, at the levels 1 and 0 on the bench, is then covered by 95 % bands in 59 seeds of
//! 100 (400 seeds; χ² of two degrees: 79; quantiles by a bootstrap from ρ̂ do little better), because
//! the columns of its neighbours surround its own.
//!
//! So the bands of `joint` and `nnls` are the shadows of one region that holds all elements at once:
//! [`BandKind::Simultaneous`].
//!
//! The region promises no more than it must: in that case it covers in 95 seeds of 100.
//!
//! Regularised methods are biased by far more than their noise, and their bias is not known without
//! the truth: ρ̂ ± z σ of `tsvd` covered 0.8 % where it said 95 %. They have no bands.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::{Method, Options, Problem, RecoveryError, WeightRule};
use crate::num::linalg::{rows_times, svd};
use crate::num::quadratic::{Bounds, box_least_squares, extent};
use crate::num::statistics::{chi_square_quantile, sidak_threshold};

/// What a band is, and so what it promises of each element taken alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum BandKind {
    /// ρ̂ ± z σ of an unbiased linear estimate: covers with exactly its confidence under normal
    /// noise of the stated standard errors.
    Gaussian,
    /// The probability of ρ_j given the photographs and the method's assumption, as much beyond either
    /// limit: covers as often as it says **on average over pictures as the assumption describes
    /// them**, not for every picture.
    Posterior,
    /// The values of ρ_j among all reflectances within the bounds that are as near to the data as the
    /// truth is with the stated probability,
    ///
    /// > { ρ_j : l ≤ ρ ≤ u, ‖R ρ − d‖² ≤ q },   P(χ²_k ≤ q) = confidence,
    ///
    /// d the k directions of the data, in standard deviations, that reflectances between 0 and 1 can
    /// move by more than one (Stark 1992). For any ρ within the bounds and normal noise of the stated
    /// errors **all elements together** are covered with at least that probability, so each alone is
    /// covered more often: how much more depends on the object. Limits are certified from outside: an
    /// inexact solver makes a band wider.
    Simultaneous,
}

/// An interval for each element.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bands {
    /// Probability that each alone covers, or all together, by `kind`.
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
pub(super) fn gaussian(estimate: &DVector<f64>, sigma: &DVector<f64>, confidence: f64) -> Bands {
    let z = deviate(confidence);
    let pairs = estimate.iter().zip(sigma.iter());
    Bands {
        confidence,
        intervals: pairs.map(|(x, s)| [x - z * s, x + z * s]).collect(),
        kind: BandKind::Gaussian,
    }
}

/// What [`simultaneous`] needs: residuals in standard deviations, and a scale.
pub(super) fn simultaneous_allowed<'a>(
    method: Method,
    problem: &Problem<'a>,
    options: &Options,
) -> Result<&'a DMatrix<f64>, RecoveryError> {
    let stderr = problem.noise().ok_or(without_noise(method))?;
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
    Ok(stderr)
}

/// Why photographs that nothing explains have no bands.
const REFUTED: &str =
    "has no bands: no reflectances within its bounds explain the photographs at this confidence";
/// Why a biased estimate has none.
pub(super) const BIASED: &str = "has no bands: regularisation, dropped directions or a free scale bias the picture \
                                 by an amount that the photographs do not tell";

/// The shadows of { l ≤ x ≤ u, ‖R x − d‖² ≤ q } on each axis, the covariance of d being the unit
/// matrix; where there is nothing in it, why.
pub(super) fn simultaneous(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    bounds: &Bounds,
    confidence: f64,
) -> Result<Result<Bands, &'static str>, RecoveryError> {
    let decomposed = svd(r)?;
    let rows = rows_times(decomposed.vt, &decomposed.sigma);
    let data = decomposed.u.tr_mul(d);
    // Which directions count is a matter of R alone: any choice of them keeps the promise.
    let seen: Vec<usize> = (0..rows.nrows())
        .filter(|&i| rows.row(i).iter().map(|x| x.abs()).sum::<f64>() > 1.0)
        .collect();
    let (rows, data) = (rows.select_rows(&seen), data.select_rows(&seen));
    let whole = |j: usize| [bounds.lower[j], bounds.upper[j]];
    let intervals = if seen.is_empty() {
        (0..r.ncols()).map(whole).collect()
    } else {
        let best = box_least_squares(&rows, &data, bounds)?;
        let room = chi_square_quantile(confidence, seen.len() as f64) - 2.0 * best.objective;
        if room < 0.0 {
            return Ok(Err(REFUTED));
        }
        let of = |j| extent(&rows, &data, bounds, &best.solution, room, j);
        (0..r.ncols()).map(of).collect::<Result<_, _>>()?
    };
    Ok(Ok(Bands {
        confidence,
        intervals,
        kind: BandKind::Simultaneous,
    }))
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

    /// Directions that are dropped leave no bands, and it is said why.
    #[test]
    fn a_biased_picture_has_no_bands() {
        assert_eq!(bands(Method::Pinv, 2, 1e-3, 1).0.kind, BandKind::Gaussian);
        let bench = Bench::new(6.0, 4, 8);
        let exact = bench.phi(&bench.board(2));
        let stderr = &exact * 1e-2;
        let problem = Problem::new(&exact, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let options = Options {
            bands: Some(0.95),
            ..Options::default()
        };
        let found = recover(Method::Tsvd, &problem, &options).unwrap();
        assert_eq!((found.bands, found.no_bands), (None, Some(BIASED)));
    }

    /// Where no bound holds, the shadows of the ellipsoid ‖R x − d‖² ≤ q: ρ̂ ± √q σ, as the rows are
    /// as many as the elements. At the edges of the board they are cut by the bounds.
    #[test]
    fn the_region_is_the_ellipsoid_where_no_bound_holds() {
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
        // The 95 % point of χ² of 4 degrees, from tables.
        let half = 9.4877_f64.sqrt();
        for method in [Method::Joint, Method::Nnls] {
            let bands = of(method).bands.unwrap();
            assert_eq!(bands.kind, BandKind::Simultaneous);
            let sigma = free.standard_error.as_ref().unwrap();
            for (j, [lower, upper]) in bands.intervals.into_iter().enumerate() {
                // `joint-unbounded` weighs by a separable fit, and this noise is not quite that.
                let near = 0.05 * half * sigma[j];
                let centre = free.reflectance[j];
                assert!(
                    (lower - (centre - half * sigma[j])).abs() < near,
                    "{j} {lower}"
                );
                assert!(
                    (upper - (centre + half * sigma[j])).abs() < near,
                    "{j} {upper}"
                );
            }
        }
        let ends: Vec<[f64; 2]> = (0..8)
            .flat_map(|seed| bands(Method::Joint, 2, 1e-2, seed).0.intervals)
            .collect();
        assert!(ends.iter().all(|[a, b]| *a >= 0.0 && *b <= 1.0 && a < b));
        assert!(ends.iter().any(|i| i[0] == 0.0) && ends.iter().any(|i| i[1] == 1.0));
    }

    /// One light element among dark ones, the case in which a profile of χ² covers that element in
    /// 59 seeds of 100: the neighbours' columns surround its own. Here it is covered as often as
    /// promised, and hardly more often: 400 seeds at 95 % give 380 ± 4.4, 99.9 % of the binomial 364
    /// … 393; the limits from outside and rows left out may add to it.
    #[test]
    #[ignore = "slow"]
    fn a_lone_light_element_is_covered_as_promised() {
        let bench = Bench::new(3.0, 3, 8);
        let truth = DVector::from_fn(9, |j, _| if j == 4 { 1.0 } else { 0.0 });
        let exact = bench.phi(&truth);
        let stderr = &exact * 1e-2;
        let options = Options {
            bands: Some(0.95),
            ..Options::default()
        };
        let covered = (0..400).filter(|seed| {
            let mut normal = normal_stream(1000 + seed);
            let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
            let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
            let found = recover(Method::Nnls, &problem, &options).unwrap();
            found
                .bands
                .is_some_and(|b| b.covered(truth.as_slice()) == 9)
        });
        let covered = covered.count();
        assert!((364..=397).contains(&covered), "{covered}");
    }

    /// Photographs that no reflectances explain have no bands, and it is said.
    #[test]
    fn a_refuted_model_has_no_bands() {
        let bench = Bench::new(6.0, 2, 4);
        let phi = bench.phi(&bench.board(2)) * 3.0;
        let stderr = &phi * 1e-3;
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let options = Options {
            bands: Some(0.95),
            ..Options::default()
        };
        let found = recover(Method::Joint, &problem, &options).unwrap();
        assert_eq!((found.bands, found.no_bands), (None, Some(REFUTED)));
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
