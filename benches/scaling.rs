//! How does the time grow with the size of the task? Varied, one at a time: pixels a side, spots,
//! points, threads (each estimator, one entry of Φcam having the same paths throughout), and
//! elements a side (the matrix model); otherwise the published scene with 100 spots, 16 × 16 pixels
//! and one thread.

use std::hint::black_box;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, criterion_group, criterion_main};
use phicam::model::{Kernel, MatrixModel};
use phicam::num::stream::Sampling;
use phicam::scene::Scene;
use phicam::transport::{Budget, Control, Estimator, Plan, render};

/// The published scene with this many pixels a side and spots a side.
fn scene(pixels: usize, per_side: usize) -> Scene {
    let text = Scene::load("thesis").expect("it is built in").text;
    let text = text
        .replace("per_side = 30", &format!("per_side = {per_side}"))
        .replace(
            "pixels = [16, 16]",
            &format!("pixels = [{pixels}, {pixels}]"),
        );
    Scene::from_toml("thesis", &text).expect("other spots and pixels on the same wall")
}

/// Samples that take an estimator some milliseconds.
fn samples(estimator: Estimator) -> u64 {
    match estimator {
        Estimator::Independent => 32,
        Estimator::Shared => 64,
        Estimator::Factored => 4096,
    }
}

/// Times Φcam of `scene` with `samples` by `estimator` on `threads` threads, as `value` of the
/// group.
fn time(
    group: &mut BenchmarkGroup<'_, WallTime>,
    value: u64,
    scene: &Scene,
    (estimator, samples, threads): (Estimator, u64, usize),
) {
    let plan = Plan {
        estimator,
        sampling: Sampling::Sobol,
        seed: 1,
        budget: Budget::new(samples, Sampling::Sobol).expect("a number that can be traced"),
    };
    let control = Control::none();
    let spots = scene.laser.spots.len();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.expect("threads can be started");
    group.bench_function(BenchmarkId::new(estimator.name(), value), |b| {
        pool.install(|| b.iter(|| render(black_box(scene), &plan, 0..spots, control)));
    });
}

fn pixels(c: &mut Criterion) {
    let mut group = c.benchmark_group("pixels a side");
    for side in [8, 16, 32] {
        let scene = scene(side, 25);
        for e in Estimator::ALL {
            time(&mut group, side as u64, &scene, (e, samples(e), 1));
        }
    }
    group.finish();
}

fn spots(c: &mut Criterion) {
    let mut group = c.benchmark_group("spots");
    for per_side in [6, 25, 100] {
        let scene = scene(16, per_side);
        for e in Estimator::ALL {
            time(&mut group, 4 * per_side as u64, &scene, (e, samples(e), 1));
        }
    }
    group.finish();
}

fn points(c: &mut Criterion) {
    let mut group = c.benchmark_group("points, as multiples of the fewest");
    let scene = scene(16, 25);
    for factor in [1, 4, 16] {
        for e in Estimator::ALL {
            time(&mut group, factor, &scene, (e, factor * samples(e), 1));
        }
    }
    group.finish();
}

fn threads(c: &mut Criterion) {
    let mut group = c.benchmark_group("threads");
    let scene = scene(16, 25);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    for threads in (0..).map(|k| 1 << k).take_while(|n| *n <= cores) {
        for e in Estimator::ALL {
            time(
                &mut group,
                threads as u64,
                &scene,
                (e, 4 * samples(e), threads),
            );
        }
    }
    group.finish();
}

fn elements(c: &mut Criterion) {
    let mut group = c.benchmark_group("elements a side");
    let scene = scene(16, 25);
    for side in [8, 16, 32, 64] {
        group.bench_function(BenchmarkId::new("matrix model", side), |b| {
            b.iter(|| {
                MatrixModel::new(black_box(&scene), Kernel::Physical, Some([side, side]))
                    .expect("a model")
                    .phi()
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = pixels, spots, points, threads, elements
}
criterion_main!(benches);
