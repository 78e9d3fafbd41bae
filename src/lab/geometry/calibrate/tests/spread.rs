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
/// within three stated errors of its own over the draws, and these below the last number.
fn is_found(scene: &Scene, free: &[(&str, f64, f64)], draws: u64) {
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
    for draw in 0..draws {
        let mut random = normal(20 + draw);
        let noisy = phi.zip_map(&stderr, |x, s| x + s * random()[0]);
        let found = how.calibrate(scene, &unexplained(&noisy, &stderr), Control::none());
        let found = found.unwrap();
        assert!(found.is_settled && found.p.unwrap() > 1e-3, "{:?}", found.p);
        for (own, (_, truth, most)) in found.found.iter().zip(free) {
            let off = (own.value - truth) / own.stderr;
            assert!(off.abs() < 3.0, "{draw}: {off} {own:?}");
            let unit = if own.name.ends_with(".weight") {
                "percentage points"
            } else {
                "%"
            };
            assert!(own.stderr < *most && own.unit == unit, "{draw}: {own:?}");
        }
        let notes = found.describe().notes.concat();
        let has_weight = names.iter().any(|name| name.ends_with(".weight"));
        let told = notes.contains("percentage points, not by parts of themselves");
        assert_eq!(told, has_weight, "{notes}");
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
        is_found(&scene, &[("laser.spot_diameter", 20.0, 5.0)], 4);
    }
}

/// A satin wall that is rougher and whose coat has another index.
#[test]
fn how_a_satin_wall_reflects_is_found() {
    let free = [("wall.roughness", 12.0, 3.0), ("wall.ior", -6.0, 3.0)];
    is_found(&with("satin", &[]), &free, 1);
}

/// One with a metallic lobe that is larger and rougher.
#[test]
fn the_lobe_of_a_wall_is_found() {
    let lobe = "mixture = [{ weight = 0.8, material = { lambertian = 0.8 } }, { weight = 0.15, material = { conductor = { eta = 0.2, k = 3.9 }, roughness = 0.5 } }]";
    let scene = with("bench", &[("lambertian = 0.8", lobe)]);
    let free = [
        ("wall.mixture.1.weight", 3.0, 1.0),
        ("wall.roughness", 10.0, 5.0),
    ];
    is_found(&scene, &free, 4);
}

/// The far one of two walls that both take spots and are seen is darker.
#[test]
fn the_albedo_of_one_of_two_walls_is_found() {
    let text = small("bench", 6).text;
    let near = text.replacen("v = [0.0, 15.5, 0.0]", "v = [0.0, 4.4, 0.0]", 1);
    let far = "\n[[surface]]\nname = \"far\"\nrole = \"relay\"\nmaterial = { lambertian = 0.7 }\n\
        rectangle = { corner = [0, 4.4, 0], u = [11.5, 0, 0], v = [0, 11.1, 0] }\n";
    let scene = Scene::from_toml("two", &(near + far)).unwrap();
    is_found(&scene, &[("far.albedo", -8.0, 0.5)], 4);
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
        (&bench, "wall.albedo", "twice, at the spot and in view"),
        (&satin, "wall.albedo", "--free-scale"),
        (&bench, "hidden.albedo", "is no wall"),
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
