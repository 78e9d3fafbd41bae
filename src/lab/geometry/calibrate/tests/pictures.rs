//! Geometries where the photographs say little of the picture, or nothing.

use super::*;
use crate::lab::finding::Tone;
use crate::lab::uncertainty::refined::tests::counted;

/// Light of 3 × 3 elements in black and white, W.
fn checks(scene: &Scene) -> Matrix {
    let model = MatrixModel::with(scene, Kernel::Physical, Some([3; 2]), Occlusion::Considered);
    let model = model.unwrap();
    let white = DVector::from_fn(9, |j, _| (j % 2) as f64);
    &model.camera_side * Matrix::from_diagonal(&white) * &model.laser_side
}

fn hinge() -> CalibrationPlan {
    let mut plan = plan(&["hinge.angle"], 3);
    plan.free[0].sigma = Some(1.0);
    plan
}

/// A board in black and white, photographed once by 6 × 6 pixels and by one pixel under 20 spots:
/// the likeliest prior is a grey one, with the board elsewhere. Its own error holds the truth, 0,
/// in hardly any of 20 draws; with the priors that are not excluded in 16 at least, the binomial
/// 99.9 %.
#[test]
fn a_board_in_few_photographs_is_within_the_errors() {
    let one_spot = small("bench", 6).with_spots_at(&[[2.0, 1.4]]).unwrap();
    for scene in [one_spot, small("bench", 1)] {
        let exact = checks(&scene);
        let stderr = &exact * 1e-3;
        let (mut held, mut by_curvature) = (0, 0);
        for seed in 0..20 {
            let mut random = normal(seed);
            let phi = exact.zip_map(&stderr, |x, s| x + s * random()[0]);
            let found = hinge().calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
            let own = &found.unwrap().found[0];
            held += u32::from(own.value.abs() < 1.96 * own.stderr);
            by_curvature += u32::from(own.value.abs() < 1.96 * own.by_curvature);
        }
        assert!(held >= 16 && by_curvature <= 8, "{held} {by_curvature}");
    }
}

/// Where the photographs tell the picture no other prior matters.
#[test]
fn a_picture_that_is_told_adds_nothing() {
    let scene = small("bench", 16);
    let (phi, stderr) = photographs(&scene, 2, 1e-3, 1);
    let found = plan(&["hinge.angle", "hidden.normal"], 2);
    let found = found.calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
    for own in found.unwrap().found {
        let more = own.by_pictures / own.by_curvature;
        assert!((0.9..1.1).contains(&more), "{}: {more}", own.name);
    }
}

/// Photographs of which nothing counts, or nothing but darkness, tell no geometry.
#[test]
fn no_light_tells_no_geometry() {
    let scene = small("bench", 4);
    let (phi, stderr) = photographs(&scene, 2, 0.01, 1);
    let (dark, all) = (&phi * 0.0, phi.map(|_| 1.0));
    let of = |photographs: Unexplained<'_>| {
        let found = plan(&["hidden.normal"], 2).calibrate(&scene, &photographs, Control::none());
        found.unwrap_err().to_string()
    };
    let left_out = Unexplained {
        left_out: Some(&all),
        ..unexplained(&phi, &stderr)
    };
    assert!(of(left_out).contains("every entry of phi is left out"));
    for stderr in [Some(&stderr), None] {
        let dark = Unexplained {
            stderr,
            ..unexplained(&dark, &phi)
        };
        assert!(of(dark).contains("every entry of phi is zero"));
    }
}

/// Photographs with the wrong sign fit a picture below 0, and three times too bright ones one above
/// 1: that no surface is so is said, and nothing is found; of right ones not.
#[test]
fn pictures_that_cannot_be_are_told() {
    let scene = small("bench", 8);
    let (phi, stderr) = photographs(&scene, 2, 1e-3, 1);
    for times in [1.0, -1.0, 3.0] {
        let (phi, stderr) = (&phi * times, &stderr * f64::abs(times));
        let found = plan(&["hidden.normal"], 2);
        let found = found.calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
        let found = found.unwrap();
        let said = found.describe();
        let is_told = said.notes.concat().contains("no surface reflects less");
        assert_eq!(is_told, times != 1.0, "{times}: {:?}", said.notes);
        assert_eq!(found.is_found(), times == 1.0, "{times}");
        assert!(times == 1.0 || said.tone == Tone::Bad);
    }
}

/// Photographs of one count an entry with √n for errors: of 40 draws of right ones at most one is
/// refuted at 1e-3, and hinge and error go together, within four of the errors of a root mean
/// square.
#[test]
fn right_light_of_few_counts_is_not_refuted() {
    let scene = small("bench", 6);
    let (exact, _) = photographs(&scene, 2, 0.0, 1);
    let per_count = exact.mean();
    let (mut refuted, mut squares) = (0, 0.0);
    let draws = 40;
    for seed in 0..draws {
        let counts = counted(&(&exact / per_count), seed);
        let [phi, stderr] = [counts.clone(), counts.map(f64::sqrt)].map(|m| m * per_count);
        let plan = CalibrationPlan {
            elements: Some([2; 2]),
            ..hinge()
        };
        let found = plan.calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
        let found = found.unwrap();
        refuted += u32::from(found.p.unwrap() < 1e-3);
        squares += (found.found[0].value / found.found[0].stderr).powi(2);
    }
    let rms = (squares / draws as f64).sqrt();
    assert!(refuted <= 1, "{refuted}");
    assert!(rms < 1.0 + 4.0 / (2.0 * draws as f64).sqrt(), "{rms}");
}
