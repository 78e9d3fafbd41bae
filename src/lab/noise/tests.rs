use super::trial::Trial;
use super::*;
use crate::geometry::DVec3;
use crate::lab::LabError;
use crate::lab::ensemble::Photographs;
use crate::lab::finding::Describe;
use crate::lab::measures::Measures;
use crate::lab::study::{self, tests::divides};
use crate::lab::validation::Integration;
use crate::matrix::Matrix;
use crate::model::Kernel;
use crate::num::quadrature::Rule;
use crate::recovery::Method;
use crate::scene::{Scene, SensorModel, Spread};
use crate::transport::Control;

fn small() -> (Scene, NoisePlan) {
    let text = Scene::load("bench").unwrap().text;
    let text = text.replace("pixels = [16, 16]", "pixels = [4, 4]");
    let scene = Scene::from_toml("small", &text.replace("per_side = 30", "per_side = 6")).unwrap();
    let plan = NoisePlan {
        boards: vec![2, 4],
        elements: vec![2, 4],
        methods: vec![Method::Pinv, Method::Tikhonov, Method::Joint],
        kernel: Kernel::Physical,
        integration: Integration::Centres,
        axis: NoiseAxis::Relative,
        levels: vec![1e-6, 1e-3, 1.0],
        seeds: 5,
        first_seed: 3,
    };
    (scene, plan)
}

fn run(scene: &Scene, plan: &NoisePlan) -> NoiseStudy {
    let tasks = NoiseTasks::new(scene, plan.clone(), Vec::new());
    study::run(&tasks, Control::none()).unwrap()
}

/// Three objects, boards of 4 checks having no place on 2 elements, with three levels, five draws
/// and three methods.
fn trials_do_not_depend_on_threads(plan: &NoisePlan) {
    let (scene, _) = small();
    let found = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build();
        pool.unwrap().install(|| run(&scene, plan))
    };
    let [one, three] = [1, 3].map(found);
    assert_eq!(one.ledger.lines().count(), 2 + 3 * 3 * 5 * 3);
    assert_eq!(one.ledger, three.ledger);
    let json = |study: &NoiseStudy| serde_json::to_string(study).unwrap();
    assert_eq!(json(&one), json(&three));
}

fn ccd() -> NamedSensor {
    NamedSensor::builtin(SensorModel::Ccd)
}

#[test]
fn on_every_axis_going_on_gives_what_running_through_gives_on_any_threads() {
    let (_, relative) = small();
    trials_do_not_depend_on_threads(&relative);
    for (axis, levels) in [
        (NoiseAxis::Photons, vec![1e12, 1e6, 1e3]),
        (NoiseAxis::Exposure(ccd()), vec![1e-3, 1e-4, 1e-5]),
        (
            NoiseAxis::Glare(ccd(), Spread::Falloff(1.0)),
            vec![1e-3, 0.1, 10.0],
        ),
        (NoiseAxis::Bits, vec![24.0, 16.0, 8.0]),
        (NoiseAxis::Scale, vec![1e-3, 0.03, 0.3]),
    ] {
        let plan = NoisePlan {
            axis,
            levels,
            ..relative.clone()
        };
        trials_do_not_depend_on_threads(&plan);
    }
}

/// Default levels are ones that the axis allows, from quiet to loud, and none of them saturates a
/// pixel.
#[test]
fn default_levels_can_be_studied() {
    let (scene, relative) = small();
    for axis in [
        NoiseAxis::Relative,
        NoiseAxis::Photons,
        NoiseAxis::Exposure(ccd()),
        NoiseAxis::Glare(ccd(), Spread::Uniform),
        NoiseAxis::Bits,
        NoiseAxis::Scale,
    ] {
        let mut plan = NoisePlan {
            axis,
            ..relative.clone()
        };
        plan.levels = plan.default_levels(&scene).unwrap();
        let axis = &plan.axis;
        assert!(plan.levels.len() > 5 && plan.levels.iter().all(|l| axis.refuses(*l).is_none()));
        assert!(
            plan.levels
                .windows(2)
                .all(|w| axis.quiet_first(w[0], w[1]).is_lt())
        );
        plan.refuse_saturation(&scene).unwrap();
        plan.levels[0] *= 100.0;
        let refused = plan.refuse_saturation(&scene);
        let exposure = matches!(plan.axis, NoiseAxis::Exposure(_));
        assert_eq!(matches!(refused, Err(LabError::Saturated { .. })), exposure);
    }
}

/// No unbiased recovery is nearer to the truth than the bound: over 200 draws, by the spread of
/// what was found. And the joint one, whose weights are those of the noise here but for what is not
/// separable, comes within a tenth of it.
#[test]
fn unbiased_recoveries_keep_the_bound_of_cramer_and_rao() {
    let (scene, plan) = small();
    for (axis, levels) in [
        (NoiseAxis::Relative, vec![1e-6]),
        (NoiseAxis::Photons, vec![1e12]),
        (NoiseAxis::Scale, vec![0.03]),
    ] {
        let plan = NoisePlan {
            boards: vec![2],
            elements: vec![2],
            methods: vec![Method::Pinv, Method::JointUnbounded],
            axis,
            levels,
            seeds: 200,
            ..plan.clone()
        };
        let study = run(&scene, &plan);
        let ratios = study.curves.into_iter().map(|c| {
            let p = &c.points[0];
            // Five standard errors of a root mean square; errors of four elements spread at most as
            // those of one.
            (p.rmse_over_bound.unwrap(), 5.0 / (2.0 * 200f64).sqrt())
        });
        let ratios: Vec<(f64, f64)> = ratios.collect();
        assert!(ratios.iter().all(|(r, s)| *r > 1.0 - s), "{ratios:?}");
        assert!(ratios[1].0 < 1.1 + ratios[1].1, "{ratios:?}");
    }
}

/// √(tr (Wᵀ W)⁻¹/r) of W = ∂Φ/∂ρ2 over σ = 10⁻³ Φ, Φ summed by Gauss and Legendre over 2 × 2
/// elements (8 × 8 nodes each) and footprints (3 × 3), cosines and distances as the equation of the
/// crate has them. At the centres the bound is another by a tenth and more.
#[test]
fn the_bound_is_that_of_integrated_light() {
    let (scene, plan) = small();
    let own = |integration| {
        let plan = NoisePlan {
            boards: vec![2],
            elements: vec![2],
            methods: vec![Method::JointUnbounded],
            levels: vec![1e-3],
            seeds: 1,
            integration,
            ..plan.clone()
        };
        let study = run(&scene, &plan);
        assert_eq!(study.curves[0].integration, integration.name());
        study.curves[0].points[0].cramer_rao.unwrap()
    };
    let (corner, u, v) = {
        let (_, hidden) = scene.hidden().next().unwrap();
        let at = |a: f64, b: f64| hidden.shape.at([a, b]).position;
        (
            at(0.0, 0.0),
            at(1.0, 0.0) - at(0.0, 0.0),
            at(0.0, 1.0) - at(0.0, 0.0),
        )
    };
    let normal = u.cross(v).normalize();
    // cos·cos/R² between a point of S2 and one of the wall.
    let coupling = |on: DVec3, wall: DVec3| {
        let d = wall - on;
        let r2 = d.length_squared();
        (d.dot(normal) * d.z / (r2 * r2)).abs()
    };
    let camera = &scene.camera;
    let nodes = |n: usize| Rule::gauss_legendre(n).on(0.0, 1.0).collect::<Vec<_>>();
    let (fine, coarse) = (nodes(8), nodes(3));
    let spots: Vec<DVec3> = scene
        .laser
        .spots
        .iter()
        .map(|s| s.target.position)
        .collect();
    let mut slopes = Matrix::zeros(camera.pixels() * spots.len(), 4);
    for element in 0..4usize {
        for ((a, wa), (b, wb)) in fine.iter().flat_map(|a| fine.iter().map(move |b| (a, b))) {
            let [s, t] = [(element % 2) as f64 + a, (element / 2) as f64 + b].map(|x| 0.5 * x);
            let on = corner + u * s + v * t;
            for p in 0..camera.pixels() {
                let footprint = camera.footprint(p);
                let mut seen = 0.0;
                for ((c, wc), (d, wd)) in coarse
                    .iter()
                    .flat_map(|c| coarse.iter().map(move |d| (c, d)))
                {
                    let wall = footprint.at([*c, *d]);
                    let to = camera.position - wall;
                    let r2 = to.length_squared();
                    seen += wc * wd * to.z * to.z / (r2 * r2) * coupling(on, wall);
                }
                for (l, spot) in spots.iter().enumerate() {
                    slopes[(p + l * camera.pixels(), element)] +=
                        wa * wb * seen * coupling(on, *spot);
                }
            }
        }
    }
    // The board: white where column and row of the element differ, or where they do not.
    let bound = |white: [usize; 2]| {
        let phi = slopes.column(white[0]) + slopes.column(white[1]);
        let weighed = Matrix::from_fn(slopes.nrows(), 4, |k, j| slopes[(k, j)] / (1e-3 * phi[k]));
        let inverse = (weighed.transpose() * weighed).try_inverse().unwrap();
        (inverse.trace() / 4.0).sqrt()
    };
    let due = [bound([0, 3]), bound([1, 2])];
    let off = |found: f64| {
        due.map(|due| (found / due - 1.0).abs())
            .into_iter()
            .fold(1.0, f64::min)
    };
    assert!(off(own(Integration::Quadrature)) < 0.01, "{due:?}");
    assert!(off(own(Integration::Centres)) > 0.05, "{due:?}");
}

/// White that photographs of 5 % more light would make lighter than white: a bounded recovery that
/// is told of the scale's error takes it there, one that is not puts the light elsewhere.
#[test]
fn a_recovery_that_is_told_of_the_scale_is_nearer() {
    let (scene, plan) = small();
    let model = plan.model(&scene, (Picture::Board(2), 4)).unwrap();
    let stage = stage::Stage::new(&NoiseAxis::Scale, &scene, model.phi()).unwrap();
    let (mut told, mut untold) = (0.0, 0.0);
    for seed in 0..10 {
        let photographs = stage.photograph(0.05, seed).unwrap();
        let error = |photographs: &Photographs| {
            let found = trial::measure(&model, photographs, Method::Joint).unwrap();
            found.rmse.unwrap().powi(2)
        };
        told += error(&photographs);
        let Photographs { phi, stderr, .. } = photographs;
        untold += error(&Photographs::told(phi, stderr));
    }
    assert!(told < untold, "{told} {untold}");
}

/// The unbounded pseudo-inverse is linear and unbiased here (2 × 2 elements have full rank), so its
/// error grows in proportion to the noise, draw by draw.
#[test]
fn the_error_of_a_linear_method_is_proportional_to_the_noise() {
    let (scene, plan) = small();
    let plan = NoisePlan {
        boards: vec![2],
        elements: vec![2],
        methods: vec![Method::Pinv],
        levels: vec![1e-5, 1e-3],
        ..plan
    };
    let study = run(&scene, &plan);
    let points = &study.curves[0].points;
    let [quiet, loud] = [0, 1].map(|i: usize| points[i].rmse.unwrap());
    assert!(
        (loud.mean / quiet.mean / 100.0 - 1.0).abs() < 1e-6,
        "{quiet:?} {loud:?}"
    );
    assert!(quiet.mean > 0.0 && quiet.draws == 5);
}

/// A board that has no place on any of the elements is named, and the others are studied.
#[test]
fn a_board_without_a_place_is_named() {
    let (scene, plan) = small();
    let plan = NoisePlan {
        boards: vec![2, 3],
        levels: vec![1e-3],
        seeds: 1,
        ..plan
    };
    let found = run(&scene, &plan);
    assert_eq!(found.unplaced, [3]);
    let told = |note: &String| note.contains("board of 3 × 3 checks was not studied");
    assert_eq!(found.describe().notes.iter().filter(|n| told(n)).count(), 1);
    assert!(found.ledger.lines().count() > 2);
}

#[test]
fn a_plan_without_object_is_refused() {
    let (scene, plan) = small();
    let plan = NoisePlan {
        boards: vec![3],
        ..plan
    };
    let refused = study::run(&NoiseTasks::new(&scene, plan, Vec::new()), Control::none());
    let refused = refused.unwrap_err().to_string();
    assert_eq!(refused, LabError::NO_OBJECT.to_string());
}

/// Least squares without bounds is unbiased: its mean raw MTF does not fall, but the denominator's
/// spread grows until no mean is spoken of.
#[test]
fn a_mean_of_wild_ratios_is_not_spoken_of() {
    let (scene, plan) = small();
    let plan = NoisePlan {
        boards: vec![4],
        elements: vec![4],
        methods: vec![Method::JointUnbounded],
        levels: vec![1e-7, 0.1, 1.0],
        seeds: 20,
        ..plan
    };
    let study = run(&scene, &plan);
    let curve = &study.curves[0];
    let [quiet, loud] = [0, 2].map(|i: usize| curve.points[i].denominator_spread.unwrap());
    assert!(quiet < 1e-3 && loud > 0.1, "{quiet} {loud}");
    assert_eq!(curve.lost_raw[1], Lost::Unknown, "{curve:?}");
    let lost = curve.lost_normalized[1];
    assert_eq!(lost, Lost::Between([1e-7, 0.1]), "{curve:?}");
}

/// Draws that stray widely around a true mean of 1, at a well determined denominator: that their
/// mean happens to lie at 0.2 is no loss.
#[test]
fn a_mean_that_strays_has_not_fallen() {
    let (_, plan) = small();
    let plan = NoisePlan {
        boards: vec![2],
        elements: vec![4],
        methods: vec![Method::JointUnbounded],
        levels: vec![0.1, 1.0],
        seeds: 4,
        ..plan
    };
    let trial = |level, seed, mtf| Trial {
        picture: Picture::Board(2),
        elements: 4,
        method: Method::JointUnbounded,
        level,
        seed,
        outcome: Ok(Measures {
            mtf_raw: Some(mtf),
            light_plus_dark: Some(1.0),
            mtf_normalized: Some(mtf / 10.0),
            correlation: None,
            rmse: None,
        }),
    };
    let of = |quiet: f64, loud: [f64; 4], truth: &[f64]| {
        let quiet = (0..4).map(|k| trial(0.1, plan.first_seed + k, quiet));
        let loud = (0..4).map(|k| trial(1.0, plan.first_seed + k, loud[k as usize]));
        NoiseCurve::of(
            &plan,
            (Picture::Board(2), 4),
            Method::JointUnbounded,
            (&quiet.chain(loud).collect::<Vec<_>>(), &[None, None]),
            truth,
        )
    };
    let curve = |loud| of(1.0, loud, &[0.0, 1.0]);
    assert_eq!(curve([9.0, -9.0, 5.0, -4.2]).lost_raw, [Lost::Unknown; 2]);
    let fallen = curve([0.25, 0.15, 0.2, 0.2]);
    // A picture of albedo 0.25 and 0.75 has a raw MTF of ½: relative to that a loss of 0.01 grows
    // to 0.81, and is 0.1 at ln 10/ln 81 of the way.
    let grey = of(0.495, [0.1, 0.09, 0.095, 0.095], &[0.25, 0.75]);
    assert_eq!(grey.mtf_of_truth, [0.5, 1.0]);
    let Lost::At(level) = grey.lost_raw[0] else {
        panic!("{grey:?}")
    };
    assert!(
        (libm::log10(level / 0.1) - libm::log(10.0) / libm::log(81.0)).abs() < 1e-12,
        "{level}"
    );
    // A mean of 1 counts as one that lost a hundredth of 0.8: a loss of 0.1 is 12.5 times that, a
    // power of 2 over the decade.
    let Lost::At(level) = fallen.lost_raw[0] else {
        panic!("{fallen:?}")
    };
    assert!((level / 0.1 / 12.5f64.sqrt() - 1.0).abs() < 1e-12);
    assert_eq!(fallen.lost_normalized, [Lost::Before; 2]);
    // The mean 0.2 is known to √(0.005/3/4): 3.182 of that, Student's t of 3 degrees of freedom,
    // lower and higher, by hand.
    let off = 3.182_446_305 * (0.005f64 / 12.0).sqrt();
    let [from, to] = fallen.held_within.unwrap().map(Option::unwrap);
    for (held, mean) in [(from, 0.2 - off), (to, 0.2 + off)] {
        let want = 0.1 * (10.0 / (1.0 - mean)).sqrt();
        assert!((held.level / want - 1.0).abs() < 1e-4, "{held:?} {want}");
    }
    // Where the mean strays nothing is known, and of the level before it falls no lower.
    let strays = curve([9.0, -9.0, 5.0, -4.2]).held_within.unwrap();
    assert_eq!(strays.map(|held| held.unwrap().level), [0.1; 2]);
}

/// What one draw is like no method is said to hold or to lose.
#[test]
fn of_one_draw_nothing_is_said_to_be_held() {
    let (scene, plan) = small();
    let plan = NoisePlan {
        boards: vec![2],
        elements: vec![4],
        methods: vec![Method::Pinv],
        seeds: 1,
        ..plan
    };
    let sentence = run(&scene, &plan).describe().sentence;
    let said =
        "no method is known to reach it, as one draw tells no mean (the published pinv: unknown)";
    assert!(sentence.contains(said), "{sentence}");
}

/// With photons the modulation rises: a loss of 0.4 at 1e4 is one of 0.025 at 1e5, so from their
/// geometric mean on it is 0.1 or less, whatever it is again with very few.
#[test]
fn more_photons_are_less_noise() {
    let (_, plan) = small();
    let mut plan = NoisePlan {
        axis: NoiseAxis::Photons,
        methods: vec![Method::Joint],
        levels: vec![1e5, 1.0, 1e4, 1e3, 1e8],
        seeds: 2,
        ..plan
    };
    plan.levels.sort_by(|a, b| plan.axis.quiet_first(*a, *b));
    let mtf = |level: f64| match level {
        1e5 => 0.975,
        1e4 => 0.6,
        1e3 => 0.375,
        _ => 1.0,
    };
    let draws = plan
        .levels
        .iter()
        .flat_map(|level| [(level, 0), (level, 1)]);
    let trials = draws.map(|(level, draw)| Trial {
        picture: Picture::Board(2),
        elements: 4,
        method: Method::Joint,
        level: *level,
        seed: plan.first_seed + draw,
        outcome: Ok(Measures {
            mtf_raw: Some(mtf(*level)),
            light_plus_dark: Some(1.0),
            mtf_normalized: Some(0.0),
            correlation: None,
            rmse: Some(1.0),
        }),
    });
    let trials: Vec<Trial> = trials.collect();
    let found = NoiseCurve::of(
        &plan,
        (Picture::Board(2), 4),
        Method::Joint,
        (&trials, &[None; 5]),
        &[0.0, 1.0],
    );
    let [Lost::At(high), Lost::At(low)] = found.lost_raw else {
        panic!("{found:?}")
    };
    // A loss of 0.5 lies half way from 0.4 at 1e4 to 0.625 at 1e3.
    let half = 10f64.sqrt();
    assert!((high / (1e4 * half) - 1.0).abs() < 1e-12);
    assert!((low / (1e3 * half) - 1.0).abs() < 1e-12);
    assert_eq!(found.held.unwrap().level, high);
    assert_eq!(found.lost_normalized, [Lost::Before; 2]);
}

/// Draws at two levels, a rest of a task among them, and a render.
#[test]
fn it_divides() {
    let plan = NoisePlan {
        boards: vec![2],
        elements: vec![2, 4],
        methods: vec![Method::Pinv, Method::Joint],
        kernel: Kernel::Physical,
        integration: Integration::Centres,
        axis: NoiseAxis::Relative,
        levels: vec![1e-6, 1e-2],
        seeds: 3,
        first_seed: 9,
    };
    let found = divides(&NoiseTasks::new(&small().0, plan, vec![16]));
    assert_eq!([found.curves.len(), found.render_noise.len()], [4, 2]);
}

/// Every table has a cell for each column and every curve of the study its line in each figure; the
/// sentence names the best method of each object.
#[test]
fn the_finding_holds_the_whole_study() {
    let (scene, plan) = small();
    let tasks = NoiseTasks::new(&scene, plan, vec![16]);
    let found = study::run(&tasks, Control::none()).unwrap();
    let finding = found.describe();
    for table in &finding.tables {
        let whole = |row: &Vec<_>| row.len() == table.columns.len();
        assert!(table.rows.iter().all(whole), "{}", table.caption);
    }
    let rows: Vec<usize> = finding.tables.iter().map(|t| t.rows.len()).collect();
    // Curves, objects, renders by two estimators, levels of the curves.
    assert_eq!(rows, [9, 3, 2, 9 * 3]);
    assert_eq!(finding.figures.len(), 4);
    for figure in &finding.figures {
        let lines: usize = figure.plots.iter().map(|p| p.curves.len()).sum();
        // A bound for each object beside the root mean square error; two renders in each plot.
        let bounds = if figure.file == "noise-rmse.svg" {
            3
        } else {
            0
        };
        assert_eq!(lines, 9 + 3 * 2 + bounds, "{}", figure.file);
    }
    // The scene's own comes first: the bench is a board of 2 × 2 checks on 8 × 8 elements, or else
    // on the most.
    let own = found.own.unwrap();
    assert_eq!(own.0, Picture::Board(2));
    let first = format!(
        ": the scene's own picture, 2 × 2 checks on {0} × {0}",
        own.1
    );
    assert!(finding.sentence.contains(&first), "{}", finding.sentence);
    assert!(finding.notes.iter().all(|note| !note.contains("--boards")));
    let left_out = NoiseStudy {
        own: None,
        ..found.clone()
    };
    assert!(left_out.describe().notes[0].contains("--boards"));
    for best in &found.best {
        let object = format!("{0} × {0} checks on {1} × {1}", best.picture, best.elements);
        assert!(finding.sentence.contains(&object), "{}", finding.sentence);
        let by = best
            .method
            .as_ref()
            .map_or("no method".to_owned(), |m| format!("by {m}"));
        assert!(finding.sentence.contains(&by), "{}", finding.sentence);
    }
    assert_eq!(finding.files, [("noise.csv".to_owned(), found.ledger)]);
}

/// A scene whose hidden surface is painted otherwise than a board is studied with its picture: its
/// truth is the picture, beside the boards.
#[test]
fn the_scenes_own_picture_is_studied_beside_the_boards() {
    let (scene, plan) = small();
    let text = scene.text.replace(
        "checkerboard = [2, 2], dark = 0.0, light = 1.0",
        "cells = [[0.1, 0.9, 0.4], [0.3, 0.2, 0.8]]",
    );
    let painted = Scene::from_toml("painted", &text).unwrap();
    let plan = NoisePlan {
        boards: vec![2],
        elements: vec![2, 6],
        methods: vec![Method::Joint],
        levels: vec![1e-9],
        seeds: 2,
        ..plan
    };
    let found = run(&painted, &plan);
    let objects: Vec<_> = found
        .curves
        .iter()
        .map(|c| (c.picture, c.elements))
        .collect();
    let board = Picture::Board(2);
    let own = Picture::Own;
    assert_eq!(objects, [(own, 2), (own, 6), (board, 2), (board, 6)]);
    // Cells of 2 × 3 elements each: the modulation of a grey picture, whose recovery is nearly
    // exact at this noise, is far from a board's.
    let (seen, full) = (&found.curves[0].points[0], &found.curves[2].points[0]);
    assert!(seen.rmse.unwrap().mean < 0.01 && seen.correlation.unwrap().mean > 0.99);
    assert!(seen.mtf_raw.unwrap().mean < 0.9 && full.mtf_raw.unwrap().mean > 0.99);
    assert!(found.ledger.contains("\nown,2,joint,"), "{}", found.ledger);
    assert!(
        found
            .describe()
            .sentence
            .contains("the scene's own picture on 2 × 2")
    );
    let json = serde_json::to_value(&found).unwrap();
    assert_eq!(json["curves"][0]["board"], "own");
    assert_eq!(json["curves"][2]["board"], 2);
    // The bench's own picture is a board: nothing is added.
    assert_eq!(run(&scene, &plan).curves.len(), 2);
    // An even picture has no modulation, and no method fails at it.
    let text = scene
        .text
        .replace("{ checkerboard = [2, 2], dark = 0.0, light = 1.0 }", "0.4");
    let even = Scene::from_toml("even", &text).unwrap();
    let sentence = run(&even, &plan).describe().sentence;
    let told = "the scene's own picture on 6 × 6 elements: it has no contrast, and so no MTF";
    assert!(sentence.contains(told), "{sentence}");
}
