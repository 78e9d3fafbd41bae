//! What does a ray cost as the scene grows, and where does the tree overtake the list? Varied:
//! number of patches (up to 8 they are tested one by one, beyond that the BVH answers; batches go
//! through the list up to 32), triangles of a mesh, one ray at a time or a batch.
//! `peers/embree_rays.py` sets the rates beside Embree's.

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use phicam::geometry::{Blockers, Bvh, DVec3, Mesh, Parallelogram, Ray, Shape};

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

/// The wall, the object and a panel between them, lengths in inches.
fn bench() -> Vec<Shape> {
    let patch = |corner: [f64; 3], u: [f64; 3], v: [f64; 3]| {
        let patch = Parallelogram::new(corner.into(), u.into(), v.into());
        Shape::Parallelogram(patch.expect("not degenerate"))
    };
    vec![
        patch([0.0, 0.0, 0.0], [11.5, 0.0, 0.0], [0.0, 15.5, 0.0]),
        patch([3.0, 8.5, 7.0], [4.0, 0.0, 0.0], [0.0, 2.8, -2.8]),
        patch([7.5, 4.0, 0.5], [0.0, 4.0, 0.0], [0.0, 0.0, 3.0]),
    ]
}

/// The sphere r = 1 + sin(12x)·sin(12y)·sin(12z)/20 + sin(80x)·sin(80y)/100 of 12·n² triangles: a
/// cube's faces, blown up.
fn sphere(n: u32) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for face in 0..6 {
        let first = positions.len() as u32;
        for i in 0..=n {
            for j in 0..=n {
                let at = |k: u32| 2.0 * f64::from(k) / f64::from(n) - 1.0;
                let mut p = [0.0; 3];
                p[face / 2] = if face % 2 == 0 { 1.0 } else { -1.0 };
                (p[(face / 2 + 1) % 3], p[(face / 2 + 2) % 3]) = (at(i), at(j));
                let p = DVec3::from_array(p).normalize();
                let s = |x: f64| x.sin();
                let coarse = s(12.0 * p.x) * s(12.0 * p.y) * s(12.0 * p.z) / 20.0;
                positions.push(p * (1.0 + coarse + s(80.0 * p.x) * s(80.0 * p.y) / 100.0));
            }
        }
        for i in 0..n {
            for j in 0..n {
                let [a, b] = [first + i * (n + 1) + j, first + (i + 1) * (n + 1) + j];
                triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
            }
        }
    }
    Mesh::new(positions, triangles).expect("a mesh")
}

/// Half-lines from everywhere in a box to everywhere, by a Weyl sequence in five dimensions.
fn half_lines(n: u32, low: DVec3, size: DVec3) -> Vec<Ray> {
    const STEPS: [f64; 5] = [
        0.881_271_5,
        0.776_639_5,
        0.684_430_3,
        0.603_168_9,
        0.531_555_6,
    ];
    (1..=n)
        .map(|i| {
            let [x, y, z, height, turn] = STEPS.map(|s| (f64::from(i) * s).fract());
            let (sin, cos) = (TAU * turn).sin_cos();
            let up = 2.0 * height - 1.0;
            let side = (1.0 - up * up).sqrt();
            let direction = DVec3::new(side * cos, side * sin, up).normalize();
            Ray::new(low + size * DVec3::new(x, y, z), direction)
        })
        .collect()
}

fn in_patches(c: &mut Criterion) {
    let mut group = c.benchmark_group("segments through n patches");
    let segments: Vec<Ray> = (0..256)
        .filter_map(|i| {
            let p = |k: f64| (f64::from(i) * k).fract();
            Ray::between(
                DVec3::new(p(0.31), p(0.47), 0.0),
                DVec3::new(p(0.83), p(0.59), 1.0),
            )
        })
        .collect();
    let (from, ends) = (vec![None; segments.len()], vec![[None; 2]; segments.len()]);
    group.throughput(Throughput::Elements(segments.len() as u64));
    for n in [2, 8, 9, 32, 64, 1024, 16384] {
        let bvh = Bvh::new(patches(n)).expect("bounded");
        group.bench_function(BenchmarkId::new("closest", n), |b| {
            b.iter(|| {
                segments
                    .iter()
                    .filter_map(|r| bvh.closest(black_box(r), None))
                    .count()
            });
        });
        group.bench_function(BenchmarkId::new("blocked", n), |b| {
            b.iter(|| {
                segments
                    .iter()
                    .filter(|r| bvh.blocked(black_box(r), [None, None]))
                    .count()
            });
        });
        group.bench_function(BenchmarkId::new("closest batch", n), |b| {
            b.iter(|| bvh.closest_many(black_box(&segments), &from));
        });
        group.bench_function(BenchmarkId::new("blocked batch", n), |b| {
            b.iter(|| bvh.blocked_many(&Blockers::Any, black_box(&segments), &ends));
        });
    }
    group.finish();
}

fn on_the_bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("rays on the bench");
    let bvh = Bvh::new(bench()).expect("bounded");
    let rays = half_lines(
        1 << 12,
        DVec3::new(0.0, 0.0, 0.05),
        DVec3::new(11.5, 15.5, 6.95),
    );
    let (from, ends) = (vec![None; rays.len()], vec![[None; 2]; rays.len()]);
    group.throughput(Throughput::Elements(rays.len() as u64));
    group.bench_function("closest", |b| {
        b.iter(|| bvh.closest_many(black_box(&rays), &from));
    });
    group.bench_function("blocked", |b| {
        b.iter(|| bvh.blocked_many(&Blockers::Any, black_box(&rays), &ends));
    });
    group.finish();
}

fn on_a_mesh(c: &mut Criterion) {
    let mut group = c.benchmark_group("rays on a sphere of n triangles");
    let rays = half_lines(1 << 16, DVec3::splat(-1.2), DVec3::splat(2.4));
    group.throughput(Throughput::Elements(rays.len() as u64));
    for n in [50, 289] {
        let mesh = sphere(n);
        let count = mesh.triangles().len();
        group.bench_function(BenchmarkId::new("closest", count), |b| {
            b.iter(|| mesh.closest_many(black_box(&rays)));
        });
        group.bench_function(BenchmarkId::new("blocked", count), |b| {
            b.iter(|| mesh.blocks_many(black_box(&rays)));
        });
        group.bench_function(BenchmarkId::new("closest one by one", count), |b| {
            b.iter(|| {
                rays.iter()
                    .filter_map(|r| mesh.closest(black_box(r)))
                    .count()
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(30);
    targets = in_patches, on_the_bench, on_a_mesh
}
criterion_main!(benches);
