use std::sync::atomic::AtomicBool;

use super::*;
use crate::lab::LabError;
use crate::lab::finding::Describe;
use crate::lab::study::{self, tests::divides};
use crate::model::{Kernel, ModelError};
use crate::recovery::Method;
use crate::scene::Scene;
use crate::transport::Control;

/// Two layouts × two numbers × one half-width × elements 2 and 4 × one kernel; boards 2 and 4: (2,
/// 2), (4, 2), (4, 4).
pub(super) fn small_plan() -> IndicatorPlan {
    IndicatorPlan {
        layouts: vec![Layout::Staggered, Layout::Random],
        spots: vec![8, 40],
        half_widths: vec![4.0],
        elements: vec![2, 4],
        boards: vec![2, 4],
        kernels: vec![Kernel::Physical],
        methods: vec![Method::Pinv, Method::JointUnbounded],
        noise: vec![1e-4],
        every: 4,
        seeds: 50,
        first_seed: 1,
    }
}

fn small_scene() -> Scene {
    let text = Scene::load("bench").unwrap().text;
    Scene::from_toml(
        "small",
        &text.replace("pixels = [16, 16]", "pixels = [4, 4]"),
    )
    .unwrap()
}

fn run(plan: &IndicatorPlan) -> Result<Indicator, LabError> {
    study::run(
        &IndicatorTasks::new(&small_scene(), plan.clone())?,
        Control::none(),
    )
}

#[test]
fn the_sweep_is_whole_and_does_not_depend_on_threads() {
    let pool = |n| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(n)
            .build()
            .unwrap()
    };
    let found = pool(1).install(|| run(&small_plan())).unwrap();
    assert_eq!(found.configurations.len(), 2 * 2 * 3);
    // Configurations 0, 4 and 8, two methods, one noise.
    assert_eq!(found.points.len(), 3 * 2);
    let json = |i: &Indicator| serde_json::to_string(i).unwrap();
    let other = pool(3).install(|| run(&small_plan())).unwrap();
    assert_eq!(json(&found), json(&other));
    let figures: Vec<&str> = found
        .coefficients
        .iter()
        .map(|c| c.indicator.as_str())
        .collect();
    assert_eq!(figures.len(), 7);
}

/// Least squares over all pixels states its covariance, so its mean under noise is predicted.
#[test]
fn the_mean_under_noise_is_the_predicted_one() {
    let found = run(&small_plan()).unwrap();
    let joint = &found.noisy[1];
    assert!(joint.compared > 0, "{joint:?}");
    assert!(joint.largest_p > 1e-3, "{joint:?}");
}

#[test]
fn what_cannot_be_swept_is_refused() {
    let none = IndicatorPlan {
        boards: vec![3],
        ..small_plan()
    };
    let refused = run(&none).unwrap_err().to_string();
    assert_eq!(refused, LabError::NO_OBJECT.to_string());
    let furnace = Scene::load("furnace").unwrap();
    let refused = IndicatorTasks::new(&furnace, small_plan());
    assert!(matches!(
        refused,
        Err(LabError::Model(ModelError::NothingHidden))
    ));
    let stopping = Control {
        stop: &AtomicBool::new(true),
        ..Control::none()
    };
    let tasks = IndicatorTasks::new(&small_scene(), small_plan()).unwrap();
    let stopped = study::run(&tasks, stopping);
    assert!(matches!(stopped, Err(LabError::Stopped(_))));
}

#[test]
fn it_divides() {
    let plan = IndicatorPlan {
        seeds: 4,
        ..small_plan()
    };
    let found = divides(&IndicatorTasks::new(&small_scene(), plan).unwrap());
    assert_eq!([found.configurations.len(), found.points.len()], [12, 6]);
    let finding = found.describe();
    for table in &finding.tables {
        let whole = |row: &Vec<_>| row.len() == table.columns.len();
        assert!(table.rows.iter().all(whole), "{}", table.caption);
    }
    let files = finding.tables.iter().filter(|t| t.file.is_some());
    let rows: Vec<usize> = files.map(|t| t.rows.len()).collect();
    assert_eq!(rows, [12, 6]);
    let plots = &finding.figures[0].plots;
    assert!(plots[..3].iter().all(|p| p.curves[0].points.len() == 12));
    assert_eq!(plots[3].curves.len(), 2);
    for words in [
        "Over 12 configurations",
        "predicted best by",
        "of what 4 draws give",
    ] {
        assert!(finding.sentence.contains(words), "{}", finding.sentence);
    }
}
