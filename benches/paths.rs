//! How long does a path take, by estimator and sampler? Varied: estimator, sampler. One spot of the
//! bench counts as one entry under `independent`; `shared` is given all 120 spots, so its paths
//! cost 120 connections.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use phicam::num::stream::Sampling;
use phicam::scene::Scene;
use phicam::transport::{Budget, Control, Estimator, Plan, render};

fn paths(c: &mut Criterion) {
    let scene = Scene::load("bench").expect("the bench is built in");
    let control = Control::none();
    let mut group = c.benchmark_group("entries of Φcam per path");
    for (estimator, spots) in [(Estimator::Independent, 0..1), (Estimator::Shared, 0..120)] {
        for sampling in [Sampling::Pcg, Sampling::Sobol] {
            let budget = Budget::new(64, sampling).expect("64 paths can be traced");
            let plan = Plan {
                estimator,
                sampling,
                seed: 1,
                budget,
            };
            let entries = scene.camera.pixels() as u64 * spots.len() as u64 * budget.samples();
            group.throughput(Throughput::Elements(entries));
            let id = BenchmarkId::new(estimator.name(), sampling.name());
            group.bench_function(id, |b| {
                b.iter(|| render(black_box(&scene), &plan, spots.clone(), control));
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = paths
}
criterion_main!(benches);
