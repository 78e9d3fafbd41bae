use super::*;

const BENCH: &str = include_str!("../../scenes/bench.toml");
const BOARD: &str = "{ checkerboard = [2, 2], dark = 0.0, light = 1.0 }";

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
fn the_scene_replaces_the_mark_once() {
    assert_eq!(PROGRAM.matches(MARK).count(), 1);
    let script = mitsuba_script(&replaced(&[("\"bench\"", "\"# @scene@\"")]));
    assert_eq!(line(&script, "NAME = "), "NAME = \"# @scene@\"");
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
        let want = [p.corner(), p.u(), p.v()].map(|p| p.to_array()).concat();
        assert_eq!(got[..9], want);
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
        "# @scene@\n",
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
    // One column alternates along v only: not told apart from cells, but never taken for a board of two columns.
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
    let script = mitsuba_script(&scene(include_str!("../../scenes/furnace.toml")));
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
    // A disc of radius 1 with its centre 0.5 inside the edge: the segment beyond it is π/3 − √3/4 of π. Midpoints of equal
    // areas miss it by less than the cells that the chord √3 cuts, some 2·√3·SIDE/√π of SIDE².
    let script = wide_spot(0.5, "disc", "");
    let points = spots(&script)[0].matches("point").count() as f64;
    let pi = std::f64::consts::PI;
    let share = 1.0 - (pi / 3.0 - 3f64.sqrt() / 4.0) / pi;
    let cells = (SIDE * SIDE) as f64;
    let cut = 2.0 * 3f64.sqrt() * SIDE as f64 / pi.sqrt();
    assert!(points < cells && (points - share * cells).abs() < 0.5 * cut);
}

/// A plate in the beam takes the light: front up it is lit where the beam meets it, front down it is black.
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
