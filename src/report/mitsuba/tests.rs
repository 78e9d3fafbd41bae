use base64::prelude::{BASE64_STANDARD, Engine};

use super::spot::SIDE;
use super::*;
use crate::geometry::Shape;
use crate::scene::material::{Material, zoo};

const BENCH: &str = include_str!("../../../scenes/bench.toml");
const BOARD: &str = "{ checkerboard = [2, 2], dark = 0.0, light = 1.0 }";

fn mitsuba_script(scene: &Scene) -> String {
    super::mitsuba_script(scene).unwrap()
}

fn scene(text: &str) -> Scene {
    Scene::from_toml("test", text).unwrap()
}

fn replaced(pairs: &[(&str, &str)]) -> Scene {
    let text = pairs.iter().fold(BENCH.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    });
    scene(&text)
}

/// What Python makes of a literal that `text` wrote: only \", \\ and \UXXXXXXXX occur.
fn read_back(literal: &str) -> String {
    let inside = literal
        .strip_prefix('"')
        .and_then(|s| s.strip_suffix('"'))
        .unwrap();
    let mut chars = inside.chars();
    let mut out = String::new();
    while let Some(c) = chars.next() {
        assert!((' '..='~').contains(&c) && c != '"', "{literal}");
        if c != '\\' {
            out.push(c);
            continue;
        }
        match chars.next() {
            Some('U') => {
                let code: String = chars.by_ref().take(8).collect();
                out.push(char::from_u32(u32::from_str_radix(&code, 16).unwrap()).unwrap());
            }
            Some(q @ ('"' | '\\')) => out.push(q),
            other => panic!("\\{other:?} in {literal}"),
        }
    }
    out
}

/// All numbers of a line, read as Python would.
fn numbers(line: &str) -> Vec<f64> {
    line.split(|c: char| !(c.is_ascii_alphanumeric() || "+-.".contains(c)))
        .filter_map(|word| word.parse().ok())
        .collect()
}

fn line<'a>(script: &'a str, start: &str) -> &'a str {
    let mut lines = script.lines().filter(|l| l.starts_with(start));
    let line = lines.next().unwrap();
    assert!(lines.next().is_none(), "{start} occurs twice");
    line
}

/// The entries of SPOTS, one line each.
fn spots(script: &str) -> Vec<&str> {
    let (_, rest) = script.split_once("\nSPOTS = [\n").unwrap();
    rest.lines().take_while(|l| *l != "]").collect()
}

#[test]
fn the_scene_stands_in_a_whole_program() {
    let script = mitsuba_script(&scene(BENCH));
    assert_eq!(line(&script, "NAME = "), "NAME = \"bench\"");
    assert!(script.starts_with("#!/usr/bin/env python3\n") && script.ends_with("main()\n"));
    assert!(script.is_ascii());
}

#[test]
fn every_part_is_there_and_every_float_reads_back() {
    let scene = replaced(&[("power = 5.0e-3", "power = 1.2345678901234567e-3")]);
    let script = mitsuba_script(&scene);
    let of = |start: &str| numbers(line(&script, start));
    assert_eq!(of("POWER"), [scene.laser.power]);
    assert_eq!(of("PINHOLE"), scene.camera.position.to_array());
    assert_eq!(of("COLUMNS"), [16.0]);
    assert_eq!(of("MAX_BOUNCES"), [3.0]);
    let view = &scene.camera.view;
    let want = [view.corner(), view.u(), view.v(), view.normal()].map(|p| p.to_array());
    assert_eq!(of("VIEW"), want.concat());
    for surface in &scene.surfaces {
        let Shape::Parallelogram(p) = &surface.shape else {
            panic!("the bench is flat")
        };
        let got = of(&format!("    {{\"name\": \"{}\"", surface.name));
        let want = [p.corner(), p.u(), p.v(), p.normal()].map(|p| p.to_array());
        assert_eq!(got[..12], want.concat());
    }
    let spots = spots(&script);
    assert_eq!(spots.len(), scene.laser.spots.len());
    for (got, want) in spots.iter().zip(&scene.laser.spots) {
        let target = want.target.position;
        let got = numbers(got);
        // The landing point is computed from the beam: equal to rounding.
        assert!((DVec3::from_slice(&got[..3]) - target).length() < 1e-13);
        assert_eq!(got[3..], [0.0, 0.0, 1.0, 0.8, 1.0]);
    }
}

#[test]
fn no_name_breaks_out_of_its_string() {
    for odd in [
        "\"\"\"\n",
        "'''\r\nimport os",
        "\\",
        "\\\"",
        "ends in \\",
        "é \u{2028}\u{202e}\u{1f52d}\u{7f}\0",
        "# ---- Camera ----\n",
    ] {
        assert_eq!(read_back(&text(odd)), odd);
    }
    let plain = mitsuba_script(&scene(BENCH));
    let odd = mitsuba_script(&replaced(&[
        ("\"bench\"", r#""\"\"\"\nexit()\n#""#),
        ("\"wall\"", r#""\"\"\"\nexit()\n# \\""#),
    ]));
    assert_eq!(plain.lines().count(), odd.lines().count());
    assert!(!odd.contains("\nexit()"));
}

#[test]
fn albedos_are_written_as_they_are() {
    let of = |albedo: &str| {
        let script = mitsuba_script(&replaced(&[(BOARD, albedo)]));
        let line = line(&script, "    {\"name\": \"object\"");
        line.split_once("\"albedo\": ").unwrap().1.to_owned()
    };
    assert_eq!(of(BOARD), "(\"checkerboard\", (2, 2, 0.0, 1.0))},");
    assert_eq!(of("0.25"), "(\"constant\", 0.25)},");
    assert_eq!(of("{ ramp = [0.1, 1] }"), "(\"ramp\", (0.1, 1.0))},");
    // One column alternates along v only: not told apart from cells, but never taken for a board of
    // two columns.
    assert_eq!(
        of("{ cells = [[0.1], [0.3]] }"),
        "(\"cells\", [[0.1], [0.3]])},"
    );
    assert_eq!(
        of("{ cells = [[0.1, 0.2, 0.1], [0.2, 0.1, 0.5]] }"),
        "(\"cells\", [[0.1, 0.2, 0.1], [0.2, 0.1, 0.5]])},"
    );
}

#[test]
fn a_cavity_keeps_its_face() {
    let script = mitsuba_script(&scene(include_str!("../../../scenes/furnace.toml")));
    let line = line(&script, "    {\"name\": \"cavity\"");
    assert!(line.contains("\"shape\": \"sphere\"") && line.contains("\"face\": \"inside\""));
    assert_eq!(numbers(line), [0.0, 0.0, 5.0, 5.0, 0.8]);
}

/// One spot of diameter 2 on the bench's wall, 0.5 from the wall's edge x = 0 or well inside.
fn wide_spot(x: f64, profile: &str, more: &str) -> String {
    let (head, rest) = BENCH.split_once("[laser.spots]").unwrap();
    let (_, tail) = rest.split_once("[camera]").unwrap();
    let head = head
        .replace("spot_diameter = 0.0", "spot_diameter = 2.0")
        .replace("profile = \"disc\"", &format!("profile = \"{profile}\""));
    let layout = format!("[laser.spots]\nlayout = \"list\"\npoints = [[{x}, 9.0]]\n");
    mitsuba_script(&scene(&format!("{head}{layout}[camera]{tail}{more}")))
}

#[test]
fn a_whole_spot_is_one_emitter_and_a_cut_one_is_many() {
    for profile in ["disc", "gaussian"] {
        let script = wide_spot(6.0, profile, "");
        let whole = spots(&script)[0];
        assert!(whole.contains(profile) && !whole.contains("point"));
        let got = numbers(whole);
        assert!((got[0] - 6.0).abs() < 1e-13 && (got[1] - 9.0).abs() < 1e-13);
        assert_eq!(got[3..], [0.0, 0.0, 1.0, 0.8, 1.0]);
    }
    // A disc of radius 1 with its centre 0.5 inside the edge: the segment beyond it is π/3 − √3/4
    // of π. Midpoints of equal areas miss it by less than the cells that the chord √3 cuts, some
    // 2·√3·SIDE/√π of SIDE².
    let script = wide_spot(0.5, "disc", "");
    let points = spots(&script)[0].matches("point").count() as f64;
    let pi = std::f64::consts::PI;
    let share = 1.0 - (pi / 3.0 - 3f64.sqrt() / 4.0) / pi;
    let cells = (SIDE * SIDE) as f64;
    let cut = 2.0 * 3f64.sqrt() * SIDE as f64 / pi.sqrt();
    assert!(points < cells && (points - share * cells).abs() < 0.5 * cut);
}

/// A plate in the beam takes the light: front up it is lit where the beam meets it, front down it
/// is black.
#[test]
fn the_beam_lands_where_it_lands() {
    let plate = |edges: &str| {
        format!(
            "[[surface]]\nname = \"plate\"\nrole = \"occluder\"\nmaterial = {{ lambertian = 0.3 }}\n\
             rectangle = {{ corner = [3.0, 7.0, 0.5], {edges} }}\n"
        )
    };
    let up = wide_spot(6.0, "disc", &plate("u = [5, 0, 0], v = [0, 4, 0]"));
    let entry = spots(&up)[0];
    assert_eq!(entry.matches("point").count(), SIDE * SIDE);
    let first = numbers(entry);
    assert_eq!(first[2..7], [0.5, 0.0, 0.0, 1.0, 0.3]);
    let down = wide_spot(6.0, "disc", &plate("u = [0, 4, 0], v = [5, 0, 0]"));
    assert_eq!(spots(&down), ["    [],"]);
}

/// What follows `"key": ` in a line, up to the next entry.
fn entry<'a>(line: &'a str, key: &str) -> &'a str {
    let (_, rest) = line.split_once(&format!("\"{key}\": ")).unwrap();
    rest.split_once(", \"").map_or(rest, |(value, _)| value)
}

fn surface_line<'a>(script: &'a str, name: &str) -> &'a str {
    line(script, &format!("    {{\"name\": \"{name}\""))
}

/// The bench and what `more` adds to it.
fn furnished(more: &str) -> Scene {
    scene(&format!("{BENCH}{more}"))
}

const BALLS: &str = r#"
[[surface]]
name = "ball"
role = "occluder"
mesh = { generate = "sphere", faces = 60, scale = 0.3, rotate = [{ axis = [1, 2, 3], angle = 40 }], translate = [9, 3, 2] }
material = { lambertian = 0.4 }

[[surface]]
name = "larger"
role = "occluder"
mesh = { generate = "sphere", faces = 60, scale = 0.5, translate = [9, 8, 2] }
sides = "two"
material = { lambertian = { cells = [[0.1, 0.3]] } }
"#;

/// Two balls, one of them with two sides, are one mesh; its decoded vertices, placed as the line
/// says, are the corners that rays meet.
#[test]
fn meshes_are_written_once_and_whole() {
    let scene = furnished(BALLS);
    let script = mitsuba_script(&scene);
    let (_, meshes) = script.split_once("\nMESHES = [\n").unwrap();
    let meshes: Vec<&str> = meshes.lines().take_while(|l| *l != "]").collect();
    let [mesh] = meshes[..] else {
        panic!("{} meshes", meshes.len())
    };
    let bytes = |key: &str| {
        let value = entry(mesh, key).trim_end_matches("},");
        BASE64_STANDARD.decode(value.trim_matches('"')).unwrap()
    };
    let chunks = |key: &str| bytes(key).chunks(4).map(|c| c.to_vec()).collect::<Vec<_>>();
    let word = |c: &Vec<u8>| <[u8; 4]>::try_from(&c[..]).unwrap();
    let positions: Vec<f64> = bytes("positions")
        .chunks(8)
        .map(|c| f64::from_le_bytes(c.try_into().unwrap()))
        .collect();
    let triangles: Vec<u32> = chunks("triangles")
        .iter()
        .map(|c| u32::from_le_bytes(word(c)))
        .collect();
    let uv: Vec<f64> = chunks("uv")
        .iter()
        .map(|c| f64::from(f32::from_le_bytes(word(c))))
        .collect();
    for name in ["ball", "larger", "larger (back)"] {
        let at = scene.surfaces.iter().position(|s| s.name == name).unwrap();
        let Shape::Instance(body) = &scene.surfaces[at].shape else {
            panic!("{name} is a mesh")
        };
        let line = surface_line(&script, name);
        assert_eq!(entry(line, "mesh").trim_end_matches("},"), "0");
        let axes = numbers(entry(line, "axes"));
        let shift = numbers(entry(line, "translation"));
        assert_eq!(triangles.len(), 3 * body.mesh().triangles().len());
        for (t, triple) in triangles.chunks(3).enumerate() {
            let corners = body.corners(t as u32);
            for (corner, k) in corners.iter().zip(triple) {
                let p = &positions[3 * *k as usize..][..3];
                let placed: Vec<f64> = (0..3)
                    .map(|d| (0..3).map(|j| p[j] * axes[3 * j + d]).sum::<f64>() + shift[d])
                    .collect();
                assert!((DVec3::from_slice(&placed) - *corner).length() < 1e-14);
            }
            let want = body.mesh().uv().unwrap()[t].as_flattened();
            let want: Vec<f64> = want.iter().map(|x| f64::from(*x as f32)).collect();
            assert_eq!(&uv[6 * t..][..6], want);
        }
    }
    assert_eq!(entry(surface_line(&script, "ball"), "face"), "\"outer\"");
    assert!(!surface_line(&script, "ball").contains("back"));
    assert_eq!(entry(surface_line(&script, "larger"), "back"), "4");
    let back = surface_line(&script, "larger (back)");
    assert_eq!(entry(back, "back_of"), "3");
    assert_eq!(entry(back, "face"), "\"inner\"");
}

#[test]
fn discs_and_panels_are_told() {
    let script = mitsuba_script(&furnished(
        r#"
[[surface]]
name = "coin"
role = "occluder"
disc = { centre = [9, 3, 2], normal = [0, 3, 4], radius = 0.7 }
material = { lambertian = 0.4 }

[[surface]]
name = "screen"
role = "occluder"
rectangle = { corner = [0, 0, 3], u = [1, 0, 0], v = [0, 1, 0] }
sides = "two"
material = { lambertian = 0.2 }
"#,
    ));
    let coin = surface_line(&script, "coin");
    let got = numbers(coin);
    assert_eq!([&got[..3], &got[6..7]].concat(), [9.0, 3.0, 2.0, 0.7]);
    assert!((DVec3::from_slice(&got[3..6]) - DVec3::new(0.0, 0.6, 0.8)).length() < 1e-15);
    // The frame of its parameters is right-handed around the normal.
    let axis = |key| DVec3::from_slice(&numbers(entry(coin, key)));
    let turned = axis("s").cross(axis("t")) - axis("normal");
    assert!(turned.length() < 1e-15);
    let panel = |name| entry(surface_line(&script, name), "panel");
    assert_eq!([panel("coin"), panel("wall")], ["False"; 2]);
    assert_eq!([panel("screen"), panel("screen (back)")], ["True"; 2]);
    let normal = |name| numbers(entry(surface_line(&script, name), "normal"));
    assert_eq!(normal("screen"), [0.0, 0.0, 1.0]);
    assert_eq!(normal("screen (back)"), [0.0, 0.0, -1.0]);
}

/// f_r along the normal: ρ R D(0)/4 = ρ ((η − 1)² + k²)/((η + 1)² + k²)/(4πα²) of metal; Σ w ρ/π of
/// a mixture of two matt surfaces.
#[test]
fn materials_are_written_with_values_to_compare() {
    let wall = |material: &str| {
        let script = mitsuba_script(&replaced(&[("{ lambertian = 0.8 }", material)]));
        let line = surface_line(&script, "wall");
        let values = line.split_once("\"brdf\": [(").map(|(_, values)| {
            let (first, _) = values.split_once(')').unwrap();
            numbers(first)
        });
        let (_, material) = line.split_once("\"material\": ").unwrap();
        let (material, _) = material.split_once(", \"albedo\"").unwrap();
        (material.to_owned(), values)
    };
    let pi = std::f64::consts::PI;
    let (matt, none) = wall("{ lambertian = 0.8 }");
    assert_eq!((matt.as_str(), none), ("(\"lambertian\",)", None));
    let (metal, values) =
        wall("{ conductor = { eta = 0.2, k = 3.9 }, roughness = 0.3, reflectance = 0.9 }");
    assert_eq!(metal, "(\"conductor\", 0.3, 0.2, 3.9)");
    let values = values.unwrap();
    assert_eq!(values[..4], [0.9, 0.0, 0.0, 0.0]);
    let reflected = (0.64 + 15.21) / (1.44 + 15.21);
    let f = 0.9 * reflected / (4.0 * pi * 0.09);
    assert!((values[4] / f - 1.0).abs() < 1e-12);
    let (mixture, values) = wall(
        "{ mixture = [{ weight = 0.5, material = { lambertian = 0.8 } }, { weight = 0.3, material = { oren_nayar = 0.4, roughness = 0.0 } }] }",
    );
    assert_eq!(
        mixture,
        "(\"mixture\", [(0.5, 0.8, (\"lambertian\",)), (0.3, 0.4, (\"oren_nayar\", 0.0))])"
    );
    let values = values.unwrap();
    assert!((values[4] * pi - 0.52).abs() < 1e-12);
    let (paint, _) = wall("{ paint = 0.8, roughness = 0.3 }");
    assert_eq!(paint, "(\"paint\", 0.3, 1.5)");
    let (paint, values) = wall("{ coated = 0.8, roughness = 0.01, ior = 1.5 }");
    let figures = numbers(&paint);
    assert_eq!(figures[..2], [0.01, 1.5]);
    // What a smooth interface of index 1.5 returns of diffuse light from inside is 0.5963
    // (Duntley's equation).
    assert!((figures[2] - 0.5963).abs() < 5e-3, "{paint}");
    assert_eq!(values.unwrap()[0], 0.8);
}

#[test]
fn what_mitsuba_cannot_have_is_refused_by_name() {
    let is_measured = |m: &Material| matches!(m, Material::Measured(_));
    let measured = zoo().into_iter().map(|(_, m)| m).find(is_measured).unwrap();
    let mut scene = scene(BENCH);
    scene.surfaces[1].material = measured;
    let refused = super::mitsuba_script(&scene).unwrap_err();
    let text = refused.to_string();
    assert!(
        text.contains("`object`") && text.contains("`coated`"),
        "{text}"
    );
}

/// On paint a spot is told as a point with its surface and parameters, and a wide one as SIDE² of
/// them.
#[test]
fn spots_on_paint_know_their_surface() {
    let paint = BENCH.replace("{ lambertian = 0.8 }", "{ coated = 0.8, roughness = 0.3 }");
    let read = scene(&paint);
    let script = mitsuba_script(&read);
    for (got, spot) in spots(&script).iter().zip(&read.laser.spots) {
        assert!(got.starts_with("    [(\"glossy\""));
        let got = numbers(got);
        let at = spot.target.position;
        assert!((DVec3::from_slice(&got[..3]) - at).length() < 1e-13);
        assert_eq!(got[3..8], [0.0, 0.0, 1.0, 1.0, 0.0]);
        assert!((got[8] - at.x / 11.5).abs() < 1e-14 && (got[9] - at.y / 15.5).abs() < 1e-14);
    }
    let wide = paint.replace("spot_diameter = 0.0", "spot_diameter = 0.5");
    let script = mitsuba_script(&scene(&wide));
    assert_eq!(spots(&script)[0].matches("glossy").count(), SIDE * SIDE);
}
