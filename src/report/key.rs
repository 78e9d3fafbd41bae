//! The key of the drawing: what its marks mean.

use super::mark::{MOST_SPOTS, colour};
use super::svg::ink;
use crate::scene::{Role, Scene};

/// Samples and texts of the legend.
pub(super) fn entries(scene: &Scene) -> Vec<(String, String)> {
    let line = |ink: &str, more: &str| {
        format!("<path d=\"M0 0L24 0\" fill=\"none\" stroke=\"{ink}\" {more}/>")
    };
    let ticked = |ink: &str| {
        format!(
            "<path d=\"M0 3L24 3M4 3L4 -5M12 3L12 -5M20 3L20 -5\" fill=\"none\" stroke=\"{ink}\" stroke-width=\"1.8\"/>"
        )
    };
    let has = |role: Role| scene.surfaces.iter().any(|s| s.role == role);
    let mut entries = Vec::new();
    for (role, text) in [
        (Role::Relay, "relay surface, ticks on its front"),
        (
            Role::Hidden,
            "hidden surface; from above: the albedo of its front, black 0, white 1",
        ),
        (Role::Occluder, "occluder"),
    ] {
        if has(role) {
            entries.push((ticked(colour(role)), text.to_owned()));
        }
    }
    let spots = scene.laser.spots.len();
    let step = spots.div_ceil(MOST_SPOTS).max(1);
    let thinned = if step > 1 {
        format!(", 1 in {step} drawn")
    } else {
        String::new()
    };
    let dot = format!(
        "<circle cx=\"12\" cy=\"0\" r=\"3\" fill=\"{}\"/>",
        ink::VERMILLION
    );
    let noun = if spots == 1 {
        "laser spot"
    } else {
        "laser spots"
    };
    entries.push((dot, format!("{spots} {noun}{thinned}")));
    entries.push((
        line(ink::VERMILLION, "stroke-width=\"1.2\""),
        "some laser beams".to_owned(),
    ));
    let c = &scene.camera;
    let square = format!(
        "<rect x=\"4\" y=\"-6\" width=\"16\" height=\"12\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\"/>",
        ink::GREEN
    );
    entries.push((
        square,
        format!("view of the camera, {} × {} pixels", c.columns, c.rows),
    ));
    entries.push((
        line(ink::GREEN, "stroke-width=\"1.2\" stroke-dasharray=\"5 3\""),
        "line of sight".to_owned(),
    ));
    if has(Role::Hidden) {
        let text = "one way of the light: spot, object, wall in view";
        entries.push((line(ink::BLUE, "stroke-width=\"1.6\""), text.to_owned()));
    }
    entries
}
