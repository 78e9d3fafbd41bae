//! Against finite differences of scenes that are displaced, and against the matrix model.

use super::*;
use crate::model::{Effort, MatrixModel, Occlusion};
use crate::scene::{Parameter, file::SceneFile};

fn small(name: &str) -> Scene {
    let mut file = SceneFile::builtin(name).unwrap();
    file.camera.pixels = [3, 2];
    if let Some(laser) = &mut file.laser {
        laser.spots.per_side = laser.spots.per_side.map(|_| 2);
        laser.spot_diameter = 0.2;
    }
    Scene::new(&file, None).unwrap()
}

fn parameters(scene: &Scene, names: &[&str]) -> Vec<Parameter> {
    let each = names
        .iter()
        .map(|name| Parameter::named(scene, name).unwrap());
    each.collect::<Vec<_>>().concat()
}

/// The largest difference of a rate from its central differences, over the largest rate of the same
/// matrix.
fn worst(base: &Scene, parameters: &[Parameter], values: &[f64], take: Fineness) -> Vec<f64> {
    let extent = base.camera.view.u().length();
    let here = base.displaced(parameters, values).unwrap();
    let model = Differential::new(&here, Some([3, 2]), take).unwrap();
    let of = |k: usize| {
        let rate = model.rate(&base.velocity(parameters, values, k));
        let at = |step: f64| {
            let mut values = values.to_vec();
            values[k] += step;
            let scene = base.displaced(parameters, &values).unwrap();
            Differential::new(&scene, Some([3, 2]), take)
                .unwrap()
                .terms()
        };
        let h = if parameters[k].is_of_spread() {
            0.1
        } else {
            1e-3 * extent
        };
        // Of sixth order: a spot over the wall's end loses light by its profile, which changes over
        // its width.
        let [a, b, c] = [h, 2.0 * h, 3.0 * h].map(|h| [at(h), at(-h)]);
        let mut worst = 0.0f64;
        let mut compare = |rate: &Option<Matrix>, of: fn(&Terms) -> &Matrix| {
            let odd = |[more, less]: &[Terms; 2]| of(more) - of(less);
            let want = (odd(&a) * 45.0 - odd(&b) * 9.0 + odd(&c)) / (60.0 * h);
            let none = Matrix::zeros(want.nrows(), want.ncols());
            let rate = rate.as_ref().unwrap_or(&none);
            let off = (rate - &want).amax();
            // What does not move is there but for rounding.
            let rounding = 1e-5 * of(&a[0]).amax();
            worst = worst.max(off / want.amax().max(rounding));
        };
        compare(&rate.camera, |t| &t.camera);
        compare(&rate.laser, |t| &t.laser);
        worst
    };
    (0..parameters.len()).map(of).collect()
}

fn all_within(scene: &Scene, names: &[&str], values: impl Fn(usize) -> f64, limit: f64) {
    let parameters = parameters(scene, names);
    let values: Vec<f64> = (0..parameters.len()).map(values).collect();
    for take in [Fineness::Centres, Fineness::Areas(1)] {
        let found = worst(scene, &parameters, &values, take);
        for (p, off) in parameters.iter().zip(found) {
            assert!(off < limit, "{} {take:?}: {off:e}", p.name);
        }
    }
}

/// Everything at once, away from where the scene is written: the order of motions counts.
#[test]
fn rates_are_those_of_displaced_scenes() {
    let names = [
        "hinge.angle",
        "hidden.normal",
        "hidden.yaw",
        "hidden.pitch",
        "spots.shift",
        "spots.angle",
        "spots.scale",
        "spots.1.x",
        "view.shift",
        "view.scale",
        "camera.position",
        "laser.position",
    ];
    let values =
        |k: usize| 0.11 * (1.0 + (k % 3) as f64) * if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    all_within(&small("bench"), &names, values, 1e-8);
}

/// The wall itself, spots and view staying at their (x, y); the profile of a spot on it may turn.
#[test]
fn rates_of_the_wall_are_those_of_displaced_scenes() {
    let names = ["wall.normal", "wall.pitch", "wall.yaw", "hidden.normal"];
    let scene = small("bench");
    let parameters = parameters(&scene, &names);
    let found = worst(
        &scene,
        &parameters,
        &[0.05, 0.4, -0.3, 0.1],
        Fineness::Centres,
    );
    assert!(found.iter().all(|off| *off < 1e-8), "{found:?}");
    let found = worst(
        &scene,
        &parameters,
        &[0.05, 0.4, -0.3, 0.1],
        Fineness::Areas(1),
    );
    assert!(found.iter().all(|off| *off < 1e-4), "{found:?}");
}

/// The bench with a wall of this material.
fn of_material(material: &str) -> Scene {
    let text = small("bench").text;
    let own = "lambertian = 0.8";
    assert!(text.contains(own), "{text}");
    Scene::from_toml("wall", &text.replacen(own, material, 1)).unwrap()
}

/// Wider spots, by either profile, that turn with their wall and hang over its end.
#[test]
fn rates_of_wider_spots_are_those_of_displaced_scenes() {
    let names = [
        "laser.spot_diameter",
        "spots.x",
        "spots.scale",
        "wall.pitch",
        "hidden.yaw",
    ];
    let values = |k: usize| 3.0 - 1.7 * k as f64;
    let disc = small("bench");
    let text = disc.text.replacen("\"disc\"", "\"gaussian\"", 1);
    assert!(text.contains("gaussian"), "{text}");
    for scene in [disc, Scene::from_toml("gaussian", &text).unwrap()] {
        let size = parameters(&scene, &names);
        let values: Vec<f64> = (0..size.len()).map(|k| 0.1 * values(k)).collect();
        for take in [Fineness::Centres, Fineness::Areas(1), Fineness::Areas(2)] {
            let off = worst(&scene, &size, &values, take)[0];
            assert!(off < 1e-8, "{take:?}: {off:e}");
        }
    }
    let over = small("bench")
        .with_spots_at(&[[0.04, 3.0], [5.0, 15.47]])
        .unwrap();
    let off = worst(
        &over,
        &parameters(&over, &names[..1]),
        &[3.0],
        Fineness::Areas(3),
    )[0];
    assert!(off < 1e-6, "{off:e}");
}

/// Walls that reflect in another way, where things move too. Of a coat the slope by its roughness
/// jumps: nodes of the quadrature that tabulates it pass the horizon.
#[test]
fn rates_of_how_walls_reflect_are_those_of_displaced_scenes() {
    let mixture = "mixture = [{ weight = 0.5, material = { lambertian = 0.8 } }, { weight = 0.2, material = { oren_nayar = 0.9, roughness = 0.5 } }, { weight = 0.25, material = { conductor = { eta = 0.2, k = 3.9 }, roughness = 0.5 } }]";
    for (material, names) in [
        (
            "oren_nayar = 0.8\nroughness = 0.4",
            &["wall.roughness", "hidden.yaw"][..],
        ),
        (
            mixture,
            &[
                "wall.roughness",
                "wall.mixture.2.weight",
                "wall.mixture.0.weight",
            ],
        ),
    ] {
        all_within(
            &of_material(material),
            names,
            |k| 0.3 - 0.2 * k as f64,
            1e-8,
        );
    }
}

/// The wall of the bench in two, the far part painted; spots and view lie on both.
fn two_walls() -> Scene {
    let text = small("bench").text;
    let near = text.replacen("v = [0.0, 15.5, 0.0]", "v = [0.0, 4.4, 0.0]", 1);
    assert!(near != text);
    let far = "\n[[surface]]\nname = \"far\"\nrole = \"relay\"\n\
        material = { paint = 0.7, roughness = 0.4 }\n\
        rectangle = { corner = [0, 4.4, 0], u = [11.5, 0, 0], v = [0, 11.1, 0] }\n";
    Scene::from_toml("two", &(near + far)).unwrap_or_else(|e| panic!("{e}"))
}

/// Albedos that are no scale of all light, of a Lambertian and of a coated wall.
#[test]
fn rates_of_albedos_are_those_of_displaced_scenes() {
    let names = ["far.albedo", "wall.albedo"];
    all_within(&two_walls(), &names, |k| 0.2 * k as f64 - 0.3, 1e-6);
}

/// Wide spots across the seam of two walls, of which one takes what the other loses.
#[test]
fn rates_of_spots_across_two_walls_are_those_of_displaced_scenes() {
    let painted = "paint = 0.7, roughness = 0.4";
    let text = two_walls().text.replacen(painted, "lambertian = 0.3", 1);
    let gaussian = text.replacen("\"disc\"", "\"gaussian\"", 1);
    let names = ["spots.shift", "laser.spot_diameter", "laser.position"];
    for text in [text, gaussian] {
        let scene = Scene::from_toml("seam", &text).unwrap();
        let scene = scene.with_spots_at(&[[4.0, 4.43], [6.0, 4.36]]).unwrap();
        let parameters = parameters(&scene, &names);
        let values = vec![0.003; parameters.len()];
        let found = worst(&scene, &parameters, &values, Fineness::Areas(3));
        for (p, off) in parameters.iter().zip(found) {
            assert!(off < 1e-5, "{}: {off:e}", p.name);
        }
    }
}

/// A glossy wall, a curved wall, a surface that shines with a fall-off.
#[test]
fn rates_of_other_surfaces_are_those_of_displaced_scenes() {
    let values = |k: usize| 0.05 * (k as f64 - 1.0);
    let names = [
        "hinge.angle",
        "hidden.normal",
        "spots.shift",
        "camera.position",
        "laser.position",
    ];
    // Its coat is interpolated in a table, which bends at its nodes.
    all_within(&small("satin"), &names, values, 1e-6);
    let curved = small("bench").with_bent_relay(0.2).unwrap();
    let names = [
        "hinge.angle",
        "spots.shift",
        "wall.x",
        "wall.normal",
        "view.shift",
        "camera.position",
    ];
    all_within(&curved, &names, values, 1e-8);
    let text = SceneFile::builtin("screen").unwrap();
    let screen = Scene::new(&text, None).unwrap();
    let names = [
        "hidden.normal",
        "hidden.yaw",
        "hidden.pitch",
        "view.shift",
        "camera.position",
    ];
    all_within(&screen, &names, |k| 0.002 * (k as f64 - 1.0), 1e-7);
}

/// At the centres they are the matrix model's C and D; integrated, its areas'.
#[test]
fn terms_are_those_of_the_matrix_model() {
    for name in ["bench", "screen"] {
        let scene = small(name);
        let model =
            MatrixModel::with(&scene, Kernel::Physical, Some([3, 2]), Occlusion::Ignored).unwrap();
        let own = Differential::new(&scene, Some([3, 2]), Fineness::Centres).unwrap();
        let phi = |terms: &Terms| {
            let rho = nalgebra::DVector::from_column_slice(&model.albedo);
            let frames = (0..terms.laser.ncols()).map(|l| terms.frame(l, 6) * &rho);
            Matrix::from_columns(&frames.collect::<Vec<_>>())
        };
        let want = model.phi();
        let off = (phi(&own.terms()) - &want).norm() / want.norm();
        assert!(off < 1e-14, "{name}: {off:e}");
        let want = MatrixModel::over_areas(
            &scene,
            Kernel::Physical,
            Some([3, 2]),
            Occlusion::Ignored,
            Effort::USUAL,
        );
        let want = want.unwrap().phi();
        let own = Differential::new(&scene, Some([3, 2]), Fineness::Areas(1)).unwrap();
        let off = (phi(&own.terms()) - &want).norm() / want.norm();
        assert!(off < 3e-3, "{name}: {off:e}");
    }
}
