//! `phicam scene`: list, check, show, export.

use crate::small_scene::{bench, with_points_and_surface};
use crate::workspace::Workspace;

pub(crate) const BUILT_IN: [&str; 14] = [
    "bench",
    "thesis",
    "experiment",
    "dual",
    "card",
    "satin",
    "shelf",
    "periscope",
    "screen",
    "mask",
    "masked-card",
    "corner",
    "room",
    "furnace",
];

#[test]
fn list_names_the_built_in_scenes() {
    let ended = Workspace::new().phicam("scene list").exits(0);
    let names: Vec<&str> = ended
        .stdout
        .lines()
        .filter_map(|l| l.split_whitespace().next())
        .collect();
    assert_eq!(names, BUILT_IN, "{}", ended.account());
}

#[test]
#[ignore = "slow"]
fn every_built_in_scene_is_sound() {
    let workspace = Workspace::new();
    for (name, size) in BUILT_IN.iter().zip([
        "120 spots; 16 × 16 pixels",
        "120 spots; 16 × 16 pixels",
        "252 spots; 64 × 64 pixels",
        "256 spots; 16 × 16 pixels",
        "128 spots; 72 × 48 pixels",
        "120 spots; 16 × 16 pixels",
        "120 spots; 16 × 16 pixels",
        "100 spots; 32 × 32 pixels",
        "`monitor` shines; 24 × 24 pixels",
        "100 spots; 32 × 32 pixels",
        "100 spots; 32 × 32 pixels",
        "144 spots; 32 × 32 pixels",
        "120 spots; 64 × 64 pixels",
        "3 spots; 4 × 4 pixels",
    ]) {
        let ended = workspace.phicam(&format!("scene check {name}")).exits(0);
        assert!(ended.stdout.contains(size), "{}", ended.account());
    }
}

/// What `scene check` says of the tiny scene with these spots and this surface added; exit code 0.
fn remarks(points: &str, surface: &str) -> String {
    let workspace = Workspace::new();
    workspace.write("odd.toml", with_points_and_surface(points, surface));
    workspace.phicam("scene check odd.toml").exits(0).stdout
}

/// A square of side `side` parallel to the wall, its corner at `corner`.
fn baffle(corner: [f64; 3], side: f64) -> String {
    format!(
        "\n[[surface]]\nname = \"baffle\"\nrole = \"occluder\"\nmaterial = {{ lambertian = 0.0 }}\n\
         rectangle = {{ corner = {corner:?}, u = [{side:?}, 0, 0], v = [0, {side:?}, 0] }}\n"
    )
}

#[test]
fn check_finds_nothing_in_a_plain_scene() {
    let text = remarks("[[1.0, 1.0], [9.0, 3.0]]", "");
    assert!(text.contains("nothing suspicious"), "{text}");
    // A surface that stands in nobody's way.
    let text = remarks("[[1.0, 1.0], [9.0, 3.0]]", &baffle([9.0, 0.5, 9.0], 1.0));
    assert!(
        text.contains("1 occluding") && text.contains("nothing suspicious"),
        "{text}"
    );
}

#[test]
fn check_names_a_spot_in_the_view() {
    let text = remarks("[[1.0, 1.0], [5.0, 4.0], [9.0, 3.0]]", "");
    assert!(
        text.contains("suspicious: spot 1 in the camera's view"),
        "{text}"
    );
}

/// A Gaussian spot of 1/e² radius 0.25 in. whose middle is 2.4 of these beside the view lights it
/// with e^−11.5 of its peak, by which light by way of a hidden surface is outshone; 4 are enough.
#[test]
fn check_names_a_gaussian_spot_whose_tail_is_in_the_view() {
    let workspace = Workspace::new();
    let points = "[[1.0, 1.0], [2.65, 4.0], [2.25, 4.0]]";
    workspace.write("odd.toml", with_points_and_surface(points, ""));
    let wide = "scene check odd.toml -D laser.spot_diameter=0.5 -D laser.profile=gaussian";
    let text = workspace.phicam(wide).exits(0).stdout;
    assert!(
        text.contains("suspicious: spot 1 in the camera's view"),
        "{text}"
    );
}

/// The spots of `parallel-squares` lie above the view's rectangle but on the square that the camera
/// does not look at, and those behind an occluder are out of its sight.
#[test]
fn check_names_no_spot_that_the_camera_cannot_see() {
    let workspace = Workspace::new();
    let known = include_str!("../../scenes/known/parallel-squares.toml");
    workspace.write("squares.toml", known);
    let text = workspace.phicam("scene check squares.toml").exits(0).stdout;
    assert!(!text.contains("camera's view"), "{text}");
    // Half way from the camera (−20, 10, 15) to the spot (5, 4, 0): (−7.5, 7, 7.5), off the beam
    // from (−20, 9, 15).
    let beside = with_points_and_surface("[[5.0, 4.0]]", &baffle([-7.6, 6.9, 7.5], 0.2)).replacen(
        "position = [-20.0, 10.0, 15.0]",
        "position = [-20.0, 9.0, 15.0]",
        1,
    );
    workspace.write("hidden-spot.toml", beside);
    let text = workspace
        .phicam("scene check hidden-spot.toml")
        .exits(0)
        .stdout;
    assert!(!text.contains("camera's view: "), "{text}");
}

#[test]
fn check_names_a_blocked_beam() {
    // Nine tenths of the way from the laser (−20, 10, 15) to spot 0 at (1, 1, 0) is (−1.1, 1.9,
    // 1.5).
    let text = remarks("[[1.0, 1.0], [9.0, 3.0]]", &baffle([-1.6, 1.4, 1.5], 1.0));
    assert!(
        text.contains("suspicious: the beam to spot 0 is stopped by `baffle`"),
        "{text}"
    );
    assert!(!text.contains("line of sight"), "{text}");
}

#[test]
fn check_names_a_blocked_line_of_sight() {
    // The camera (−20, 10, 15) sees the view x ∈ [3.25, 6.5], y ∈ [2.75, 6] through x ∈ [0.925,
    // 3.85], y ∈ [3.475, 6.4] of the plane z = 1.5; the pixels are 3 × 2, so a square over its
    // lower left corner hides the pixel (0, 0) alone.
    let text = remarks("[[1.0, 1.0], [9.0, 3.0]]", &baffle([0.9, 3.4, 1.5], 1.2));
    assert!(
        text.contains("suspicious: the line of sight of 1 pixels is blocked by `baffle`"),
        "{text}"
    );
    assert!(!text.contains("the beam"), "{text}");
}

#[test]
fn a_render_says_what_is_suspicious() {
    let workspace = Workspace::new();
    workspace.write("odd.toml", with_points_and_surface("[[5.0, 4.0]]", ""));
    let ended = workspace
        .phicam("render odd.toml -o out --samples 32")
        .exits(0);
    assert!(
        ended
            .stderr
            .contains("warning: spot 0 in the camera's view"),
        "{}",
        ended.account()
    );
}

#[test]
#[ignore = "slow"]
fn an_exported_scene_is_the_built_in_one() {
    let workspace = Workspace::new();
    for name in BUILT_IN {
        let text = workspace
            .phicam(&format!("scene export {name}"))
            .exits(0)
            .stdout;
        let _ = workspace
            .phicam(&format!("scene export {name} -o mine.toml --force"))
            .exits(0);
        assert_eq!(workspace.text("mine.toml"), text);
        let own = workspace.phicam("scene check mine.toml").exits(0);
        let built_in = workspace.phicam(&format!("scene check {name}")).exits(0);
        assert_eq!(own.stdout, built_in.stdout);
    }
    assert!(bench().contains("[laser.spots]"));
}

#[test]
#[ignore = "slow"]
fn show_draws_an_svg() {
    let workspace = Workspace::new();
    for name in BUILT_IN {
        let printed = workspace.phicam(&format!("-q scene show {name}")).exits(0);
        assert_eq!(printed.stderr, "", "{}", printed.account());
        let svg = printed.stdout.trim();
        assert!(
            svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\"") && svg.ends_with("</svg>"),
            "{name}: {}",
            &svg[..80.min(svg.len())]
        );
        assert_eq!(svg.matches("<svg").count(), svg.matches("</svg>").count());
        let _ = workspace
            .phicam(&format!("scene show {name} -o drawing.svg --force"))
            .exits(0);
        assert_eq!(workspace.text("drawing.svg"), printed.stdout);
    }
}
