//! The picture that goes with a geometry, and its errors.

use std::f64::consts::FRAC_1_SQRT_2;

use super::*;
use crate::lab::problem::problem as inverse;
use crate::num::linalg::Cholesky;
use crate::recovery::{Method, Options, recover};

/// The bench with 6 × 6 pixels and 20 spots, and its model of 3 × 3 elements.
fn bench() -> (Scene, MatrixModel) {
    let scene = small("bench", 6);
    let (kernel, occlusion) = (Kernel::Physical, Occlusion::Considered);
    let model = MatrixModel::with(&scene, kernel, Some([3; 2]), occlusion).unwrap();
    (scene, model)
}

/// The scene as it is thought to be with a hinge known to 1°, by photographs of these reflectances
/// where it is off by a normal deviate of that, with noise of this part of a grey's mean light.
fn found(scene: &Scene, rho: &DVector<f64>, level: f64, seed: u64) -> (Calibration, [Matrix; 2]) {
    let mut random = normal(7000 + seed);
    let hinge = Parameter::named(scene, "hinge.angle").unwrap();
    let there = scene.displaced(&hinge, &[random()[0]]).unwrap();
    let (kernel, occlusion) = (Kernel::Physical, Occlusion::Considered);
    let model = MatrixModel::with(&there, kernel, Some([3; 2]), occlusion).unwrap();
    let light =
        |rho: &DVector<f64>| &model.camera_side * Matrix::from_diagonal(rho) * &model.laser_side;
    let exact = light(rho);
    let grey = light(&DVector::from_element(9, 0.5));
    let stderr = exact.map(|_| level * grey.mean());
    let phi = exact.zip_map(&stderr, |x, s| x + s * random()[0]);
    let mut plan = plan(&["hinge.angle"], 3);
    plan.free[0].sigma = Some(1.0);
    let found = plan.calibrate(scene, &unexplained(&phi, &stderr), Control::none());
    (found.unwrap(), [phi, stderr])
}

/// Reflectances between 0.05 and 0.95, each by itself.
fn independent(seed: u64) -> DVector<f64> {
    let mut random = normal(100 + seed);
    DVector::from_fn(9, |_, _| {
        0.05 + 0.45 * libm::erfc(FRAC_1_SQRT_2 * random()[0])
    })
}

/// ρ = m + f of the process that the pictures are taken to be of: m ~ N(½, ½²), ln τ ~ N(−2.13,
/// 0.98²), ln ℓ even from 0.4 distances of neighbours to 8 extents, of τ² a tenth at random by
/// itself.
fn drawn(model: &MatrixModel, seed: u64) -> DVector<f64> {
    let mut random = normal(200 + seed);
    let even = 0.5 * libm::erfc(FRAC_1_SQRT_2 * random()[0]);
    let apart = |i: usize, j: usize| {
        let [a, b] = [model.places[i], model.places[j]];
        (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    };
    let (nearest, extent) = (apart(0, 1), apart(0, 8));
    let length = 0.4 * nearest * libm::exp(even * libm::log(20.0 * extent / nearest));
    let tau = libm::exp(-2.13 + 0.98 * random()[0]);
    let alike = Matrix::from_fn(9, 9, |i, j| {
        let own = if i == j { 0.1 } else { 0.0 };
        own + 0.9 * libm::exp(-apart(i, j) / length)
    });
    let root = Cholesky::new(&alike).unwrap();
    let z = DVector::from_fn(9, |_, _| random()[0]);
    (root.lower() * z * tau).add_scalar(0.5 + 0.5 * random()[0])
}

/// Checks, each element the opposite of its neighbours.
fn checks() -> DVector<f64> {
    DVector::from_fn(9, |j, _| 0.1 + 0.8 * (j % 2) as f64)
}

/// Of 400 pictures of all lengths and spreads, where noise leaves these open, one element in twenty
/// is off by more than 1.96 of its errors: within three binomial deviations, as if the elements of
/// a picture erred together. By the likeliest prior alone it is one in nine.
#[test]
fn errors_of_the_picture_hold_whatever_its_prior() {
    let (scene, model) = bench();
    let (levels, draws) = ([1e-1, 3e-2], 200);
    let all = levels.len() as f64 * draws as f64;
    let mut beyond = 0.0;
    for level in levels {
        for seed in 0..draws {
            let rho = drawn(&model, seed);
            let (own, _) = found(&scene, &rho, level, seed);
            let grid = &own.grids[0];
            let each = grid.values.iter().zip(&grid.stderr).zip(&rho);
            let far = each.filter(|((x, s), truth)| (*x - *truth).abs() > 1.96 * *s);
            beyond += far.count() as f64 / 9.0 / all;
        }
    }
    let most = 0.05 + 3.0 * (0.05 * 0.95 / all).sqrt();
    assert!(beyond < most, "{beyond} {most}");
}

/// Checks that look smooth by chance are off by many errors: that the photographs do not say how
/// alike neighbours are is told.
#[test]
fn that_neighbours_may_not_be_alike_is_told() {
    let (scene, _) = bench();
    let (own, _) = found(&scene, &checks(), 1e-1, 0);
    let notes = own.describe().notes.concat();
    let doubt = "do not say how alike neighbouring elements are";
    assert!(notes.contains(doubt), "{notes}");
    assert!(own.picture_warnings.concat().contains(doubt));
}

/// By the calibrated scene `joint-gp` recovers the same picture with the same errors.
#[test]
fn the_picture_is_that_of_the_process_over_all_priors() {
    let (scene, _) = bench();
    let (own, [phi, stderr]) = found(&scene, &independent(1), 1e-2, 1);
    let there = Scene::from_toml("calibrated", &own.toml).unwrap();
    let (kernel, occlusion) = (Kernel::Physical, Occlusion::Considered);
    let model = MatrixModel::with(&there, kernel, Some([3; 2]), occlusion).unwrap();
    let of = inverse(&model, &phi, Some(&stderr)).unwrap();
    let of = of.with_grids(&[[3; 2]]).unwrap();
    let of = of.with_places(&model.places).unwrap();
    let want = recover(Method::JointGp, &of, &Options::default()).unwrap();
    let errors = want.standard_error.unwrap();
    for j in 0..9 {
        let off = (own.grids[0].values[j] - want.reflectance[j]) / errors[j];
        let ratio = own.stderr_given[j] / errors[j];
        assert!(
            off.abs() < 1e-6 && (ratio - 1.0).abs() < 1e-6,
            "{j}: {off:e} {ratio}"
        );
    }
}
