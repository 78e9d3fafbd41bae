//! Two places that make the same photographs.

use super::*;
use crate::lab::geometry::resized::resized;
use crate::scene::file::{Layout, SpotsTable};

/// Spots, view and camera on the line x = 5, about which the hidden surface is symmetric; that does
/// not stand in the camera's or the laser's way.
fn on_the_axis() -> Scene {
    let mut file = SceneFile::builtin("bench").unwrap();
    let laser = file.laser.as_mut().unwrap();
    laser.position = [5.0, -10.0, 60.0];
    laser.spots = SpotsTable {
        layout: Layout::List,
        points: Some((0..16).map(|k| [5.0, 1.2 + 0.48 * f64::from(k)]).collect()),
        ..SpotsTable::default()
    };
    file.camera.position = [5.0, -10.0, 60.0];
    file.camera.view.x = [3.5, 6.5];
    file.camera.pixels = [1, 12];
    Scene::new(&file, None).unwrap()
}

/// Turned to the left the surface makes the photographs that it makes turned to the right, with a
/// mirrored picture: both places are told, whichever side the start leads to, and one alone where
/// the surface is known to be turned to that side.
#[test]
fn a_place_that_makes_the_same_photographs_is_told() {
    let scene = on_the_axis();
    let yaw = Parameter::named(&scene, "hidden.yaw").unwrap();
    for turned in [12.0, -12.0] {
        let there = scene.displaced(&yaw, &[turned]).unwrap();
        let elements = Some([4, 3]);
        let rho: Vec<f64> = (0..12)
            .map(|k| 0.3 + 0.05 * f64::from((5 * k) % 12))
            .collect();
        let of = |occlusion| MatrixModel::with(&there, Kernel::Physical, elements, occlusion);
        let clean = of(Occlusion::Considered).unwrap().phi_of(&rho);
        let stderr = clean.map(|_| 5e-5 * clean.mean());
        let mut random = normal(6);
        let phi = clean.zip_map(&stderr, |x, s| x + s * random()[0]);
        let plan = CalibrationPlan {
            elements,
            ..plan(&["hidden.yaw"], 3)
        };
        let start = scene.displaced(&yaw, &[9.0]).unwrap();
        let both = plan.calibrate(&start, &unexplained(&phi, &stderr), Control::none());
        let both = both.unwrap();
        let own = &both.found[0];
        let [other] = &both.elsewhere[..] else {
            panic!("{:?} {own:?}", both.elsewhere);
        };
        let places = [own.value, other.values[0]].map(|value| 9.0 + value);
        let off = places.map(|at| (at.abs() - 12.0) / own.stderr);
        let both_ways = places[0] * places[1] < 0.0;
        assert!(
            both_ways && off.iter().all(|off| off.abs() < 3.0),
            "{off:?}"
        );
        assert!(!both.is_found() && both.describe().sentence.contains("do NOT TELL"));
        let aside = scene.displaced(&yaw, &[0.8 * turned]).unwrap();
        let known = CalibrationPlan {
            free: vec![Free {
                name: "hidden.yaw".to_owned(),
                sigma: Some(3.0),
            }],
            ..plan
        };
        let one = known.calibrate(&aside, &unexplained(&phi, &stderr), Control::none());
        let one = one.unwrap();
        let off = (one.found[0].value - 0.2 * turned) / one.found[0].stderr;
        assert!(
            one.is_found() && off.abs() < 3.0,
            "{off} {:?}",
            one.elsewhere
        );
    }
}

/// A board that the scene has 0.8 or 1.25 times as large as it is: that it is likelier with the
/// right size is told; of that size nothing.
#[test]
fn a_board_of_another_size_is_told() {
    let right = small("bench", 8);
    let elements = Some([4; 2]);
    let of = MatrixModel::with(&right, Kernel::Physical, elements, Occlusion::Ignored);
    let rho: Vec<f64> = (0..16).map(|k| 0.4 + 0.1 * f64::from(k % 4)).collect();
    let clean = of.unwrap().phi_of(&rho);
    let stderr = clean.map(|x| 2e-3 * x);
    let mut random = normal(7);
    let phi = clean.zip_map(&stderr, |x, s| x + s * random()[0]);
    let found = |scene: &Scene| {
        let plan = plan(&["hidden.normal"], 4);
        plan.calibrate(scene, &unexplained(&phi, &stderr), Control::none())
            .unwrap()
    };
    let own = found(&right);
    assert!(own.is_found() && own.resized.is_none(), "{:?}", own.resized);
    for (factor, scene) in resized(&right) {
        let found = found(&scene);
        let other = found.resized.as_ref().unwrap();
        assert!((other.factor * factor - 1.0).abs() < 1e-12, "{other:?}");
        let off = (other.values[0] - own.found[0].value) / own.found[0].stderr;
        assert!(off.abs() < 1.0, "{off} {other:?}");
        let told = found.describe();
        let all = told.sentence + &told.notes.concat();
        assert!(all.contains("may have its size WRONG"), "{all}");
    }
}
