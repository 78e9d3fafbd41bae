use super::*;
use crate::lab::comparison::misplaced::normal;
use crate::lab::ensemble::Photographs;
use crate::lab::problem::problem;
use crate::lab::study::tests::small;
use crate::lab::uncertainty::certainty::Errors;
use crate::lab::{Noise, recover_objects};
use crate::model::{Effort, Extent, Kernel, MatrixModel, Occlusion, converged};
use crate::num::control::Control;
use crate::recovery::{Nuisance, recover};
use crate::scene::Scene;

fn known<'a>(stderr: &'a Matrix, factors: Option<&'a Factors>) -> Known<'a> {
    Known {
        stderr,
        certainty: Certainty::STATED,
        factors,
    }
}

/// One element, C = D = 1, σ = 0.5: ρ̂ is the mean 0.4 of 0.2, 0.3, 0.4, 0.7, so that χ² =
/// (0.04 + 0.01 + 0 + 0.09)/0.25 = 0.56 with 3 degrees of freedom; a fifth entry has no error.
/// `joint` held at 1 by photographs of 2 ± 0.5 has χ² = 4·4 with 4.
#[test]
fn a_fit_by_hand() {
    let one = |rows, columns| Matrix::from_element(rows, columns, 1.0);
    let (c, d) = (one(1, 1), one(1, 5));
    let stderr = Matrix::from_row_slice(1, 5, &[0.5, 0.5, 0.5, 0.5, 0.0]);
    let phi = Matrix::from_row_slice(1, 5, &[0.2, 0.3, 0.4, 0.7, 0.4]);
    let problem = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap();
    let fitted = |problem: &Problem<'_>, method| {
        let found = recover(method, problem, &Options::default()).unwrap();
        fit(problem, known(&stderr, None), &found).unwrap()
    };
    let free = fitted(&problem, Method::JointUnbounded);
    assert!((free.chi2_per_dof - 0.56 / 3.0).abs() < 1e-12, "{free:?}");
    assert_eq!((free.dof, free.entries, free.left_out), (3.0, 4, 1));
    // P(χ²₃ > x) = erfc(√(x/2)) + √(2x/π) e^(−x/2).
    let x: f64 = 0.56;
    let tail = libm::erfc((0.5 * x).sqrt())
        + (2.0 * x / std::f64::consts::PI).sqrt() * libm::exp(-0.5 * x);
    assert!((free.p - tail).abs() < 1e-9 && free.fits, "{free:?} {tail}");
    let bright = Matrix::from_element(1, 5, 2.0);
    let problem = Problem::new(&bright, &c, &d, Some(&stderr)).unwrap();
    let held = fitted(&problem, Method::Joint);
    assert!(
        (held.chi2_per_dof - 4.0).abs() < 1e-9 && held.dof == 4.0,
        "{held:?}"
    );
    assert!((problem.brightness() - 2.0).abs() < 1e-12);
}

/// P(χ²₂ > x) = e^(−x/2), so that of two degrees of freedom a level α lets m = √(−ln α − 1) pass:
/// more than twice the noise at 0.001, less at 0.05, and of a thousand little at either.
#[test]
fn few_degrees_of_freedom_refute_little() {
    for (level, blind) in [(1e-3, true), (0.05, false)] {
        let of = |dof| Fit {
            dof,
            level,
            ..crate::lab::sample::fit(1.0)
        };
        let due = (-f64::ln(level) - 1.0).sqrt();
        assert!((of(2.0).passes() - due).abs() < 1e-9);
        assert_eq!(of(2.0).is_blind(), blind);
        assert!(of(1e3).passes() < 0.5 && !of(1e3).is_blind());
        let refuted = Fit {
            fits: false,
            ..of(2.0)
        };
        assert!(!refuted.is_blind());
    }
}

/// A right model is called refuted at the rate of the level: 400 seeds at 10 %, within the
/// binomial 99.9 %. Photographs by the model on its own elements, levels away from the bounds
/// and at them; where they are at them `joint` keeps to the right side.
#[test]
fn p_values_of_a_right_model_are_uniform() {
    let mut model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([2, 2])).unwrap();
    let certainty = Certainty::STATED;
    for (levels, methods) in [
        (
            [0.3, 0.7],
            vec![Method::JointUnbounded, Method::Joint, Method::Nnls],
        ),
        ([0.0, 1.0], vec![Method::JointUnbounded, Method::Joint]),
    ] {
        model.albedo = vec![levels[0], levels[1], levels[1], levels[0]];
        let exact = model.phi();
        for method in methods {
            let alarms = (0..400).filter(|seed| {
                let shot = Photographs::relative(&exact, 0.05, *seed);
                let problem = problem(&model, &shot.phi, Some(&shot.stderr)).unwrap();
                let found = recover(method, &problem, &Options::default()).unwrap();
                fit(
                    &problem,
                    Known {
                        certainty,
                        ..known(&shot.stderr, None)
                    },
                    &found,
                )
                .unwrap()
                .p < 0.1
            });
            let alarms = alarms.count();
            assert!((21..=61).contains(&alarms), "{method} {levels:?}: {alarms}");
        }
    }
}

/// Errors that a pixel's entries share have the degrees of freedom of the pixels, and those that
/// all share count as one: 400 draws at 10 % give between 21 and 61 alarms; where one deviate
/// makes all of χ², P is that of one degree exactly.
#[test]
fn shared_errors_count_once() {
    let stderr = Matrix::from_element(40, 30, 2.0);
    let none = Matrix::zeros(40, 30);
    for errors in [Errors::WithinRows, Errors::Everywhere] {
        let alarms = (0..400).filter(|seed| {
            let deviates = crate::lab::deviate::normal_deviates(*seed, 40, 30);
            let phi = Matrix::from_fn(40, 30, |p, _| match errors {
                Errors::Everywhere => 2.0 * deviates[(0, 0)],
                _ => 2.0 * deviates[(p, 0)],
            });
            let certainty = Certainty::new(errors, None);
            let mut residuals = Residuals::default();
            residuals.add(&phi, &none, &stderr, certainty);
            residuals.fit(0.0, certainty).unwrap().p < 0.1
        });
        let alarms = alarms.count();
        assert!((21..=61).contains(&alarms), "{errors:?}: {alarms}");
    }
}

/// Standard errors of 8 replicates: z = t would be 7/5 in the mean of squares.
#[test]
fn errors_from_few_replicates_are_students() {
    let certainty = Certainty::new(Errors::Independent, Some(8));
    let (rows, columns) = (100, 60);
    let draws: Vec<Matrix> = (0..8)
        .map(|seed| crate::lab::deviate::normal_deviates(seed, rows, columns))
        .collect();
    let at = |p, l| -> Vec<f64> { draws.iter().map(|d| d[(p, l)]).collect() };
    let mean = |values: &[f64]| crate::num::summation::mean_and_stderr(values);
    let phi = Matrix::from_fn(rows, columns, |p, l| mean(&at(p, l)).0);
    let stderr = Matrix::from_fn(rows, columns, |p, l| mean(&at(p, l)).1);
    let mut residuals = Residuals::default();
    residuals.add(&phi, &Matrix::zeros(rows, columns), &stderr, certainty);
    let fit = residuals.fit(0.0, certainty).unwrap();
    // 6000 squares of variance 2: standard error 0.018.
    assert!((fit.chi2_per_dof - 1.0).abs() < 0.09, "{fit:?}");
}

/// Normal deviates x of which each pixel has (x_p + x_p+1)/√2 have a correlation of ½ between
/// pixels side by side, which is told; independent ones, of 40 draws, none.
#[test]
fn noise_that_neighbours_share_is_told() {
    let (pixels, spots) = (200, 20);
    let one = Matrix::from_element(pixels, spots, 1.0);
    let of = |phi: &Matrix| {
        let mut residuals = Residuals::default();
        // In parts, as of photographs that are read by rows.
        for first in [0, 60] {
            let count = if first == 0 { 60 } else { pixels - 60 };
            let part = |m: &Matrix| m.rows(first, count).into_owned();
            residuals.add(
                &part(phi),
                &(part(phi) * 0.0),
                &part(&one),
                Certainty::STATED,
            );
        }
        residuals.fit(0.0, Certainty::STATED).unwrap().neighbours
    };
    for seed in 0..40 {
        let own = crate::lab::deviate::normal_deviates(seed, pixels + 1, spots);
        let [a, b] = [0, 1].map(|first| own.rows(first, pixels).into_owned());
        assert_eq!(of(&a), None);
        let found = of(&((a + b) / 2f64.sqrt())).unwrap();
        assert!((found - 0.5).abs() < 0.1, "{found}");
    }
}

#[test]
fn nothing_left_to_judge_by() {
    let mut residuals = Residuals::default();
    let m = |x| Matrix::from_element(2, 2, x);
    residuals.add(&m(1.0), &m(1.0), &m(0.0), Certainty::STATED);
    assert_eq!(residuals.fit(0.0, Certainty::STATED), None);
    residuals.add(&m(1.0), &m(1.0), &m(1.0), Certainty::STATED);
    assert_eq!(residuals.fit(4.0, Certainty::STATED), None);
    assert_eq!(residuals.fit(3.0, Certainty::STATED).unwrap().left_out, 4);
}

/// Where the noise is not known a picture of two values is refuted by what nine greys leave over,
/// and a right one is not: 60 pixels, one photograph, 1 % noise, 20 seeds.
#[test]
fn two_levels_are_held_against_any_where_the_noise_is_not_known() {
    let mut state = 1u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let (c, d) = (
        Matrix::from_fn(60, 9, |_, _| next()),
        Matrix::from_element(9, 1, 1.0),
    );
    let greys = Matrix::from_fn(9, 1, |j, _| 0.1 + 0.1 * j as f64);
    let board = Matrix::from_fn(9, 1, |j, _| if j % 2 == 0 { 0.8 } else { 0.3 });
    for (picture, refuted) in [(greys, true), (board, false)] {
        for seed in 0..20 {
            let exact = &c * &picture;
            let noise = Matrix::from_fn(60, 1, |_, _| 0.04 * (next() + next() + next() - 1.5));
            let phi = &exact + noise;
            let problem = Problem::new(&phi, &c, &d, None).unwrap();
            let options = Options::default();
            let found = recover(Method::JointTwoValued, &problem, &options).unwrap();
            let judged = Judged::any(&problem, None, &[&found], &options);
            let fit = judged.of(&problem, None, (&found, &options)).fit;
            assert_eq!(fit.is_some_and(|fit| !fit.fits), refuted, "seed {seed}");
        }
    }
}

/// A plate close to the wall, at `place`, before few elements, pixels and spots.
fn plate(place: &str) -> Scene {
    let text = Scene::load("periscope").unwrap().text;
    let text = text
        .replacen("pixels = [32, 32]", "pixels = [6, 6]", 1)
        .replacen("per_side = 25", "per_side = 4", 1)
        .replacen("elements = [8, 8]", "elements = [4, 4]", 1)
        .replacen(
            "[8, 8], dark = 0.0, light = 1.0",
            "[4, 4], dark = 0.2, light = 0.8",
            1,
        )
        .replacen("[4.44, 5.9, 2.0]", place, 1);
    assert!(text.contains(place) && text.contains("dark = 0.2"));
    Scene::from_toml("near", &text).unwrap()
}

/// Its photographs without noise, by a rule that is not the model's.
fn by_another_rule(scene: &Scene) -> Matrix {
    let light = converged(scene, Kernel::Physical, Extent::FULL);
    light.unwrap().phi
}

/// Photographs past a plate near the wall, by another rule ([`converged`]), with noise that is less
/// than what elements, footprints and spots divided as usual leave: refuted as they stand, open
/// with what the last steps move; with the plate elsewhere refuted all the same.
#[test]
fn what_integrals_leave_over_is_no_evidence() {
    let near = plate("[4.0, 4.0, 0.2]");
    let clean = by_another_rule(&near);
    let stderr = clean.map(|x| 1.5e-4 * x + 5e-6 * clean.mean());
    let mut draw = normal(5);
    let phi = clean.zip_map(&stderr, |x, s| x + s * draw()[0]);
    let judged = |scene: &Scene, with: bool| {
        let (kernel, occlusion) = (Kernel::Physical, Occlusion::Considered);
        let model = MatrixModel::over_areas(scene, kernel, None, occlusion, Effort::USUAL);
        let model = model.unwrap();
        let problem = problem(&model, &phi, Some(&stderr)).unwrap();
        let found = recover(Method::Joint, &problem, &Options::default()).unwrap();
        let factors = model.factors.as_ref().filter(|_| with);
        fit(&problem, known(&stderr, factors), &found).unwrap()
    };
    let bare = judged(&near, false);
    assert!(!bare.fits && bare.within_integration.is_none(), "{bare:?}");
    let open = judged(&near, true);
    assert!(
        open.fits && open.within_integration.unwrap() < 1.2,
        "{open:?}"
    );
    assert_eq!((open.p, open.chi2_per_dof), (bare.p, bare.chi2_per_dof));
    let wrong = judged(&plate("[4.1, 4.0, 0.2]"), true);
    assert!(
        !wrong.fits && wrong.within_integration.unwrap() > 3.0,
        "{wrong:?}"
    );
}

/// With noise far below what elements are integrated to, light by another rule is open, and no
/// entry is called an outlier; light that is off by 1e-5 is refuted.
#[test]
fn noise_below_the_precision_of_the_model_leaves_it_open() {
    let scene = small("bench");
    let exact = converged(&scene, Kernel::Physical, Extent::UNOBSTRUCTED);
    let exact = exact.unwrap().phi;
    let (kernel, effort) = (Kernel::Physical, Effort::USUAL);
    let model = MatrixModel::over_areas(&scene, kernel, None, Occlusion::Ignored, effort);
    let model = model.unwrap();
    let judged = |share: f64, clean: &Matrix| {
        let stderr = Matrix::from_element(clean.nrows(), clean.ncols(), share * clean.mean());
        let mut draw = normal(7);
        let phi = clean.map(|x| x + share * clean.mean() * draw()[0]);
        let noise = Noise::StandardError(&stderr, Certainty::STATED);
        let (beside, options) = (Nuisance::default(), Options::default());
        let methods = [Method::Joint];
        let found = recover_objects(
            &model,
            &phi,
            noise,
            beside,
            &methods,
            &options,
            Control::none(),
        );
        let object = found.into_iter().next().unwrap().outcome.unwrap().remove(0);
        (object.fit.unwrap(), object.warnings)
    };
    for share in [1e-8, 1e-9, 1e-10] {
        let (own, told) = judged(share, &exact);
        assert!(own.fits && own.outlier.is_none(), "{share}: {own:?}");
        assert!(own.is_open() || share > 1e-9, "{share}: {own:?}");
        // What integrals leave over is smooth, and goes with the light.
        let noise = ["HANGS TOGETHER", "GROWS with the light"];
        let doubted = told.iter().find(|w| noise.iter().any(|n| w.contains(n)));
        assert!(doubted.is_none(), "{share}: {doubted:?}");
    }
    let off = Matrix::from_fn(exact.nrows(), exact.ncols(), |p, l| {
        exact[(p, l)] * (1.0 + 1e-5 * ((p + l) % 3) as f64)
    });
    assert!(!judged(1e-8, &off).0.fits);
}

/// The picture of photographs without noise, by another rule, is off by what the integrals are off:
/// by no more than twice what their last steps move it. With noise of any size errors of all
/// elements allow for both, and that is told where it is not much less than the noise.
#[test]
fn what_integrals_move_is_counted_in_standard_errors() {
    let near = plate("[4.0, 4.0, 0.2]");
    let clean = by_another_rule(&near);
    let (kernel, occlusion) = (Kernel::Physical, Occlusion::Considered);
    let model = MatrixModel::over_areas(&near, kernel, None, occlusion, Effort::USUAL).unwrap();
    let methods = [Method::JointUnbounded, Method::JointTwoValued];
    let of_noise = [(2e-4, true), (1e-2, false)];
    for (method, (noise, is_told)) in methods.iter().flat_map(|m| of_noise.map(|n| (*m, n))) {
        let options = Options {
            bands: (method == Method::JointUnbounded).then_some(0.95),
            ..Options::default()
        };
        // Of no law of the entries, by which errors would be taken by the light expected.
        let stderr = Matrix::from_fn(clean.nrows(), clean.ncols(), |p, l| {
            noise * (clean[(p, l)] + 0.03 * clean.mean()) * (1.0 + 0.1 * (p % 3) as f64)
        });
        let found = recover_objects(
            &model,
            &clean,
            Noise::StandardError(&stderr, Certainty::STATED),
            Nuisance::default(),
            &[method],
            &options,
            Control::none(),
        );
        let found = &found[0].outcome.as_ref().unwrap()[0];
        let problem = problem(&model, &clean, Some(&stderr)).unwrap();
        let own = recover(method, &problem, &options).unwrap();
        let known = known(&stderr, model.factors.as_ref());
        let moved = integrated::moved(&problem, known, &own, &options).unwrap();
        let alone = own.standard_error.unwrap();
        let errors = found.standard_error.as_ref().unwrap();
        let mut largest = [0.0_f64; 2];
        for (j, truth) in model.albedo.iter().enumerate() {
            let off = (found.reflectance[j] - truth).abs();
            largest = [
                largest[0].max(off / alone[j]),
                largest[1].max(moved[j] / alone[j]),
            ];
            let both = (alone[j].powi(2) + moved[j].powi(2)).sqrt();
            assert!((errors[j] / both - 1.0).abs() < 1e-12 && off < 2.0 * errors[j]);
            if method == Method::JointUnbounded {
                let bands = found.bands.as_ref().unwrap();
                let half = 0.5 * (bands.upper[j] - bands.lower[j]);
                assert!((half / (1.959_963_985 * both) - 1.0).abs() < 1e-6);
                let own = found.covariance.as_ref().unwrap()[(j, j)];
                assert!((own.sqrt() / both - 1.0).abs() < 1e-9);
            }
        }
        let [off, moved] = largest;
        // Of two levels what the steps move may cancel where of 16 elements not all does.
        let most = if method == Method::JointTwoValued {
            10.0
        } else {
            3.0
        };
        assert!(
            moved < most * off && off < 2.0 * moved,
            "{method} {noise}: {moved} {off}"
        );
        let told = found.warnings.iter();
        let told = told.filter(|w| w.contains("the integrals of the model may be off by"));
        assert_eq!(told.count() > 0, is_told, "{noise}: {:?}", found.warnings);
    }
}

/// The best of all numbers is the best between 0 and 1 where it lies there, and leaves less over
/// where it does not: 60 pixels, one photograph, nine greys of which the last is 0.97 or 1.2.
#[test]
fn the_best_is_looked_for_where_no_picture_shows_that_one_exists() {
    let mut draw = normal(7);
    let c = Matrix::from_fn(60, 9, |_, _| draw()[0].abs());
    let d = Matrix::from_element(9, 1, 1.0);
    let stderr = Matrix::from_element(60, 1, 1e-3);
    for (last, inside) in [(0.97, true), (1.2, false)] {
        let greys = Matrix::from_fn(
            9,
            1,
            |j, _| if j == 8 { last } else { 0.1 + 0.1 * j as f64 },
        );
        let phi = &c * greys + Matrix::from_fn(60, 1, |_, _| 1e-3 * draw()[0]);
        let problem = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap();
        let options = Options::default();
        let noise = Some(known(&stderr, None));
        let best = |method| {
            let found = recover(method, &problem, &options).unwrap();
            let best = Judged::any(&problem, noise, &[&found], &options).best;
            (found, best.unwrap())
        };
        let (any, alone) = best(Method::JointUnbounded);
        let (_, bounded) = best(Method::Joint);
        assert_eq!(
            any.reflectance.iter().all(|x| (0.0..=1.0).contains(x)),
            inside
        );
        let [alone, bounded] = [&alone, &bounded].map(|best| best.possible.clone());
        assert_eq!([alone.fits, bounded.fits], [inside; 2]);
        let off = (alone.chi2_per_dof * alone.dof) / (bounded.chi2_per_dof * bounded.dof) - 1.0;
        assert!(off.abs() < 1e-3, "{alone:?} {bounded:?}");
    }
}
