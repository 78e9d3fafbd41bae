//! Devices and names in a drawing of a scene.

use super::colour;
use crate::geometry::{DVec3, Shape};
use crate::report::axis::tick;
use crate::report::label::Labels;
use crate::report::projection::{Projection, View};
use crate::report::svg::{Close, Svg, fill, ink, stroke};
use crate::scene::{Role, Scene};

/// Devices (or arrows towards them) and the names of everything.
pub(in crate::report) fn names(svg: &mut Svg, scene: &Scene, p: &Projection, labels: &mut Labels) {
    let [laser, camera] = [scene.laser.position, scene.camera.position];
    let place = |q: DVec3| format!("({}, {}, {})", tick(q.x), tick(q.y), tick(q.z));
    let devices = if scene.laser.is_shining() {
        vec![(camera, format!("camera {}", place(camera)), ink::GREEN)]
    } else if laser == camera {
        vec![(
            laser,
            format!("laser and camera {}", place(laser)),
            ink::VERMILLION,
        )]
    } else {
        vec![
            (laser, format!("laser {}", place(laser)), ink::VERMILLION),
            (camera, format!("camera {}", place(camera)), ink::GREEN),
        ]
    };
    // A flat surface seen on edge is a line: its box would keep labels off for nothing.
    for s in scene
        .surfaces
        .iter()
        .filter(|s| s.role != Role::Relay && (p.view == View::Above || !s.shape.is_flat()))
    {
        labels.avoid(area(
            &s.shape
                .outline()
                .iter()
                .map(|q| p.at(q.position))
                .collect::<Vec<_>>(),
        ));
    }
    labels.avoid(area(&scene.camera.view.corners().map(|c| p.at(c))));
    let mut anchors = Vec::new();
    for (position, text, ink) in devices {
        let anchor = match p.exit(position) {
            None => {
                let [x, y] = p.at(position);
                let style = format!("fill=\"{ink}\" stroke=\"#ffffff\" stroke-width=\"1.2\"");
                svg.path(
                    &[[x, y - 7.0], [x + 7.0, y], [x, y + 7.0], [x - 7.0, y]],
                    Close::Yes,
                    &style,
                );
                [x, y]
            }
            Some((edge, way)) => arrow(svg, edge, way, ink),
        };
        labels.avoid([
            anchor[0] - 7.0,
            anchor[1] - 7.0,
            anchor[0] + 7.0,
            anchor[1] + 7.0,
        ]);
        anchors.push((anchor, ink, text));
    }
    for (anchor, ink, text) in anchors {
        labels.place(svg, anchor, ink, &text);
    }
    if let Some(spot) = scene.laser.beams().first() {
        labels.place(svg, p.at(spot.target.position), ink::VERMILLION, "spot 0");
    }
    for s in &scene.surfaces {
        let corner = match (&s.shape, s.role) {
            (Shape::Sphere(sphere), _) => sphere.centre + DVec3::new(0.0, 0.6, 0.8) * sphere.radius,
            (shape, Role::Relay) => shape.at([0.97, 0.08]).position,
            (shape, _) => shape.at([1.0, 0.5]).position,
        };
        let [x, y] = p.at(corner);
        let size = p.size();
        let anchor = [
            x.clamp(p.corner[0], p.corner[0] + size[0]),
            y.clamp(p.corner[1], p.corner[1] + size[1]),
        ];
        labels.place(svg, anchor, colour(s.role), &s.name);
    }
    labels.place(
        svg,
        p.at(scene.camera.view.at([1.0, 1.0]).position),
        ink::GREEN,
        "view",
    );
}

/// The smallest upright rectangle around points.
fn area(points: &[[f64; 2]]) -> [f64; 4] {
    let start = [
        f64::INFINITY,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NEG_INFINITY,
    ];
    points.iter().fold(start, |a, [x, y]| {
        [a[0].min(*x), a[1].min(*y), a[2].max(*x), a[3].max(*y)]
    })
}

/// An arrow that ends at the frame; returns where it starts.
fn arrow(svg: &mut Svg, [x, y]: [f64; 2], [dx, dy]: [f64; 2], ink: &str) -> [f64; 2] {
    let back = |t: f64, side: f64| [x - t * dx - side * dy, y - t * dy + side * dx];
    svg.line(back(26.0, 0.0), back(6.0, 0.0), &stroke(ink, 2.4));
    svg.path(
        &[back(0.0, 0.0), back(10.0, 5.0), back(10.0, -5.0)],
        Close::Yes,
        &fill(ink),
    );
    back(14.0, 0.0)
}
