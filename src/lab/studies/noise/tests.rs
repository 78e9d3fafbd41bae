mod bound;
mod lost;

use super::trial::Trial;
use super::*;
use crate::geometry::DVec3;
use crate::lab::LabError;
use crate::lab::comparison::validation::Integration;
use crate::lab::ensemble::Photographs;
use crate::lab::finding::Describe;
use crate::lab::recovered::measures::Measures;
use crate::lab::study::{self, tests::divides};
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
