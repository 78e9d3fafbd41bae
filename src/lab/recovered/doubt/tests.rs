mod contested;
mod errors;
mod misfit;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::*;
use crate::lab::comparison::misplaced::normal;
use crate::lab::ensemble::Photographs;
use crate::lab::recovered::fit::Fit;
use crate::lab::study::tests::small;
use crate::lab::{Certainty, Noise, RecoveredObject, Work, recover_objects};
use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel};
use crate::num::control::Control;
use crate::recovery::{Nuisance, Options, Problem, RecoveryError};

/// Every method that 16 elements and 14 spots allow, with what it makes of the photographs: a
/// refusal, or its first surface.
fn by_every_method(
    model: &MatrixModel,
    phi: &Matrix,
    stderr: Option<&Matrix>,
) -> Vec<(Method, Result<RecoveredObject, String>)> {
    let noise = stderr.map_or(Noise::Unknown, |s| {
        Noise::StandardError(s, Certainty::STATED)
    });
    let options = Options::default();
    let nuisance = Nuisance::default();
    recover_objects(
        model,
        phi,
        noise,
        nuisance,
        &Method::ALL,
        &options,
        Control::none(),
    )
    .into_iter()
    .map(|a| {
        let outcome = a.outcome.map(|mut all| all.remove(0));
        (a.method, outcome.map_err(|e| e.to_string()))
    })
    .collect()
}

fn loud(object: &RecoveredObject) -> bool {
    let told = object.warnings.iter().any(|w| w.contains("DOES NOT FIT"));
    assert!(!object.parameter.contains("Solved"), "{}", object.parameter);
    told
}

/// What a method makes of photographs whose standard errors are known: its first surface.
fn recovered(
    model: &MatrixModel,
    phi: &Matrix,
    (stderr, certainty): (&Matrix, Certainty),
    (method, options): (Method, &Options),
) -> RecoveredObject {
    let noise = Noise::StandardError(stderr, certainty);
    let (nuisance, methods, control) = (Nuisance::default(), [method], Control::none());
    let mut found = recover_objects(model, phi, noise, nuisance, &methods, options, control);
    found.remove(0).outcome.unwrap().remove(0)
}

/// What is said of a method's picture, each entry known to 0.01.
fn warnings(model: &MatrixModel, phi: &Matrix, method: Method) -> Vec<String> {
    let known = (&phi.map(|_| 0.01), Certainty::STATED);
    recovered(model, phi, known, (method, &Options::default())).warnings
}

/// Three spots tell three directions of nine elements apart, and one spot none: the inverse of the
/// laser side says the first, and refuses the second.
#[test]
fn an_inverse_of_few_spots_says_so() {
    let camera = Matrix::from_fn(20, 9, |p, j| 1.5 + libm::sin((p * (j + 2)) as f64));
    for spots in [12, 3, 1] {
        let laser = Matrix::from_fn(9, spots, |j, l| 1.5 + libm::cos((j * (l + 2)) as f64));
        let model = MatrixModel::of_sides(camera.clone(), laser, [3, 3]).unwrap();
        let phi = model.phi();
        let stderr = phi.map(|x| 1e-3 * x);
        let noise = Noise::StandardError(&stderr, Certainty::STATED);
        let (nuisance, options) = (Nuisance::default(), Options::default());
        let methods = [Method::Pinv];
        let found = recover_objects(
            &model,
            &phi,
            noise,
            nuisance,
            &methods,
            &options,
            Control::none(),
        );
        match &found[0].outcome {
            Err(error) => assert!(
                spots == 1 && error.to_string().contains("one spot"),
                "{error}"
            ),
            Ok(found) => {
                let told = found[0]
                    .warnings
                    .iter()
                    .any(|w| w.contains("3 directions of 9"));
                assert_eq!(told, spots == 3, "{spots}: {:?}", found[0].warnings);
            }
        }
    }
}

/// What is finished before it is stopped is kept; the others say that they were stopped, and their
/// share of the work is told all the same.
#[test]
fn methods_that_are_finished_are_kept() {
    let (stop, told) = (AtomicBool::new(false), AtomicU64::new(0));
    let progress = |units: u64| {
        let all = told.fetch_add(units, Ordering::Relaxed) + units;
        stop.store(all >= 2 * Work::EACH_METHOD, Ordering::Relaxed);
    };
    let control = Control {
        progress: &progress,
        stop: &stop,
    };
    let camera = Matrix::from_fn(20, 4, |p, j| 1.0 + libm::sin((p * (j + 2)) as f64));
    let model = MatrixModel::of_sides(camera, Matrix::from_element(4, 1, 1.0), [4, 1]).unwrap();
    let exact = &model.camera_side * Matrix::from_row_slice(4, 1, &[0.3, 0.7, 0.6, 0.0]);
    let stderr = exact.map(|_| 0.01);
    let noise = Noise::StandardError(&stderr, Certainty::STATED);
    let methods = [Method::JointUnbounded, Method::Joint, Method::JointGp];
    let (nuisance, options) = (Nuisance::default(), Options::default());
    let found = recover_objects(&model, &exact, noise, nuisance, &methods, &options, control);
    let finished: Vec<bool> = found.iter().map(|a| a.outcome.is_ok()).collect();
    assert_eq!(finished, [true, true, false]);
    let last = found[2].outcome.as_ref().unwrap_err();
    assert!(last.to_string().contains("stopped"), "{last}");
    assert_eq!(told.load(Ordering::Relaxed), 3 * Work::EACH_METHOD);
}

/// With a free scale the brightest of reflectances 0.9 and 0.85 is certain at little noise, and the
/// picture is right in units of its brightest; at much noise that is told to be uncertain.
#[test]
fn a_free_scales_uncertain_unit_is_told() {
    let mut model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([2, 2])).unwrap();
    model.albedo = vec![0.3, 0.9, 0.85, 0.2];
    let nuisance = Nuisance {
        free_scale: true,
        ..Nuisance::default()
    };
    let exact = &model.camera_side
        * Matrix::from_diagonal(&model.albedo.clone().into())
        * &model.laser_side;
    for (level, uncertain) in [(1e-5, false), (0.5, true)] {
        let taken = Photographs::relative(&exact, level, 3);
        let noise = Noise::StandardError(&taken.stderr, Certainty::STATED);
        let methods = [Method::JointUnbounded, Method::JointGp];
        let (options, control) = (Options::default(), Control::none());
        let found = recover_objects(
            &model, &taken.phi, noise, nuisance, &methods, &options, control,
        );
        let told = |k: usize| {
            let object = &found[k].outcome.as_ref().unwrap()[0];
            let unit = |w: &String| w.contains("UNIT IS NOT CERTAIN");
            (object.warnings.iter().any(unit), object.rmse.unwrap())
        };
        assert_eq!(told(0).0, uncertain, "{found:?}");
        let right = |(told, rmse): (bool, f64)| !told && rmse < 1e-3;
        assert!(uncertain || right(told(0)) && right(told(1)), "{found:?}");
    }
}

/// Where reflectances between 0 and 1 were looked for and not found, that is told beside a picture
/// that fits.
#[test]
fn a_search_that_finds_no_possible_picture_is_told() {
    let side = |rows, columns| Matrix::from_fn(rows, columns, |i, j| 1.0 + ((i * j) % 3) as f64);
    let (c, d) = (side(4, 2), side(2, 3));
    let phi = &c * &d;
    let problem = Problem::new(&phi, &c, &d, None).unwrap();
    let found = crate::recovery::recover(Method::JointUnbounded, &problem, &Options::default());
    let found = found.unwrap();
    for (none_possible, told) in [(None, false), (Some(RecoveryError::TakenUp), true)] {
        let judged = Judged {
            none_possible,
            ..Judged::default()
        };
        let warned = doubts(&found, &judged);
        let is_told = warned.iter().any(|w| w.contains("NOT KNOWN"));
        assert_eq!(is_told, told, "{warned:?}");
    }
}

/// Dark less light, of a free scale: numbers explain it and no reflectances above 0 do, so that
/// every method that takes a free scale refuses it in the same words.
#[test]
fn photographs_of_no_possible_picture_are_refused() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([2, 2])).unwrap();
    let taken = Photographs::relative(&model.phi(), 1e-3, 3);
    let nuisance = Nuisance {
        free_scale: true,
        ..Nuisance::default()
    };
    let (options, control) = (Options::default(), Control::none());
    let methods: Vec<Method> = Method::ALL.into_iter().filter(|m| m.is_joint()).collect();
    for (sign, refused) in [(1.0, false), (-1.0, true)] {
        // One number is above 0, for the scale to be that.
        let mut phi = &taken.phi * sign;
        let own = model.camera_side.column(0) * model.laser_side.row(0) * 0.2;
        phi += own;
        let noise = Noise::StandardError(&taken.stderr, Certainty::STATED);
        let found = recover_objects(&model, &phi, noise, nuisance, &methods, &options, control);
        assert_eq!(found.len(), 6);
        for attempt in found {
            match attempt.outcome {
                Ok(found) => assert!(!refused && !found[0].contradicted(), "{}", attempt.method),
                Err(error) => {
                    let told = error.to_string().contains("no element comes out bright");
                    assert!(refused && told, "{} {error}", attempt.method);
                }
            }
        }
    }
}

/// An element that no light reaches: every method says so of its picture, by its number, with a
/// known and a free scale, with known and unknown noise; where all are lit none does.
#[test]
fn an_element_without_light_is_told_by_every_method() {
    let side = |rows: usize, columns: usize, dark: usize| {
        Matrix::from_fn(rows, columns, |p, j| {
            let x = 1.5 + libm::sin((p * (j + 2)) as f64 + 0.3 * j as f64);
            if j == dark { 0.0 } else { x }
        })
    };
    for (dark, free_scale) in [(6, false), (6, true), (99, false), (99, true)] {
        let laser = side(12, 9, 99).transpose();
        let model = MatrixModel::of_sides(side(20, 9, dark), laser, [3, 3]).unwrap();
        let board = Matrix::from_fn(9, 1, |j, _| if j % 2 == 0 { 0.8 } else { 0.2 });
        let exact =
            &model.camera_side * Matrix::from_diagonal(&board.column(0)) * &model.laser_side;
        let taken = Photographs::relative(&exact, 1e-3, 3);
        let nuisance = Nuisance {
            free_scale,
            ..Nuisance::default()
        };
        let known = Noise::StandardError(&taken.stderr, Certainty::STATED);
        for noise in [known, Noise::Unknown] {
            let methods: Vec<Method> = Method::ALL.into_iter().filter(|m| m.is_joint()).collect();
            let options = Options {
                total_variation: Some(1e-6),
                ..Options::default()
            };
            let control = Control::none();
            let found = recover_objects(
                &model, &taken.phi, noise, nuisance, &methods, &options, control,
            );
            for attempt in found {
                let case = format!("{} {dark} {free_scale} {noise:?}", attempt.method);
                let Ok(objects) = attempt.outcome else {
                    // A Gaussian process needs more light than this to know its noise.
                    assert!(matches!(noise, Noise::Unknown), "{case}");
                    continue;
                };
                let told = objects[0].warnings.iter().filter(|w| {
                    w.contains("say NOTHING of 1 of 9 elements, whose light they do not show (6;")
                        || w.contains("do not determine 1 of 9 elements")
                });
                assert_eq!(
                    told.count(),
                    usize::from(dark == 6),
                    "{case}: {:?}",
                    objects[0].warnings
                );
            }
        }
    }
}
