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

/// Parameters drawn `times` as far as they are known, 1 % of noise, a scale that is free: the bench
/// with them, calibrated.
fn calibrated(seed: u64, times: f64) -> Calibration {
    let mut file = SceneFile::builtin("bench").unwrap();
    file.camera.pixels = [6; 2];
    if let Some(laser) = &mut file.laser {
        laser.spots.per_side = laser.spots.per_side.map(|_| 4);
    }
    let scene = Scene::new(&file, None).unwrap();
    let mut random = normal(seed);
    let named = |(name, _): &(&str, f64)| Parameter::named(&scene, name).unwrap();
    let parameters: Vec<Parameter> = KNOWN.iter().flat_map(named).collect();
    let off = KNOWN.iter().map(|(_, sigma)| times * sigma * random()[0]);
    let off: Vec<f64> = off.collect();
    let there = scene.displaced(&parameters, &off).unwrap();
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
    let found = plan.calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
    found.unwrap()
}

/// Of parameters drawn from their priors P is even or larger: of 60, at most as many below 0.1 as a
/// binomial count exceeds twice in a thousand, and hardly one is told. Of such that are three times
/// as far off, which photographs of right geometry fit as well, all are.
#[test]
fn parameters_are_together_as_far_off_as_they_were_known_to_be() {
    let draws = 60;
    let found: Vec<Calibration> = (0..draws).map(|seed| calibrated(seed, 1.0)).collect();
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
    for seed in 0..6 {
        let found = calibrated(seed, 3.0);
        assert!(found.is_found(), "{:?}", found.p);
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
