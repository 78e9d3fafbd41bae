use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::*;
use crate::lab::ensemble::Photographs;
use crate::lab::fit::Fit;
use crate::lab::misplaced::normal;
use crate::lab::study::tests::small;
use crate::lab::{Certainty, Noise, RecoveredObject, Work, recover_objects};
use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel};
use crate::num::control::Control;
use crate::recovery::{Nuisance, Options};

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

/// Frames upside down, spots in another order, counts given as W, spots elsewhere by half an
/// inch, the published kernel: each is warned of by every method, or refused by it.
#[test]
fn every_method_warns_of_photographs_that_are_not_of_this_scene() {
    let scene = small("bench");
    let model = MatrixModel::new(&scene, Kernel::Physical, Some([4, 4])).unwrap();
    let right = Photographs::relative(&model.phi(), 1e-3, 1);
    let both = |f: &dyn Fn(&Matrix) -> Matrix| (f(&right.phi), f(&right.stderr));
    let (columns, rows) = (scene.camera.columns, scene.camera.rows);
    let upside_down = both(&|m| {
        Matrix::from_fn(m.nrows(), m.ncols(), |p, l| {
            m[((rows - 1 - p / columns) * columns + p % columns, l)]
        })
    });
    let permuted = both(&|m| {
        let n = m.ncols();
        Matrix::from_fn(m.nrows(), n, |p, l| m[(p, (l + 1) % n)])
    });
    let counts = both(&|m| m * 1e15);
    let shifted = scene.with_shifted_spots([0.5, 0.0]).unwrap();
    let elsewhere = MatrixModel::new(&shifted, Kernel::Physical, Some([4, 4])).unwrap();
    let published = MatrixModel::new(&scene, Kernel::Published, Some([4, 4])).unwrap();
    let own = (right.phi.clone(), right.stderr.clone());
    for (fault, model, (phi, stderr)) in [
        ("upside down", &model, &upside_down),
        ("permuted", &model, &permuted),
        ("counts", &model, &counts),
        ("elsewhere", &elsewhere, &own),
        ("published", &published, &own),
    ] {
        let mut told = 0;
        for (method, outcome) in by_every_method(model, phi, Some(stderr)) {
            let Ok(object) = outcome else { continue };
            assert!(
                loud(&object) && object.contradicted(),
                "{fault} {method}: {object:?}"
            );
            told += 1;
        }
        assert!(told >= 8, "{fault}: {told} recovered");
    }
    // Of counts no noise is needed to see it, unless bounds or levels hide it.
    for (method, outcome) in by_every_method(&model, &counts.0, None) {
        let Ok(object) = outcome else { continue };
        let first = &object.warnings[0];
        assert!(
            first.contains("CANNOT BE JUDGED") && object.fit.is_none(),
            "{method}"
        );
        let second = object.warnings.iter().skip(1);
        let second: Vec<&String> = second
            .filter(|w| w.contains("on a bound") || w.contains("beyond 0 to 1"))
            .collect();
        assert!(
            !second.is_empty() || method == Method::JointTwoValued,
            "{method}"
        );
    }
}

/// Right photographs but for one entry, five times as bright, whose standard error is given as 0:
/// it moves the picture and no test sees it, so it is among what is to be checked; and of numbers
/// that fit worse than reflectances do, nothing is said.
#[test]
fn a_wrong_entry_without_an_error_is_among_the_cures() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
    let mut right = Photographs::relative(&model.phi(), 1e-3, 1);
    right.phi[(2, 3)] *= 5.0;
    right.stderr[(2, 3)] = 0.0;
    for (method, outcome) in by_every_method(&model, &right.phi, Some(&right.stderr)) {
        let Ok(object) = outcome else { continue };
        if method != Method::Joint {
            continue;
        }
        let told = object.warnings.join(" ");
        assert!(told.contains("DOES NOT FIT, by any method"), "{told}");
        assert!(told.contains("whose standard error is 0"), "{told}");
        assert!(!told.contains("no numbers at all"), "{told}");
    }
}

/// Right photographs: nothing contradicts, and `joint` fits.
#[test]
fn right_photographs_are_not_warned_of() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
    for seed in 1..6 {
        let right = Photographs::relative(&model.phi(), 1e-3, seed);
        for (method, outcome) in by_every_method(&model, &right.phi, Some(&right.stderr)) {
            let Ok(object) = outcome else { continue };
            assert!(!object.contradicted(), "{method}: {object:?}");
            assert!(object.fit.is_some());
            let joint = [Method::Joint, Method::JointUnbounded, Method::Nnls];
            assert!(
                !joint.contains(&method) || !loud(&object),
                "{method}: {object:?}"
            );
        }
    }
}

/// What is said of a method's picture, each entry known to 0.01.
fn warnings(model: &MatrixModel, phi: &Matrix, method: Method) -> Vec<String> {
    let stderr = phi.map(|_| 0.01);
    let noise = Noise::StandardError(&stderr, Certainty::STATED);
    let (nuisance, options) = (Nuisance::default(), Options::default());
    let methods = [method];
    let control = Control::none();
    let found = recover_objects(model, phi, noise, nuisance, &methods, &options, control);
    found[0].outcome.as_ref().unwrap()[0].warnings.clone()
}

/// Two elements of equal columns are known by their sum alone: the shortest solution gives each a
/// half of it with an error that does not know that, and says so; without the second nothing is
/// said.
#[test]
fn elements_that_cannot_be_told_apart_are_told() {
    let camera = |alike: bool| {
        Matrix::from_fn(20, 4, |p, j| {
            let j = if alike && j == 3 { 2 } else { j };
            1.0 + libm::sin((p * (j + 2)) as f64)
        })
    };
    for alike in [true, false] {
        let model =
            MatrixModel::of_sides(camera(alike), Matrix::from_element(4, 1, 1.0), [4, 1]).unwrap();
        let exact = &model.camera_side * Matrix::from_row_slice(4, 1, &[0.3, 0.7, 0.6, 0.0]);
        let warnings = warnings(&model, &exact, Method::JointUnbounded);
        let told = warnings
            .iter()
            .any(|w| w.contains("do not determine 2 of 4"));
        assert_eq!(told, alike, "{warnings:?}");
    }
}

/// An element whose light is a hundred millionth of the others' has whatever noise makes of it by
/// `nnls`, which says so; of one that is seen nothing is said.
#[test]
fn an_element_that_is_not_seen_is_told() {
    for (light, unseen) in [(1e-8, true), (1.0, false)] {
        let camera = Matrix::from_fn(20, 4, |p, j| {
            (1.0 + libm::sin((p * (j + 2)) as f64)) * if j == 3 { light } else { 1.0 }
        });
        let model = MatrixModel::of_sides(camera, Matrix::from_element(4, 1, 1.0), [4, 1]).unwrap();
        let exact = &model.camera_side * Matrix::from_row_slice(4, 1, &[0.3, 0.7, 0.6, 0.5]);
        let phi = exact + model.camera_side.columns(3, 1) * (1e-3 / light);
        let warnings = warnings(&model, &phi, Method::Nnls);
        let told = warnings
            .iter()
            .any(|w| w.contains("1 of 4 elements, up to"));
        assert_eq!(told, unseen, "{warnings:?}");
    }
}

/// Right photographs whose errors are no product of one by pixel and one by spot: no method says
/// that nothing explains them, and one whose weights are of that form says what helps. Their errors
/// estimated from few replicates, those of the picture are told to be too small.
#[test]
fn errors_of_any_form_refute_nothing() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([2, 2])).unwrap();
    let phi = model.phi();
    for seed in 1..4 {
        let mut normal = normal(seed);
        let stderr = phi.map(|x| 0.01 * x * libm::exp(1.5 * normal()[0]));
        let noisy = phi.zip_map(&stderr, |x, s| x + s * normal()[0]);
        let mut told = 0;
        for (method, outcome) in by_every_method(&model, &noisy, Some(&stderr)) {
            let Ok(object) = outcome else { continue };
            assert!(!object.contradicted(), "{method}: {:?}", object.warnings);
            let helps = object.warnings.iter();
            told += usize::from(helps.filter(|w| w.contains("--weighting entries")).count() > 0);
        }
        assert!(told > 0, "{seed}");
    }
    for (replicates, few) in [(Some(5), true), (Some(32), false), (None, false)] {
        let right = Photographs::relative(&phi, 1e-2, 5);
        let certainty = Certainty {
            replicates,
            ..Certainty::STATED
        };
        let found = recover_objects(
            &model,
            &right.phi,
            Noise::StandardError(&right.stderr, certainty),
            Nuisance::default(),
            &[Method::JointUnbounded],
            &Options::default(),
            Control::none(),
        );
        let warnings = &found[0].outcome.as_ref().unwrap()[0].warnings;
        let told = warnings.iter().any(|w| w.contains("replicates"));
        assert_eq!(told, few, "{replicates:?}: {warnings:?}");
    }
}

/// Noisy photographs do not say how alike elements are, good ones of elements that are not do.
#[test]
fn how_alike_elements_are_is_told_or_not() {
    let mut model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
    model.albedo = (0..16)
        .map(|j| 0.5 + 0.3 * libm::sin(f64::from(j * j)))
        .collect();
    for (level, untold) in [(1e-9, false), (0.1, true)] {
        let of = Photographs::relative(&model.phi(), level, 5);
        let found = recover_objects(
            &model,
            &of.phi,
            Noise::StandardError(&of.stderr, Certainty::STATED),
            Nuisance::default(),
            &[Method::JointGp],
            &Options::default(),
            Control::none(),
        );
        let warnings = &found[0].outcome.as_ref().unwrap()[0].warnings;
        let told = warnings.iter().any(|w| w.contains("how alike"));
        assert_eq!(told, untold, "{level}: {warnings:?}");
    }
}

/// Elements about two levels, and on them: at the same noise the first are told from two
/// reflectances and have errors that hold all the same, the second are taken for two.
#[test]
fn greys_about_two_levels_are_told_from_two_levels() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
    let level = |j: usize| if j % 4 == j / 4 || j < 4 { 0.8 } else { 0.2 };
    let off = |j: usize| 0.12 * libm::sin(7.0 * j as f64);
    for grey in [true, false] {
        let truth: Vec<f64> = (0..16)
            .map(|j| level(j) + if grey { off(j) } else { 0.0 })
            .collect();
        let of = MatrixModel {
            albedo: truth.clone(),
            ..model.clone()
        };
        for seed in 1..4 {
            let right = Photographs::relative(&of.phi(), 1e-3, seed);
            let noise = Noise::StandardError(&right.stderr, Certainty::STATED);
            let (nuisance, options) = (Nuisance::default(), Options::default());
            let two = [Method::JointTwoValued];
            let found = recover_objects(
                &of,
                &right.phi,
                noise,
                nuisance,
                &two,
                &options,
                Control::none(),
            );
            let found = &found[0].outcome.as_ref().unwrap()[0];
            let assumed = found.patterns.as_ref().unwrap().assumed();
            let exact = assumed.exact.unwrap();
            let told = found
                .warnings
                .iter()
                .any(|w| w.contains("exactly two reflectances"));
            assert!(told == grey && (exact < 0.5) == grey, "{seed}: {exact}");
            let errors = found.standard_error.as_ref().unwrap();
            for (j, error) in errors.iter().enumerate() {
                let z = (found.reflectance[j] - truth[j]) / error;
                assert!(z.abs() < 4.0, "{grey} {seed} {j}: {z}");
            }
        }
    }
}

/// Little noise leaves one pattern; more of it leaves many, and the one that is shown says so.
#[test]
fn a_pattern_that_is_one_of_many_says_so() {
    let mut model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
    model.albedo = (0..16)
        .map(|j: usize| if (j * 7 + j / 4) % 3 == 1 { 0.8 } else { 0.2 })
        .collect();
    let options = Options {
        levels: Some([0.2, 0.8]),
        ..Options::default()
    };
    for (level, many) in [(1e-4, false), (0.3, true)] {
        let of = Photographs::relative(&model.phi(), level, 5);
        let found = recover_objects(
            &model,
            &of.phi,
            Noise::StandardError(&of.stderr, Certainty::STATED),
            Nuisance::default(),
            &[Method::JointTwoValued],
            &options,
            Control::none(),
        );
        let found = &found[0].outcome.as_ref().unwrap()[0];
        let told = found.warnings.iter().any(|w| w.contains("one of many"));
        assert_eq!(
            told, many,
            "{level}: {:?} {:?}",
            found.patterns, found.warnings
        );
    }
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

/// One entry of all is 10 standard errors too bright: it is named, and without it none is.
#[test]
fn an_entry_that_noise_does_not_explain_is_named() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([2, 2])).unwrap();
    let right = Photographs::relative(&model.phi(), 1e-3, 4);
    for off in [0.0, 10.0] {
        let mut phi = right.phi.clone();
        phi[(5, 3)] += off * right.stderr[(5, 3)];
        for (method, outcome) in by_every_method(&model, &phi, Some(&right.stderr)) {
            let Ok(object) = outcome else { continue };
            let named = |w: &&String| w.contains("the entry of pixel 5 and spot 3 lies");
            let told = object.warnings.iter().filter(named).count();
            // Where a method leaves light of many entries over none of them is to blame.
            let fits = object
                .fit
                .as_ref()
                .is_some_and(|fit| fit.chi2_per_dof < 5.0);
            let expected = usize::from(off > 0.0 && fits);
            assert_eq!(told, expected, "{method} {off}: {:?}", object.warnings);
        }
    }
}

/// Two pictures of the same photographs that lie apart by more than their errors are both
/// contested; where one is far likelier, the other alone; and those that agree are not.
#[test]
fn pictures_that_contradict_each_other_are_told() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([2, 2])).unwrap();
    let right = Photographs::relative(&model.phi(), 1e-3, 4);
    let problem = crate::lab::problem::problem(&model, &right.phi, Some(&right.stderr)).unwrap();
    let grids = [[2, 2]];
    let problem = problem.with_grids(&grids).unwrap();
    let methods = [Method::JointGp, Method::JointUnbounded];
    let found = methods.map(|m| crate::recovery::recover(m, &problem, &Options::default()));
    let mut found = found.map(Result::unwrap);
    let fit = Fit {
        chi2_per_dof: 1.0,
        dof: 200.0,
        p: 0.5,
        entries: 200,
        left_out: 0,
        level: 1e-3,
        fits: true,
        within_integration: None,
        outlier: None,
        pooled: None,
        neighbours: None,
    };
    let contested = |found: &[Recovered; 2]| {
        let mut judged = [(); 2].map(|()| Judged {
            fit: Some(fit.clone()),
            ..Judged::default()
        });
        let [a, b] = &mut judged;
        contest(&mut [(&found[0], a), (&found[1], b)]);
        judged.map(|j| j.against.map(|rival| rival.method))
    };
    assert_eq!(contested(&found), [None, None]);
    let errors = found[0].standard_error.clone().unwrap();
    found[0].reflectance += errors * 10.0;
    let [gp, unbounded] = [Some(Method::JointGp), Some(Method::JointUnbounded)];
    assert_eq!(contested(&found), [unbounded, gp]);
    for (ahead, expected) in [
        (5.0, [unbounded, gp]),
        (20.0, [None, gp]),
        (-20.0, [unbounded, None]),
    ] {
        found[0].log_evidence = Some(-3.0);
        found[1].log_evidence = Some(-3.0 - ahead);
        assert_eq!(contested(&found), expected, "{ahead}");
    }
    // Two levels that lie close to a wider picture are told where evidence does not settle it.
    found[1].method = Method::JointTwoValued;
    found[1].reflectance = found[0].reflectance.clone();
    found[1].standard_error = found[0].standard_error.as_ref().map(|s| s / 20.0);
    // Alike neighbours that two levels make less likely are told by themselves.
    let levels = Some(Method::JointTwoValued);
    for (ahead, expected) in [
        (2.0, [None, gp]),
        (5.0, [levels, gp]),
        (20.0, [levels, None]),
    ] {
        found[1].log_evidence = found[0].log_evidence.map(|e| e + ahead);
        assert_eq!(contested(&found), expected, "{ahead}");
    }
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

/// Dark less light, of a free scale: numbers explain it, no reflectances above 0 do, and where
/// these were looked for and not found that is told beside a picture that fits.
#[test]
fn a_search_that_finds_no_possible_picture_is_told() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([2, 2])).unwrap();
    let taken = Photographs::relative(&model.phi(), 1e-3, 3);
    let nuisance = Nuisance {
        free_scale: true,
        ..Nuisance::default()
    };
    let (options, control) = (Options::default(), Control::none());
    for (sign, told) in [(1.0, false), (-1.0, true)] {
        // One number is above 0, for the scale to be that.
        let mut phi = &taken.phi * sign;
        let own = model.camera_side.column(0) * model.laser_side.row(0) * 0.2;
        phi += own;
        let noise = Noise::StandardError(&taken.stderr, Certainty::STATED);
        let methods = [Method::JointUnbounded];
        let found = recover_objects(&model, &phi, noise, nuisance, &methods, &options, control);
        let object = &found[0].outcome.as_ref().unwrap()[0];
        let warned = object.warnings.iter();
        let warned = warned.filter(|w| w.contains("NOT KNOWN") || w.contains("DOES NOT FIT"));
        assert_eq!(warned.count() > 0, told, "{sign}: {:?}", object.warnings);
    }
}
