use std::f64::consts::{FRAC_1_PI, SQRT_2};
use std::sync::atomic::AtomicBool;

use nalgebra::DVector;

use super::layout::{HALF_WIDTHS, PIXELS, TRACED, VIEWS, View, board, scene};
use super::system::System;
use super::{Modelled, Seen, modelled};
use crate::lab::LabError;
use crate::lab::published::ReproducePlan;
use crate::model::{Kernel, MatrixModel};
use crate::recovery::{Method, Options, Problem, recover};
use crate::transport::Control;

/// Every view is where it is said to be, and on the wall; the fixed one does not move.
#[test]
fn views_keep_their_offset_and_the_wall() {
    for (name, half_width) in HALF_WIDTHS {
        let scene = scene(name, 2).unwrap();
        for view in VIEWS {
            for spot in 0..scene.laser.spots.len() {
                let seen = view.at(&scene, spot);
                let centre = seen.camera.view.at([0.5, 0.5]).position;
                let lit = scene.laser.spots[spot].target.position;
                let want = match view {
                    View::Fixed => [4.875, 4.375],
                    // The spots' square, 2 in. further left.
                    View::Wide => [3.0, 4.373476808130942],
                    View::Moving {
                        offset: [dx, dy], ..
                    } => [lit.x + dx, lit.y + dy],
                };
                assert!((centre.x - want[0]).abs() < 1e-12 && (centre.y - want[1]).abs() < 1e-12);
                // The wide one reaches half a view and the stagger of 1 in. beyond the square on
                // either side.
                let width = match view {
                    View::Wide => 2.0 * half_width + 3.25 + 2.0,
                    _ => 3.25,
                };
                assert!((seen.camera.view.area() - width * width).abs() < 1e-9);
                for corner in seen.camera.view.corners() {
                    let wall = &scene.surfaces[0].shape;
                    assert_eq!(wall.at_xy(corner.x, corner.y).len(), 1, "{name} {corner}");
                }
                let photograph = view.photograph(&scene, spot).unwrap();
                let [own] = photograph.laser.spots[..] else {
                    panic!("{} spots", photograph.laser.spots.len());
                };
                assert!((own.target.position - lit).length() < 1e-12);
                assert_eq!(photograph.camera, seen.camera);
            }
        }
    }
}

/// K by the formula of the bench: Φlaser (ρ1/π) A G12 · E (ρ3/π) G23/π, both G = z2 (15.5 −
/// y)/√2/R⁴, the pixel where the moved view has it.
#[test]
fn rows_have_the_g23_of_their_own_view() {
    let scene = scene("bench", PIXELS).unwrap();
    let rho = |j: usize| {
        (0..64)
            .map(|k| f64::from(u8::from(k == j)))
            .collect::<Vec<_>>()
    };
    let system = System::new(&scene, TRACED, Kernel::Physical, 1).unwrap();
    for (pixel, spot, element) in [(0, 0, 0), (13, 47, 9), (63, 119, 62)] {
        let lit = scene.laser.spots[spot].target.position;
        let place = |at: usize| 3.25 / 8.0 * (at as f64 + 0.5) - 1.625;
        let seen = [lit.x - 2.0 + place(pixel % 8), lit.y + place(pixel / 8)];
        let d = (5.867_64 + 0.25 + 0.5 * (element / 8) as f64) / SQRT_2;
        let (x2, y2, z2) = (3.25 + 0.5 * (element % 8) as f64, 15.5 - d, d);
        let g = |x: f64, y: f64| {
            let r2 = (x - x2).powi(2) + (y - y2).powi(2) + z2 * z2;
            z2 * (15.5 - y) / SQRT_2 / (r2 * r2)
        };
        let d2 = (seen[0] + 20.0).powi(2) + (seen[1] - 10.0).powi(2) + 225.0;
        let etendue = 0.05 * 225.0 / (d2 * d2) * (3.25 / 8.0) * (3.25 / 8.0);
        let want = 5e-3
            * 0.8
            * FRAC_1_PI
            * 0.25
            * g(lit.x, lit.y)
            * etendue
            * (0.8 * FRAC_1_PI)
            * g(seen[0], seen[1])
            * FRAC_1_PI;
        let found = system.light(&rho(element))[pixel + 64 * spot];
        // The scene file has the object's corner to sixteen digits, S2's tilt to fifteen.
        assert!((found / want - 1.0).abs() < 1e-12, "{found:e} for {want:e}");
    }
}

/// For the fixed view the rows are the Khatri–Rao product that `joint` works on: the same singular
/// values.
#[test]
fn the_fixed_view_is_the_operator_of_joint() {
    let scene = scene("thesis", 4).unwrap();
    let model = MatrixModel::new(&scene, Kernel::Physical, None).unwrap();
    let phi = model.phi();
    let problem = Problem::new(&phi, &model.camera_side, &model.laser_side, None).unwrap();
    let found = recover(Method::JointUnbounded, &problem, &Options::default()).unwrap();
    let system = System::new(&scene, View::Fixed, Kernel::Physical, 1).unwrap();
    let sigma = system.sigma().unwrap();
    for (a, b) in found.sigma.iter().zip(&sigma) {
        assert!((a - b).abs() < 1e-13 * sigma[0], "{a:e} for {b:e}");
    }
    assert!(
        (system.light(&model.albedo) - DVector::from_column_slice(phi.as_slice())).amax()
            < 1e-13 * phi.amax()
    );
}

/// A planted grey object comes back exactly, to the rounding of Φ times the condition; through the
/// rows of the fixed view it does not.
#[test]
fn a_planted_object_is_recovered_from_moving_photographs() {
    let scene = scene("thesis", PIXELS).unwrap();
    let planted: Vec<f64> = (0..64)
        .map(|j| 0.1 + 0.8 * f64::from(j * 37 % 64) / 64.0)
        .collect();
    let system = System::new(&scene, TRACED, Kernel::Physical, 1).unwrap();
    let phi = system.light(&planted);
    let ones = DVector::from_element(phi.len(), 1.0);
    let error = |system: &System| {
        let weighted = system.weighted(&phi).unwrap();
        let along = weighted.along(&ones);
        let found = weighted
            .recover(Method::JointUnbounded, &along, 1.0)
            .unwrap();
        let condition = weighted.sigma[0] / weighted.sigma[63];
        let planted = DVector::from_row_slice(&planted);
        ((found.reflectance - planted).amax(), condition)
    };
    let (own, condition) = error(&system);
    assert!(
        own < 10.0 * f64::EPSILON * condition,
        "{own:e} at {condition:e}"
    );
    assert!(own < 1e-3);
    let fixed = System::new(&scene, View::Fixed, Kernel::Physical, 1).unwrap();
    assert!(error(&fixed).0 > 1.0);
}

/// Elements by 4 × 4 points are nearer to the integral over their area than by their centres: an
/// object of one albedo against the same by 16 × 16 points.
#[test]
fn finer_elements_converge() {
    let scene = scene("bench", 2).unwrap();
    let light = |points| {
        let system = System::new(&scene, TRACED, Kernel::Physical, points).unwrap();
        system.light(&[0.5; 64])
    };
    let exact = light(16);
    let [centres, fine] = [1, 4].map(|n| (light(n) - &exact).norm() / exact.norm());
    // The midpoint rule is of second order.
    assert!(
        fine < centres / 12.0 && fine < 2e-4,
        "{fine:e}, {centres:e}"
    );
}

/// The contrast's standard error is the spread of the contrast over draws: 400 of them tell it to
/// 3.5 %, here to five times that.
#[test]
#[ignore = "slow"]
fn the_contrast_error_is_what_noise_makes() {
    let scene = scene("thesis", 4).unwrap();
    let truth = board(2);
    let system = System::new(&scene, TRACED, Kernel::Physical, 1).unwrap();
    let exact = system.light(&truth);
    let weighted = system.weighted(&exact).unwrap();
    let clean = weighted.along(&DVector::from_element(exact.len(), 1.0));
    let unit = modelled::contrast_error(&weighted, &clean, &truth).unwrap();
    let noise = 1e-9;
    let contrast = |seed: u64| {
        let z = crate::lab::deviate::normal_deviates(seed, exact.len(), 1);
        let z = weighted.along(&DVector::from_column_slice(z.as_slice()));
        let found = weighted
            .recover(Method::JointUnbounded, &(&clean + z * noise), noise)
            .unwrap();
        let (light, dark) =
            crate::metrics::light_and_dark(found.reflectance.as_slice(), &truth).unwrap();
        light - dark
    };
    let draws = 400;
    let all: Vec<f64> = (0..draws).map(contrast).collect();
    let mean = all.iter().sum::<f64>() / draws as f64;
    let spread = (all.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (draws - 1) as f64).sqrt();
    assert!(
        (spread / (noise * unit) - 1.0).abs() < 0.18,
        "{spread:e} for {:e}",
        noise * unit
    );
}

/// 0.95 at 1e-2 and 0.85 at 1e-1: half way to 0.9 by the logarithm.
#[test]
fn the_noise_borne_is_read_between_the_levels() {
    let course = |mtf: &[Option<f64>]| modelled::Course {
        checks: 2,
        points: mtf
            .iter()
            .zip([1e-3, 1e-2, 1e-1])
            .map(|(mtf, noise)| modelled::Point {
                noise,
                effective_rank: 0,
                contrast_error: 0.0,
                mtf: *mtf,
            })
            .collect(),
    };
    let borne = |mtf: &[Option<f64>]| course(mtf).borne();
    let half = borne(&[Some(1.0), Some(0.95), Some(0.85)]).unwrap();
    assert!((half / 10f64.powf(-1.5) - 1.0).abs() < 1e-12);
    assert_eq!(borne(&[Some(1.0), Some(0.95), Some(0.9)]), Some(1e-1));
    assert_eq!(borne(&[Some(0.8), Some(0.95), Some(0.95)]), None);
    assert_eq!(borne(&[None; 3]), None);
}

#[test]
fn a_stop_is_heeded() {
    let plan = ReproducePlan {
        most_elements: 8,
        seeds: 2,
        first_seed: 1,
    };
    let control = Control {
        stop: &AtomicBool::new(true),
        ..Control::none()
    };
    let modelled = Modelled::compute(0, &plan, control);
    assert!(matches!(modelled, Err(LabError::Stopped(_))));
    let traced = Seen::compute(0, &plan, control);
    assert!(matches!(traced, Err(LabError::Stopped(_))));
}
