//! What does a ray cost as the scene grows, and where does the tree overtake the list? Varied: number of patches; up to 8
//! they are tested one by one, beyond that the BVH answers.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use phicam::geometry::{Bvh, DVec3, Parallelogram, Ray, Shape};

/// Patches scattered through the unit cube, by a Weyl sequence.
fn patches(n: usize) -> Vec<Shape> {
    let weyl = |i: usize, k: f64| (i as f64 * k).fract();
    let v = |i| DVec3::new(weyl(i, 0.618_034), weyl(i, 0.754_878), weyl(i, 0.569_840));
    (0..n)
        .map(|i| {
            let (u, w) = (v(3 * i + 1) - 0.5, v(3 * i + 2) - 0.5);
            let patch = Parallelogram::new(v(3 * i), u * 0.3, w * 0.3).expect("not degenerate");
            Shape::Parallelogram(patch)
        })
        .collect()
}

fn rays(c: &mut Criterion) {
    let mut group = c.benchmark_group("segments through n patches");
    let ends: Vec<Ray> = (0..256)
        .filter_map(|i| {
            let p = |k: f64| (f64::from(i) * k).fract();
            Ray::between(
                DVec3::new(p(0.31), p(0.47), 0.0),
                DVec3::new(p(0.83), p(0.59), 1.0),
            )
        })
        .collect();
    group.throughput(Throughput::Elements(ends.len() as u64));
    for n in [2, 8, 9, 64, 1024, 16384] {
        let bvh = Bvh::new(patches(n)).expect("bounded");
        group.bench_function(BenchmarkId::new("closest", n), |b| {
            b.iter(|| {
                ends.iter()
                    .filter_map(|r| bvh.closest(black_box(r), None))
                    .count()
            });
        });
        group.bench_function(BenchmarkId::new("blocked", n), |b| {
            b.iter(|| {
                ends.iter()
                    .filter(|r| bvh.blocked(black_box(r), [None, None]))
                    .count()
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(30);
    targets = rays
}
criterion_main!(benches);
