use super::*;
use crate::lab::finding::{Cell, Describe};
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
        slope_bound: (error > 0.05).then_some(0.25),
        slope_scatter: Some(0.125),
        bend: (error > 0.15).then_some(Bend {
            samples: [64, 128],
            by: 9.7,
        }),
    };
    let found = Convergence {
        scene: "bench".to_owned(),
        scene_hash: String::new(),
        seed: 1,
        quadrature_bound: 0.05,
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
        "have no one slope: stated errors of shared, pcg by 9.7 from 64 to 128 samples.",
        "known to 0.050 only: errors of shared, sobol fall below that",
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

/// Errors that a reference may move by ± β move the slope by no more than its bound, and by that
/// much where all move the worst way.
#[test]
fn a_slope_is_known_as_well_as_its_reference() {
    let steps = |off: [f64; 2]| {
        [16.0, 1024.0].map(|n: f64| Step {
            samples: n as u64,
            error: 8.0 / n + off[usize::from(n > 100.0)],
            stated: 0.0,
        })
    };
    // ln 64 apart, errors 1/2 and 1/128: the worst is 0.004 less of both.
    let bound = 0.004;
    let worst = (-(1.0f64 - bound / 0.5).ln() - (1.0 - 128.0 * bound).ln()) / 64f64.ln();
    let own = slope(&steps([0.0; 2])).unwrap();
    let said = slope_bound(&steps([0.0; 2]), bound).unwrap();
    assert!((said - worst).abs() < 1e-12 * worst, "{said} {worst}");
    for off in [[bound, -bound], [-bound, bound], [-bound; 2], [bound; 2]] {
        let moved = slope(&steps(off)).unwrap();
        assert!(
            (moved - own).abs() <= said,
            "{off:?}: {own} {moved} ± {said}"
        );
    }
    assert_eq!(slope_bound(&steps([0.0; 2]), 0.01), None);
}

/// Errors 1, ½ (1 + δ), ¼ at 1, 4, 16: the slope is −½ and its error that of three points about a
/// line, by hand: r = (−a, 2a, −a)/3 with a = ln(1 + δ), Σ r² = ⅔ a², Σ (x − x̄)² = 2 ln²4. A step
/// of ten is no line; a scatter of a tenth is one.
#[test]
fn a_slope_says_whether_there_is_a_line() {
    let steps = |errors: &[f64]| -> Vec<Step> {
        let each = errors.iter().enumerate();
        each.map(|(k, e)| Step {
            samples: 1 << (2 * k),
            error: *e,
            stated: *e,
        })
        .collect()
    };
    let three = steps(&[1.0, 0.55, 0.25]);
    let a = 1.1f64.ln();
    let want = (2.0 / 3.0 * a * a / (2.0 * 4f64.ln().powi(2))).sqrt();
    assert!((slope(&three).unwrap() + 0.5).abs() < 1e-14);
    assert!((slope_scatter(&three).unwrap() / want - 1.0).abs() < 1e-12);
    assert_eq!(slope_scatter(&steps(&[1.0, 0.5])), None);
    assert_eq!(bend(&steps(&[1.0, 0.55, 0.25, 0.12, 0.065])), None);
    let found = bend(&steps(&[1.0, 0.5, 0.25, 0.025, 0.0125])).unwrap();
    assert_eq!(found.samples, [16, 64]);
    assert!((found.by - 10.0).abs() < 1e-12);
}
