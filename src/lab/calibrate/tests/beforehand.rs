//! What was known beforehand against what is found, all parameters together.

use super::*;

/// Six parameters, and how well each is known.
const KNOWN: [(&str, f64); 6] = [
    ("hinge.angle", 0.5),
    ("hidden.normal", 0.05),
    ("view.x", 0.05),
    ("view.y", 0.05),
    ("camera.y", 1.0),
    ("camera.z", 1.0),
];

/// Parameters drawn as they are known, 1 % of noise, a scale and gains that are free: taken for a
/// scene with the material `wall`, photographs of one whose wall is matt. That it is calibrated.
fn calibrated(seed: u64, wall: &str) -> Calibration {
    let scene = |wall: &str| {
        let mut file = SceneFile::builtin("bench").unwrap();
        file.camera.pixels = [6; 2];
        if let Some(laser) = &mut file.laser {
            laser.spots.per_side = laser.spots.per_side.map(|_| 4);
        }
        let text = file.toml().unwrap();
        let matt = "lambertian = 0.8";
        assert!(text.contains(matt), "{text}");
        Scene::from_toml("bench", &text.replace(matt, wall)).unwrap()
    };
    let mut random = normal(seed);
    let there = scene(wall);
    let names = KNOWN.map(|(name, _)| name).join(",");
    let parameters: Vec<Parameter> = names
        .split(',')
        .flat_map(|name| Parameter::named(&there, name).unwrap())
        .collect();
    let off: Vec<f64> = KNOWN.iter().map(|(_, sigma)| sigma * random()[0]).collect();
    let there = there.displaced(&parameters, &off).unwrap();
    let (phi, stderr) = photographs(&there, 2, 1e-2, seed);
    let free = KNOWN.map(|(name, sigma)| Free {
        name: name.to_owned(),
        sigma: Some(sigma),
    });
    let plan = CalibrationPlan {
        free: free.to_vec(),
        is_scale_free: true,
        ..plan(&[], 2)
    };
    let found = plan.calibrate(
        &scene("lambertian = 0.8"),
        &unexplained(&phi, &stderr),
        Control::none(),
    );
    found.unwrap()
}

/// Of parameters drawn from their priors P is even or larger: of 60, at most as many below 0.1 as a
/// binomial count exceeds twice in a thousand, and hardly one is told. A glossy wall taken for a
/// matt one, which the geometry takes up, is told.
#[test]
fn parameters_are_together_as_far_off_as_they_were_known_to_be() {
    let draws = 60;
    let of = |seed| calibrated(seed, "lambertian = 0.8");
    let found: Vec<Calibration> = (0..draws).map(of).collect();
    let all: Vec<f64> = found.iter().map(|f| f.beforehand.unwrap().p).collect();
    let few = all.iter().filter(|p| **p < 0.1).count();
    // Binomial, 60 at 0.1: 14 or more in 2 of 1000.
    assert!(few < 14, "{few} {all:?}");
    // Two or more of 60 are below 0.001 in 2 of 1000.
    let told = all.iter().filter(|p| **p < 1e-3).count();
    assert!(told < 2, "{all:?}");
    // Twice the smaller of two probabilities is ½ on average or more; 60 of 1 would say nothing.
    let mean = all.iter().sum::<f64>() / draws as f64;
    assert!((0.4..0.8).contains(&mean), "{mean} {all:?}");
    // One in 100 by a single parameter, and those above: 5 of 60 in 2 of 1000.
    let beware = |f: &&Calibration| f.describe().notes.concat().contains("Beware: farther");
    assert!(found.iter().filter(beware).count() < 5);
    let glossy = "mixture = [{ weight = 0.6, material = { lambertian = 0.9 } }, { weight = 0.4, material = { conductor = { eta = 0.2, k = 3.9 }, roughness = 0.25 } }]";
    for seed in 0..3 {
        let found = calibrated(seed, glossy);
        let told = found.describe();
        let notes = told.notes.concat();
        assert!(
            notes.contains("all together (χ²") && told.tone != Tone::Good,
            "{:?} {:?} {notes}",
            found.beforehand,
            found.p
        );
        assert!(!notes.contains("errors are those of the noise"), "{notes}");
    }
}
