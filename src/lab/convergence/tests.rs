use super::*;
use crate::lab::study::tests::{divides, refuses, small};

#[test]
fn it_divides() {
    let tasks = ConvergenceTasks::new(&small("bench"), &[32, 64], 7);
    assert_eq!(divides(&tasks).curves.len(), 6);
    // The last task is of all spots, the first of some.
    let context = tasks.context(Control::none()).unwrap();
    let last = tasks.task(&context, tasks.tasks() - 1, Control::none());
    refuses(&tasks, 0, &last.unwrap());
}

#[test]
fn slopes_are_told_by_sampler() {
    let curve = |sampler: &str, slope, error| Curve {
        estimator: "shared".to_owned(),
        sampler: sampler.to_owned(),
        steps: vec![Step {
            samples: 64,
            error,
            stated: error,
        }],
        slope,
    };
    let found = Convergence {
        scene: "bench".to_owned(),
        scene_hash: String::new(),
        seed: 1,
        curves: vec![
            curve("pcg", -0.51, 0.1),
            curve("pcg", -0.49, 0.2),
            curve("sobol", -0.9, 0.01),
        ],
    };
    let found = found.describe();
    for words in [
        "that of pcg by a slope of −0.510 to −0.490 and of sobol",
        "0.010, is that of shared, sobol with 64 samples",
    ] {
        assert!(found.sentence.contains(words), "{}", found.sentence);
    }
    assert_eq!(found.tables[1].rows[2][3], Cell::Number(Some(0.01)));
    let drawn = &found.figures[0].plots[0].curves[2];
    assert_eq!(drawn.name, "shared, sobol: slope −0.900");
    assert_eq!(drawn.points, [[64.0, 0.01]]);
}

#[test]
fn a_power_law_has_its_exponent() {
    let step = |n: f64| Step {
        samples: n as u64,
        error: 3.0 / (n * n.sqrt()),
        stated: 0.0,
    };
    let found = slope(&[step(16.0), step(64.0), step(1024.0)]).unwrap();
    assert!((found + 1.5).abs() < 1e-12, "{found}");
    assert_eq!(slope(&[step(16.0), step(16.0)]), None);
}
