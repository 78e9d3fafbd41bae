//! Scenes with absurd numbers: refused where the format has a limit, within memory where it has
//! none.

use phicam::scene::Scene;

use crate::Alone;
use crate::readers::{Outcome, SCENE};

const BENCH: &str = include_str!("../../scenes/bench.toml");

fn bench(old: &str, new: &str) -> String {
    assert!(BENCH.contains(old), "the bench has no `{old}`");
    BENCH.replacen(old, new, 1)
}

#[test]
fn absurd_sizes_are_refused_before_memory_is_taken() {
    let alone = Alone::new();
    let board = "{ checkerboard = [2, 2], dark = 0.0, light = 1.0 }";
    for (old, new) in [
        (
            "pixels = [16, 16]",
            "pixels = [1_000_000_000, 1_000_000_000]",
        ),
        ("pixels = [16, 16]", "pixels = [4294967295, 4294967295]"),
        ("per_side = 30", "per_side = 1_000_000_000"),
        ("per_side = 30", "per_side = 4294967295"),
        ("max_bounces = 3 ", "max_bounces = 4294967295 "),
        ("elements = [8, 8]", "elements = [4294967295, 4294967295]"),
        (
            board,
            "{ checkerboard = [4294967295, 4294967295], dark = 0.0, light = 1.0 }",
        ),
        (
            board,
            "{ target = \"siemens\", size = [4294967295, 4294967295] }",
        ),
        (board, "{ target = \"card\", size = [1000000, 1] }"),
        ("power = 5.0e-3", "power = 1e999"),
        ("wavelength = 632.8e-9", "wavelength = nan"),
        ("aperture_area = 0.05", "aperture_area = -inf"),
        ("u = [11.5, 0, 0]", "u = [1e300, 0, 0]"),
        ("corner = [0, 0, 0]", "corner = [nan, 0, 0]"),
        (
            "position = [-20.0, 10.0, 15.0]",
            "position = [1e308, 10.0, 15.0]",
        ),
        ("spot_diameter = 0.0", "spot_diameter = 1e-308"),
        ("aperture_area = 0.05", "aperture_area = 1e308"),
        ("power = 5.0e-3", "power = 1e308"),
        ("light = 1.0", "light = 5e-324"),
        ("v = [0, 15.5, 0]", "v = [0, 1e-200, 0]"),
    ] {
        let (outcome, taken) = alone.read(&SCENE, bench(old, new).as_bytes(), new);
        assert_eq!(outcome, Outcome::Refused, "{new}");
        assert!(taken < 8 << 20, "{new}: {taken}");
    }
}

/// What a scene may ask for is counted over all its surfaces: eight boards of 4096 × 4096 cells
/// would take a gigabyte, a hundred and twenty meshes of a million triangles more than that.
#[test]
fn sizes_are_counted_together() {
    let alone = Alone::new();
    let surface = |i: usize, rest: &str| {
        format!("[[surface]]\nname = \"{i}\"\nrole = \"occluder\"\n{rest}\n")
    };
    let board = |i: usize| {
        let rest = format!(
            "rectangle = {{ corner = [0, 0, {}], u = [1, 0, 0], v = [0, 1, 0] }}\n\
             material = {{ lambertian = {{ checkerboard = [4096, 4096], dark = 0, light = 1 }} }}",
            i + 20
        );
        surface(i, &rest)
    };
    let body = |i: usize| {
        let rest = format!(
            "mesh = {{ generate = \"box\", scale = [1, 1, {}] }}\nmaterial = {{ lambertian = 0.5 }}",
            i + 2
        );
        surface(i, &rest)
    };
    let large =
        "mesh = { generate = \"sphere\", faces = 20_000_000 }\nmaterial = { lambertian = 0.5 }";
    for (text, cause) in [
        ((0..8).map(board).collect::<String>(), "cells"),
        (body(0) + &surface(1, large), "triangles"),
    ] {
        let text = format!("{BENCH}\n{text}");
        let (outcome, taken) = alone.read(&SCENE, text.as_bytes(), cause);
        let error = Scene::from_toml("many", &text).unwrap_err();
        assert!(
            error.cause.contains(cause) && error.cure.contains("together"),
            "{error}"
        );
        assert!(
            outcome != Outcome::Accepted && taken <= 640 << 20,
            "{cause}: {taken}"
        );
    }
}
