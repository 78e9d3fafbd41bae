//! Photographs that are never held at once.
//!
//! ρ_j = (1/p) Σ_p X\[p,j\]/C\[p,j\] and its standard error are sums over pixels, and D^# knows
//! nothing of Φ: some rows of Φ, C and the standard errors after the other are enough. What is held
//! is one strip, D with its decomposition, and for standard errors a matrix of spots × elements.

use nalgebra::{DMatrix, DVector};

use super::{Inverse, inverse, refuse_unseen};
use crate::num::linalg::{product, tr_product};
use crate::recovery::bands;
use crate::recovery::problem::LitElements;
use crate::recovery::{Method, Options, Problem, Recovered, RecoveryError, Uncertainty};

/// Some rows (pixels) of a problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    /// Of Φ, W.
    pub phi: DMatrix<f64>,
    /// Of the camera side C.
    pub c: DMatrix<f64>,
    /// Of the standard errors, where they are known: of all strips or of none.
    pub stderr: Option<DMatrix<f64>>,
}

/// Recovers as [`recover`](crate::recovery::recover) does, from strips that follow each other:
/// `strip`(p) gives rows of pixels from p on, `None` where there are no more. All of them are asked
/// for twice, the second time for the residual. There is no covariance and no resolution matrix.
///
/// # Errors
/// Those of [`recover`](crate::recovery::recover), and of `strip`; [`RecoveryError::NotForMethod`]
/// for a method that needs all of Φ at once: the joint ones, and `tsvd`, `tikhonov` and
/// `tikhonov-gradient` where their parameter is not given.
pub fn recover_strips<E: From<RecoveryError>>(
    method: Method,
    d: &DMatrix<f64>,
    options: &Options,
    mut strip: impl FnMut(usize) -> Result<Option<Strip>, E>,
) -> Result<Recovered, E> {
    allowed(method, options)?;
    if let Some(confidence) = options.bands {
        bands::allowed(method, confidence)?;
    }
    let options = &Options {
        uncertainty: Uncertainty::StandardError,
        ..*options
    };
    let (elements, spots) = (d.nrows(), d.ncols());
    let mut known: Option<Inverse> = None;
    let mut sum = DVector::zeros(elements);
    let mut variance: Option<DMatrix<f64>> = None;
    let mut square = 0.0;
    let mut pixels = 0;
    while let Some(Strip { phi, c, stderr }) = strip(pixels)? {
        let problem = Problem::new(&phi, &c, d, stderr.as_ref())?;
        refuse_unseen(method, &problem)?;
        let inverse = match known.take() {
            Some(inverse) => inverse,
            None => inverse(method, &problem, options)?,
        };
        sum += inverse.sum(&problem)?;
        known = Some(inverse);
        square += phi.norm_squared();
        pixels += phi.nrows();
        if let Some(stderr) = problem.noise() {
            let share = c.map(|x| 1.0 / (x * x));
            let seen = tr_product(&stderr.component_mul(stderr), &share);
            *variance.get_or_insert_with(|| DMatrix::zeros(spots, elements)) += seen;
        }
    }
    let Some(inverse) = known.filter(|_| square > 0.0) else {
        return Err(RecoveryError::Dark.into());
    };
    let reflectance = sum / pixels as f64;
    let lit = LitElements::new(d, &reflectance)?;
    let (mut left, mut at) = (0.0, 0);
    while let Some(Strip { phi, c, .. }) = strip(at)? {
        let residual = Problem::new(&phi, &c, d, None)?.residual(&lit);
        left += residual * residual;
        at += phi.nrows();
    }
    let norms = [left.sqrt(), square.sqrt()];
    let sigma = inverse.sigma.clone();
    let mut found = Recovered::with_norms(method, norms, reflectance, sigma, inverse.rank);
    (found.parameter, found.choice) = inverse.why;
    found.effective_rank = inverse.effective_rank;
    found.standard_error = variance.map(|seen| {
        let sharp = product(&inverse.data.transpose(), &inverse.solution);
        DVector::from_fn(elements, |j, _| {
            let terms = seen.column(j).zip_map(&sharp.column(j), |v, s| v * s * s);
            terms.sum().sqrt() / pixels as f64
        })
    });
    found = found.without_errors_of_the_unseen(|| inverse.lost(d));
    if let Some(confidence) = options.bands {
        found.add_gaussian_bands(confidence)?;
    }
    Ok(found)
}

/// Refuses what needs all of Φ.
fn allowed(method: Method, options: &Options) -> Result<(), RecoveryError> {
    let refuse = |what, cure| Err(RecoveryError::NotForMethod { method, what, cure });
    if method.is_joint() || method == Method::TikhonovGradient {
        return refuse(
            "needs all photographs at once",
            "give it the memory for them, or use pinv, rdivide, tsvd or tikhonov",
        );
    }
    match method {
        Method::Tsvd if options.rank.is_none() => refuse(
            "chooses its rank from all photographs at once",
            "give the rank",
        ),
        Method::Tikhonov if options.damping.is_none() => refuse(
            "chooses its damping from all photographs at once",
            "give the damping",
        ),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::linalg::Tolerance;
    use crate::recovery::bench::{Bench, relative_noise};
    use crate::recovery::recover;

    /// Strips of any height give what all rows together give.
    #[test]
    fn strips_give_what_the_whole_gives() {
        let bench = Bench::new(6.0, 3, 6);
        let (phi, stderr) = relative_noise(&bench.phi(&bench.board(3)), 1e-3, 3);
        let options = Options {
            rank: Some(5),
            damping: Some(1e-3),
            ..Options::default()
        };
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        for method in [
            Method::Pinv,
            Method::RightInverse,
            Method::Rdivide,
            Method::RdivideMinNorm,
            Method::Tsvd,
            Method::Tikhonov,
        ] {
            let known = recover(method, &problem, &options).unwrap();
            for height in [1, 7, 36] {
                let strip = |first: usize| {
                    let count = height.min(36 - first);
                    Ok::<_, RecoveryError>((count > 0).then(|| Strip {
                        phi: phi.rows(first, count).into_owned(),
                        c: bench.c.rows(first, count).into_owned(),
                        stderr: Some(stderr.rows(first, count).into_owned()),
                    }))
                };
                let found = recover_strips(method, &bench.d, &options, strip).unwrap();
                let off = (&found.reflectance - &known.reflectance).amax();
                assert!(
                    off < 1e-9 * known.reflectance.amax(),
                    "{method} {height}: {off:e}"
                );
                let errors = (found.standard_error.unwrap())
                    .component_div(known.standard_error.as_ref().unwrap());
                assert!(errors.add_scalar(-1.0).amax() < 1e-9, "{method} {height}");
                assert!((found.residual / known.residual - 1.0).abs() < 1e-9);
                assert_eq!((found.parameter, found.rank), (known.parameter, known.rank));
            }
        }
    }

    /// Three spots tell no four elements apart: none has a finite error, by rows as by all of Φ,
    /// and one that a spot of its own lights keeps its own.
    #[test]
    fn elements_that_no_spot_tells_apart_have_no_finite_error() {
        let c = DMatrix::from_fn(6, 4, |p, j| 1.0 + (p * (j + 1)) as f64);
        let d = DMatrix::from_row_slice(4, 3, &[1., 2., 0., 3., 1., 0., 2., 2., 0., 0., 0., 5.]);
        let phi = &c * DMatrix::from_diagonal_element(4, 4, 0.5) * &d;
        let stderr = phi.map(|x| 1e-3 * x);
        let problem = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap();
        let strip = |first: usize| {
            Ok::<_, RecoveryError>((first < 6).then(|| Strip {
                phi: phi.rows(first, 2).into_owned(),
                c: c.rows(first, 2).into_owned(),
                stderr: Some(stderr.rows(first, 2).into_owned()),
            }))
        };
        for method in [Method::Pinv, Method::Rdivide, Method::RdivideMinNorm] {
            let all = recover(method, &problem, &Options::default()).unwrap();
            let rows = recover_strips(method, &d, &Options::default(), strip).unwrap();
            for found in [all, rows] {
                let errors = found.standard_error.unwrap();
                let unknown: Vec<bool> = errors.iter().map(|s| s.is_infinite()).collect();
                assert_eq!(unknown, [true, true, true, false], "{method}: {errors}");
            }
            let given = Options {
                tolerance: Tolerance::Rank(3),
                ..Options::default()
            };
            let cut = recover(method, &problem, &given).unwrap();
            assert!(cut.standard_error.unwrap().iter().all(|s| s.is_finite()));
        }
    }

    #[test]
    fn what_needs_all_photographs_says_so() {
        let bench = Bench::new(6.0, 2, 2);
        let none = |_| Ok::<Option<Strip>, RecoveryError>(None);
        for method in [
            Method::Joint,
            Method::TikhonovGradient,
            Method::Tsvd,
            Method::Tikhonov,
        ] {
            let error = recover_strips(method, &bench.d, &Options::default(), none).unwrap_err();
            assert!(
                matches!(error, RecoveryError::NotForMethod { .. }),
                "{error}"
            );
        }
        let error = recover_strips(Method::Pinv, &bench.d, &Options::default(), none);
        assert!(matches!(error, Err(RecoveryError::Dark)));
    }
}
