//! Scenes without a laser: what can shine, and what a column stands for.

use super::*;
use crate::scene::SceneError;

fn text() -> String {
    Scene::load("screen").unwrap().text
}

/// The built-in scene with one part of its text replaced.
fn with(old: &str, new: &str) -> Result<Scene, SceneError> {
    let text = text();
    assert_eq!(text.matches(old).count(), 1, "`{old}`");
    Scene::from_toml("own", &text.replace(old, new))
}

/// The picture's lines, from the key on.
fn picture() -> String {
    let text = text();
    let start = text.find("shining = {").unwrap();
    let end = start + text[start..].find("] }").unwrap() + 3;
    text[start..end].to_owned()
}

#[test]
fn what_cannot_shine_is_refused() {
    let laser = "[laser]\npower = 1.0\nwavelength = 5e-7\nposition = [0.5, 0.5, 1.0]\n\
                 spots = { layout = \"list\", points = [[0.3, 0.3]] }\n[camera]";
    let second = "[[surface]]\nname = \"second\"\nrole = \"hidden\"\nelements = [1, 1]\n\
                  rectangle = { corner = [0.0, 0.6, 0.9], u = [-0.1, 0, 0], v = [0, 0.1, 0] }\n";
    let shines = format!("{second}material = {{ shining = 0.5 }}\n[[surface]]\nname = \"plate\"");
    let reflects = shines.replace("shining", "lambertian");
    let rectangle =
        "rectangle = { corner = [0.4, 0.1, 1.0], u = [-0.4, 0.0, 0.0], v = [0.0, 0.4, 0.0] }";
    let disc = "disc = { centre = [0.2, 0.3, 1.0], normal = [0, 0, -1], radius = 0.2 }";
    let sphere = "sphere = { centre = [0.2, 0.3, 1.2], radius = 0.1, face = \"outside\" }";
    let plate = "material = { lambertian = 0.05 }";
    let picture = picture();
    let elements = format!("light = \"elements\"\n{picture}");
    let cases: [(&str, &str, [&str; 2]); 17] = [
        (
            "[camera]",
            laser,
            [
                "a laser, and a surface that shines",
                "remove the [laser] table",
            ],
        ),
        (
            plate,
            "material = { shining = 1.0 }",
            ["not the hidden surface", "role = \"hidden\""],
        ),
        (
            "name = \"plate\"",
            &shines[12..],
            ["two surfaces that shine", "keep one"],
        ),
        (
            "name = \"plate\"",
            &reflects[12..],
            ["is hidden and reflects", "one at a time"],
        ),
        (
            rectangle,
            disc,
            ["which a disc has not", "remove `falloff`"],
        ),
        (
            rectangle,
            sphere,
            ["neither a rectangle nor a disc", "let a rectangle"],
        ),
        (
            "max_bounces = 2",
            "max_bounces = 1",
            ["max_bounces is 1", "use 2 or more"],
        ),
        (
            "exitance = 100.0",
            "exitance = 0.0",
            ["an exitance of 0", "positive"],
        ),
        (
            "exitance = 100.0",
            "exitance = inf",
            ["an exitance of inf", "positive"],
        ),
        (
            "exitance = 100.0",
            "exitance = 1e80",
            ["shines with", "1e60"],
        ),
        (
            "falloff = [1.0, 2.0]",
            "falloff = [1.0, -2.0]",
            ["to the power of -2", "from 0"],
        ),
        (
            "falloff = [1.0, 2.0]",
            "falloff = [1e9, 2.0]",
            ["to the power of 1000000000", "to 1000"],
        ),
        (
            "exitance = 100.0",
            "wavelength = 0.0",
            ["wavelength 0 m", "in metres"],
        ),
        (&picture, "shining = 1.5", ["1.5", "[0, 1]"]),
        (
            &picture,
            &elements,
            ["each element shines alone", "shining = 1.0"],
        ),
        (
            &picture,
            "lambertian = 0.5",
            ["does not belong to `lambertian`", "remove"],
        ),
        (
            plate,
            "material = { mixture = [{ weight = 1.0, material = { shining = 1.0 } }] }",
            ["a part of a mixture that shines", "whole surface"],
        ),
    ];
    for (old, new, words) in cases {
        let error = with(old, new).expect_err(new).to_string();
        assert!(words.iter().all(|w| error.contains(w)), "{new}: {error}");
    }
    let dark = text().replace(
        "[surface.material]",
        "material = { lambertian = 0.5 }\n[rest]",
    );
    let error = Scene::from_toml("own", &dark[..dark.find("[rest]").unwrap()]).unwrap_err();
    assert!(error.to_string().contains("nothing gives light"), "{error}");
}

/// The columns are the picture, or each element alone; both stay on the surface when it moves.
#[test]
fn columns_lie_on_the_surface() {
    let whole = Scene::load("screen").unwrap();
    assert_eq!((whole.laser.spots.len(), whole.laser.beams().len()), (1, 0));
    // 100 W/m² on 0.4 × 0.4 m.
    assert!((whole.laser.power - 16.0).abs() < 1e-12);
    let each = with(&picture(), "light = \"elements\"\nshining = 1.0").unwrap();
    assert_eq!(each.laser.spots.len(), 64);
    assert!((each.laser.power - 0.25).abs() < 1e-12);
    let [corner, width] = each.laser.part(10).unwrap();
    let near = |a: f64, b: f64| (a - b).abs() < 1e-15;
    assert!(near(corner[0], 0.25) && near(corner[1], 0.125) && width == [0.125; 2]);
    for (j, share) in [(9, 0.0), (10, 1.0), (18, 0.0)] {
        assert_eq!(each.laser.share(10, (j, [8, 8])), share);
    }
    // A fourth of a larger element, and all of four smaller ones.
    assert_eq!(each.laser.share(10, (1, [4, 4])), 0.25);
    assert_eq!(each.laser.share(10, (2 + 4 + 16 * 2 + 2, [16, 16])), 0.0);
    assert_eq!(each.laser.share(10, (4 + 16 * 2, [16, 16])), 1.0);
    let by = crate::geometry::DVec3::new(0.1, 0.0, 0.05);
    let moved = each
        .with_moved_hidden(&glam::DAffine3::from_translation(by))
        .unwrap();
    let shift = moved.laser.spots[10].target.position - each.laser.spots[10].target.position;
    assert!((shift - by).length() < 1e-15);
    assert!(each.with_spots_at(&[[0.3, 0.3]]).is_err());
}

#[test]
fn an_unknown_picture_is_known_to_be_so() {
    let unknown = with(&picture(), "shining = \"unknown\"").unwrap();
    assert_eq!(unknown.unknown().as_deref(), Some("`monitor`"));
    let error = unknown.known().unwrap_err().to_string();
    assert!(
        error.contains("screen:32:") && error.contains("`monitor`"),
        "{error}"
    );
}
