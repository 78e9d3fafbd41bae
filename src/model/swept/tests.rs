use super::*;
use crate::geometry::Facing;
use crate::model::Effort;
use crate::scene::file::{RectangleTable, SceneFile, SphereTable};
use crate::scene::{Parameter, Role};

/// Rates of all elements, in the frames of the first and the last spot, against displaced scenes.
fn compare(name: &str, names: &[&str], limit: f64) {
    let mut file = SceneFile::builtin(name).unwrap();
    file.camera.pixels = [9, 8];
    if let Some(laser) = &mut file.laser {
        laser.spots.per_side = laser.spots.per_side.map(|_| 2);
    }
    let base = Scene::new(&file, None).unwrap();
    let each = names
        .iter()
        .flat_map(|n| Parameter::named(&base, n).unwrap());
    let parameters: Vec<Parameter> = each.collect();
    let values = vec![0.0; parameters.len()];
    let velocity = |k| base.velocity(&parameters, &values, k);
    let velocities: Vec<Velocity> = (0..parameters.len()).map(velocity).collect();
    let elements = Some([4, 3]);
    let swept = Swept::new(&base, elements, &velocities, Effort::USUAL)
        .unwrap()
        .unwrap();
    let extent = base.camera.view.u().length();
    for (k, parameter) in parameters.iter().enumerate() {
        let rate = swept.rates[k].as_ref().expect("flat figures alone");
        let h = 1e-3 * if parameter.is_angle() { 10.0 } else { extent };
        let at = |step: f64| {
            let mut values = values.clone();
            values[k] += step;
            let scene = base.displaced(&parameters, &values).unwrap();
            Swept::new(&scene, elements, &[], Effort::USUAL)
                .unwrap()
                .unwrap()
                .terms
        };
        let (more, less) = (at(h), at(-h));
        for l in [0, base.laser.spots.len() - 1] {
            let of = |terms: &Terms| terms.frame(l, swept.elements);
            let want = (of(&more) - of(&less)) / (2.0 * h);
            let off = (of(rate) - &want).norm() / want.norm();
            assert!(off < limit, "{name} {} {l}: {off:e}", parameter.name);
        }
    }
}

#[test]
fn rates_are_those_of_displaced_occluders() {
    compare(
        "screen",
        &["occluders.x", "occluders.z", "occluders.yaw"],
        0.01,
    );
    compare("periscope", &["occluders.x", "occluders.normal"], 0.01);
    compare(
        "shelf",
        &["board.x", "rod.z", "occluders.y", "board.normal", "rod.yaw"],
        0.03,
    );
}

/// Of what moves all else past them.
#[test]
fn rates_are_those_of_displaced_scenes() {
    compare("screen", &["hidden.normal", "view.x", "camera.z"], 0.01);
    compare(
        "periscope",
        &[
            "hidden.normal",
            "hidden.yaw",
            "hinge.angle",
            "spots.x",
            "view.scale",
            "wall.pitch",
        ],
        0.01,
    );
    compare(
        "shelf",
        &["hidden.yaw", "spots.y", "camera.x", "view.y"],
        0.03,
    );
}

/// What moves occluders alone is told, for what they do not shade is at rest then.
#[test]
fn what_moves_occluders_alone_is_known() {
    let base = Scene::load("screen").unwrap();
    let parameters: Vec<Parameter> = ["occluders.x", "hidden.normal", "view.x"]
        .iter()
        .flat_map(|n| Parameter::named(&base, n).unwrap())
        .collect();
    let velocity = |k| base.velocity(&parameters, &[0.0; 3], k);
    let moves: Vec<bool> = (0..3)
        .map(|k| crate::model::sweep::moves_figures_alone(&base, &velocity(k)))
        .collect();
    assert_eq!(moves, [true, false, false]);
}

/// What a spot lights of a surface that is not flat is asked ray by ray, and such light has no rate
/// of its own: `calibrate` then takes differences.
#[test]
fn a_hidden_surface_that_is_not_flat_has_no_rates_here() {
    let mut file = SceneFile::builtin("periscope").unwrap();
    file.camera.pixels = [3, 3];
    if let Some(laser) = &mut file.laser {
        laser.spots.per_side = laser.spots.per_side.map(|_| 2);
    }
    let rates = |file: &SceneFile| {
        let scene = Scene::new(file, None).unwrap();
        let parameters = Parameter::named(&scene, "occluders.x").unwrap();
        let velocity = scene.velocity(&parameters, &[0.0], 0);
        let swept = Swept::new(&scene, Some([2, 2]), &[velocity], Effort::coarse(0.5)).unwrap();
        swept.unwrap().rates[0].is_some()
    };
    assert!(rates(&file));
    // A ball, and between it and the camera a second plate, for cameras must not see it.
    let mut occluders = file.surface.iter().filter(|s| s.role == Role::Occluder);
    let mut blind = occluders.next().unwrap().clone();
    blind.name = "blind".to_owned();
    blind.rectangle = Some(RectangleTable {
        corner: [2.5, 7.0, 4.0],
        u: [0.0, 6.0, 0.0],
        v: [0.0, 0.0, 5.0],
    });
    let mut surfaces = file.surface.iter_mut();
    let hidden = surfaces.find(|s| s.role == Role::Hidden).unwrap();
    hidden.rectangle = None;
    hidden.sphere = Some(SphereTable {
        centre: [5.0, 10.0, 5.5],
        radius: 1.0,
        face: Facing::Outside,
    });
    file.surface.push(blind);
    assert!(!rates(&file));
}

/// Nor one in cells without corners: a mesh by its texture, which stands in its own way nowhere.
#[test]
fn a_hidden_mesh_in_cells_has_no_rates_here() {
    let own = "rectangle = { corner = [3, 11.350951966438567, 4.149048033561433], u = [4, 0, 0], v = [0, -2.82842712474619, 2.82842712474619] }";
    let ball =
        "mesh = { generate = \"sphere\", faces = 320, scale = 1.0, translate = [5, 10, 5.5] }";
    // A second plate, for cameras must not see it.
    let blind = "\n[[surface]]\nname = \"blind\"\nrole = \"occluder\"\nmaterial = { lambertian = 0.0 }\n\
        rectangle = { corner = [2.5, 7, 4], u = [0, 6, 0], v = [0, 0, 5] }\n";
    let text = Scene::load("periscope").unwrap().text;
    let text = text
        .replacen("pixels = [32, 32]", "pixels = [3, 3]", 1)
        .replacen("per_side = 25", "per_side = 2", 1);
    let rates = |text: &str| {
        let scene = Scene::from_toml("mesh", text).unwrap();
        let parameters = Parameter::named(&scene, "occluders.x").unwrap();
        let velocity = scene.velocity(&parameters, &[0.0], 0);
        let swept = Swept::new(&scene, Some([2, 2]), &[velocity], Effort::coarse(0.5)).unwrap();
        swept.unwrap().rates[0].is_some()
    };
    assert!(rates(&text));
    let with_ball = text.replacen(own, ball, 1) + blind;
    assert!(with_ball.contains(ball));
    assert!(!rates(&with_ball));
}
