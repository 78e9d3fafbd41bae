use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

use super::figure::{change, figure};
use super::pair::{self, Direction};
use super::reciprocity::Reciprocity;
use super::spectrum::{participation, spectrum};
use crate::geometry::DVec3;
use crate::lab::LabError;
use crate::lab::published::ReproducePlan;
use crate::matrix::Matrix;
use crate::scene::Scene;
use crate::transport::Control;

/// The scene with 4 × 4 pixels and the centres of 4 × 4 cells as spots.
fn small() -> Scene {
    let mut scene = Scene::load("dual").unwrap();
    [scene.camera.columns, scene.camera.rows] = [4; 2];
    let place = |l: usize| [7.25 + (l % 4) as f64, 2.875 + (l / 4) as f64];
    scene
        .with_spots_at(&(0..16).map(place).collect::<Vec<_>>())
        .unwrap()
}

/// Spots become footprints and footprints spots, laser and pinhole change places; exchanged twice
/// all is as it was.
#[test]
fn exchanging_turns_spots_into_footprints_and_back() {
    for scene in [Scene::load("dual").unwrap(), small()] {
        let back = pair::exchanged(&scene).unwrap();
        assert_eq!(back.camera.position, scene.laser.position);
        assert_eq!(back.laser.position, scene.camera.position);
        let again = pair::exchanged(&back).unwrap();
        let near = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-12, "{a} for {b}");
        let [width, height] = [scene.camera.columns, scene.camera.rows];
        for l in 0..width * height {
            let spot = scene.laser.spots[l].target.position;
            near(back.camera.footprint(l).at([0.5, 0.5]), spot);
            near(again.laser.spots[l].target.position, spot);
        }
        // Cells touch: the first spot is half a step off the corner.
        let step =
            scene.laser.spots[width + 1].target.position - scene.laser.spots[0].target.position;
        near(
            back.camera.view.corner(),
            scene.laser.spots[0].target.position - step * 0.5,
        );
    }
}

/// Above the middle of a rectangle the étendues add up to A_lens·π·F with the form factor F of a
/// point element and a parallel rectangle, four times (X/√(1+X²)·atan(Y/√(1+X²)) +
/// Y/√(1+Y²)·atan(X/√(1+Y²)))/2π for the quarters of sides X and Y times the height.
#[test]
fn etendues_add_up_to_the_form_factor_of_the_view() {
    let mut scene = Scene::load("dual").unwrap();
    scene.camera.position = DVec3::new(2.5, 4.375, 3.0);
    let (x, y) = (2.0f64 / 3.0, 2.0f64 / 3.0);
    let half = |x: f64, y: f64| {
        let root = (1.0 + x * x).sqrt();
        x / root * libm::atan(y / root)
    };
    let want = 0.05 * PI * 4.0 * (half(x, y) + half(y, x)) / (2.0 * PI);
    let found: f64 = pair::etendues(&scene, pair::NODES).iter().sum();
    assert!((found / want - 1.0).abs() < 1e-12, "{found} for {want}");
}

/// The law holds between two renders within their error bars; without transposing, without
/// étendues, or with étendues 5 % off it does not.
#[test]
fn two_renders_obey_reciprocity() {
    let scene = small();
    let back = pair::exchanged(&scene).unwrap();
    let there = Direction::trace(scene, 16, 3, Control::none()).unwrap();
    let mut back = Direction::trace(back, 16, 4, Control::none()).unwrap();
    let law = Reciprocity::new(&there, &back).unwrap();
    assert!(law.entries.agrees, "{:?}", law.entries);
    assert!(law.pictures.agrees, "{:?}", law.pictures);
    assert!(!law.untransposed.agrees && !law.scaleless.agrees);
    assert!(law.entries.relative_noise < 0.02);
    back.etendues.iter_mut().for_each(|e| *e *= 1.05);
    let law = Reciprocity::new(&there, &back).unwrap();
    assert!(!law.entries.agrees && !law.pictures.agrees);
}

/// An orthogonal matrix has as many alike singular values as rows, a product of two vectors one.
#[test]
fn participation_counts_alike_singular_values() {
    let orthogonal = Matrix::from_row_slice(2, 2, &[0.6, -0.8, 0.8, 0.6]) * 7.0;
    assert!((participation(&spectrum(&orthogonal).unwrap()) - 2.0).abs() < 1e-14);
    let product = Matrix::from_fn(3, 3, |i, j| (1.0 + i as f64) * (2.0 - j as f64));
    assert!((participation(&spectrum(&product).unwrap()) - 1.0).abs() < 1e-14);
}

/// (1, 1) beside (1, 0): the best scale is 1, and (0, 1) is left of √2.
#[test]
fn changes_are_taken_after_the_best_scale() {
    assert!((change(&[1.0, 1.0], &[1.0, 0.0]) - 0.5f64.sqrt()).abs() < 1e-15);
    assert!(change(&[2.0, 6.0], &[1.0, 3.0]) < 1e-15);
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
    let stopped = figure(&plan, control);
    assert!(matches!(stopped, Err(LabError::Stopped(_))));
}
