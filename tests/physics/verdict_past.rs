//! What `validate` says of light past what stands in the way, and of light that no model has.

use phicam::lab::{Against, Certainty, Errors, Integration, Measured, Test, Validation, validate};
use phicam::matrix::Matrix;
use phicam::model::{Kernel, Occlusion};
use phicam::num::statistics::binomial_interval;
use phicam::num::stream::{Key, Sampling, Stream};
use phicam::scene::{Parameter, Scene};

use crate::builtin;
use crate::divided::{by_quadrature, scene};
use crate::verdict::{score, traced};

fn judged(scene: &Scene, phi: &Matrix, seed: u64, occlusion: Occlusion) -> Validation {
    let light = traced(phi, Errors::Independent, seed);
    let measured = Measured::new(&light.flux, &light.stderr, None);
    let against = Against {
        kernel: Kernel::Physical,
        integration: Integration::Quadrature,
        occlusion,
    };
    let test = Test {
        significance: 1e-3,
        known: Certainty::new(Errors::Independent, Some(32)),
    };
    validate(scene, measured, against, test).unwrap()
}

/// A plate off the wall, its corner moved by so much, cm.
fn with_plate_at(by: [f64; 3]) -> Scene {
    let [x, y, z] = by;
    scene(
        "position = [-3.0, 25.0, 9.0]\nspots = { layout = \"list\", points = [[-9, 1], [-8, 12], [8, 3], [9, 11], [0, 13], [6, 14]] }",
        "view = { x = [-6, 4], y = [2, 8] }\npixels = [6, 4]",
        &format!(
            "rectangle = {{ corner = [{}, {}, {}], u = [0, 3, 0], v = [0, 0, 3] }}",
            x - 5.0,
            y + 4.5,
            z - 1.5
        ),
    )
}

/// A plate that is moved along one of its axes by twice what the verdict says it detects: rejected
/// and named, alone or among what is not told from it, and the fit within 3 standard errors, all in
/// 9 of 10 seeds at least. The right place is not rejected.
#[test]
fn a_plate_that_is_elsewhere_is_named() {
    let thought = with_plate_at([0.0; 3]);
    let phi = by_quadrature(&thought).phi;
    let right = judged(&thought, &phi, 1, Occlusion::Considered);
    assert!(right.agreement.agrees, "{}", right.agreement.verdict());
    let axes = [
        ("plate.normal", [1.0, 0.0, 0.0]),
        ("plate.u", [0.0, 1.0, 0.0]),
        ("plate.v", [0.0, 0.0, 1.0]),
    ];
    for (name, axis) in axes {
        let all = &score(&right).deviations;
        let stated = all.iter().find(|d| d.name == name);
        let size = 2.0 * stated.unwrap().detectable;
        let there = by_quadrature(&with_plate_at(axis.map(|x| x * size))).phi;
        let mut found = 0;
        for seed in 1..=10 {
            let own = judged(&thought, &there, seed, Occlusion::Considered);
            let named = score(&own).likely.iter().any(|d| d.name == name);
            let all = &score(&own).deviations;
            let fit = all.iter().find(|d| d.name == name).unwrap();
            let within = (fit.value - size).abs() <= 3.0 * fit.stderr;
            found += u32::from(named && within && !own.agreement.agrees);
        }
        assert!(found >= 9, "{name} by {size}: {found} of 10");
    }
}

/// What moves everything else past the plate, whose shadow then moves too: the same of view, hidden
/// surface and spots, and the fit has their sign and size.
#[test]
fn what_moves_past_a_plate_is_named() {
    let thought = with_plate_at([0.0; 3]);
    let phi = by_quadrature(&thought).phi;
    let right = judged(&thought, &phi, 1, Occlusion::Considered);
    assert!(!score(&right).shadows_stay);
    let of = [
        ("view, x", "view.x"),
        ("view, y", "view.y"),
        ("S2 along its normal", "hidden.normal"),
        ("yaw of S2", "hidden.yaw"),
        ("all spots, x", "spots.x"),
        ("all spots, y", "spots.y"),
    ];
    for (name, parameter) in of {
        let parameters = Parameter::named(&thought, parameter).unwrap();
        let all = &score(&right).deviations;
        let size = 2.0 * all.iter().find(|d| d.name == name).unwrap().detectable;
        let there = thought.displaced(&parameters, &[size]).unwrap();
        let there = by_quadrature(&there).phi;
        let mut found = 0;
        for seed in 1..=10 {
            let own = judged(&thought, &there, seed, Occlusion::Considered);
            let named = score(&own).likely.iter().any(|d| d.name == name);
            let all = &score(&own).deviations;
            let fit = all.iter().find(|d| d.name == name).unwrap();
            let within = (fit.value - size).abs() <= 3.0 * fit.stderr;
            found += u32::from(named && within && !own.agreement.agrees);
        }
        assert!(found >= 9, "{name} by {size}: {found} of 10");
    }
}

/// Of two replicates no deviation is fitted: right light is rejected no oftener than at 1 in 1000.
#[test]
fn two_replicates_tell_no_deviation() {
    let scene = crate::verdict::small();
    let phi = crate::verdict::right();
    let test = Test {
        significance: 1e-3,
        known: Certainty::new(Errors::Independent, Some(2)),
    };
    let against = Against {
        kernel: Kernel::Physical,
        integration: Integration::Quadrature,
        occlusion: Occlusion::Considered,
    };
    let mut rejected = 0;
    for seed in 0..200 {
        let mut stream = Stream::new(
            Sampling::Pcg,
            Key {
                seed,
                spot: 0,
                pixel: 0,
                block: 0,
            },
        );
        let mut draw = || phi.map(|x| x * (1.0 + 0.01 * stream.normal()));
        let [a, b] = [draw(), draw()];
        let mean = (&a + &b) * 0.5;
        let stderr = (a - b).abs() * 0.5;
        let measured = Measured::new(&mean, &stderr, None);
        let found = validate(&scene, measured, against, test).unwrap().agreement;
        assert!(found.score.is_none());
        rejected += u64::from(!found.agrees);
    }
    let [_, most] = binomial_interval(200, 1e-3, 0.99);
    assert!(rejected <= most, "{rejected} of 200");
}

/// Light that frames hold and no model has is told where there is any: a spot that is seen, walls
/// that light one another, an occluder that is not black, more bounces, a shadow that is ignored;
/// and that frames of two bounces have none of the model's.
#[test]
fn light_that_the_model_lacks_is_told() {
    let told = |scene: &Scene, occlusion| {
        let phi = by_quadrature(scene).phi;
        judged(scene, &phi, 1, occlusion).agreement.unmodelled
    };
    let small = [
        ("pixels = [16, 16]", "pixels = [2, 2]"),
        ("per_side = 30", "per_side = 2"),
    ];
    let bench = |change: &[(&str, &str)]| builtin("bench", &[&small, change].concat());
    let own = bench(&[]);
    assert_eq!(own.max_bounces, 3);
    assert!(told(&own, Occlusion::Considered).is_empty());
    let mut longer = own.clone();
    longer.max_bounces = 5;
    assert_eq!(
        told(&longer, Occlusion::Considered),
        ["light of 4 to 5 bounces"]
    );
    longer.max_bounces = 4;
    assert_eq!(told(&longer, Occlusion::Considered), ["light of 4 bounces"]);
    // A wall of its own beside the other one, that faces it, and one that turns its back on it.
    let beside = |sides: &str| {
        let wall = format!(
            "[[surface]]\nname = \"side\"\nrole = \"relay\"\n\
             rectangle = {{ corner = [9, 0, 0], {sides} }}\nmaterial = {{ lambertian = 0.6 }}\n\n"
        );
        let first = "[[surface]]\nname = \"object\"";
        bench(&[(first, &format!("{wall}{first}"))])
    };
    let facing = beside("u = [0, 0, 6], v = [0, 15.5, 0]");
    let words = told(&facing, Occlusion::Considered);
    assert!(
        words.len() == 1 && words[0].contains("three bounces that `side` sends"),
        "{words:?}"
    );
    let away = beside("u = [0, 15.5, 0], v = [0, 0, 6]");
    assert!(told(&away, Occlusion::Considered).is_empty());
    let mut shorter = own.clone();
    shorter.max_bounces = 2;
    let words = told(&shorter, Occlusion::Considered);
    assert!(
        words.len() == 1 && words[0].contains("frames hold none of it"),
        "{words:?}"
    );
    let view = own.camera.view.at([0.5; 2]).position;
    let seen = own.with_spots_at(&[[view.x, view.y], [1.0, 2.0]]).unwrap();
    let words = told(&seen, Occlusion::Considered);
    assert!(
        words.len() == 1 && words[0].contains("spot 0 in the camera's view"),
        "{words:?}"
    );
    let bowl = Scene::from_toml("bowl", BOWL).unwrap();
    let words = told(&bowl, Occlusion::Considered);
    assert!(
        words.len() == 2
            && words[0].contains("2 of 2 spots straight to")
            && words[1].contains("three bounces that `bowl` sends"),
        "{words:?}"
    );
    let plate = with_plate_at([0.0; 3]);
    assert!(told(&plate, Occlusion::Considered).is_empty());
    let words = told(&plate, Occlusion::Ignored);
    assert!(
        words.len() == 1 && words[0].starts_with("what stands in the way"),
        "{words:?}"
    );
}

const BOWL: &str = r#"
name = "bowl"
unit = "m"
max_bounces = 3
[laser]
power = 1.0
wavelength = 500e-9
position = [-0.75, 0.1, 1.5]
spots = { layout = "list", points = [[0.5, 0.2], [-0.5, -0.3]] }
[camera]
position = [0.75, 0.1, 1.5]
aperture_area = 1e-4
view = { x = [-0.2, 0.3], y = [-0.4, 0.1] }
pixels = [2, 2]
[[surface]]
name = "bowl"
role = "relay"
sphere = { centre = [0, 0, 1], radius = 1.0, face = "inside" }
material = { lambertian = 0.5 }
[[surface]]
name = "disc"
role = "hidden"
disc = { centre = [0.1, 0.0, 1.3], normal = [0.2, 0, -1], radius = 0.3 }
material = { lambertian = 0.6 }
elements = [2, 2]
"#;
