//! The likelihood against a dense normal distribution, its slope against differences.

mod averaged;
mod beforehand;
mod common;
mod edge;
mod elsewhere;
mod errors;
mod estimates;
mod light_left_out;
mod named;
mod pictures;
mod spread;

use nalgebra::DVector;

use super::picture::{Prior, priors};
use super::*;
use crate::lab::finding::{Describe, Tone};
use crate::lab::uncertainty::certainty::{Certainty, Errors};
use crate::lab::uncertainty::pooled::tests::repeated;
use crate::matrix::Matrix;
use crate::model::Effort;
use crate::num::cosines::from_cosines;
use crate::num::stream::Sampling;
use crate::recovery::ErrorField;
use crate::scene::file::SceneFile;
use crate::transport::{Budget, Estimator, Plan, render};

pub(super) fn small(name: &str, pixels: u32) -> Scene {
    let mut file = SceneFile::builtin(name).unwrap();
    file.camera.pixels = [pixels; 2];
    if let Some(laser) = &mut file.laser {
        laser.spots.per_side = laser.spots.per_side.map(|_| 5);
    }
    Scene::new(&file, None).unwrap()
}

/// The bench with two spots and 4 × 3 pixels.
pub(super) fn of_two_spots() -> Scene {
    let mut file = SceneFile::builtin("bench").unwrap();
    file.camera.pixels = [4, 3];
    Scene::new(&file, None)
        .unwrap()
        .with_spots_at(&[[1.0, 2.0], [9.0, 4.0]])
        .unwrap()
}

/// Photographs of `scene` with n × n elements and relative noise, and their standard errors.
pub(super) fn photographs(scene: &Scene, n: usize, level: f64, seed: u64) -> (Matrix, Matrix) {
    let model = MatrixModel::with(scene, Kernel::Physical, Some([n; 2]), Occlusion::Considered);
    let phi = model.unwrap().phi();
    let stderr = &phi * level;
    let mut random = normal(seed);
    let noisy = phi.zip_map(&stderr, |x, s| x + s * random()[0]);
    (noisy, stderr)
}

pub(super) fn plan(free: &[&str], n: usize) -> CalibrationPlan {
    let free = free.iter().map(|name| Free {
        name: (*name).to_owned(),
        sigma: None,
    });
    CalibrationPlan {
        free: free.collect(),
        frame_gain: None,
        is_scale_free: false,
        error_field: false,
        background: false,
        elements: Some([n; 2]),
        occlusion: Occlusion::Considered,
        integration: Integration::Centres,
        starts: 1,
        spread: 1.0,
        seed: 1,
    }
}

pub(super) fn unexplained<'a>(phi: &'a Matrix, stderr: &'a Matrix) -> Unexplained<'a> {
    Unexplained {
        phi,
        stderr: Some(stderr),
        certainty: Certainty::STATED,
        left_out: None,
        patterns: None,
    }
}

/// Priors of 2 × 2 elements.
pub(super) fn pictures(scene: &Scene) -> Vec<Prior> {
    let model = MatrixModel::with(scene, Kernel::Physical, Some([2; 2]), Occlusion::Ignored);
    priors(&model.unwrap().places, false).unwrap()
}

pub(super) fn problem<'a>(
    scene: &'a Scene,
    parameters: &'a [Parameter],
    photographs: Unexplained<'a>,
    pictures: &'a [Prior],
    gains: usize,
) -> Problem<'a> {
    Problem {
        geometry: Geometry {
            scene,
            parameters,
            elements: Some([2; 2]),
            fineness: Fineness::Centres,
            occlusion: Occlusion::Considered,
            gains,
        },
        photographs,
        priors: vec![Some(0.3); parameters.len() + gains],
        pictures,
        is_scale_free: false,
        first: first(&photographs),
        common: None,
        cosines: None,
        log_errors: 0.0,
    }
}

/// y ~ N(½ A 1, 1 + A R Rᵀ Aᵀ), written out by an eigen-decomposition.
#[test]
fn the_cost_is_that_of_a_dense_normal_distribution() {
    let scene = of_two_spots();
    let (phi, stderr) = photographs(&scene, 2, 0.1, 3);
    let parameters = Parameter::named(&scene, "hidden.normal").unwrap();
    let pictures = pictures(&scene);
    let photographs = unexplained(&phi, &stderr);
    let problem = problem(&scene, &parameters, photographs, &pictures, 0);
    let light = problem.geometry.light(&[0.2], 0.0, false).unwrap();
    let frames: Vec<Matrix> = (0..2).map(|l| light.frame(l)).collect();
    let rows = |k: usize| [k / 12, k % 12];
    let white = |k: usize, j: usize| {
        let [l, p] = rows(k);
        frames[l][(p, j)] / stderr[(p, l)]
    };
    let a = Matrix::from_fn(24, 4, white);
    let mean = &a * DVector::from_element(4, 0.5);
    let y = DVector::from_fn(24, |k, _| {
        let [l, p] = rows(k);
        phi[(p, l)] / stderr[(p, l)]
    });
    let dense = |prior: &Prior| {
        let ar = &a * &prior.root;
        let covariance = Matrix::identity(24, 24) + &ar * ar.transpose();
        let eigen = nalgebra::SymmetricEigen::new(covariance);
        let left = eigen.eigenvectors.tr_mul(&(&y - &mean));
        let each = left.iter().zip(&eigen.eigenvalues);
        0.5 * each.map(|(x, v)| x * x / v + v.ln()).sum::<f64>()
    };
    for prior in [
        &problem.pictures[0],
        &problem.pictures[6],
        &problem.pictures[15],
    ] {
        let cost = problem.cost(&[0.2], 1.0, prior).unwrap().unwrap();
        let want = dense(prior) + 0.5 * (0.2f64 / 0.3).powi(2);
        assert!(
            (cost - want).abs() < 1e-8 * want.abs().max(1.0),
            "{cost} for {want}"
        );
    }
    let state = problem.state(&[0.2], 1.0, None).unwrap();
    let best = problem
        .pictures
        .iter()
        .map(dense)
        .fold(f64::INFINITY, f64::min);
    assert!((state.value.cost - best).abs() < 1e-8 * best.abs().max(1.0));
}

/// y ~ N(0, A R Rᵀ Aᵀ + T V Tᵀ) beside a constant and a slope of each frame, as one dense matrix
/// S: −ln p of what they leave is ½ yᵀPy + ½ ln det S + ½ ln det FᵀS⁻¹F, P = S⁻¹ − S⁻¹F(FᵀS⁻¹F)⁻¹
/// FᵀS⁻¹, up to a constant; that of a field without what is shared is that of noise alone.
#[test]
fn likelihoods_of_different_errors_are_comparable() {
    let scene = of_two_spots();
    let (phi, _) = photographs(&scene, 2, 0.1, 3);
    let level = phi.amax();
    let patterns = Matrix::from_fn(12, 2, |p, k| if k == 0 { 1.0 } else { (p % 4) as f64 });
    let parameters = Parameter::named(&scene, "hidden.normal").unwrap();
    let pictures = pictures(&scene);
    let photographs = Unexplained {
        phi: &phi,
        stderr: None,
        certainty: Certainty::STATED,
        left_out: None,
        patterns: Some(&patterns),
    };
    let problem = problem(&scene, &parameters, photographs, &pictures, 0);
    let light = problem.geometry.light(&[0.2], 0.0, false).unwrap();
    let prior = &pictures[6];
    let a = Matrix::from_fn(24, 4, |k, j| light.frame(k / 12)[(k % 12, j)]);
    let y = Matrix::from_fn(24, 1, |k, _| phi[(k % 12, k / 12)])
        - &a * Matrix::from_element(4, 1, prior.mean);
    let f = Matrix::from_fn(24, 4, |k, j| {
        f64::from(u8::from(k / 12 == j / 2)) * patterns[(k % 12, j % 2)]
    });
    let dense = |errors: &ErrorField| {
        let v = DVector::from_vec(errors.variances([4, 3]));
        let once = from_cosines(&Matrix::from_diagonal(&v), [4, 3]);
        let own = from_cosines(&once.transpose(), [4, 3]);
        let light = &a * &prior.root;
        let mut s = &light * light.transpose();
        for (k, j) in (0..24).flat_map(|k| (0..24).map(move |j| (k, j))) {
            if k / 12 == j / 12 {
                s[(k, j)] += own[(k % 12, j % 12)];
            }
        }
        let s = nalgebra::Cholesky::new(s / (level * level)).unwrap();
        let (y, f) = (&y / level, &f);
        let gram = nalgebra::Cholesky::new(f.tr_mul(&s.solve(f))).unwrap();
        let seen = f.tr_mul(&s.solve(&y));
        let left = y.dot(&s.solve(&y)) - seen.dot(&gram.solve(&seen));
        0.5 * (left + s.determinant().ln() + gram.determinant().ln())
    };
    let total = |errors: ErrorField| {
        let field = field::Field::new(&problem, errors).unwrap();
        let own = problem.with_field(&field).unwrap();
        let state = own.state(&[0.2], 1.0, Some(prior)).unwrap();
        own.total(&state)
    };
    let errors = |pixel: f64, shared: f64, range: f64| ErrorField {
        pixel: pixel * level,
        shared: shared * level,
        range,
    };
    let white = errors(0.1, 0.0, 1.0);
    let state = problem.state(&[0.2], white.pixel, Some(prior)).unwrap();
    let alone = problem.total(&state);
    assert!((total(white) - alone).abs() < 1e-8 * alone.abs(), "{alone}");
    for other in [errors(0.1, 0.3, 2.0), errors(0.01, 0.2, 5.0)] {
        let [found, want] = [total(other) - total(white), dense(&other) - dense(&white)];
        assert!((found - want).abs() < 1e-7 * want.abs(), "{found} {want}");
    }
    // Those that are found are the likeliest.
    let mut field = field::Field::new(&problem, white).unwrap();
    let found = problem.likeliest_errors(&mut field, &state, Control::none());
    assert!(found.unwrap());
    let best = total(field.errors);
    for [pixel, shared] in [
        [1.1, 1.0],
        [0.9, 1.0],
        [1.0, 1.1],
        [1.0, 0.9],
        [1.1, 1.1],
        [0.9, 0.9],
    ] {
        let other = ErrorField {
            pixel: field.errors.pixel * pixel,
            shared: field.errors.shared * shared,
            ..field.errors
        };
        let gained = best - total(other);
        assert!(gained < 0.01, "{:?} {other:?}: {gained}", field.errors);
    }
}

/// The slope at `values` by some unknowns against differences of the cost.
pub(super) fn is_slope_of_the_cost(problem: &Problem<'_>, values: &[f64], unknowns: &[usize]) {
    let state = problem.state(values, 1.0, None).unwrap();
    let slope = problem.whole_slope(&state);
    for &k in unknowns {
        let h = 1e-4;
        let at = |x: f64| {
            let mut values = values.to_vec();
            values[k] += x;
            problem.cost(&values, 1.0, &state.prior).unwrap().unwrap()
        };
        let want = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
        let off = (slope[k] - want).abs() / want.abs().max(1.0);
        assert!(off < 1e-5, "{k}: {} for {want}", slope[k]);
    }
}

/// Slopes are those of the cost, gains among them; of an obstructed scene too.
#[test]
fn slopes_are_those_of_the_cost() {
    let scene = small("bench", 4);
    let (phi, stderr) = photographs(&scene, 2, 0.02, 4);
    let parameters = ["hinge.angle", "hidden.normal", "spots.shift"];
    let parameters: Vec<Parameter> = parameters
        .iter()
        .flat_map(|name| Parameter::named(&scene, name).unwrap())
        .collect();
    let frames = phi.ncols();
    let pictures = pictures(&scene);
    let photographs = unexplained(&phi, &stderr);
    let problem = problem(&scene, &parameters, photographs, &pictures, frames);
    let mut values = vec![0.3, -0.05, 0.02, 0.04];
    values.extend((0..frames).map(|l| 0.01 * (l % 3) as f64));
    is_slope_of_the_cost(&problem, &values, &[0, 1, 2, 3, 4, 5, 4 + frames - 1]);
}
