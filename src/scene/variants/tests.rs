//! Variants of a scene against what they claim to be.

use super::*;

#[test]
fn a_checkerboard_is_that_of_a_scene_file() {
    let bench = Scene::load("bench").unwrap();
    let own = bench
        .text
        .replace("checkerboard = [2, 2]", "checkerboard = [4, 4]");
    let own = Scene::from_toml("own", &own).unwrap();
    let albedo = |scene: &Scene| scene.hidden().next().unwrap().1.albedo.clone();
    assert_eq!(albedo(&bench.with_checkerboard(4)), albedo(&own));
    assert_ne!(albedo(&bench), albedo(&own));
}

/// An unknown albedo is the hidden surface's alone, is written as it was read, and is refused
/// at its line by what needs it; painted over it is known.
#[test]
fn an_unknown_albedo_is_known_to_be_so() {
    let board = "{ checkerboard = [2, 2], dark = 0.0, light = 1.0 }";
    let bench = Scene::load("bench").unwrap().text;
    let text = bench.replace(board, "\"unknown\"");
    let scene = Scene::from_toml("own", &text).unwrap();
    assert_eq!(scene.unknown().as_deref(), Some("`object`"));
    let line = text.lines().position(|l| l.contains("unknown")).unwrap() + 1;
    let refused = scene.clone().known().unwrap_err().to_string();
    let told = refused.contains(&format!("bench:{line}:")) && refused.contains("`object`");
    assert!(told, "{refused}");
    let painted = scene.with_checkerboard(4);
    assert!(painted.unknown().is_none() && painted.known().is_ok());
    let wall = bench.replace("lambertian = 0.8", "lambertian = \"unknown\"");
    let refused = Scene::from_toml("own", &wall).unwrap_err().to_string();
    assert!(refused.contains("of a hidden surface"), "{refused}");
    let file: SceneFile = toml::from_str(&text).unwrap();
    let again = toml::to_string(&file).unwrap();
    let again = Scene::from_toml("again", &again).unwrap();
    assert_eq!(again.unknown().as_deref(), Some("`object`"));
}

/// The bench's wall ends at x = 0 and 11.5, y = 0 and 15.5; albedo 0.8.
#[test]
fn an_extended_wall_holds_spots_beyond_the_old_one() {
    let bench = Scene::load("bench").unwrap();
    let corners = [[-2.9, -2.9], [14.4, -2.9], [14.4, 18.4], [-2.9, 18.4]];
    assert!(bench.with_spots_at(&corners).is_err());
    let wide = bench.with_extended_relay(3.0).unwrap();
    let lit = wide.with_spots_at(&corners).unwrap();
    for (spot, corner) in lit.laser.spots.iter().zip(corners) {
        let at = spot.target.position;
        assert!((at.x - corner[0]).abs() < 1e-12 && (at.y - corner[1]).abs() < 1e-12);
        assert_eq!(at.z, 0.0);
    }
    assert!(wide.with_spots_at(&[[-3.1, 0.0]]).is_err());
    assert_eq!(wide.surfaces[0].albedo, Texture::Constant(0.8));
}
