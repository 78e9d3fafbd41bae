use super::super::svg::well_formed;
use super::*;

fn check(svg: &str) {
    well_formed(svg).unwrap();
    for word in ["NaN", "inf"] {
        assert!(!svg.contains(word), "{word}");
    }
    // Every number that can be told from text is finite.
    for value in svg
        .split('"')
        .skip(1)
        .step_by(2)
        .flat_map(|v| v.split([' ', 'M', 'L', 'Z', 'h', ',']))
    {
        if let Ok(x) = value.parse::<f64>() {
            assert!(x.is_finite());
        }
    }
}

fn bench_with(changes: &[(&str, &str)]) -> Scene {
    let mut text = include_str!("../../scenes/bench.toml").to_owned();
    for (old, new) in changes {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    Scene::from_toml("test", &text).unwrap()
}

#[test]
#[ignore = "slow"]
fn every_built_in_scene_is_drawn() {
    for scene in crate::scene::builtins() {
        let scene = Scene::load(scene.name).unwrap();
        let svg = bench_svg(&scene);
        check(&svg);
        // Each spot is drawn twice (halo and dot) in each of two views.
        assert_eq!(
            svg.matches("h.01").count(),
            4 * scene.laser.beams().len(),
            "{}",
            scene.name
        );
    }
}

#[test]
fn the_drawing_is_to_scale() {
    let svg = bench_svg(&Scene::load("bench").unwrap());
    // The wall's outline: x from 0 to 11.5 and y from 0 to 15.5, seen from above, as the second
    // relay surface drawn.
    let walls: Vec<Vec<f64>> = svg
        .split("<path d=\"M")
        .filter(|p| p.contains("fill=\"#808080\""))
        .map(|p| {
            let d = p.split('Z').next().unwrap();
            d.split(['L', ' ']).map(|n| n.parse().unwrap()).collect()
        })
        .collect();
    assert_eq!(walls.len(), 2);
    let [side, above] = [&walls[0], &walls[1]];
    let (width, height) = (above[2] - above[0], above[3] - above[5]);
    // Coordinates are rounded to 0.01 px, so a length of some 300 px is good to 5e-5.
    assert!(
        (width / height / (11.5 / 15.5) - 1.0).abs() < 1e-4,
        "{above:?}"
    );
    // From the side the same 15.5 in. run to the right.
    let length = side[4] - side[0];
    assert!((length / height - 1.0).abs() < 1e-4, "{side:?}");
}

#[test]
fn names_are_escaped_and_shortened() {
    let long = "w".repeat(500);
    let scene = bench_with(&[
        ("name = \"bench\"", "name = \"<&\\\"ü\\u0007\""),
        ("name = \"object\"", "name = '</text><script>'"),
        ("name = \"wall\"", &format!("name = \"{long}\"")),
    ]);
    let svg = bench_svg(&scene);
    check(&svg);
    assert!(
        svg.contains("&lt;&amp;&quot;ü\u{fffd}")
            && !svg.contains("<script")
            && !svg.contains(&long)
    );
}

#[test]
fn odd_sizes_are_drawn() {
    // A laser far away, a camera of many pixels, a texture of many cells, many spots, an occluder,
    // a sphere.
    let ball = "elements = [8, 8]\n[[surface]]\nname = \"ball\"\nrole = \"occluder\"\n\
                sphere = { centre = [9, 9, 2], radius = 0.5, face = \"outside\" }\nmaterial = { lambertian = 0.5 }";
    let scene = bench_with(&[
        (
            "position = [-20.0, 10.0, 15.0]\nspot",
            "position = [-1.0e9, 10.0, 1.0e9]\nspot",
        ),
        ("pixels = [16, 16]", "pixels = [4000, 1]"),
        ("checkerboard = [2, 2]", "checkerboard = [4000, 4000]"),
        ("layout = \"square\"", "layout = \"grid\""),
        ("per_side = 30", "per_side = 200"),
        ("stagger = [-1.0, 1.0, 0.0]", ""),
        ("elements = [8, 8]", ball),
    ]);
    let svg = bench_svg(&scene);
    check(&svg);
    assert!(svg.len() < 3_000_000, "{}", svg.len());
    assert!(
        svg.contains("40000 laser spots, 1 in 2 drawn"),
        "thinning is said"
    );
    assert!(svg.contains("<circle") && svg.contains("ball"));
}
