//! How laser and wall spread light, from photographs.

use super::*;

/// A scene of 6 × 6 pixels and 20 spots with these changes of its text.
fn with(name: &str, changes: &[(&str, &str)]) -> Scene {
    let mut text = small(name, 6).text;
    for (old, new) in changes {
        assert!(text.contains(old), "{name} has no `{old}`");
        text = text.replacen(old, new, 1);
    }
    Scene::from_toml(name, &text).unwrap()
}

fn over_areas(scene: &Scene, n: usize) -> Matrix {
    let (kernel, occlusion) = (Kernel::Physical, Occlusion::Considered);
    let model = MatrixModel::over_areas(scene, kernel, Some([n; 2]), occlusion, Effort::USUAL);
    model.unwrap().phi()
}

/// What the free parameters of `scene` are by photographs of another scene with noise of 1e-3: each
/// within three stated errors of `truth` over the draws, and these errors at most `errors`.
fn is_found(scene: &Scene, free: &[(&str, f64, f64)]) {
    let names: Vec<&str> = free.iter().map(|(name, ..)| *name).collect();
    let parameters: Vec<Parameter> = names
        .iter()
        .flat_map(|name| Parameter::named(scene, name).unwrap())
        .collect();
    let truth: Vec<f64> = free.iter().map(|(_, truth, _)| *truth).collect();
    let there = scene.displaced(&parameters, &truth).unwrap();
    let phi = over_areas(&there, 2);
    let stderr = &phi * 1e-3;
    let how = CalibrationPlan {
        integration: Integration::Quadrature,
        ..plan(&names, 2)
    };
    for draw in 0..4 {
        let mut random = normal(20 + draw);
        let noisy = phi.zip_map(&stderr, |x, s| x + s * random()[0]);
        let found = how.calibrate(scene, &unexplained(&noisy, &stderr), Control::none());
        let found = found.unwrap();
        assert!(found.is_settled && found.p.unwrap() > 1e-3, "{:?}", found.p);
        for (own, (_, truth, most)) in found.found.iter().zip(free) {
            let off = (own.value - truth) / own.stderr;
            assert!(off.abs() < 3.0, "{draw}: {off} {own:?}");
            assert!(own.stderr < *most && own.unit == "%", "{draw}: {own:?}");
        }
        if draw == 0 {
            let written = Scene::from_toml("calibrated", &found.toml).unwrap();
            let values: Vec<f64> = found.found.iter().map(|f| f.value).collect();
            let own = over_areas(&scene.displaced(&parameters, &values).unwrap(), 2);
            let off = (&own - over_areas(&written, 2)).norm() / own.norm();
            assert!(off < 1e-12, "{off:e}");
        }
    }
}

/// Spots a fifth wider than they are thought to be.
#[test]
fn the_size_of_spots_is_found() {
    for profile in ["\"disc\"", "\"gaussian\""] {
        let wide = [
            ("spot_diameter = 0.0", "spot_diameter = 1.0"),
            ("\"disc\"", profile),
        ];
        let scene = with("bench", &wide);
        is_found(&scene, &[("laser.spot_diameter", 20.0, 5.0)]);
    }
}

/// A satin wall that is rougher and whose coat has another index; one whose lobe is larger.
#[test]
fn how_the_wall_reflects_is_found() {
    let satin = with("satin", &[]);
    is_found(
        &satin,
        &[("wall.roughness", 12.0, 3.0), ("wall.ior", -6.0, 3.0)],
    );
    let lobe = "mixture = [{ weight = 0.8, material = { lambertian = 0.8 } }, { weight = 0.15, material = { conductor = { eta = 0.2, k = 3.9 }, roughness = 0.5 } }]";
    let scene = with("bench", &[("lambertian = 0.8", lobe)]);
    is_found(&scene, &[("wall.mixture.1.weight", 3.0, 1.0)]);
}

/// Size of the spots and roughness of the wall at once from traced light, which knows nothing of
/// the model, both off.
#[test]
#[ignore = "slow"]
fn traced_light_tells_spots_and_wall() {
    let scene = with("satin", &[("spot_diameter = 0.0", "spot_diameter = 1.0")]);
    let names = ["laser.spot_diameter", "wall.roughness"];
    let parameters = names.map(|name| Parameter::named(&scene, name).unwrap().remove(0));
    let truth = [25.0, 12.0];
    let there = scene.displaced(&parameters, &truth).unwrap();
    let how = Plan {
        estimator: Estimator::Factored,
        sampling: Sampling::Sobol,
        seed: 1,
        budget: Budget::new(1 << 14, Sampling::Sobol).unwrap(),
    };
    let spots = 0..there.laser.spots.len();
    let traced = render(&there, &how, spots, Control::none()).unwrap();
    let stderr = traced
        .stderr
        .zip_map(&traced.flux, |s, x| s.hypot(1e-3 * x));
    let mut random = normal(3);
    let noisy = traced.flux.map(|x| x + 1e-3 * x * random()[0]);
    let how = CalibrationPlan {
        integration: Integration::Quadrature,
        ..plan(&names, 2)
    };
    let found = how.calibrate(&scene, &unexplained(&noisy, &stderr), Control::none());
    let found = found.unwrap();
    assert!(found.is_settled && found.p.unwrap() > 1e-3, "{:?}", found.p);
    for (own, truth) in found.found.iter().zip(truth) {
        let off = (own.value - truth) / own.stderr;
        assert!(off.abs() < 3.0 && own.stderr < 0.3 * truth, "{off} {own:?}");
    }
}

/// What no light tells is refused with the reason: spots without a size, or taken for points; walls
/// without what is named; surfaces of which the model takes the reflection for the picture.
#[test]
fn what_has_no_such_number_is_refused() {
    let bench = small("bench", 4);
    let satin = small("satin", 4);
    let said = |scene: &Scene, name: &str| Parameter::named(scene, name).unwrap_err().to_string();
    for (scene, name, words) in [
        (&bench, "laser.spot_diameter", "the spots are points"),
        (&bench, "wall.roughness", "has not a roughness"),
        (&bench, "wall.ior", "has not a coat"),
        (&satin, "wall.mixture.0.weight", "has not a mixture"),
        (&satin, "hidden.roughness", "is no wall"),
        (
            &satin,
            "nothing.roughness",
            "no parameter `nothing.roughness`",
        ),
        (&satin, "wall.mixture.x.weight", "no parameter"),
    ] {
        let said = said(scene, name);
        assert!(said.contains(words), "{name}: {said}");
    }
    let wide = with("bench", &[("spot_diameter = 0.0", "spot_diameter = 0.5")]);
    let (phi, stderr) = photographs(&wide, 2, 0.1, 6);
    let refused = plan(&["laser.spot_diameter"], 2).calibrate(
        &wide,
        &unexplained(&phi, &stderr),
        Control::none(),
    );
    let refused = refused.unwrap_err().to_string();
    assert!(refused.contains("--integration quadrature"), "{refused}");
    let size = Parameter::named(&wide, "laser.spot_diameter").unwrap();
    let gone = wide.displaced(&size, &[-100.0]).unwrap_err().to_string();
    assert!(gone.contains("no size"), "{gone}");
    let rough = Parameter::named(&satin, "wall.roughness").unwrap();
    let gone = satin.displaced(&rough, &[300.0]).unwrap_err().to_string();
    assert!(gone.contains("leaves its range"), "{gone}");
}
