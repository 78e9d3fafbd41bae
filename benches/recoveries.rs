//! How does the time of each recovery method grow with the elements? Varied: method, elements a
//! side; 256 pixels, 120 spots.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use phicam::model::{Kernel, MatrixModel};
use phicam::recovery::{Method, Options, Problem, recover};
use phicam::scene::Scene;

fn recoveries(c: &mut Criterion) {
    let scene = Scene::load("bench").expect("the bench is built in");
    let mut group = c.benchmark_group("recovery by elements a side");
    for side in [4, 8, 16] {
        let model =
            MatrixModel::new(&scene, Kernel::Physical, Some([side, side])).expect("a model");
        let phi = model.phi();
        let stderr = phi.map(|x| 1e-3 * x);
        let problem = Problem::new(&phi, &model.camera_side, &model.laser_side, Some(&stderr))
            .expect("matrices of one bench");
        for method in Method::USUAL {
            group.bench_function(BenchmarkId::new(method.name(), side), |b| {
                b.iter(|| recover(method, black_box(&problem), &Options::default()));
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = recoveries
}
criterion_main!(benches);
