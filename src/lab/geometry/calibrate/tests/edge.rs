//! Where the scene ends.

use super::*;
use crate::model::Swept;

/// The bench with five spots, the third at (5, y); its wall begins at y = `below` in place of 0.
fn with_a_spot_at(y: f64, below: f64) -> Scene {
    let mut file = SceneFile::builtin("bench").unwrap();
    file.camera.pixels = [8; 2];
    let wall = file.surface.iter_mut().find(|s| s.name == "wall");
    let wall = wall.unwrap().rectangle.as_mut().unwrap();
    wall.corner[1] = below;
    wall.v[1] -= below;
    let scene = Scene::new(&file, None).unwrap();
    let spots = [[1.0, 2.0], [9.0, 4.0], [5.0, y], [2.0, 8.0], [9.0, 9.0]];
    scene.with_spots_at(&spots).unwrap()
}

/// A spot that is beyond where the wall is said to end goes to its edge and stays there, which is
/// told; the board is found where it is found if that spot is fixed at the edge: minima under a
/// bound that holds are those with equality.
#[test]
fn an_edge_that_holds_a_spot_is_told_and_holds_nothing_else() {
    let there = with_a_spot_at(-0.4, -1.0);
    let normal = Parameter::named(&there, "hidden.normal").unwrap();
    let there = there.displaced(&normal, &[0.1]).unwrap();
    let (phi, stderr) = photographs(&there, 2, 1e-2, 3);
    let by = |scene: &Scene, free: &[&str]| {
        let found = plan(free, 2).calibrate(scene, &unexplained(&phi, &stderr), Control::none());
        found.unwrap()
    };
    let near = with_a_spot_at(0.05, 0.0);
    let found = by(&near, &["hidden.normal", "spots.2.y"]);
    let want = by(&with_a_spot_at(0.0, 0.0), &["hidden.normal"]);
    let held: Vec<usize> = found.held.iter().map(|h| h.index).collect();
    assert!(found.is_settled && held == [1], "{held:?}");
    assert!((found.found[1].value + 0.05).abs() < 1e-4, "{found:?}");
    let off = found.found[0].value - want.found[0].value;
    assert!(off.abs() < 0.05 * want.found[0].by_curvature, "{off}");
    let notes = found.describe().notes.concat();
    let told = notes.contains("its edge holds spots.2.y") && notes.contains("falls off");
    assert!(told, "{notes}");
    // Of a wall that goes on nothing is held, and the spot is found.
    let found = by(&with_a_spot_at(0.05, -1.0), &["hidden.normal", "spots.2.y"]);
    let off = (found.found[1].value + 0.45) / found.found[1].stderr;
    assert!(found.held.is_empty() && off.abs() < 4.0, "{off}");
}

/// Random starts and profiles of a spot that stands on the wall's edge are on the wall.
#[test]
fn starts_beside_an_edge_are_scenes() {
    let scene = with_a_spot_at(0.0, 0.0);
    let (phi, stderr) = photographs(&scene, 2, 1e-2, 3);
    let plan = CalibrationPlan {
        starts: 6,
        ..plan(&["spots.2.x", "spots.2.y", "hidden.normal"], 2)
    };
    let found = plan.calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
    let found = found.unwrap();
    assert_eq!(found.starts.tried, 6);
    let profile = found.found[1].profile.as_ref().unwrap();
    let least = profile.points.iter().map(|p| p.0).fold(0.0, f64::min);
    assert!(least >= 0.0, "{profile:?}");
}

/// Past a ball, where light has differences for slopes, that of a spot on the wall's edge is as on
/// a wall that goes on, within what a step of 1e-3 of the distance leaves of a slope that changes
/// over inches.
#[test]
fn a_difference_at_an_edge_takes_the_other_side() {
    let with_ball = |below: f64| {
        let scene = with_a_spot_at(0.0, below);
        let ball = "\n[[surface]]\nname = \"ball\"\nrole = \"occluder\"\n\
            sphere = { centre = [5.0, 6.5, 2.0], radius = 0.5, face = \"outside\" }\n\
            material = { lambertian = 0.0 }\n";
        let places = scene.laser.spots.iter().map(|s| s.target.position);
        let spots: Vec<[f64; 2]> = places.map(|p| [p.x, p.y]).collect();
        let scene = Scene::from_toml("ball", &(scene.text.to_string() + ball)).unwrap();
        scene.with_spots_at(&spots).unwrap()
    };
    let rate = |scene: &Scene| {
        let parameters = Parameter::named(scene, "spots.2.y").unwrap();
        let geometry = Geometry {
            scene,
            parameters: &parameters,
            elements: Some([2; 2]),
            fineness: Fineness::Areas(1),
            occlusion: Occlusion::Considered,
            gains: 0,
        };
        let velocity = scene.velocity(&parameters, &[0.0], 0);
        let swept = Swept::new(scene, geometry.elements, &[velocity], Effort::FINEST);
        assert!(swept.unwrap().unwrap().rates[0].is_none());
        let light = geometry.light(&[0.0], 0.0, true).unwrap();
        light.frame_rate(2, 0).unwrap()
    };
    let (own, want) = (rate(&with_ball(0.0)), rate(&with_ball(-1.0)));
    let off = (&own - &want).norm() / want.norm();
    assert!(off < 0.01, "{off}");
}
