//! Stated errors against draws, and what is said where they cannot be believed.

use super::*;

/// Where no noise is stated, what the model lacks is not told from noise: the sentence says so.
#[test]
fn an_estimate_without_a_stated_noise_is_conditional() {
    let scene = small("bench", 8);
    let (phi, stderr) = photographs(&scene, 4, 1e-2, 5);
    let told = |is_stated: bool| {
        let photographs = Unexplained {
            stderr: is_stated.then_some(&stderr),
            ..unexplained(&phi, &stderr)
        };
        let plan = plan(&["hinge.angle"], 4);
        let found = plan.calibrate(&scene, &photographs, Control::none());
        found.unwrap().describe().sentence
    };
    assert!(told(true).starts_with("From what the scene says: hinge.angle"));
    assert!(told(false).starts_with("If what is left over is noise, from what the scene says:"));
}

/// Errors of 0 weigh nothing: whatever is photographed fits, and so it is refused.
#[test]
fn errors_that_are_all_zero_are_refused() {
    let scene = small("bench", 4);
    let (phi, stderr) = photographs(&scene, 2, 0.01, 1);
    let zero = stderr * 0.0;
    let found =
        plan(&["hidden.normal"], 2).calibrate(&scene, &unexplained(&phi, &zero), Control::none());
    let said = found.unwrap_err().to_string();
    assert!(said.contains("every standard error is 0"), "{said}");
}

/// Of errors that entries share it is said that they do not average out, in place of that they are
/// those of the noise; of others not.
#[test]
fn errors_that_hang_together_are_told() {
    let scene = small("bench", 4);
    let (phi, stderr) = photographs(&scene, 2, 0.01, 1);
    for errors in Errors::ALL {
        let photographs = Unexplained {
            certainty: Certainty::new(errors, None),
            ..unexplained(&phi, &stderr)
        };
        let found = plan(&["hidden.normal"], 2).calibrate(&scene, &photographs, Control::none());
        let notes = found.unwrap().describe().notes.concat();
        let is_shared = errors != Errors::Independent;
        assert_eq!(notes.contains("HANG TOGETHER"), is_shared, "{notes}");
        assert_eq!(notes.contains("those of the noise"), !is_shared, "{notes}");
    }
}

/// Standard errors that are three times too large fit anything: that is said, in place of that the
/// errors are those of the noise.
#[test]
fn errors_that_are_too_large_are_told() {
    let scene = small("bench", 6);
    let (phi, stderr) = photographs(&scene, 2, 0.01, 1);
    for times in [1.0, 3.0] {
        let stderr = &stderr * times;
        let photographs = unexplained(&phi, &stderr);
        let found = plan(&["hidden.normal"], 2).calibrate(&scene, &photographs, Control::none());
        let notes = found.unwrap().describe().notes.concat();
        assert_eq!(notes.contains("CLOSER than"), times > 1.0, "{notes}");
        assert_eq!(
            notes.contains("errors are those of"),
            times == 1.0,
            "{notes}"
        );
    }
}

/// Gains that scatter by 2 % as stated are not told of; by 10 %, or one of them by 12 %, they are:
/// errors of the geometry are those of smaller ones.
#[test]
fn gains_larger_than_stated_are_told() {
    let scene = small("bench", 8);
    let (exact, stderr) = photographs(&scene, 2, 3e-3, 1);
    let told = |gain: &dyn Fn(usize, f64) -> f64| {
        let (mut noise, mut of_frames) = (normal(2), normal(3));
        let gains: Vec<f64> = (0..exact.ncols())
            .map(|l| gain(l, of_frames()[0]))
            .collect();
        let phi = Matrix::from_fn(exact.nrows(), exact.ncols(), |p, l| {
            exact[(p, l)] * (1.0 + gains[l]) + stderr[(p, l)] * noise()[0]
        });
        let plan = CalibrationPlan {
            frame_gain: Some(0.02),
            ..plan(&["hidden.normal"], 2)
        };
        let found = plan.calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
        found.unwrap().describe().notes.concat()
    };
    let stated = told(&|_, z| 0.02 * z);
    assert!(!stated.contains("LARGER"), "{stated}");
    let larger = told(&|_, z| 0.1 * z);
    assert!(
        larger.contains("gains of the frames are LARGER than the 2.0 %"),
        "{larger}"
    );
    let one = told(&|l, z| if l == 3 { 0.12 } else { 0.02 * z });
    assert!(one.contains("gain of frame 3 1"), "{one}");
}

/// Noise of which each pixel has half of its neighbour's has the variance that is stated, and χ²
/// says nothing: that neighbours share it is told, errors by blocks of pixels count, and over 24
/// draws the surface is off by what is stated, √χ²/n within four of its errors. Of a noise that is
/// not stated it is told too, of single pixels' noise nothing.
#[test]
fn noise_that_neighbours_share_is_in_the_errors() {
    let scene = small("bench", 16);
    let (exact, _) = photographs(&scene, 4, 0.0, 1);
    let stderr = &exact * 1e-2;
    let found = |seed: u64, share: f64, is_stated: bool| {
        let mut random = normal(seed);
        let own = Matrix::from_fn(exact.nrows() + 1, exact.ncols(), |_, _| random()[0]);
        let noise =
            |p: usize, l: usize| (own[(p, l)] + share * own[(p + 1, l)]) / 1f64.hypot(share);
        let noise = Matrix::from_fn(exact.nrows(), exact.ncols(), noise);
        let phi = &exact + stderr.component_mul(&noise);
        let plan = plan(&["hidden.normal"], 4);
        let photographs = Unexplained {
            stderr: is_stated.then_some(&stderr),
            ..unexplained(&phi, &stderr)
        };
        plan.calibrate(&scene, &photographs, Control::none())
            .unwrap()
    };
    let draws = 24;
    let squares = (0..draws).map(|seed| {
        let found = found(seed, 1.0, true);
        assert!((found.neighbours.unwrap() - 0.5).abs() < 0.1);
        let notes = found.describe().notes.concat();
        assert!(notes.contains("HANGS TOGETHER"), "{notes}");
        let own = &found.found[0];
        assert!(own.by_blocks.is_some());
        (own.value / own.stderr).powi(2)
    });
    let rms = (squares.sum::<f64>() / draws as f64).sqrt();
    assert!(
        (rms - 1.0).abs() < 4.0 / (2.0 * draws as f64).sqrt(),
        "{rms}"
    );
    let unstated = found(1, 1.0, false);
    assert!((unstated.neighbours.unwrap() - 0.5).abs() < 0.1);
    assert!(found(1, 0.0, false).neighbours.is_none());
    let alone = found(1, 0.0, true);
    assert!(alone.neighbours.is_none() && alone.found[0].by_blocks.is_none());
}

/// Wide spots past a thin rod, photographs traced, which knows of no elements: the stated error
/// knows what their light is not integrated to, and no geometry is refuted for it.
#[test]
#[ignore = "slow"]
fn what_the_integration_leaves_is_in_the_errors() {
    let text = r#"
name = "rod"
unit = "cm"
max_bounces = 3
[laser]
power = 1.0
wavelength = 500e-9
position = [30.0, 8.0, 13.0]
spot_diameter = 2.0
[laser.spots]
layout = "list"
points = [[8, 2], [8, 5], [8, 8], [8, 11], [-8, 3], [-8, 6], [-8, 9], [0, 12]]
[camera]
position = [5.0, -10.0, 35.0]
aperture_area = 0.1
view = { x = [-4, 6], y = [2, 8] }
pixels = [5, 3]
[[surface]]
name = "wall"
role = "relay"
rectangle = { corner = [-10, 0, 0], u = [20, 0, 0], v = [0, 15, 0] }
material = { lambertian = 0.6 }
[[surface]]
name = "board"
role = "hidden"
rectangle = { corner = [-3, 5, 22], u = [0, 5, -1], v = [5, 0, 0] }
material = { lambertian = { checkerboard = [2, 2], dark = 0.2, light = 0.9 } }
elements = [2, 2]
[[surface]]
name = "rod"
role = "occluder"
rectangle = { corner = [2.6, 0.5, 11.0], u = [0, 13, 0], v = [0.5, 0, 0] }
sides = "two"
material = { lambertian = 0.0 }
"#;
    let scene = Scene::from_toml("rod", text).unwrap();
    let how = Plan {
        estimator: Estimator::Factored,
        sampling: Sampling::Sobol,
        seed: 1,
        budget: Budget::new(1 << 16, Sampling::Sobol).unwrap(),
    };
    let traced = render(&scene, &how, 0..8, Control::none()).unwrap();
    let photographs = unexplained(&traced.flux, &traced.stderr);
    let found = plan(&["rod.v"], 2).calibrate(&scene, &photographs, Control::none());
    let found = found.unwrap();
    let own = &found.found[0];
    assert!(own.by_rule.unwrap() > own.by_curvature, "{own:?}");
    assert!(own.stderr >= own.by_rule.unwrap(), "{own:?}");
    assert!(
        own.value.abs() < 3.0 * own.stderr && own.value.abs() > 3.0 * own.by_curvature,
        "{own:?}"
    );
    assert!(found.is_found(), "{:?} {:?}", found.misfit, found.p);
}

/// χ² of errors from 8 replicates, by draws of Student's t of 7 degrees of freedom as ratios of
/// normal numbers: one in a hundred is below p = 0.01, within the binomial error of 2000.
#[test]
fn estimated_errors_are_expected_to_scatter() {
    let mut random = normal(11);
    let estimated = Certainty::new(Errors::Independent, Some(8));
    let mut t2 = || {
        let own = random()[0];
        let squares: f64 = (0..7).map(|_| random()[0]).map(|x| x * x).sum();
        own * own * 7.0 / squares
    };
    let draws = 1000;
    let few = |level: f64, all: &[f64]| all.iter().filter(|p| **p < level).count();
    let all: Vec<f64> = (0..draws)
        .map(|_| estimated.by_noise((0..400).map(|_| t2()).sum(), 400.0))
        .collect();
    // Tails heavier than those of χ²: up to twice as many as stated, and no fewer than half.
    let below = few(0.05, &all);
    assert!((25..=100).contains(&below), "{below}");
    assert!(Certainty::STATED.by_noise(1.4 * 400.0, 400.0) < 1e-6);
}

/// Three photographs of each spot: over 40 draws the hinge is off by its stated error, √χ²/n within
/// four of its standard errors 1/√(2n), and the photographs are not refuted, as they are where each
/// error is taken for known.
#[test]
fn errors_of_three_replicates_are_pooled() {
    let scene = small("bench", 12);
    let names = ["hinge.angle"];
    let parameters = Parameter::named(&scene, names[0]).unwrap();
    let there = scene.displaced(&parameters, &[0.5]).unwrap();
    let (exact, sigma) = photographs(&there, 2, 0.0, 0);
    let sigma = sigma.map(|_| 0.01 * exact.mean());
    let plan = plan(&names, 2);
    let pooled = Certainty::new(Errors::Independent, Some(3));
    let draws = 40;
    let mut squares = [0.0; 2];
    let mut refuted = [0; 2];
    for seed in 0..draws {
        let [phi, stderr] = repeated(&exact, &sigma, 3, 50 + seed);
        for (k, certainty) in [pooled, Certainty::STATED].into_iter().enumerate() {
            let photographs = Unexplained {
                certainty,
                ..unexplained(&phi, &stderr)
            };
            let found = plan.calibrate(&scene, &photographs, Control::none());
            let found = found.unwrap();
            let own = &found.found[0];
            squares[k] += ((own.value - 0.5) / own.by_curvature).powi(2);
            refuted[k] += u32::from(found.p.unwrap() < 1e-3);
        }
    }
    let [pooled, known] = squares.map(|sum| (sum / draws as f64).sqrt());
    let most = 1.0 + 4.0 / (2.0 * draws as f64).sqrt();
    assert!(pooled < most && refuted[0] == 0, "{pooled} {refuted:?}");
    assert!(known > most && refuted[1] > 30, "{known} {refuted:?}");
}

/// Photographs of a hinge that is wrong, with a drawn field of errors of a fifteenth of the light
/// beside noise: over 24 draws the hinge lies within its stated errors as often as it should, where
/// errors by noise of single pixels are too small; the field's numbers and that it is likelier are
/// found. Of noise alone errors stay what they are, and nothing is much likelier.
#[test]
fn errors_allow_for_what_neighbours_share() {
    let scene = small("bench", 12);
    let parameters = Parameter::named(&scene, "hinge.angle").unwrap();
    let there = scene.displaced(&parameters, &[1.0]).unwrap();
    let clean = MatrixModel::new(&there, Kernel::Physical, Some([2; 2])).unwrap();
    let clean = clean.phi();
    let level = clean.norm() / (clean.len() as f64).sqrt();
    let draw = |shared: f64, seed: u64, error_field: bool| {
        let truth = ErrorField {
            pixel: 0.02 * level,
            shared: shared * level,
            range: 4.0,
        };
        let v = truth.variances([12; 2]);
        let mut random = normal(seed);
        let errors = Matrix::from_fn(144, clean.ncols(), |k, _| v[k].sqrt() * random()[0]);
        let phi = &clean + from_cosines(&errors, [12; 2]);
        let photographs = Unexplained {
            phi: &phi,
            stderr: None,
            certainty: Certainty::STATED,
            left_out: None,
            patterns: None,
        };
        let plan = CalibrationPlan {
            error_field,
            ..plan(&["hinge.angle"], 2)
        };
        let found = plan.calibrate(&scene, &photographs, Control::none());
        (found.unwrap(), truth)
    };
    let off = |found: &Calibration| (found.found[0].value - 1.0) / found.found[0].stderr;
    let (mut told, mut alone, mut sizes) = (0, 0.0, [0.0; 2]);
    for seed in 0..24 {
        let (found, truth) = draw(0.06, seed, true);
        let z = off(&found);
        told += usize::from(z.abs() < 1.96);
        let field = found.field.unwrap();
        sizes[0] += field.pixel / truth.pixel / 24.0;
        sizes[1] += field.shared / truth.shared / 24.0;
        assert!(found.log_likelier.unwrap() > 1000.0 && found.is_settled);
        let (white, _) = draw(0.06, seed, false);
        alone += (white.found[0].value - 1.0).powi(2) / white.found[0].by_curvature.powi(2) / 24.0;
    }
    assert!(sizes.iter().all(|x| (x - 1.0).abs() < 0.15), "{sizes:?}");
    // Of 24 at 95 %: fewer than 20 in one of a thousand.
    assert!(told >= 20, "{told}");
    assert!(alone > 4.0, "{alone}");
    let (found, _) = draw(0.0, 1, true);
    let (white, _) = draw(0.0, 1, false);
    assert!(
        found.log_likelier.unwrap() < 6.0,
        "{:?}",
        found.log_likelier
    );
    let ratio = found.found[0].by_curvature / white.found[0].by_curvature;
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
}

/// Errors of neighbours are looked for where noise is unknown and all entries count.
#[test]
fn a_field_of_errors_is_refused_where_there_is_none() {
    let scene = small("bench", 4);
    let (phi, stderr) = photographs(&scene, 2, 0.1, 6);
    let plan = CalibrationPlan {
        error_field: true,
        ..plan(&["hinge.angle"], 2)
    };
    let refused = |photographs: &Unexplained<'_>| {
        let refused = plan.calibrate(&scene, photographs, Control::none());
        refused.unwrap_err().to_string()
    };
    let known = unexplained(&phi, &stderr);
    assert!(refused(&known).contains("is stated"));
    let holed = Matrix::from_fn(phi.nrows(), phi.ncols(), |p, _| f64::from(u8::from(p == 0)));
    let holed = Unexplained {
        stderr: None,
        left_out: Some(&holed),
        ..known
    };
    assert!(refused(&holed).contains("entries are left out"));
}

/// Photographs of the bench with few spots, its frames drifting by `drift` beside a little noise;
/// the hidden surface stands 0.1 in. farther along its normal.
fn drifting(drift: f64, seed: u64) -> (Scene, Matrix) {
    let scene = small("bench", 8);
    let parameters = Parameter::named(&scene, "hidden.normal").unwrap();
    let there = scene.displaced(&parameters, &[0.1]).unwrap();
    let (mut phi, _) = photographs(&there, 4, 1e-3, seed);
    let mut random = normal(seed + 1000);
    for mut frame in phi.column_iter_mut() {
        frame *= 1.0 + drift * random()[0];
    }
    (scene, phi)
}

/// Errors by frames and by blocks of pixels of an unstated noise are those of leaving out one after
/// the other and fitting the others anew, √((m − 1)/m Σ (θ_(c) − θ̄)²), to a tenth.
#[test]
fn errors_by_groups_are_those_without_each() {
    let (scene, phi) = drifting(0.01, 3);
    let (pixels, frames) = phi.shape();
    let found = |left_out: Option<&Matrix>| {
        let photographs = Unexplained {
            phi: &phi,
            stderr: None,
            certainty: Certainty::STATED,
            left_out,
            patterns: None,
        };
        let found = plan(&["hidden.normal"], 4).calibrate(&scene, &photographs, Control::none());
        found.unwrap().found.swap_remove(0)
    };
    let jackknife = |groups: usize, of: &dyn Fn(usize, usize) -> usize| {
        let without = (0..groups).map(|c| {
            let flag = |p, l| f64::from(u8::from(of(p, l) == c));
            found(Some(&Matrix::from_fn(pixels, frames, flag))).value
        });
        let without = DVector::from_iterator(groups, without);
        // That of nalgebra is Σ (θ − θ̄)²/m.
        ((groups as f64 - 1.0) * without.variance()).sqrt()
    };
    let own = found(None);
    // Blocks of 2 × 2 of the 8 × 8 pixels.
    let by_blocks = jackknife(16, &|p, _| p % 8 / 2 + p / 16 * 4);
    for (own, refitted) in [
        (own.by_frames, jackknife(frames, &|_, l| l)),
        (own.by_blocks, by_blocks),
    ] {
        let own = own.unwrap();
        assert!((own / refitted - 1.0).abs() < 0.1, "{own} {refitted}");
    }
}

/// Photographs whose frames drift by 1 %, which nothing states: over 32 draws the hidden surface is
/// off by the errors that are stated, √χ²/n within four of its standard errors 1/√(2n).
#[test]
fn drifting_frames_are_in_the_errors() {
    let draws = 32;
    let squares = (0..draws).map(|seed| {
        let (scene, phi) = drifting(0.01, seed);
        let photographs = Unexplained {
            phi: &phi,
            stderr: None,
            certainty: Certainty::STATED,
            left_out: None,
            patterns: None,
        };
        let found = plan(&["hidden.normal"], 4).calibrate(&scene, &photographs, Control::none());
        let own = found.unwrap().found.swap_remove(0);
        ((own.value - 0.1) / own.stderr).powi(2)
    });
    let rms = (squares.sum::<f64>() / draws as f64).sqrt();
    assert!(rms < 1.0 + 4.0 / (2.0 * draws as f64).sqrt(), "{rms}");
    assert!(rms > 0.4, "{rms}");
}
