//! Estimates against scenes that are displaced.

use super::*;

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

/// Of photographs that are clipped at 93 % of their brightest it is told that the brightest entries
/// are left over; of those in another order not.
#[test]
fn clipped_photographs_are_told_from_others() {
    let scene = small("bench", 8);
    let (phi, stderr) = photographs(&scene, 4, 1e-3, 5);
    let (most, last) = (0.93 * phi.max(), phi.ncols() - 1);
    let reversed = Matrix::from_fn(phi.nrows(), phi.ncols(), |p, l| phi[(p, last - l)]);
    for (phi, is_clipped) in [(phi.map(|x| x.min(most)), true), (reversed, false)] {
        let plan = plan(&["hidden.normal"], 4);
        let found = plan.calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
        let notes = found.unwrap().describe().notes.concat();
        assert_eq!(
            notes.contains("values that are clipped"),
            is_clipped,
            "{notes}"
        );
        assert_eq!(
            notes.contains("the order of the spots, say"),
            !is_clipped,
            "{notes}"
        );
    }
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

/// Of photographs whose noise is far below what the coarse rule leaves out, the errors are those of
/// the noise, and hold the truth: the estimate goes on by the finer rule.
#[test]
fn the_estimate_goes_on_by_a_finer_rule() {
    let scene = small("bench", 8);
    let names = ["hinge.angle", "hidden.normal"];
    let parameters = names.map(|name| Parameter::named(&scene, name).unwrap().remove(0));
    let truth = [0.5, 0.05];
    let there = scene.displaced(&parameters, &truth).unwrap();
    let (kernel, occlusion) = (Kernel::Physical, Occlusion::Considered);
    let model = MatrixModel::over_areas(&there, kernel, Some([2; 2]), occlusion, Effort::FINEST);
    let phi = model.unwrap().phi();
    let stderr = &phi * 1e-5;
    let mut random = normal(8);
    let noisy = phi.zip_map(&stderr, |x, s| x + s * random()[0]);
    let plan = CalibrationPlan {
        integration: Integration::Quadrature,
        ..plan(&names, 2)
    };
    let found = plan.calibrate(&scene, &unexplained(&noisy, &stderr), Control::none());
    let found = found.unwrap();
    assert!(found.is_settled && found.p.unwrap() > 1e-3, "{:?}", found.p);
    for (own, want) in found.found.iter().zip(truth) {
        let off = (own.value - want) / own.stderr;
        assert!(off.abs() < 3.0, "{own:?}");
        assert!(own.stderr < 1.3 * own.by_curvature, "{own:?}");
    }
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
