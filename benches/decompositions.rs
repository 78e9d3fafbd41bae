//! What does the number of directions save over the full decomposition? Varied: elements and spots;
//! G12 of the published scene, numerical rank about 100. Read as ratios: `full` decomposes all of
//! the matrix, `needed` as far as its numerical rank needs, `inverse` is the Moore–Penrose inverse.
//! `benches/peers/factorisations.py` sets them beside NumPy's.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use phicam::model::{Kernel, MatrixModel};
use phicam::num::linalg::{Tolerance, pinv, svd, svd_to};
use phicam::scene::Scene;

fn decompositions(c: &mut Criterion) {
    let text = Scene::load("thesis").expect("it is built in").text;
    let mut group = c.benchmark_group("singular values of G12 by elements a side and spots");
    for (side, per_side) in [(16, 100), (24, 200), (32, 1000)] {
        let many = text.replace("per_side = 30", &format!("per_side = {per_side}"));
        let scene = Scene::from_toml("many", &many).expect("more spots on the same wall");
        let model =
            MatrixModel::new(&scene, Kernel::Physical, Some([side, side])).expect("a model");
        let name = format!("{side} x {}", 4 * per_side);
        group.bench_function(BenchmarkId::new("full", &name), |b| {
            b.iter(|| svd(black_box(&model.g12)));
        });
        group.bench_function(BenchmarkId::new("needed", &name), |b| {
            b.iter(|| svd_to(black_box(&model.g12), Tolerance::Auto));
        });
        group.bench_function(BenchmarkId::new("inverse", &name), |b| {
            b.iter(|| pinv(black_box(&model.g12), Tolerance::Auto));
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = decompositions
}
criterion_main!(benches);
