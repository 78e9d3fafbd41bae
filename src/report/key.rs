//! The key of the drawing: what its marks mean.

use super::mark::{MOST_SPOTS, colour};
use super::svg::{Svg, fill, ink, stroke};
use crate::scene::{Role, Scene};

/// Samples and texts of the legend.
pub(super) fn entries(scene: &Scene) -> Vec<(String, String)> {
    let drawn = |draw: &dyn Fn(&mut Svg)| {
        let mut svg = Svg::default();
        draw(&mut svg);
        svg.text
    };
    let line = |style: &str| drawn(&|svg| svg.line([0.0, 0.0], [24.0, 0.0], style));
    let ticked = |ink: &str| {
        let style = stroke(ink, 1.8);
        drawn(&|svg| {
            svg.line([0.0, 3.0], [24.0, 3.0], &style);
            for x in [4.0, 12.0, 20.0] {
                svg.line([x, 3.0], [x, -5.0], &style);
            }
        })
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
    let spots = scene.laser.beams().len();
    let step = spots.div_ceil(MOST_SPOTS).max(1);
    let thinned = if step > 1 {
        format!(", 1 in {step} drawn")
    } else {
        String::new()
    };
    let dot = drawn(&|svg| svg.circle([12.0, 0.0], 3.0, &fill(ink::VERMILLION)));
    let noun = if spots == 1 {
        "laser spot"
    } else {
        "laser spots"
    };
    if spots > 0 {
        entries.push((dot, format!("{spots} {noun}{thinned}")));
        entries.push((
            line(&stroke(ink::VERMILLION, 1.2)),
            "some laser beams".to_owned(),
        ));
    }
    let c = &scene.camera;
    let square = drawn(&|svg| svg.rect([4.0, -6.0], [16.0, 12.0], &stroke(ink::GREEN, 1.8)));
    entries.push((
        square,
        format!("view of the camera, {} × {} pixels", c.columns, c.rows),
    ));
    entries.push((
        line(&(stroke(ink::GREEN, 1.2) + " stroke-dasharray=\"5 3\"")),
        "line of sight".to_owned(),
    ));
    if has(Role::Hidden) {
        let text = "one light path: spot, object, wall in view";
        entries.push((line(&stroke(ink::BLUE, 1.6)), text.to_owned()));
    }
    entries
}
