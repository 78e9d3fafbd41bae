//! The tracer against an independent quadrature, and against the laws of light transport.

mod reference;

use std::sync::atomic::AtomicBool;

use phicam::num::stream::Sampling;
use phicam::scene::Scene;
use phicam::transport::{Budget, Control, Estimator, Plan, Traced, render};
use reference::{Bench, relative_difference};

fn trace(
    scene: &Scene,
    estimator: Estimator,
    sampling: Sampling,
    seed: u64,
    samples: u64,
) -> Traced {
    let budget = Budget::new(samples, sampling).unwrap();
    let plan = Plan {
        estimator,
        sampling,
        seed,
        budget,
    };
    let stop = AtomicBool::new(false);
    let control = Control {
        progress: &|_| (),
        stop: &stop,
    };
    render(scene, &plan, 0..scene.laser.spots.len(), control).unwrap()
}

fn rows(phi: &phicam::matrix::Matrix) -> Vec<Vec<f64>> {
    phi.row_iter()
        .map(|r| r.iter().copied().collect())
        .collect()
}

#[test]
fn shared_sobol_converges_to_the_quadrature_of_the_thesis_bench() {
    let scene = Scene::load("thesis").unwrap();
    let truth = Bench::new(6.0, 8).converged();
    for n in [512, 2048, 8192] {
        let start = std::time::Instant::now();
        let traced = trace(&scene, Estimator::Shared, Sampling::Sobol, 1, n);
        let error = relative_difference(&rows(&traced.flux), &truth);
        println!("{n}: error {error:e} in {:?}", start.elapsed());
    }
    for n in [64, 256, 1024] {
        let start = std::time::Instant::now();
        let traced = trace(&scene, Estimator::Independent, Sampling::Pcg, 1, n);
        let error = relative_difference(&rows(&traced.flux), &truth);
        println!("ind pcg {n}: error {error:e} in {:?}", start.elapsed());
        let traced = trace(&scene, Estimator::Independent, Sampling::Sobol, 1, n);
        let error = relative_difference(&rows(&traced.flux), &truth);
        println!("ind sobol {n}: error {error:e} in {:?}", start.elapsed());
    }
}
