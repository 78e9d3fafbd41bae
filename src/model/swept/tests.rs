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

/// A plate from x = `plate` on, half way up to the laser, before a wall.
fn past_plate(spots: &str, plate: f64) -> Scene {
    let text = format!(
        "name = \"cut\"\nunit = \"in\"\nmax_bounces = 3\n\
         [laser]\npower = 0.005\nwavelength = 632.8e-9\nposition = [0, 0, 10]\n{spots}\n\
         [camera]\nposition = [-20, 2, 10]\naperture_area = 0.05\npixels = [2, 2]\n\
         view = {{ x = [-3, -2], y = [-1, 1] }}\n\
         [[surface]]\nname = \"wall\"\nrole = \"relay\"\nmaterial = {{ lambertian = 0.8 }}\n\
         rectangle = {{ corner = [-30, -30, 0], u = [60, 0, 0], v = [0, 60, 0] }}\n\
         [[surface]]\nname = \"board\"\nrole = \"hidden\"\nelements = [2, 2]\n\
         rectangle = {{ corner = [-8, -2, 6], u = [0, 4, 0], v = [4, 0, 0] }}\n\
         material = {{ lambertian = 0.7 }}\n\
         [[surface]]\nname = \"plate\"\nrole = \"occluder\"\nsides = \"two\"\n\
         rectangle = {{ corner = [{plate}, -20, 5], u = [20, 0, 0], v = [0, 40, 0] }}\n\
         material = {{ lambertian = 0.0 }}\n"
    );
    Scene::from_toml("cut", &text).unwrap()
}

/// A plate half way up cuts the beam of a wide spot at x = e: as it moves, twice as fast moves its
/// shadow, and the light grows by that of the points of the edge,
///
/// > ∂Φ/∂θ = 2 ∫_{|y| < h} f(e, y) L(e, y) dy,
///
/// f the profile and L the light of an ideal spot with nothing in the way.
#[test]
fn the_edge_that_cuts_a_beam_takes_its_light_along() {
    let light = |scene: &Scene| {
        let extent = crate::model::Extent::FULL;
        let found = crate::model::converged(scene, Kernel::Physical, extent);
        found.unwrap().phi
    };
    let pi = std::f64::consts::PI;
    for (profile, radius, e) in [
        ("disc", 0.5, 0.2),
        ("disc", 0.5, -0.3),
        ("gaussian", 0.4, 0.1),
        // Through the middle, along an axis of the wall.
        ("disc", 0.5, 0.0),
        ("gaussian", 0.4, 0.0),
    ] {
        let is_disc = profile == "disc";
        let e: f64 = e;
        let (half, scale) = if is_disc {
            (
                (radius * radius - e * e).sqrt(),
                1.0 / (pi * radius * radius),
            )
        } else {
            (3.0 * radius, 2.0 / (pi * radius * radius))
        };
        let rule = crate::num::quadrature::Rule::gauss_legendre(24);
        let nodes: Vec<(f64, f64)> = rule.on(-half, half).collect();
        let points: Vec<[f64; 2]> = nodes.iter().map(|(y, _)| [e, *y]).collect();
        // The plate is far to the right of these.
        let ideal = past_plate(
            &format!("spots = {{ layout = \"list\", points = {points:?} }}"),
            9.0,
        );
        let ideal = light(&ideal);
        let wide = past_plate(
            &format!(
                "spot_diameter = {}\nprofile = \"{profile}\"\nspots = {{ layout = \"list\", points = [[0, 0], [-9, 1]] }}",
                2.0 * radius
            ),
            0.5 * e,
        );
        let parameters = Parameter::named(&wide, "plate.x").unwrap();
        let velocity = wide.velocity(&parameters, &[0.0], 0);
        let swept = Swept::new(&wide, None, &[velocity], Effort::USUAL);
        let swept = swept.unwrap().unwrap();
        let rate = swept.rates[0].as_ref().unwrap();
        let rate = rate.phi(&vec![0.7; swept.elements]);
        for p in 0..4 {
            let of = |(k, (y, w)): (usize, &(f64, f64))| {
                let fall = if is_disc {
                    1.0
                } else {
                    libm::exp(-2.0 * (e * e + y * y) / (radius * radius))
                };
                2.0 * w * scale * fall * ideal[(p, k)]
            };
            let want: f64 = nodes.iter().enumerate().map(of).sum();
            let off = (rate[(p, 0)] / want - 1.0).abs();
            assert!(off < 0.02, "{profile} {e} {p}: {} for {want}", rate[(p, 0)]);
            // The other beam meets nothing.
            assert!(rate[(p, 1)].abs() < 1e-9 * want);
        }
    }
}

/// The same plate before a spot that is small against all distances: with t = e/R or e/w there
/// passes ½ + (t √(1 − t²) + asin t)/π of a disc, ½ + ½ erf(√2 t) of a Gaussian, which by R or w
/// alone changes by −t times its derivative by t. All light follows.
#[test]
fn a_wider_spot_past_an_edge_passes_what_its_profile_says() {
    for (profile, t) in [
        ("disc", 0.4),
        ("disc", -0.7),
        ("gaussian", 0.3),
        ("gaussian", -0.6),
    ] {
        let (radius, t): (f64, f64) = (0.02, t);
        let spot = |place: &str| {
            format!(
                "spot_diameter = {}\nprofile = \"{profile}\"\nspots = {{ layout = \"list\", points = [{place}] }}",
                2.0 * radius
            )
        };
        let wide = past_plate(&spot("[0, 0], [-9, 1]"), 0.5 * radius * t);
        let size = Parameter::named(&wide, "laser.spot_diameter").unwrap();
        let velocity = wide.velocity(&size, &[0.0], 0);
        let swept = Swept::new(&wide, None, &[velocity], Effort::USUAL);
        let swept = swept.unwrap().unwrap();
        let rate = swept.rates[0]
            .as_ref()
            .unwrap()
            .phi(&vec![0.7; swept.elements]);
        // The plate is far to the right of that.
        let free = past_plate(&spot("[0, 0]"), 9.0);
        let extent = crate::model::Extent::FULL;
        let free = crate::model::converged(&free, Kernel::Physical, extent);
        let free = free.unwrap().phi;
        let pi = std::f64::consts::PI;
        let slope = if profile == "disc" {
            2.0 * (1.0 - t * t).sqrt() / pi
        } else {
            (2.0 / pi).sqrt() * libm::exp(-2.0 * t * t)
        };
        for p in 0..4 {
            let want = -0.01 * t * slope * free[(p, 0)];
            let off = (rate[(p, 0)] / want - 1.0).abs();
            assert!(off < 0.02, "{profile} {t} {p}: {} for {want}", rate[(p, 0)]);
        }
    }
}
