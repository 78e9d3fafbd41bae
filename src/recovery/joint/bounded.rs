//! Least squares over all pixels and spots with reflectances that a surface can have: 0 ≤ ρ ≤ 1
//! (`joint`), or ρ ≥ 0 alone (`nnls`).

use nalgebra::DMatrix;

use crate::num::quadratic::{Bounds, box_least_squares};
use crate::recovery::joint::operator::reduced::Reduced;
use crate::recovery::joint::operator::stacked::stack;
use crate::recovery::joint::operator::weights;
use crate::recovery::{Bands, Method, Options, Problem, Recovered, RecoveryError, bands};

/// `method` is [`Method::Joint`] or [`Method::Nnls`].
pub(in crate::recovery) fn recover(
    method: Method,
    problem: &Problem<'_>,
    options: &Options,
) -> Result<Recovered, RecoveryError> {
    let reduced = Reduced::new(problem, options)?;
    let bounds = match method {
        Method::Nnls => Bounds::all(problem.c.ncols(), 0.0, f64::INFINITY),
        _ => reduced.bounds(problem),
    };
    let solved = box_least_squares(&reduced.r, &reduced.d, &bounds)?;
    let asked = match options.bands {
        Some(confidence) => {
            let stderr = bands::simultaneous_allowed(method, problem, options)?;
            Some(if problem.nuisance.free_scale {
                Err(bands::UNSCALED)
            } else {
                region(problem, stderr, &bounds, confidence)?
            })
        }
        None => None,
    };
    let mut found = reduced.finish(method, problem, options, solved.solution.clone())?;
    found.solver = Some(reduced.report(&solved));
    (found.bands, found.no_bands) = match asked {
        Some(Ok(bands)) => (Some(bands), None),
        Some(Err(why)) => (None, Some(why)),
        None => (None, None),
    };
    Ok(found)
}

/// The bands of all elements at once, each entry by its own error: separable weights would not make
/// them all units.
fn region(
    problem: &Problem<'_>,
    stderr: &DMatrix<f64>,
    bounds: &Bounds,
    confidence: f64,
) -> Result<Result<Bands, &'static str>, RecoveryError> {
    let (pixels, spots) = problem.phi.shape();
    let fitted = weights::fit(Some(stderr), pixels, spots);
    let exact = stack(problem, |p, l| fitted.root(problem, Some(stderr), p, l))?.triangle;
    bands::simultaneous(&exact.r, &exact.d, bounds, confidence, problem.control)
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;
    use crate::recovery::bench::{Bench, modulation, normal_stream, relative_noise};
    use crate::recovery::{Nuisance, recover};

    #[test]
    fn planted_boards_are_recovered_exactly_without_noise() {
        let bench = Bench::new(3.0, 8, 16);
        for checks in [2, 4, 8] {
            let board = bench.board(checks);
            let phi = bench.phi(&board);
            let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
            let found = recover(Method::Joint, &problem, &Options::default()).unwrap();
            // Rounding of Φ, one eps of its norm, reaches the weakest direction divided by its
            // singular value.
            let condition = found.sigma[0] / found.sigma[63];
            let error = (&found.reflectance - &board).amax();
            assert!(
                error < 10.0 * f64::EPSILON * condition,
                "{checks}: {error:e} {:?}",
                found.solver
            );
            assert!((modulation(&found.reflectance, &board) - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn a_board_of_two_checks_survives_one_percent_of_noise() {
        let bench = Bench::new(3.0, 8, 16);
        let board = bench.board(2);
        let exact = bench.phi(&board);
        let stderr = &exact * 1e-2;
        for seed in 0..5 {
            let mut normal = normal_stream(seed);
            let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
            for noise in [Some(&stderr), None] {
                let problem = Problem::new(&phi, &bench.c, &bench.d, noise).unwrap();
                let found = recover(Method::Joint, &problem, &Options::default()).unwrap();
                let mtf = modulation(&found.reflectance, &board);
                let solver = found.solver.unwrap();
                assert!(mtf >= 0.95, "seed {seed}: {mtf}");
                assert!(solver.gap <= 1e-9 * solver.objective, "{solver:?}");
                assert!(found.reflectance.iter().all(|x| (0.0..=1.0).contains(x)));
            }
        }
    }

    /// 0.967 and 0.947 were measured over 20 seeds; the standard deviation of one seed is about
    /// 0.04.
    #[test]
    fn a_board_of_two_checks_survives_a_tenth_of_noise() {
        for half_width in [6.0, 3.0] {
            let bench = Bench::new(half_width, 8, 16);
            let board = bench.board(2);
            let exact = bench.phi(&board);
            let stderr = &exact * 0.1;
            let mtf = |seed| {
                let mut normal = normal_stream(seed);
                let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
                let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
                let found = recover(Method::Joint, &problem, &Options::default()).unwrap();
                modulation(&found.reflectance, &board)
            };
            let mean = (1000..1020).map(mtf).sum::<f64>() / 20.0;
            assert!(mean >= 0.9, "{half_width}: {mean}");
        }
    }

    /// In units of the noise the data are 1e8 here, their misfit some units: the solver's relative
    /// tolerance alone would stop where the misfit is still wrong in its first digit.
    #[test]
    fn little_noise_is_used_to_the_last_digit() {
        let bench = Bench::new(3.0, 8, 16);
        let board = bench.board(4);
        let exact = bench.phi(&board);
        let stderr = &exact * 1e-6;
        let mut normal = normal_stream(1);
        let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let found = recover(Method::Joint, &problem, &Options::default()).unwrap();
        assert!(found.solver.unwrap().gap < 1e-6);
        assert!(modulation(&found.reflectance, &board) > 0.95);
    }

    #[test]
    fn an_unseen_element_is_no_obstacle() {
        let bench = Bench::new(6.0, 2, 4);
        let board = bench.board(2);
        let mut c = bench.c.clone();
        c[(3, 1)] = 0.0;
        let mut left = c.clone();
        for (mut column, &rho) in left.column_iter_mut().zip(board.iter()) {
            column *= rho;
        }
        let phi = left * &bench.d;
        let problem = Problem::new(&phi, &c, &bench.d, None).unwrap();
        for method in [Method::JointUnbounded, Method::Joint] {
            let found = recover(method, &problem, &Options::default()).unwrap();
            assert!((found.reflectance - &board).amax() < 1e-9);
        }
    }

    /// An element that no pixel sees, that no spot lights, or of less light than a rounding of the
    /// others: the others are those of the problem without it, and their bands.
    #[test]
    fn an_element_without_light_takes_no_part() {
        let mut normal = normal_stream(4);
        let mut side = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| 0.6 + 0.1 * normal());
        let (c, d) = (side(20, 9), side(9, 12));
        let rho = DVector::from_fn(8, |j, _| 0.1 + 0.1 * j as f64);
        let without = (c.clone().remove_column(4), d.clone().remove_row(4));
        let exact = &without.0 * DMatrix::from_diagonal(&rho) * &without.1;
        let (phi, stderr) = relative_noise(&exact, 1e-2, 5);
        let options = Options {
            bands: Some(0.95),
            ..Options::default()
        };
        let scaled = |light: f64, lit: f64| {
            let (mut c, mut d) = (c.clone(), d.clone());
            c.column_mut(4).scale_mut(light);
            d.row_mut(4).scale_mut(lit);
            (c, d)
        };
        for free_scale in [false, true] {
            let nuisance = Nuisance {
                free_scale,
                ..Nuisance::default()
            };
            let of = |method, (c, d): &(DMatrix<f64>, DMatrix<f64>)| {
                let problem = Problem::new(&phi, c, d, Some(&stderr)).unwrap();
                recover(method, &problem.with_nuisance(nuisance).unwrap(), &options).unwrap()
            };
            for method in [Method::Nnls, Method::Joint] {
                let alone = of(method, &without);
                for sides in [scaled(0.0, 1.0), scaled(1.0, 0.0), scaled(1e-17, 1.0)] {
                    let found = of(method, &sides);
                    assert_eq!(found.reflectance[4], 0.0, "{method}");
                    let others = found.reflectance.remove_row(4);
                    let off = (others - &alone.reflectance).amax();
                    assert!(off < 1e-12, "{method} {free_scale}: {off:e}");
                    let (Some(own), Some(mut all)) = (&alone.bands, found.bands) else {
                        assert!(free_scale);
                        continue;
                    };
                    let top = if method == Method::Nnls {
                        f64::INFINITY
                    } else {
                        1.0
                    };
                    assert_eq!(all.intervals.remove(4), [0.0, top]);
                    for (own, other) in own.intervals.iter().zip(&all.intervals) {
                        // Both ends of both are proved from outside, to what the solver reaches.
                        assert!((own[0] - other[0]).abs() < 1e-6, "{own:?} {other:?}");
                        assert!((own[1] - other[1]).abs() < 1e-6, "{own:?} {other:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn inactive_bounds_change_nothing() {
        let bench = Bench::new(6.0, 2, 4);
        let grey = bench.board(2).map(|x| 0.3 + 0.4 * x);
        let mut normal = normal_stream(9);
        let phi = bench.phi(&grey).map(|x| x * (1.0 + 1e-4 * normal()));
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        let free = recover(Method::JointUnbounded, &problem, &Options::default()).unwrap();
        let bounded = recover(Method::Joint, &problem, &Options::default()).unwrap();
        assert!(free.reflectance.iter().all(|x| (0.0..=1.0).contains(x)));
        assert!((free.reflectance - bounded.reflectance).amax() < 1e-10);
    }
}
