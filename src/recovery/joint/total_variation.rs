//! Least squares over all pixels and spots with a penalty on the differences of neighbours.
//!
//! > minimise ½ Σ w_p v_l (Φ − C diag(ρ) D)² + λ TV(ρ)   over 0 ≤ ρ ≤ 1
//!
//! TV is the anisotropic total variation, Σ |ρ_a − ρ_b| over all pairs of neighbours along u and
//! along v of each grid: edges along the rows and columns of elements cost their length. With a
//! free scale the penalty is on s ρ, and only s ρ ≥ 0 is asked.
//!
//! λ is given as a fraction of σ₁², σ₁ the largest singular value of the weighted operator, or it
//! is the largest that the noise allows. Of the pixels·spots weighted residuals, those outside the
//! range of the operator say nothing of ρ, but their scatter, √(2 N), would hide any pattern of
//! less. So the test is on what is left inside, where the unbounded fit has no residual at all:
//! with noise of unit variance (that is what the weights make) and k singular values above
//! rounding,
//!
//! > ‖R ρ_λ − d‖² ≤ target = k − dof(λ),
//!
//! dof(λ) the number of patches of one value strictly between the bounds (Tibshirani and Taylor
//! 2012). No deviation is allowed on top: two of them, 2 √(2 k), are negligible against the
//! thousands of residuals of the methods that work pixel by pixel, but a third of the few tens
//! here, and a λ that spends them flattens the pattern. Where the unpenalised fit (λ = 0) is above
//! the target already, but by no more than four, it is kept; where it is above that, the noise is
//! understated.

use super::reduced::{Reduced, report};
use crate::num::quadratic::{Bounds, Fused, box_least_squares, fused_least_squares};
use crate::recovery::{
    Choice, Method, Options, Parameter, Problem, Recovered, RecoveryError, WeightRule,
};

/// Trial values of λ/σ₁² fall from 1 by this factor until one is accepted, and bisection goes on to
/// within this of the answer.
const STEP: f64 = 0.1;
const NEAR: f64 = 1.02;
/// Standard deviations of χ² above its mean, √(2 target) each, beyond which noise does not explain
/// a residual.
const DEVIATIONS: f64 = 4.0;
/// The smallest λ/σ₁² tried: some roundings.
const LEAST: f64 = 1e-24;

pub(in crate::recovery) fn recover(
    problem: &Problem<'_>,
    options: &Options,
) -> Result<Recovered, RecoveryError> {
    let method = Method::JointTv;
    let reduced = Reduced::new(problem, options)?;
    let grids = problem.grids.ok_or(RecoveryError::NotForMethod {
        method,
        what: "needs to know which elements are neighbours",
        cure: "give the grids of the elements, or use joint",
    })?;
    let search = Search {
        pairs: neighbours(grids),
        bounds: reduced.bounds(problem),
        unit: reduced.sigma[0] * reduced.sigma[0],
        start: box_least_squares(&reduced.r, &reduced.d, &reduced.bounds(problem))?.solution,
        reduced: &reduced,
    };
    let (lambda, choice) = match options.total_variation {
        Some(value) if value.is_finite() && value >= 0.0 => (value, Choice::Given),
        Some(value) => {
            return Err(RecoveryError::BadParameter {
                method,
                name: "the total variation's weight",
                value,
                cure: "give a fraction of the largest squared singular value, 0 or more",
            });
        }
        None if options.weighting == WeightRule::Unweighted => {
            return Err(RecoveryError::NotForMethod {
                method,
                what: "chooses its total variation's weight by residuals in units of the noise",
                cure: "leave the weighting to the noise, or give the weight yourself",
            });
        }
        None if problem.noise().is_none() => {
            let parameter = "total variation's weight";
            return Err(match problem.stderr {
                Some(_) => RecoveryError::NoNoise { method, parameter },
                None => RecoveryError::NoNoiseModel { method, parameter },
            });
        }
        None => search.largest()?,
    };
    let found = search.at(lambda)?.found;
    let mut recovered = reduced.finish(method, problem, options, found.solution.clone())?;
    recovered.parameter = Parameter::TotalVariation(lambda);
    recovered.choice = choice;
    recovered.solver = Some(report(&found));
    Ok(recovered)
}

struct Search<'a> {
    reduced: &'a Reduced,
    bounds: Bounds,
    pairs: Vec<[usize; 2]>,
    /// σ₁².
    unit: f64,
    /// The solution without penalty.
    start: nalgebra::DVector<f64>,
}

impl Search<'_> {
    fn at(&self, lambda: f64) -> Result<Fused, RecoveryError> {
        let Reduced { r, d, .. } = self.reduced;
        let lambda = lambda * self.unit;
        Ok(fused_least_squares(
            r,
            d,
            &self.bounds,
            &self.pairs,
            lambda,
            &self.start,
        )?)
    }

    /// Residual, target and limit of λ.
    fn level(&self, lambda: f64) -> Result<Level, RecoveryError> {
        let fused = self.at(lambda)?;
        let Reduced { r, d, .. } = self.reduced;
        let target = r.nrows().saturating_sub(fused.free_sets).max(1) as f64;
        Ok(Level {
            residual: (r * &fused.found.solution - d).norm_squared(),
            target,
            limit: target + DEVIATIONS * (2.0 * target).sqrt(),
        })
    }

    /// The largest λ/σ₁² that the noise allows, no larger than 1.
    fn largest(&self) -> Result<(f64, Choice), RecoveryError> {
        let none = self.level(0.0)?;
        if none.residual > none.limit {
            return Err(RecoveryError::JointNoiseUnderstated {
                residual: none.residual,
                limit: none.limit,
            });
        }
        let (mut high, mut low) = (1.0, 1.0);
        let mut level = self.level(low)?;
        while !level.accepted() {
            high = low;
            low *= STEP;
            if low < LEAST {
                return Ok((0.0, none.choice()));
            }
            level = self.level(low)?;
        }
        while high / low > NEAR {
            let middle = (high * low).sqrt();
            let between = self.level(middle)?;
            if between.accepted() {
                (low, level) = (middle, between);
            } else {
                high = middle;
            }
        }
        Ok((low, level.choice()))
    }
}

/// The three numbers of [`Choice::JointDiscrepancy`].
struct Level {
    residual: f64,
    target: f64,
    limit: f64,
}

impl Level {
    fn accepted(&self) -> bool {
        self.residual <= self.target
    }

    fn choice(&self) -> Choice {
        Choice::JointDiscrepancy {
            residual: self.residual,
            target: self.target,
            limit: self.limit,
        }
    }
}

/// Pairs of neighbours along u and along v.
fn neighbours(grids: &[[usize; 2]]) -> Vec<[usize; 2]> {
    let mut pairs = Vec::new();
    let mut first = 0;
    for &[nu, nv] in grids {
        for at in 0..nu * nv {
            if at % nu + 1 < nu {
                pairs.push([first + at, first + at + 1]);
            }
            if at / nu + 1 < nv {
                pairs.push([first + at, first + at + nu]);
            }
        }
        first += nu * nv;
    }
    pairs
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::recovery::bench::{Bench, normal_stream};
    use crate::recovery::recover;

    fn noisy(bench: &Bench, exact: &DMatrix<f64>, noise: f64, seed: u64) -> [DMatrix<f64>; 2] {
        let stderr = exact * noise;
        let mut normal = normal_stream(seed);
        assert_eq!(exact.nrows(), bench.c.nrows());
        [exact.zip_map(&stderr, |x, s| x + s * normal()), stderr]
    }

    #[test]
    fn neighbours_are_those_of_each_grid() {
        // 3 × 2: rows 0-1-2 and 3-4-5; then 1 × 2.
        let pairs = neighbours(&[[3, 2], [1, 2]]);
        let exact = [
            [0, 1],
            [0, 3],
            [1, 2],
            [1, 4],
            [2, 5],
            [3, 4],
            [4, 5],
            [6, 7],
        ];
        assert_eq!(pairs, exact);
    }

    #[test]
    fn the_chosen_weight_leaves_what_noise_leaves() {
        let bench = Bench::new(6.0, 8, 16);
        let exact = bench.phi(&bench.board(2).map(|x| 0.3 + 0.4 * x));
        for (noise, seed) in [(0.1, 1), (1e-2, 2), (1e-3, 3)] {
            let [phi, stderr] = noisy(&bench, &exact, noise, seed);
            let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
            let problem = problem.with_grids(&[[8, 8]]).unwrap();
            let found = recover(Method::JointTv, &problem, &Options::default()).unwrap();
            let Choice::JointDiscrepancy {
                residual,
                target,
                limit,
            } = found.choice
            else {
                panic!("{:?}", found.choice)
            };
            let Parameter::TotalVariation(lambda) = found.parameter else {
                panic!("{:?}", found.parameter)
            };
            // As large as can be, or no penalty where noise is above its mean already.
            let within = residual <= target && residual > 0.8 * target;
            assert!(
                within || (lambda == 0.0 && residual <= limit),
                "{residual} {target} {limit}"
            );
            let solver = found.solver.unwrap();
            assert!(solver.gap < 1e-2 * solver.objective, "{solver:?}");
        }
    }

    #[test]
    fn no_weight_is_joint_and_a_great_one_is_flat() {
        let bench = Bench::new(6.0, 4, 8);
        let [phi, stderr] = noisy(&bench, &bench.phi(&bench.board(2)), 1e-2, 1);
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let problem = problem.with_grids(&[[4, 4]]).unwrap();
        let of = |weight| {
            let options = Options {
                total_variation: Some(weight),
                ..Options::default()
            };
            recover(Method::JointTv, &problem, &options)
        };
        let joint = recover(Method::Joint, &problem, &Options::default()).unwrap();
        assert!((of(0.0).unwrap().reflectance - joint.reflectance).amax() < 1e-9);
        let flat = of(1.0).unwrap().reflectance;
        assert!(flat.max() - flat.min() < 1e-9 && flat[0] > 0.1);
        for bad in [-1.0, f64::NAN] {
            assert!(matches!(of(bad), Err(RecoveryError::BadParameter { .. })));
        }
    }

    #[test]
    fn what_is_missing_is_said() {
        let bench = Bench::new(6.0, 2, 4);
        let phi = bench.phi(&bench.board(2));
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        let error = recover(Method::JointTv, &problem, &Options::default()).unwrap_err();
        assert!(
            matches!(error, RecoveryError::NotForMethod { .. }),
            "{error}"
        );
        assert!(matches!(
            problem.with_grids(&[[2, 3]]),
            Err(RecoveryError::Grids {
                elements: 4,
                covered: 6
            })
        ));
        let problem = problem.with_grids(&[[2, 2]]).unwrap();
        let error = recover(Method::JointTv, &problem, &Options::default()).unwrap_err();
        assert!(
            matches!(error, RecoveryError::NoNoiseModel { .. }),
            "{error}"
        );
        // Errors a hundred times too small: no ρ fits.
        let [phi, stderr] = noisy(&bench, &phi, 1e-2, 1);
        let small = stderr * 1e-2;
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&small)).unwrap();
        let problem = problem.with_grids(&[[2, 2]]).unwrap();
        let error = recover(Method::JointTv, &problem, &Options::default()).unwrap_err();
        assert!(
            matches!(error, RecoveryError::JointNoiseUnderstated { .. }),
            "{error}"
        );
    }
}
