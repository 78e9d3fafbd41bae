//! Scenes that cannot be used: refused with cause, cure and line, before anything is written.

use crate::small_scene::{TINY, altered, bench};
use crate::workspace::Workspace;

/// Number of the only line of `text` that contains `part`, from 1.
fn line_of(text: &str, part: &str) -> usize {
    let lines: Vec<usize> = (1..)
        .zip(text.lines())
        .filter(|(_, l)| l.contains(part))
        .map(|(n, _)| n)
        .collect();
    assert_eq!(lines.len(), 1, "`{part}` in {lines:?}");
    lines[0]
}

/// The tiny bench with `old` replaced by `new` is refused by every command that reads a scene; the
/// message has the line that `blamed` stands in, and `words`.
fn refuses_altered(old: &str, new: &str, blamed: &str, words: &[&str]) {
    let text = altered(TINY.iter().filter(|(o, _)| *o != old).chain([&(old, new)]));
    let place = format!("bad.toml:{}:", line_of(&text, blamed));
    let words = [&["error: ", "cure: ", place.as_str()], words].concat();
    let workspace = Workspace::new();
    workspace.write("bad.toml", text);
    for command in [
        "run bad.toml -o out",
        "render bad.toml -o out",
        "model bad.toml -o out",
        "scene check bad.toml",
        "scene show bad.toml -o out.svg",
    ] {
        workspace.refuses(command, &words);
    }
}

#[test]
fn an_unknown_key_has_its_line_and_the_nearest_key() {
    refuses_altered(
        "aperture_area",
        "apertur_area",
        "apertur_area",
        &[
            "unknown field `apertur_area`",
            "did you mean `aperture_area`",
        ],
    );
}

#[test]
fn a_wrong_type_has_its_line() {
    let words = [
        "string \"much\"",
        "expected a number",
        "phicam help scene laser.power",
    ];
    refuses_altered("power = 5.0e-3", "power = \"much\"", "power =", &words);
    let words = ["a length", "a power", "mW", "phicam help scene laser.power"];
    refuses_altered("power = 5.0e-3", "power = \"5 mm\"", "power =", &words);
}

#[test]
fn a_negative_power() {
    let words = ["power -1 W", "positive"];
    refuses_altered("power = 5.0e-3", "power = -1.0", "power =", &words);
}

#[test]
fn numbers_as_others_write_them() {
    for (number, word) in [
        (".2", "0.2 is written so"),
        ("2.", "2.0 is written so"),
        ("1,5", "a decimal comma is a point here"),
    ] {
        let line = format!("power = {number}");
        refuses_altered("power = 5.0e-3", &line, "power =", &[word]);
    }
}

#[test]
fn an_albedo_above_one() {
    let words = ["albedo 1.2", "outside [0, 1]", "from 0 to 1"];
    refuses_altered("lambertian = 0.8", "lambertian = 1.2", "1.2", &words);
}

#[test]
fn a_surface_without_area() {
    let words = ["`object` has no area", "neither zero nor parallel"];
    refuses_altered("u = [4, 0, 0]", "u = [0, 0, 0]", "u = [0, 0, 0]", &words);
}

#[test]
fn no_pixels() {
    let (old, new) = ("pixels = [16, 16]", "pixels = [0, 16]");
    refuses_altered(old, new, "pixels =", &["0 × 16", "pixel"]);
}

#[test]
fn a_spot_off_the_wall() {
    let words = ["spot 0 at", "falls off", "extend the wall"];
    refuses_altered(
        "half_width = 3.0",
        "half_width = 9.0",
        "[laser.spots]",
        &words,
    );
}

#[test]
fn a_view_off_the_wall() {
    let words = ["the view", "does not lie on the wall", "extend the wall"];
    refuses_altered("x = [3.25, 6.5]", "x = [3.25, 16.5]", "view =", &words);
}

/// The wall in the plane of x and z: x and y name no point of it.
#[test]
fn a_wall_parallel_to_z() {
    let words = [
        "the wall `wall` stands parallel to z",
        "axes = { x = [1, 0, 0], y = [0, 0, 1] }",
    ];
    let (old, new) = ("v = [0, 15.5, 0]", "v = [0, 0, 15.5]");
    refuses_altered(old, new, "[laser.spots]", &words);
}

#[test]
fn a_camera_that_sees_the_hidden_face() {
    // In front of the leaning surface, whose front looks towards −y and −z.
    let words = [
        "camera sees the front of hidden surface `object`",
        "occluder",
    ];
    let camera = "[camera]\nposition = [-20.0, 10.0, 15.0]";
    let moved = "[camera]\nposition = [5.0, -20.0, 1.0]";
    let text = altered(&TINY);
    let object = text
        .find("name = \"object\"")
        .expect("the bench has an object");
    let line = text[..object].rfind("[[surface]]").expect("its table");
    let place = format!("bad.toml:{}:", text[..line].lines().count() + 1);
    let workspace = Workspace::new();
    workspace.write("bad.toml", altered(TINY.iter().chain([&(camera, moved)])));
    workspace.refuses(
        "run bad.toml -o out",
        &[&[place.as_str()], &words[..]].concat(),
    );
}

/// A sheet under plates with a gap of 0.06 in., as wide as half the distance between the points of
/// the sheet that are looked at; lines of sight are 0.013 in. apart there.
#[test]
fn a_camera_that_sees_the_hidden_face_through_a_gap() {
    let plate = |[from, to]: [f64; 2]| {
        format!(
            "[[surface]]\nname = \"plate{to}\"\nrole = \"occluder\"\nmaterial = {{ lambertian = 0.0 }}\n\
             rectangle = {{ corner = [{from}, -50, 12], u = [{}, 0, 0], v = [0, 100, 0] }}\n",
            to - from
        )
    };
    let object = "corner = [3, 11.350951966438567, 4.149048033561433], u = [4, 0, 0], v = [0, -2.82842712474619, 2.82842712474619]";
    let sheet = "corner = [3, 2, 10], u = [4, 0, 0], v = [0, 4, 0]";
    let camera = "[camera]\nposition = [-20.0, 10.0, 15.0]";
    let above = "[camera]\nposition = [5.0, 4.0, 20.0]";
    let scene = altered(TINY.iter().chain([&(camera, above), &(object, sheet)]));
    let workspace = Workspace::new();
    let gaps = [("shut", 5.024), ("open", 5.072)];
    for (name, end) in gaps {
        let plates = [plate([-50.0, 5.024]), plate([end, 50.0])].concat();
        workspace.write(&format!("{name}.toml"), format!("{scene}\n{plates}"));
    }
    let words = ["camera sees the front of hidden surface `object`"];
    workspace.refuses("scene check open.toml", &words);
    assert_eq!(workspace.phicam("scene check shut.toml").code, 0);
}

#[test]
fn a_scene_that_is_not_there() {
    let workspace = Workspace::new();
    for command in ["run", "render", "model"] {
        let words = ["nowhere.toml", "cannot read", "cure: ", "bench, thesis"];
        workspace.refuses(&format!("{command} nowhere.toml -o out"), &words);
    }
    workspace.refuses("scene check .", &["cannot read", "cure: "]);
}

#[test]
fn nothing_that_is_no_scene_crashes() {
    // A linear congruential generator: bytes without sense, the same every time.
    let noise: Vec<u8> = std::iter::successors(Some(1u32), |x| {
        Some(x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223))
    })
    .take(1 << 14)
    .map(|x| (x >> 24) as u8)
    .collect();
    let deep = 100_000;
    let bombs: [(&str, Vec<u8>); 8] = [
        ("random bytes", noise),
        ("nothing", Vec::new()),
        ("one NUL", vec![0]),
        (
            "half a scene",
            bench().as_bytes()[..bench().len() / 2].to_vec(),
        ),
        (
            "arrays",
            format!("a = {}{}", "[".repeat(deep), "]".repeat(deep)).into(),
        ),
        (
            "inline tables",
            format!("a = {}1{}", "{a=".repeat(deep), "}".repeat(deep)).into(),
        ),
        ("dotted keys", format!("a{} = 1", ".a".repeat(deep)).into()),
        ("dotted tables", format!("[a{}]", ".a".repeat(deep)).into()),
    ];
    let workspace = Workspace::new();
    for (what, bytes) in bombs {
        println!("{what}");
        workspace.write("bomb.toml", bytes);
        workspace.refuses("scene check bomb.toml", &["error: bomb.toml", "cure: "]);
        workspace.refuses("run bomb.toml -o out", &["error: bomb.toml", "cure: "]);
    }
}
