//! The noise study against what the published simulation reports of its own method.

use phicam::lab::{Integration, NoiseAxis, NoisePlan, NoiseTasks, Spread, run};
use phicam::model::Kernel;
use phicam::recovery::Method;
use phicam::scene::Scene;
use phicam::transport::Control;

/// Normalized MTF of `pinv` on the published kernel: the published spots (120, staggered,
/// half-width 6), 2 × 2 checks, 16 × 16 pixels; mean over 40 draws.
fn published(elements: usize, level: f64) -> Spread {
    let scene = Scene::load("thesis").unwrap();
    let plan = NoisePlan {
        boards: vec![2],
        elements: vec![elements],
        methods: vec![Method::Pinv],
        kernel: Kernel::Published,
        integration: Integration::Centres,
        axis: NoiseAxis::Relative,
        levels: vec![level],
        seeds: 40,
        first_seed: 1,
    };
    let study = run(&NoiseTasks::new(&scene, plan, Vec::new()), Control::none());
    let found = study.unwrap().curves[0].points[0].mtf_normalized.unwrap();
    println!("{elements} elements, {level:e}: {found:?}");
    found
}

/// Published: 0.99 at 10 % with 2 × 2 elements; 0.46 at 0.1 % and at least 0.95 at 1e-3 % with 4
/// × 4.
#[test]
fn few_elements_bear_the_published_noise() {
    assert!((published(2, 0.1).mean - 0.99).abs() < 0.01);
    assert!((published(4, 1e-3).mean - 0.46).abs() < 0.2);
    assert!(published(4, 1e-5).mean >= 0.95);
}

/// Published: 0.93 at 1e-10 % with 8 × 8 elements, and nothing left at 1e-6 %.
#[test]
fn many_elements_bear_none() {
    assert!((published(8, 1e-12).mean - 0.93).abs() < 0.05);
    assert!(published(8, 1e-8).mean.abs() <= 0.2);
}
