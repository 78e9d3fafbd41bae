use super::*;
use crate::transport::render;

fn scene(name: &str) -> Scene {
    let mut scene = Scene::load(name).unwrap();
    (scene.camera.columns, scene.camera.rows) = (8, 8);
    scene.laser.spots.truncate(12);
    scene
}

/// Hidden surfaces alone reflect: independent paths, whether or not something black stands in the
/// way. A plank reflects too: points that serve all, as many as make the error of a render with
/// other random numbers 1 %, found from the spread over ten of them.
#[test]
fn what_is_chosen_reaches_its_aim() {
    let aim = |scene: &Scene| aimed(scene, Sampling::Sobol, 1, Control::none()).unwrap();
    for name in ["bench", "periscope", "satin", "screen"] {
        let (plan, foretold) = aim(&scene(name));
        let usual = (Estimator::Independent, SAMPLES, None);
        assert_eq!((plan.estimator, plan.budget.samples(), foretold), usual);
    }
    let shelf = scene("shelf");
    let (plan, foretold) = aim(&shelf);
    assert_eq!(plan.estimator, Estimator::Factored);
    assert!(plan.budget.samples() > SAMPLES && foretold.unwrap() <= AIM);
    let traced = |seed| {
        let plan = Plan { seed, ..plan };
        let spots = 0..shelf.laser.spots.len();
        render(&shelf, &plan, spots, Control::none()).unwrap().flux
    };
    let flux: Vec<_> = (1..=10).map(traced).collect();
    let mean = flux.iter().sum::<crate::matrix::Matrix>() / 10.0;
    let squares = flux.iter().map(|f| (f - &mean).norm_squared()).sum::<f64>() / 9.0;
    let error = squares.sqrt() / mean.norm();
    assert!(error < AIM, "{error}");
}

/// Without light there is no relative error to aim at: the usual plan, whose render says that there
/// is none.
#[test]
fn darkness_has_the_usual_plan() {
    let mut dark = scene("shelf");
    dark.laser.power = 0.0;
    let (plan, foretold) = aimed(&dark, Sampling::Sobol, 1, Control::none()).unwrap();
    assert_eq!((plan.estimator, foretold), (Estimator::Independent, None));
}

/// Some minutes: fewer points for more pixels, never below 512.
#[test]
fn the_most_is_a_power_of_two() {
    let of = |side: usize| {
        let mut scene = scene("shelf");
        (scene.camera.columns, scene.camera.rows) = (side, side);
        [Estimator::Factored, Estimator::Shared].map(|e| most(&scene, e))
    };
    // 2²⁶/(64² + 12) = 16336, 2²⁸/(64²·12) = 5461.
    assert_eq!(of(64), [8192, 4096]);
    assert_eq!(of(1024), [512, 512]);
}
