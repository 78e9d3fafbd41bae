//! A background against a dense normal distribution, the slope beside it against differences, and
//! the geometry from photographs in bright light.

use nalgebra::DVector;

use super::*;
use crate::lab::comparison::misplaced::normal;
use crate::lab::geometry::calibrate::CalibrationPlan;
use crate::lab::geometry::calibrate::descent::Problem;
use crate::lab::geometry::calibrate::tests::{
    is_slope_of_the_cost, of_two_spots, photographs, pictures, plan, problem, small, unexplained,
};
use crate::lab::geometry::common::{Common, FIELD, OTHER_LIGHT};
use crate::scene::Parameter;
use crate::transport::Control;

/// A light of its own in each pixel, up to `level`, in every frame.
fn lit(phi: &Matrix, level: f64, seed: u64) -> Matrix {
    let mut random = normal(seed);
    let each: Vec<f64> = (0..phi.nrows())
        .map(|_| level * random()[0].abs())
        .collect();
    Matrix::from_fn(phi.nrows(), phi.ncols(), |p, l| phi[(p, l)] + each[p])
}

fn beside<'a>(problem: Problem<'a>, common: &'a Common) -> Problem<'a> {
    Problem {
        photographs: Unexplained {
            phi: &common.phi,
            ..problem.photographs
        },
        common: Some(common),
        ..problem
    }
}

/// Along the directions that no light of single pixels has, y ~ N(½ A 1, 1 + A R Rᵀ Aᵀ).
#[test]
fn the_cost_is_that_of_a_dense_normal_distribution_beside_a_background() {
    let scene = of_two_spots();
    let (phi, stderr) = photographs(&scene, 2, 0.1, 3);
    let phi = lit(&phi, 30.0 * phi.amax(), 8);
    let parameters = Parameter::named(&scene, "hidden.normal").unwrap();
    let pictures = pictures(&scene);
    let photographs = unexplained(&phi, &stderr);
    let own = problem(&scene, &parameters, photographs, &pictures, 0);
    let light = own.geometry.light(&[0.2], 0.0, false).unwrap();
    let frames: Vec<Matrix> = (0..2).map(|l| light.frame(l)).collect();
    let sigma = |p: usize, l: usize| stderr[(p, l)];
    // In each pixel (1/σ_1, −1/σ_0) over its length is at right angles to (1/σ_0, 1/σ_1).
    let left = |of: &dyn Fn(usize, usize) -> f64, p: usize| {
        let [a, b] = [0, 1].map(|l| of(p, l) / sigma(p, l));
        let length = (sigma(p, 0).powi(-2) + sigma(p, 1).powi(-2)).sqrt();
        (a / sigma(p, 1) - b / sigma(p, 0)) / length
    };
    let a = Matrix::from_fn(12, 4, |p, j| left(&|p, l| frames[l][(p, j)], p));
    let y = DVector::from_fn(12, |p, _| left(&|p, l| phi[(p, l)], p));
    let prior = &pictures[6];
    let ar = &a * &prior.root;
    let covariance = Matrix::identity(12, 12) + &ar * ar.transpose();
    let eigen = nalgebra::SymmetricEigen::new(covariance);
    let along = eigen
        .eigenvectors
        .tr_mul(&(&y - &a * DVector::from_element(4, prior.mean)));
    let each = along.iter().zip(&eigen.eigenvalues);
    let dense = 0.5 * each.map(|(x, v)| x * x / v + libm::log(*v)).sum::<f64>();
    let common = Common::new(&photographs, false).unwrap();
    let problem = beside(own, &common);
    let cost = problem.cost(&[0.2], 1.0, prior).unwrap().unwrap();
    let want = dense + 0.5 * (0.2f64 / 0.3).powi(2);
    assert!((cost - want).abs() < 1e-8 * want.abs(), "{cost} for {want}");
    let state = problem.state(&[0.2], 1.0, Some(prior)).unwrap();
    assert_eq!(state.value.count, 12.0);
}

/// With gains of all frames unknown, whose rates are of one frame each, and entries left out.
#[test]
fn slopes_beside_a_background_are_those_of_the_cost() {
    let scene = small("bench", 4);
    let (phi, stderr) = photographs(&scene, 2, 0.02, 4);
    let phi = lit(&phi, 3.0 * phi.amax(), 2);
    let names = ["hinge.angle", "spots.shift"];
    let parameters = names
        .iter()
        .flat_map(|name| Parameter::named(&scene, name).unwrap());
    let parameters: Vec<Parameter> = parameters.collect();
    let (pixels, frames) = phi.shape();
    // All of pixel 0, all of pixel 3 but one, and some.
    let flags = Matrix::from_fn(pixels, frames, |p, l| {
        f64::from(u8::from(p == 0 || (p == 3 && l != 2) || (p + l) % 7 == 0))
    });
    let phi = phi.zip_map(&flags, |x, flag| if flag == 0.0 { x } else { f64::NAN });
    let pictures = pictures(&scene);
    let photographs = Unexplained {
        left_out: Some(&flags),
        ..unexplained(&phi, &stderr)
    };
    let common = Common::new(&photographs, false).unwrap();
    let own = problem(&scene, &parameters, photographs, &pictures, frames);
    let problem = Problem {
        first: 1.0,
        ..beside(own, &common)
    };
    let mut values = vec![0.3, 0.02, 0.04];
    values.extend((0..frames).map(|l| 0.01 * (l % 3) as f64));
    let state = problem.state(&values, 1.0, None).unwrap();
    let counted = flags.iter().filter(|flag| **flag == 0.0).count();
    assert_eq!(state.value.count, (counted - (pixels - 1)) as f64);
    is_slope_of_the_cost(&problem, &values, &[0, 1, 2, 3, 4, 3 + frames - 1]);
}

/// In a light a hundred times as bright as the signal the geometry is found as without it: a
/// background changes nothing, is told where it is not asked for, and stated errors hold.
#[test]
fn the_geometry_is_found_in_bright_light() {
    let scene = small("bench", 8);
    let names = ["hinge.angle", "hidden.normal", "hidden.yaw"];
    let parameters = names
        .iter()
        .flat_map(|name| Parameter::named(&scene, name).unwrap());
    let parameters: Vec<Parameter> = parameters.collect();
    let mut squares = 0.0;
    for seed in 0..8 {
        let mut random = normal(seed + 100);
        let truth = [1.0, 0.1, 1.0].map(|size| size * random()[0]);
        let there = scene.displaced(&parameters, &truth).unwrap();
        let (phi, stderr) = photographs(&there, 2, 1e-3, seed);
        let own = CalibrationPlan {
            background: true,
            ..plan(&names, 2)
        };
        let by = |phi: &Matrix, plan: &CalibrationPlan| {
            plan.calibrate(&scene, &unexplained(phi, &stderr), Control::none())
                .unwrap()
        };
        let bright = lit(&phi, 100.0 * phi.amax(), seed);
        let [dark, found] = [&phi, &bright].map(|phi| by(phi, &own));
        assert!(found.is_settled && found.p.unwrap() > 1e-3, "{:?}", found.p);
        for ((own, dark), want) in found.found.iter().zip(&dark.found).zip(truth) {
            assert!(
                (own.value - dark.value).abs() < 0.05 * own.stderr,
                "{own:?} {dark:?}"
            );
            squares += ((own.value - want) / own.stderr).powi(2) / 24.0;
        }
        if seed == 0 {
            let without = by(&bright, &plan(&names, 2));
            assert!(without.p.unwrap() < 1e-6);
        }
    }
    assert!((0.5..1.7).contains(&squares), "{squares}");
}

/// What is not taken out together with a background is refused.
#[test]
fn other_light_beside_a_background_is_refused() {
    let scene = of_two_spots();
    let (phi, stderr) = photographs(&scene, 2, 0.1, 3);
    let patterns = Matrix::from_element(12, 1, 1.0);
    let refused = |patterns, error_field| {
        let own = CalibrationPlan {
            background: true,
            error_field,
            ..plan(&["hidden.normal"], 2)
        };
        let photographs = Unexplained {
            patterns,
            ..unexplained(&phi, &stderr)
        };
        own.calibrate(&scene, &photographs, Control::none())
            .unwrap_err()
            .to_string()
    };
    assert_eq!(refused(Some(&patterns), false), OTHER_LIGHT.to_string());
    assert_eq!(refused(None, true), FIELD.to_string());
}
