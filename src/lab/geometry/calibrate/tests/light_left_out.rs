//! Light that the calibration leaves out.

use super::*;

/// The bench moved by what is free, with 2 % of noise, stated or not: what its photographs, changed
/// by `beside`, say of light that is left out.
fn calibrated(seed: u64, is_stated: bool, beside: impl Fn(usize, f64) -> f64) -> Calibration {
    let scene = small("bench", 8);
    let named = |name: &str| Parameter::named(&scene, name).unwrap();
    let parameters: Vec<Parameter> = ["hidden.normal", "spots.shift"]
        .into_iter()
        .flat_map(named)
        .collect();
    let there = scene.displaced(&parameters, &[0.05, 0.03, 0.0]).unwrap();
    let (phi, stderr) = photographs(&there, 2, 2e-2, seed);
    let mean = phi.mean();
    let phi = Matrix::from_fn(phi.nrows(), phi.ncols(), |p, l| {
        phi[(p, l)] + beside(p, phi[(p, l)] / mean) * mean
    });
    let plan = plan(&["hidden.normal", "spots.shift"], 2);
    let photographs = Unexplained {
        stderr: is_stated.then_some(&stderr),
        ..unexplained(&phi, &stderr)
    };
    let found = plan.calibrate(&scene, &photographs, Control::none());
    found.unwrap()
}

/// Without any, P is as even as chance leaves it: of 40 draws and two kinds below 0.1 as many as a
/// binomial count has but for twice in a thousand. 1 % of even light, which χ² of all entries
/// hardly sees, is told, of 3 % too where the noise is not stated, and so is light that falls off
/// by a tenth; neither where it is estimated.
#[test]
fn light_that_is_left_out_is_told() {
    let none = |_, _| 0.0;
    let mut all: Vec<f64> = Vec::new();
    for seed in 0..40 {
        let found = calibrated(seed, true, none);
        assert_eq!(found.light_left_out.len(), 2);
        let kinds = found.light_left_out.iter();
        assert!(kinds.clone().all(|kind| kind.directions == 3));
        all.extend(kinds.map(|kind| kind.p));
    }
    let few = all.iter().filter(|p| **p < 0.1).count();
    // Binomial, 80 at 0.1: 17 or more, and 1 or fewer, in 2 of 1000.
    assert!((2..17).contains(&few), "{few} {all:?}");
    assert!(all.iter().filter(|p| **p < 1e-3).count() < 2, "{all:?}");
    // Of 80 even ones the mean is ½ ± 0.032.
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    assert!((mean - 0.5).abs() < 0.13, "{mean} {all:?}");
    let falls_off = |p: usize, own: f64| {
        let over = |k: usize| (2 * k + 1) as f64 / 8.0 - 1.0;
        let [x, y] = [over(p % 8), over(p / 8)];
        -0.05 * own * (x * x + y * y)
    };
    let told = |found: &Calibration, what: &str| {
        let notes = found.describe().notes.concat();
        notes.contains(&format!("Beware: {what}"))
    };
    for seed in 0..5 {
        // Entries weigh alike where the noise is not stated: less is told of noise that is a share.
        for (is_stated, even) in [(true, 0.01), (false, 0.03)] {
            let found = calibrated(seed, is_stated, |_, _| even);
            assert!(
                told(&found, "light that all frames share"),
                "{is_stated} {:?}",
                found.light_left_out
            );
        }
        let found = calibrated(seed, false, none);
        let any = ["light that", "a falloff"]
            .iter()
            .any(|what| told(&found, what));
        assert!(!any, "{:?}", found.light_left_out);
        let found = calibrated(seed, true, falls_off);
        assert!(told(&found, "a falloff"), "{:?}", found.light_left_out);
    }
}

/// The bench as it is, with 2 % of noise unless `seed` is none, and even light of this share of the
/// mean beside it: what its photographs say with a yaw of which something is known and gains.
fn beside_even_light(share: f64, seed: Option<u64>, change: &CalibrationPlan) -> Calibration {
    let scene = small("bench", 8);
    let (exact, _) = photographs(&scene, 2, 0.0, 0);
    let stderr = &exact * 2e-2;
    let phi = seed.map_or(exact.clone(), |seed| photographs(&scene, 2, 2e-2, seed).0);
    let phi = phi.add_scalar(share * exact.mean());
    let photographs = Unexplained {
        stderr: (!change.error_field).then_some(&stderr),
        ..unexplained(&phi, &stderr)
    };
    let found = change.calibrate(&scene, &photographs, Control::none());
    found.unwrap()
}

/// Even light moves what is found as is said: the estimate of photographs with 0.1 % of it less
/// that of the same ones without, within a tenth and what two searches leave, of what was known, of
/// gains, and beside errors that neighbours share too. The parameter that is named is the one that
/// moves most of its errors.
#[test]
fn even_light_moves_the_geometry_as_is_said() {
    let mut yaw = plan(&["hidden.normal", "hidden.yaw", "spots.shift"], 2);
    yaw.free[1].sigma = Some(0.3);
    let gains = CalibrationPlan {
        frame_gain: Some(0.01),
        ..yaw.clone()
    };
    let shared = CalibrationPlan {
        error_field: true,
        ..yaw.clone()
    };
    let share = 1e-3;
    for how in [yaw, gains, shared] {
        let [without, with] = [0.0, share].map(|x| beside_even_light(x, Some(3), &how));
        for (a, b) in without.found.iter().zip(&with.found) {
            let (moved, said) = (b.value - a.value, a.by_even_light.unwrap() * share / 0.01);
            let most = 0.1 * said.abs() + 2e-3 * a.stderr;
            assert!((moved - said).abs() < most, "{moved} {said} {a:?}");
        }
        let notes = without.describe().notes.concat();
        assert!(notes.contains("would move hidden.normal by"), "{notes}");
    }
    // Without noise all that is left over is that light: the score test's χ² is δχ².
    let exact = beside_even_light(0.01, None, &plan(&["hidden.normal"], 2));
    let (score, said) = (exact.light_left_out[0].chi2, exact.even_light_chi2.unwrap());
    assert!((score - said).abs() < 0.05 * said, "{score} {said}");
}

/// Where light that all frames share is estimated nothing is said of it.
#[test]
fn even_light_that_is_estimated_moves_nothing() {
    let how = CalibrationPlan {
        background: true,
        ..plan(&["hidden.normal"], 2)
    };
    let [without, with] = [0.0, 0.01].map(|x| beside_even_light(x, Some(3), &how));
    let (a, b) = (&without.found[0], &with.found[0]);
    assert!((a.value - b.value).abs() < 0.03 * a.stderr, "{a:?} {b:?}");
    assert!(with.even_light_chi2.is_none() && b.by_even_light.is_none());
    let notes = with.describe().notes.concat();
    assert!(!notes.contains("Even light"), "{notes}");
}
