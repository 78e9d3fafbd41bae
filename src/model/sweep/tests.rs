//! Against finite differences of scenes whose occluders are displaced.

use super::*;
use crate::model::Kernel;
use crate::model::cells::cells_of_elements;
use crate::model::divided;
use crate::model::obstacles::obstacles;
use crate::scene::{Parameter, file::SceneFile};

const NAMES: [&str; 4] = [
    "occluders.x",
    "occluders.z",
    "occluders.yaw",
    "occluders.pitch",
];

fn small(name: &str) -> Scene {
    let mut file = SceneFile::builtin(name).unwrap();
    file.camera.pixels = [7, 6];
    if let Some(laser) = &mut file.laser {
        laser.spots.per_side = laser.spots.per_side.map(|_| 2);
    }
    Scene::new(&file, None).unwrap()
}

fn cells(scene: &Scene) -> Vec<HiddenCell> {
    let hidden = scene.hidden();
    let of = hidden.flat_map(|surface| cells_of_elements(surface, [3, 3], 2));
    of.flatten().collect()
}

fn past(scene: &Scene) -> Obstructed<'_> {
    divided::past(scene, Kernel::Physical, &obstacles(scene), 0)
}

/// Light of all pairs, pixels and spots by cells.
fn light(scene: &Scene, cells: &[HiddenCell]) -> Vec<f64> {
    let past = past(scene);
    let camera = past.camera(cells).into_iter().flatten();
    let laser = (0..past.spots()).flat_map(|l| past.laser(l, cells));
    let scale = [1.0 / camera_scale(scene), 1.0];
    let of = |k: usize| move |both: [f64; 2]| both[1] * scale[k];
    camera.map(of(0)).chain(laser.map(of(1))).collect()
}

/// So that both sides weigh alike in a comparison.
fn camera_scale(scene: &Scene) -> f64 {
    wall_point::seen(scene, 0, [0.5; 2], 1.0).weight
}

/// The same with wide spots and a wall that is rough.
fn spread(name: &str) -> Scene {
    let rough = small(name).text;
    let rough = rough.replacen("lambertian = 0.8", "oren_nayar = 0.8\nroughness = 0.4", 1);
    let wide = rough.replacen("spot_diameter = 0.0", "spot_diameter = 0.2", 1);
    Scene::from_toml(name, &wide).unwrap()
}

/// Every pair of a cell with a pixel or a spot that a shadow's edge meets, by four parameters.
fn compare(base: &Scene, names: [&str; 4]) {
    let name = &base.name;
    let each = names
        .iter()
        .flat_map(|n| Parameter::named(base, n).unwrap());
    let parameters: Vec<Parameter> = each.collect();
    let extent = base.camera.view.u().length();
    let small = |k: usize| {
        let size = if parameters[k].is_angle() {
            0.1
        } else {
            extent
        };
        0.003 * size * (k as f64 - 1.3)
    };
    let values: Vec<f64> = (0..4).map(small).collect();
    let here = base.displaced(&parameters, &values).unwrap();
    let own = cells(&here);
    let velocities: Vec<Velocity> = (0..4)
        .map(|k| base.velocity(&parameters, &values, k))
        .collect();
    let moving: Vec<&Velocity> = velocities.iter().collect();
    let past = past(&here);
    assert!(past.is_flat());
    let sweep = Sweep::new(&past, &moving).unwrap();
    let scale = 1.0 / camera_scale(&here);
    let camera = own.iter().flat_map(|cell| sweep.camera(cell));
    let camera = camera.map(|rates| rates.map(|x| x * scale));
    let laser = (0..past.spots()).flat_map(|l| sweep.laser(l, &own));
    let found: Vec<Rates> = camera.chain(laser).collect();
    for (lane, parameter) in parameters.iter().enumerate() {
        let at = |step: f64| {
            let mut values = values.clone();
            values[lane] += step;
            let there = base.displaced(&parameters, &values).unwrap();
            let mut found = light(&there, &cells(&there));
            let count = own.len() * there.camera.pixels();
            let again = camera_scale(&there) * scale;
            found[..count].iter_mut().for_each(|x| *x *= again);
            found
        };
        let spreads = ["laser.spot_diameter", "wall.roughness"].contains(&&*parameter.name);
        let h = if spreads {
            0.1
        } else if parameter.is_angle() {
            2e-3
        } else {
            1e-5 * extent
        };
        let [a, b, c, d] = [h, -h, 2.0 * h, -2.0 * h].map(at);
        let want = |i: usize| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * h);
        let largest = (0..a.len()).map(|i| want(i).abs()).fold(0.0, f64::max);
        assert!(largest > 0.0, "{name} {}: nothing moves", parameter.name);
        let mut off: Vec<f64> = (0..a.len())
            .map(|i| (found[i][lane] - want(i)).abs() / largest)
            .collect();
        off.sort_by(f64::total_cmp);
        // Where a shadow begins or ends to meet a footprint within the step.
        let few = off.len() - off.len() / 1000 - 1;
        assert!(off[few] < 1e-8, "{name} {}: {:e}", parameter.name, off[few]);
    }
}

/// By shifts and turns of all occluders together.
#[test]
fn rates_are_those_of_displaced_occluders() {
    for name in ["screen", "periscope"] {
        compare(&small(name), NAMES);
    }
}

/// By what moves hidden surfaces, walls, spots, view, camera and laser past occluders at rest.
#[test]
fn rates_are_those_of_displaced_scenes() {
    compare(
        &small("periscope"),
        ["hidden.normal", "hidden.yaw", "hinge.angle", "view.x"],
    );
    compare(
        &small("periscope"),
        ["spots.x", "spots.angle", "camera.z", "spots.y"],
    );
    compare(
        &small("periscope"),
        ["view.scale", "wall.normal", "wall.pitch", "occluders.x"],
    );
    compare(
        &small("screen"),
        ["hidden.normal", "camera.x", "view.y", "hidden.yaw"],
    );
    compare(
        &spread("periscope"),
        ["laser.spot_diameter", "wall.roughness", "spots.x", "view.x"],
    );
}
