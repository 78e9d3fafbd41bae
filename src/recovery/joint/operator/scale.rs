//! The size of photographs whose unit is not known.

use nalgebra::DVector;

use super::gram::{GREY, grey_factor};
use super::khatri_rao::operator;
use crate::recovery::{Options, Problem, RecoveryError};

/// s₀, what s is before the picture is known: 1, or with a free scale the factor that brings the
/// model's photographs M of a grey surface, ρ = ½, nearest to Φ:
///
/// > s₀ = ⟨Φ, M⟩/⟨M, M⟩,   weighted, other light eliminated from both, factors as they are estimated,
///
/// or ‖Φ‖/‖M‖ where that is not positive. What a method supposes of ρ it supposes of x/s₀ then, so
/// that photographs in any unit give the same picture. In the unit of Φ per W.
///
/// # Errors
/// [`RecoveryError::NO_DIRECTION`] where nothing of M or Φ is left; those of the operator.
pub(in crate::recovery::joint) fn unit(problem: &Problem<'_>) -> Result<f64, RecoveryError> {
    if !problem.nuisance.free_scale {
        return Ok(1.0);
    }
    // A factor that is known roughly multiplies this very light, and would take it.
    let known = problem.soft.map(|_| problem.with_known_factors());
    let operator = operator(known.as_ref().unwrap_or(problem), &Options::default())?;
    let directions = operator.directions()?;
    let (found, seen) = &*directions;
    let grey = &found.vt * DVector::from_element(problem.elements(), GREY);
    let grey = grey.component_mul(&found.sigma);
    let seen = seen.rows(0, grey.len());
    let size = grey_factor(seen.dot(&grey), grey.norm_squared(), seen.norm_squared());
    size.ok_or(RecoveryError::NO_DIRECTION)
}

/// Refuses photographs that hold no light of the surface, where the scale is free. With the light
/// r_j of each element and the photographs d, weighted, other light eliminated from both, the
/// least squares over ρ ≥ 0 are those of no light at all where
///
/// > r_jᵀ d ≤ 0   for every element j
///
/// (Karush, Kuhn and Tucker): whatever its reflectance, an element only adds to what is left over.
///
/// # Errors
/// [`RecoveryError::NoScale`]; those of the operator.
pub(in crate::recovery) fn refuse_no_light(
    problem: &Problem<'_>,
    options: &Options,
) -> Result<(), RecoveryError> {
    if !problem.nuisance.free_scale {
        return Ok(());
    }
    let operator = operator(problem, options)?;
    let directions = operator.directions()?;
    let (found, seen) = &*directions;
    let seen = seen.rows(0, found.sigma.len());
    let along = found.vt.tr_mul(&seen.component_mul(&found.sigma));
    let sizes = found.column_norms();
    // What rounding leaves of r_jᵀ d; an element below the rounding of the brightest has no sign.
    let rounding = f64::EPSILON * along.len() as f64;
    let least = rounding * sizes.max();
    let mut each = along.iter().zip(&sizes).filter(|(_, size)| **size > least);
    if each.any(|(along, size)| *along > rounding * size * seen.norm()) {
        Ok(())
    } else {
        Err(RecoveryError::NoScale { largest: 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::recovery::bench::{Bench, relative_noise};
    use crate::recovery::{
        Method, Nuisance, Parameter, Recovered, determined, picard_joint, recover,
    };

    const JOINT: [Method; 6] = [
        Method::JointUnbounded,
        Method::Joint,
        Method::Nnls,
        Method::JointGp,
        Method::JointTv,
        Method::JointTwoValued,
    ];

    /// s₀ by hand: Φ of 3.7 times a grey of ½, and with light of its own in each frame.
    #[test]
    fn the_size_of_a_grey_surface() {
        let bench = Bench::new(6.0, 4, 8);
        let grey = bench.phi(&DVector::from_element(16, 0.5)) * 3.7;
        let stderr = grey.map(|x| 1e-3 * x);
        let lit = DMatrix::from_fn(64, 120, |p, l| grey[(p, l)] + 50.0 * grey[(5, l)]);
        let size = |phi: &DMatrix<f64>, free_scale, frame_constant| {
            let nuisance = Nuisance {
                free_scale,
                frame_constant,
                ..Nuisance::default()
            };
            let problem = Problem::new(phi, &bench.c, &bench.d, Some(&stderr));
            unit(&problem.unwrap().with_nuisance(nuisance).unwrap())
        };
        assert!((size(&grey, true, false).unwrap() / 3.7 - 1.0).abs() < 1e-12);
        assert!((size(&lit, true, true).unwrap() / 3.7 - 1.0).abs() < 1e-9);
        assert!(size(&lit, true, false).unwrap() > 100.0);
        assert_eq!(size(&lit, false, true), Ok(1.0));
        // Darker than nothing: by norms.
        assert!((size(&-&grey, true, false).unwrap() / 3.7 - 1.0).abs() < 1e-9);
        assert!(size(&(&grey * 0.0), true, false).is_err());
    }

    /// Photographs from Φ to −Φ, and one element that no light reaches: every method refuses those
    /// in which no element's light, summed over all entries by hand, has the sign of light, and no
    /// others.
    #[test]
    fn photographs_without_light_are_refused_by_every_method() {
        let bench = Bench::new(6.0, 4, 8);
        let mut c = bench.c.clone();
        c.column_mut(5).fill(0.0);
        let d = DMatrix::from_fn(16, 24, |j, l| bench.d[(j, 5 * l)]);
        let picture = |rho: &dyn Fn(usize) -> f64| {
            let rho = DVector::from_fn(16, |j, _| rho(j));
            &c * DMatrix::from_diagonal(&rho) * &d
        };
        let (light, one) = (
            picture(&|j| 0.2 + 0.04 * j as f64),
            picture(&|j| f64::from(u8::from(j == 10))),
        );
        let stderr = light.map(|x| 1e-2 * x);
        let mut refused = Vec::new();
        for part in [-0.5, -0.05, 0.0, 0.05, 0.5, 2.0, 8.0] {
            let phi = &one * part - &light;
            let along = |j: usize| -> f64 {
                let entry = |(p, l): (usize, usize)| {
                    c[(p, j)] * d[(j, l)] * phi[(p, l)] / stderr[(p, l)].powi(2)
                };
                (0..64 * 24).map(|i| entry((i % 64, i / 64))).sum()
            };
            let dark = (0..16).all(|j| along(j) <= 0.0);
            refused.push(dark);
            let problem = Problem::new(&phi, &c, &d, Some(&stderr))
                .and_then(|p| p.with_grids(&[[4, 4]]))
                .and_then(|p| {
                    p.with_nuisance(Nuisance {
                        free_scale: true,
                        ..Nuisance::default()
                    })
                })
                .unwrap();
            for method in JOINT {
                // A weight of the total variation that suits noise alone is not looked for.
                let options = Options {
                    total_variation: Some(1e-9),
                    weighting: crate::recovery::WeightRule::Entries,
                    ..Options::default()
                };
                let found = recover(method, &problem, &options);
                let none = Err(RecoveryError::NoScale { largest: 0.0 });
                assert_eq!(dark, found.map(|_| ()) == none, "{method} {part}");
            }
        }
        assert_eq!(refused[..4], [true; 4], "{refused:?}");
        assert_eq!(refused[6..], [false], "{refused:?}");
    }

    /// Largest difference of entries over the largest entry.
    fn apart<'a>(
        a: impl IntoIterator<Item = &'a f64>,
        b: impl IntoIterator<Item = &'a f64>,
    ) -> f64 {
        let a: Vec<f64> = a.into_iter().copied().collect();
        let b: Vec<f64> = b.into_iter().copied().collect();
        assert_eq!(a.len(), b.len());
        let largest = a.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
        let off = a.iter().zip(&b).map(|(x, y)| (x - y).abs());
        off.fold(0.0, f64::max) / largest
    }

    /// Photographs in another unit, by a power of 2 since normal equations double what roundings
    /// do: the same reflectances, errors, bands, evidence, Picard plot and share that is
    /// determined; a scale as many times as large.
    #[test]
    fn the_unit_of_the_photographs_changes_nothing_but_the_scale() {
        let bench = Bench::new(6.0, 4, 8);
        let board = bench.board(2).map(|x| 0.2 + 0.6 * x);
        let (c, d) = (
            &bench.c,
            DMatrix::from_fn(16, 24, |j, l| bench.d[(j, 5 * l)]),
        );
        let (exact, errors) = relative_noise(&(c * DMatrix::from_diagonal(&board) * &d), 1e-2, 6);
        let pattern = DMatrix::from_fn(64, 24, |p, l| 1.0 / (1 + p + l) as f64);
        let factor = (2f64).powi(53);
        let (grids, left_out) = ([[4, 4]], DMatrix::zeros(64, 24));
        let cases = [
            (Some(0.95), None, None, None),
            (None, Some(0.1), None, Some(&left_out)),
            (None, None, Some(&pattern), None),
        ];
        for (bands, frame_gain, glare, left_out) in cases {
            let nuisance = Nuisance {
                free_scale: true,
                frame_constant: true,
                frame_gain,
                glare,
                left_out,
                ..Nuisance::default()
            };
            let options = Options {
                bands,
                ..Options::default()
            };
            let at = |factor: f64, method| {
                let (phi, stderr) = (&exact * factor, &errors * factor);
                let problem = Problem::new(&phi, c, &d, Some(&stderr))
                    .and_then(|p| p.with_grids(&grids))
                    .and_then(|p| p.with_nuisance(nuisance))
                    .unwrap();
                let found = recover(method, &problem, &options);
                (
                    found,
                    determined(&problem).unwrap(),
                    picard_joint(&problem, &options).unwrap(),
                )
            };
            for method in JOINT {
                let case = format!("{method} {frame_gain:?} {}", glare.is_some());
                let told = |off: f64| assert!(off < 1e-8, "{case} {off:e}");
                let ((own, share, plot), (other, shares, plots)) =
                    (at(1.0, method), at(factor, method));
                told(apart(&share.shares, &shares.shares));
                assert!(
                    share.rank > 2.0 && share.rank < 16.0,
                    "{case} {}",
                    share.rank
                );
                told(apart(&plot.coefficient, &plots.coefficient));
                let (own, other): (Recovered, Recovered) = match (own, other) {
                    (Ok(own), Ok(other)) => (own, other),
                    (own, other) => {
                        assert_eq!(own, other, "{case}");
                        continue;
                    }
                };
                told(apart(&own.reflectance, &other.reflectance));
                let errors = [&own, &other].map(|found| found.standard_error.clone());
                let limits = [&own, &other].map(|found| {
                    let limits = |b: &crate::recovery::Bands| b.intervals.concat();
                    found.bands.as_ref().map(limits)
                });
                let evidence = [&own, &other].map(|found| found.log_evidence);
                let shape = [&own, &other].map(|found| found.covariance.clone());
                told(apart(
                    errors[0].iter().flatten(),
                    errors[1].iter().flatten(),
                ));
                told(apart(
                    limits[0].iter().flatten(),
                    limits[1].iter().flatten(),
                ));
                told(apart(&evidence[0], &evidence[1]));
                told(apart(shape[0].iter().flatten(), shape[1].iter().flatten()));
                told(apart(&[own.effective_rank], &[other.effective_rank]));
                let of = |found: &Recovered| found.nuisance.as_ref().and_then(|n| n.scale).unwrap();
                told(apart(&[of(&own) * factor], &[of(&other)]));
                if let (
                    Parameter::GaussianProcess { spread, .. },
                    Parameter::GaussianProcess { spread: found, .. },
                ) = (own.parameter, other.parameter)
                {
                    told(apart(&[spread], &[found]));
                    assert!(spread > 0.05 && spread < 2.0, "{case} {spread}");
                }
            }
        }
    }
}
