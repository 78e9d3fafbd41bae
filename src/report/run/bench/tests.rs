use super::super::run_html;
use super::*;
use crate::lab::sample::bare;
use crate::scene::builtins;

/// The corners of the object of the bench: x from 3 to 7, at distances 5.86764 and 9.86764 from the
/// hinge at y = 15.5 (design.md, 1).
#[test]
fn the_object_of_the_bench_is_where_the_page_of_its_design_says() {
    let scene = Scene::load("bench").unwrap();
    let (bench, _) = bench(&scene);
    let value = serde_json::to_value(&bench).unwrap();
    let object = &value["surfaces"][1];
    assert!(object["name"] == "object" && object["role"] == "hidden" && object["kind"] == "patch");
    let vector =
        |v: &serde_json::Value| DVec3::from_array([0, 1, 2].map(|i| v[i].as_f64().unwrap()));
    let [corner, u, v] = ["corner", "u", "v"].map(|key| vector(&object[key]));
    let root = std::f64::consts::SQRT_2;
    for (x, d, at) in [
        (3.0, 5.86764, corner),
        (7.0, 5.86764, corner + u),
        (3.0, 9.86764, corner + v),
        (7.0, 9.86764, corner + u + v),
    ] {
        let expected = DVec3::new(x, 15.5 - d / root, d / root);
        // The distances are given to five decimals.
        assert!((at - expected).length() < 1e-5, "{at} {expected}");
    }
    let normal = DVec3::new(0.0, -1.0, -1.0) / root;
    assert!((vector(&object["normal"]) - normal).length() < 1e-12);
    assert_eq!(
        value["camera"]["corner"],
        serde_json::json!([3.25, 2.75, 0.0])
    );
    assert_eq!(value["laser"], serde_json::json!([-20.0, 10.0, 15.0]));
    assert_eq!(value["up"], serde_json::json!([0.0, 0.0, 1.0]));
    assert_eq!(value["unit"], "in");
}

/// The text of a block of a page.
fn block<'a>(html: &'a str, id: &str) -> &'a str {
    let (_, rest) = html.split_once(&format!(" id=\"{id}\"")).unwrap();
    let (_, rest) = rest.split_once('>').unwrap();
    rest.split_once("</script>").unwrap().0
}

#[test]
#[ignore = "slow"]
fn every_built_in_scene_has_a_block_of_its_size() {
    for builtin in builtins() {
        let scene = Scene::load(builtin.name).unwrap();
        let mut page = Page::new("test");
        section(&mut page, &scene);
        let html = page.html();
        let size: usize = ["bench", "bench-spots"]
            .into_iter()
            .chain(
                ["bench-vertices", "bench-triangles", "bench-coordinates"]
                    .into_iter()
                    .filter(|id| html.contains(&format!(" id=\"{id}\""))),
            )
            .map(|id| block(&html, id).len())
            .sum();
        assert!(size < 1_500_000, "{}: {size}", builtin.name);
        let value: serde_json::Value = serde_json::from_str(block(&html, "bench")).unwrap();
        let names: Vec<&str> = value["surfaces"]
            .as_array()
            .unwrap()
            .iter()
            .map(|s| s["name"].as_str().unwrap())
            .collect();
        let expected: Vec<&str> = scene.surfaces.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names, expected);
        assert_eq!(value["spots"]["count"], scene.laser.beams().len());
        assert_eq!(value["laser"].is_null(), scene.laser.is_shining());
        let shown: u64 = value["meshes"]
            .as_array()
            .unwrap()
            .iter()
            .map(|m| m["triangles"].as_u64().unwrap())
            .sum();
        assert!(shown <= MOST_TRIANGLES as u64);
        // Every number is one.
        let few = scene.camera.pixels() <= 1 << 16 && !scene.laser.is_shining();
        assert!(!(few && block(&html, "bench").contains("null")));
        for p in &scene.laser.spots {
            let [low, high] = near(&scene);
            assert!(p.target.position.cmpge(low).all() && p.target.position.cmple(high).all());
        }
    }
}

#[test]
#[ignore = "slow"]
fn a_floor_says_what_is_up() {
    let up = |name: &str| up(&Scene::load(name).unwrap());
    assert_eq!(up("corner"), DVec3::Y);
    assert_eq!(up("room"), DVec3::Y);
    assert_eq!(up("card"), DVec3::Z);
}

#[test]
#[ignore = "slow"]
fn what_is_coarser_than_the_scene_is_said() {
    let html = run_html(&bare("card"));
    assert!(html.contains("The albedo of card is averaged"));
    assert!(!run_html(&bare("bench")).contains("is averaged"));
}
