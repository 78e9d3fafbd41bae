//! Derivatives of the model beside the model itself: the cost of a parameter in models.
//!
//! The published geometry with 120 spots, 16 × 16 pixels, 8 × 8 elements, by centres and
//! integrated; and a scene past a plate, with none, one and three parameters of the plate at once.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use phicam::model::{Differential, Effort, Fineness, Swept};
use phicam::scene::file::SceneFile;
use phicam::scene::{Parameter, Scene, Velocity};

fn derivatives(c: &mut Criterion) {
    let scene = Scene::load("bench").expect("a built-in scene");
    for (name, fineness) in [
        ("centres", Fineness::Centres),
        ("integrated", Fineness::Areas(1)),
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

fn past_a_plate(c: &mut Criterion) {
    let mut file = SceneFile::builtin("periscope").expect("a built-in scene");
    file.camera.pixels = [16, 16];
    let scene = Scene::new(&file, None).expect("a valid scene");
    let parameters = Parameter::named(&scene, "plate.position").expect("parameters");
    let values = vec![0.0; parameters.len()];
    let velocity = |k| scene.velocity(&parameters, &values, k);
    let velocities: Vec<Velocity> = (0..parameters.len()).map(velocity).collect();
    let mut group = c.benchmark_group("derivatives, past a plate");
    group.sample_size(10);
    for (name, count) in [("the model", 0), ("one parameter", 1), ("three", 3)] {
        let moving = &velocities[..count];
        group.bench_function(name, |b| {
            b.iter(|| {
                Swept::new(black_box(&scene), Some([8, 8]), moving, Effort::USUAL).expect("a model")
            });
        });
    }
    group.finish();
}

criterion_group!(benches, derivatives, past_a_plate);
criterion_main!(benches);
