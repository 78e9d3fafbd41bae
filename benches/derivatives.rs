//! Derivatives of the model beside the model itself: the cost of a parameter in models.
//!
//! The published geometry with 120 spots, 16 × 16 pixels, 8 × 8 elements, by centres and
//! integrated.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use phicam::model::{Differential, Fineness};
use phicam::scene::{Parameter, Scene};

fn derivatives(c: &mut Criterion) {
    let scene = Scene::load("bench").expect("a built-in scene");
    for (name, fineness) in [
        ("centres", Fineness::Centres),
        ("integrated", Fineness::Areas),
    ] {
        let mut group = c.benchmark_group(format!("derivatives, {name}"));
        let model = Differential::new(&scene, None, fineness).expect("a model");
        group.bench_function("the model", |b| b.iter(|| black_box(&model).terms()));
        for name in [
            "hinge.angle",
            "hidden.normal",
            "spots.x",
            "view.x",
            "camera.z",
        ] {
            let parameter = Parameter::named(&scene, name).expect("a parameter");
            let velocity = scene.velocity(&parameter, &[0.0], 0);
            group.bench_function(name, |b| b.iter(|| black_box(&model).rate(&velocity)));
        }
        group.finish();
    }
}

criterion_group!(benches, derivatives);
criterion_main!(benches);
