//! How does the time of each recovery method grow with the elements? Varied: method, elements a
//! side; 256 pixels, 120 spots. And that of pictures at a camera's noise: entries of 1 % noise and a
//! constant in each frame, up to the elements from which not all of the normal equations are formed;
//! bands.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use phicam::model::{Kernel, MatrixModel};
use phicam::recovery::{Method, Nuisance, Options, Problem, recover};
use phicam::scene::Scene;

fn recoveries(c: &mut Criterion) {
    let scene = Scene::load("bench").expect("the bench is built in");
    let mut group = c.benchmark_group("recovery by elements a side");
    for side in [4, 8, 16] {
        let model =
            MatrixModel::new(&scene, Kernel::Physical, Some([side, side])).expect("a model");
        let phi = model.phi();
        let stderr = phi.map(|x| 1e-3 * x);
        let grids = [[side, side]];
        let problem = Problem::new(&phi, &model.camera_side, &model.laser_side, Some(&stderr))
            .and_then(|problem| problem.with_grids(&grids))
            .expect("matrices of one bench");
        for method in Method::USUAL {
            group.bench_function(BenchmarkId::new(method.name(), side), |b| {
                let options = Options::default();
                b.iter(|| recover(method, black_box(&problem), &options).expect("a picture"));
            });
        }
    }
    group.finish();
}

fn pictures(c: &mut Criterion) {
    let scene = Scene::load("bench").expect("the bench is built in");
    let mut group = c.benchmark_group("picture at 1 % noise");
    for (side, method, bands) in [
        (16, Method::Joint, Some(0.95)),
        (24, Method::Joint, None),
        (24, Method::JointTv, None),
        (24, Method::JointGp, None),
        (48, Method::Joint, None),
    ] {
        let model =
            MatrixModel::new(&scene, Kernel::Physical, Some([side, side])).expect("a model");
        let phi = model.phi();
        let stderr = phi.map(|x| 1e-2 * x);
        let grids = [[side, side]];
        let nuisance = Nuisance {
            frame_constant: true,
            ..Nuisance::default()
        };
        let problem = Problem::new(&phi, &model.camera_side, &model.laser_side, Some(&stderr))
            .and_then(|problem| problem.with_grids(&grids)?.with_nuisance(nuisance))
            .expect("matrices of one bench");
        let options = Options {
            bands,
            ..Options::default()
        };
        let name = match bands {
            Some(_) => format!("{method} with bands"),
            None => method.name().to_owned(),
        };
        group.bench_function(BenchmarkId::new(name, side), |b| {
            b.iter(|| recover(method, black_box(&problem), &options).expect("a picture"));
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = recoveries, pictures
}
criterion_main!(benches);
