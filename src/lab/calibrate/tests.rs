//! The likelihood against a dense normal distribution, its slope against differences, estimates
//! against scenes that are displaced.

use nalgebra::DVector;

use super::picture::{Prior, priors};
use super::*;
use crate::lab::finding::Describe;
use crate::lab::pooled::tests::repeated;
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
        replicates: None,
        errors: Errors::Independent,
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

/// A hinge, a distance and a yaw that are wrong come back within three errors, which are small, and
/// the file that is written is the scene.
#[test]
fn a_displaced_scene_is_found() {
    let scene = small("bench", 8);
    let names = ["hinge.angle", "hidden.normal", "hidden.yaw"];
    let parameters: Vec<Parameter> = names
        .iter()
        .flat_map(|name| Parameter::named(&scene, name).unwrap())
        .collect();
    let truth = [1.0, 0.1, 1.0];
    let there = scene.displaced(&parameters, &truth).unwrap();
    let (phi, stderr) = photographs(&there, 4, 1e-3, 5);
    let found = plan(&names, 4).calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
    let found = found.unwrap();
    assert!(found.is_settled && found.p.unwrap() > 1e-3, "{:?}", found.p);
    for (own, want) in found.found.iter().zip(truth) {
        let off = (own.value - want) / own.stderr;
        assert!(off.abs() < 3.0 && own.stderr < 0.15 * want, "{own:?}");
    }
    let written = Scene::from_toml("calibrated", &found.toml).unwrap();
    let values: Vec<f64> = found.found.iter().map(|f| f.value).collect();
    let own = scene.displaced(&parameters, &values).unwrap();
    let phi = |scene: &Scene| {
        MatrixModel::new(scene, Kernel::Physical, None)
            .unwrap()
            .phi()
    };
    let (a, b) = (phi(&own), phi(&written));
    assert!((a - &b).norm() < 1e-12 * b.norm());
}

/// Photographs in another order than the spots are no picture of any geometry: that comes first,
/// and that nothing is estimated.
#[test]
fn photographs_of_no_geometry_come_with_that_verdict_first() {
    let scene = small("bench", 8);
    let names = ["hinge.angle", "hidden.yaw"];
    let told = |is_in_order: bool| {
        let (mut phi, mut stderr) = photographs(&scene, 4, 1e-2, 5);
        let last = phi.ncols() - 1;
        for l in 0..=last / 2 {
            if !is_in_order {
                phi.swap_columns(l, last - l);
                stderr.swap_columns(l, last - l);
            }
        }
        let found = plan(&names, 4).calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
        found.unwrap().describe().sentence
    };
    let (right, wrong) = (told(true), told(false));
    assert!(right.starts_with("From what the scene says"), "{right}");
    assert!(
        wrong.starts_with("The photographs fit NO geometry"),
        "{wrong}"
    );
    assert!(wrong.contains("these are no estimates"), "{wrong}");
}

/// A board that is turned where only its distance is free: its light by a finer rule leaves as
/// much, so that the photographs refute it however coarse its elements are.
#[test]
fn a_misfit_that_a_finer_rule_leaves_refutes() {
    let scene = small("bench", 8);
    let yaw = Parameter::named(&scene, "hidden.yaw").unwrap();
    let there = scene.displaced(&yaw, &[4.0]).unwrap();
    let (kernel, occlusion) = (Kernel::Physical, Occlusion::Considered);
    let model = MatrixModel::over_areas(&there, kernel, Some([2; 2]), occlusion, Effort::USUAL);
    let phi = model.unwrap().phi();
    let stderr = &phi * 1e-3;
    let plan = CalibrationPlan {
        integration: Integration::Quadrature,
        ..plan(&["hidden.normal"], 2)
    };
    let found = plan.calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
    let found = found.unwrap();
    assert!(found.finer_misfit.unwrap() > 2.0, "{found:?}");
    assert!(!found.is_found(), "{}", found.describe().sentence);
}

/// Where no noise is stated, what the model lacks is not told from noise: the sentence says so.
#[test]
fn an_estimate_without_a_stated_noise_is_conditional() {
    let scene = small("bench", 8);
    let (phi, stderr) = photographs(&scene, 4, 1e-2, 5);
    let told = |is_stated: bool| {
        let photographs = Unexplained {
            stderr: is_stated.then_some(&stderr),
            ..unexplained(&phi, &stderr)
        };
        let plan = plan(&["hinge.angle"], 4);
        let found = plan.calibrate(&scene, &photographs, Control::none());
        found.unwrap().describe().sentence
    };
    assert!(told(true).starts_with("From what the scene says: hinge.angle"));
    assert!(told(false).starts_with("If what is left over is noise, from what the scene says:"));
}

/// What moves together is refused with its names, and taken where one of it is known.
#[test]
fn what_light_does_not_tell_is_refused() {
    let scene = small("bench", 4);
    let (phi, stderr) = photographs(&scene, 2, 0.1, 6);
    let photographs = unexplained(&phi, &stderr);
    let mut together = plan(&["spots.x", "view.x", "camera.x", "laser.x"], 2);
    let refused = together.calibrate(&scene, &photographs, Control::none());
    let refused = refused.unwrap_err().to_string();
    assert!(
        refused.contains("do not tell") && refused.contains("laser.x"),
        "{refused}"
    );
    together.free.iter_mut().for_each(|f| f.sigma = Some(0.1));
    let held = together
        .calibrate(&scene, &photographs, Control::none())
        .unwrap();
    assert!(!held.untold.is_empty());
    let laser = &held.found[3];
    assert!((laser.stderr / 0.1 - 1.0).abs() < 0.05, "{laser:?}");
    let refused = Parameter::named(&scene, "hidden.u")
        .unwrap_err()
        .to_string();
    assert!(refused.contains("own plane"), "{refused}");
}

/// A plate in the way that is not where it is thought to be, by differences of what it leaves
/// visible.
#[test]
#[ignore = "slow"]
fn a_displaced_occluder_is_found() {
    let mut file = SceneFile::builtin("bench").unwrap();
    file.camera.pixels = [8; 2];
    file.laser.as_mut().unwrap().spots.per_side = Some(3);
    let plate = r#"
[[surface]]
name = "plate"
role = "occluder"
rectangle = { corner = [4.5, 6.0, 2.0], u = [1.0, 0.0, 0.0], v = [0.0, 1.0, 0.0] }
material = { lambertian = 0.0 }
"#;
    let text = file.toml().unwrap() + plate;
    let scene = Scene::from_toml("plate", &text).unwrap();
    let names = ["occluders.x", "occluders.y", "hidden.normal"];
    let parameters: Vec<Parameter> = names
        .iter()
        .flat_map(|name| Parameter::named(&scene, name).unwrap())
        .collect();
    let truth = [0.08, -0.05, 0.06];
    let there = scene.displaced(&parameters, &truth).unwrap();
    let (phi, stderr) = photographs(&there, 4, 1e-2, 7);
    let found = plan(&names, 4).calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
    let found = found.unwrap();
    assert!(found.is_settled && found.p.unwrap() > 1e-3, "{:?}", found.p);
    for (own, want) in found.found.iter().zip(truth) {
        let off = (own.value - want) / own.stderr;
        assert!(off.abs() < 3.5 && own.stderr < 0.5 * want.abs(), "{own:?}");
    }
}

/// Errors of 0 weigh nothing: whatever is photographed fits, and so it is refused.
#[test]
fn errors_that_are_all_zero_are_refused() {
    let scene = small("bench", 4);
    let (phi, stderr) = photographs(&scene, 2, 0.01, 1);
    let zero = stderr * 0.0;
    let found =
        plan(&["hidden.normal"], 2).calibrate(&scene, &unexplained(&phi, &zero), Control::none());
    let said = found.unwrap_err().to_string();
    assert!(said.contains("every standard error is 0"), "{said}");
}

/// Of errors that entries share it is said that they do not average out, in place of that they are
/// those of the noise; of others not.
#[test]
fn errors_that_hang_together_are_told() {
    let scene = small("bench", 4);
    let (phi, stderr) = photographs(&scene, 2, 0.01, 1);
    for errors in Errors::ALL {
        let how = CalibrationPlan {
            errors,
            ..plan(&["hidden.normal"], 2)
        };
        let found = how.calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
        let notes = found.unwrap().describe().notes.concat();
        let is_shared = errors != Errors::Independent;
        assert_eq!(notes.contains("HANG TOGETHER"), is_shared, "{notes}");
        assert_eq!(notes.contains("those of the noise"), !is_shared, "{notes}");
    }
}

/// A picture that changes within the elements bends the geometry: twice as many are asked for, the
/// error counts what they move, and knows the truth again. A picture of the elements asks for none.
#[test]
fn a_picture_that_is_not_even_asks_for_finer_elements() {
    let scene = small("bench", 6);
    let extent = crate::model::Extent::UNOBSTRUCTED;
    let board = scene.with_checkerboard(2);
    let phi = crate::model::converged(&board, Kernel::Physical, extent)
        .unwrap()
        .phi;
    for (elements, is_asked) in [(2, false), (1, true)] {
        let stderr = &phi * 3e-3;
        let mut random = normal(3);
        let noisy = phi.zip_map(&stderr, |x, s| x + s * random()[0]);
        let how = CalibrationPlan {
            integration: Integration::Quadrature,
            ..plan(&["hidden.normal", "hidden.pitch"], elements)
        };
        let found = how.calibrate(&scene, &unexplained(&noisy, &stderr), Control::none());
        let found = found.unwrap();
        let finer = found.finer_elements.as_ref().unwrap();
        assert_eq!(finer.elements, [2 * elements; 2]);
        assert_eq!(finer.is_asked(), is_asked, "{finer:?}");
        for own in &found.found {
            assert_eq!(own.by_elements.is_some(), is_asked);
            assert!(own.value.abs() < 4.0 * own.stderr, "{own:?}");
            let bent = own.value.abs() > 4.0 * own.by_curvature;
            assert!(!bent || is_asked, "{own:?}");
        }
        let said = format!("{:?}", found.describe());
        assert_eq!(said.contains("--elements 2x2"), is_asked);
    }
}

/// Wide spots past a thin rod, photographs traced, which knows of no elements: the stated error
/// knows what their light is not integrated to, and no geometry is refuted for it.
#[test]
#[ignore = "slow"]
fn what_the_integration_leaves_is_in_the_errors() {
    let text = r#"
name = "rod"
unit = "cm"
max_bounces = 3
[laser]
power = 1.0
wavelength = 500e-9
position = [30.0, 8.0, 13.0]
spot_diameter = 2.0
[laser.spots]
layout = "list"
points = [[8, 2], [8, 5], [8, 8], [8, 11], [-8, 3], [-8, 6], [-8, 9], [0, 12]]
[camera]
position = [5.0, -10.0, 35.0]
aperture_area = 0.1
view = { x = [-4, 6], y = [2, 8] }
pixels = [5, 3]
[[surface]]
name = "wall"
role = "relay"
rectangle = { corner = [-10, 0, 0], u = [20, 0, 0], v = [0, 15, 0] }
material = { lambertian = 0.6 }
[[surface]]
name = "board"
role = "hidden"
rectangle = { corner = [-3, 5, 22], u = [0, 5, -1], v = [5, 0, 0] }
material = { lambertian = { checkerboard = [2, 2], dark = 0.2, light = 0.9 } }
elements = [2, 2]
[[surface]]
name = "rod"
role = "occluder"
rectangle = { corner = [2.6, 0.5, 11.0], u = [0, 13, 0], v = [0.5, 0, 0] }
sides = "two"
material = { lambertian = 0.0 }
"#;
    let scene = Scene::from_toml("rod", text).unwrap();
    let how = Plan {
        estimator: Estimator::Factored,
        sampling: Sampling::Sobol,
        seed: 1,
        budget: Budget::new(1 << 16, Sampling::Sobol).unwrap(),
    };
    let traced = render(&scene, &how, 0..8, Control::none()).unwrap();
    let photographs = unexplained(&traced.flux, &traced.stderr);
    let found = plan(&["rod.v"], 2).calibrate(&scene, &photographs, Control::none());
    let found = found.unwrap();
    let own = &found.found[0];
    assert!(own.by_rule.unwrap() > own.by_curvature, "{own:?}");
    assert!(own.stderr >= own.by_rule.unwrap(), "{own:?}");
    assert!(
        own.value.abs() < 3.0 * own.stderr && own.value.abs() > 3.0 * own.by_curvature,
        "{own:?}"
    );
    assert!(found.is_found(), "{:?} {:?}", found.misfit, found.p);
}

/// χ² of errors from 8 replicates, by draws of Student's t of 7 degrees of freedom as ratios of
/// normal numbers: one in a hundred is below p = 0.01, within the binomial error of 2000.
#[test]
fn estimated_errors_are_expected_to_scatter() {
    let mut random = normal(11);
    let estimated = Certainty::new(Errors::Independent, Some(8));
    let mut t2 = || {
        let own = random()[0];
        let squares: f64 = (0..7).map(|_| random()[0]).map(|x| x * x).sum();
        own * own * 7.0 / squares
    };
    let draws = 1000;
    let few = |level: f64, all: &[f64]| all.iter().filter(|p| **p < level).count();
    let all: Vec<f64> = (0..draws)
        .map(|_| estimated.by_noise((0..400).map(|_| t2()).sum(), 400.0))
        .collect();
    // Tails heavier than those of χ²: up to twice as many as stated, and no fewer than half.
    let below = few(0.05, &all);
    assert!((25..=100).contains(&below), "{below}");
    assert!(Certainty::STATED.by_noise(1.4 * 400.0, 400.0) < 1e-6);
}

/// Three photographs of each spot: over 40 draws the hinge is off by its stated error, √χ²/n within
/// four of its standard errors 1/√(2n), and the photographs are not refuted, as they are where each
/// error is taken for known.
#[test]
fn errors_of_three_replicates_are_pooled() {
    let scene = small("bench", 12);
    let names = ["hinge.angle"];
    let parameters = Parameter::named(&scene, names[0]).unwrap();
    let there = scene.displaced(&parameters, &[0.5]).unwrap();
    let (exact, sigma) = photographs(&there, 2, 0.0, 0);
    let sigma = sigma.map(|_| 0.01 * exact.mean());
    let pooled = CalibrationPlan {
        replicates: Some(3),
        ..plan(&names, 2)
    };
    let known = plan(&names, 2);
    let draws = 40;
    let mut squares = [0.0; 2];
    let mut refuted = [0; 2];
    for seed in 0..draws {
        let [phi, stderr] = repeated(&exact, &sigma, 3, 50 + seed);
        for (k, plan) in [&pooled, &known].into_iter().enumerate() {
            let found = plan.calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
            let found = found.unwrap();
            let own = &found.found[0];
            squares[k] += ((own.value - 0.5) / own.by_curvature).powi(2);
            refuted[k] += u32::from(found.p.unwrap() < 1e-3);
        }
    }
    let [pooled, known] = squares.map(|sum| (sum / draws as f64).sqrt());
    let most = 1.0 + 4.0 / (2.0 * draws as f64).sqrt();
    assert!(pooled < most && refuted[0] == 0, "{pooled} {refuted:?}");
    assert!(known > most && refuted[1] > 30, "{known} {refuted:?}");
}

/// Photographs of a hinge that is wrong, with a drawn field of errors of a fifteenth of the light
/// beside noise: over 24 draws the hinge lies within its stated errors as often as it should, where
/// errors by noise of single pixels are too small; the field's numbers and that it is likelier are
/// found. Of noise alone errors stay what they are, and nothing is much likelier.
#[test]
fn errors_allow_for_what_neighbours_share() {
    let scene = small("bench", 12);
    let parameters = Parameter::named(&scene, "hinge.angle").unwrap();
    let there = scene.displaced(&parameters, &[1.0]).unwrap();
    let clean = MatrixModel::new(&there, Kernel::Physical, Some([2; 2])).unwrap();
    let clean = clean.phi();
    let level = clean.norm() / (clean.len() as f64).sqrt();
    let draw = |shared: f64, seed: u64, error_field: bool| {
        let truth = ErrorField {
            pixel: 0.02 * level,
            shared: shared * level,
            range: 4.0,
        };
        let v = truth.variances([12; 2]);
        let mut random = normal(seed);
        let errors = Matrix::from_fn(144, clean.ncols(), |k, _| v[k].sqrt() * random()[0]);
        let phi = &clean + from_cosines(&errors, [12; 2]);
        let photographs = Unexplained {
            phi: &phi,
            stderr: None,
            left_out: None,
            patterns: None,
        };
        let plan = CalibrationPlan {
            error_field,
            ..plan(&["hinge.angle"], 2)
        };
        let found = plan.calibrate(&scene, &photographs, Control::none());
        (found.unwrap(), truth)
    };
    let off = |found: &Calibration| (found.found[0].value - 1.0) / found.found[0].stderr;
    let (mut told, mut alone, mut sizes) = (0, 0.0, [0.0; 2]);
    for seed in 0..24 {
        let (found, truth) = draw(0.06, seed, true);
        let z = off(&found);
        told += usize::from(z.abs() < 1.96);
        let field = found.field.unwrap();
        sizes[0] += field.pixel / truth.pixel / 24.0;
        sizes[1] += field.shared / truth.shared / 24.0;
        assert!(found.log_likelier.unwrap() > 1000.0 && found.is_settled);
        let (white, _) = draw(0.06, seed, false);
        alone += (white.found[0].value - 1.0).powi(2) / white.found[0].by_curvature.powi(2) / 24.0;
    }
    assert!(sizes.iter().all(|x| (x - 1.0).abs() < 0.15), "{sizes:?}");
    // Of 24 at 95 %: fewer than 20 in one of a thousand.
    assert!(told >= 20, "{told}");
    assert!(alone > 4.0, "{alone}");
    let (found, _) = draw(0.0, 1, true);
    let (white, _) = draw(0.0, 1, false);
    assert!(
        found.log_likelier.unwrap() < 6.0,
        "{:?}",
        found.log_likelier
    );
    let ratio = found.found[0].by_curvature / white.found[0].by_curvature;
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
}

/// Errors of neighbours are looked for where noise is unknown and all entries count.
#[test]
fn a_field_of_errors_is_refused_where_there_is_none() {
    let scene = small("bench", 4);
    let (phi, stderr) = photographs(&scene, 2, 0.1, 6);
    let plan = CalibrationPlan {
        error_field: true,
        ..plan(&["hinge.angle"], 2)
    };
    let refused = |photographs: &Unexplained<'_>| {
        let refused = plan.calibrate(&scene, photographs, Control::none());
        refused.unwrap_err().to_string()
    };
    let known = unexplained(&phi, &stderr);
    assert!(refused(&known).contains("is stated"));
    let holed = Matrix::from_fn(phi.nrows(), phi.ncols(), |p, _| f64::from(u8::from(p == 0)));
    let holed = Unexplained {
        stderr: None,
        left_out: Some(&holed),
        ..known
    };
    assert!(refused(&holed).contains("entries are left out"));
}
