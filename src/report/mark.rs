//! Marks of the drawing: surfaces, view, lines, spots, and everything's name.

mod names;

use std::collections::BTreeMap;
use std::fmt::Write;

use super::hull::hull;
use super::label::Labels;
use super::projection::{Projection, View};
use super::svg::{Close, Svg, ink, number, stroke};
use crate::geometry::{DVec3, Shape};
use crate::scene::{Role, Scene, Surface, Texture};
pub(super) use names::names;

/// More spots than this are thinned out.
pub(super) const MOST_SPOTS: usize = 20_000;
/// A texture is drawn with at most this many cells a side.
const MOST_CELLS: usize = 64;
/// A mesh is drawn as the outline of at most this many vertices.
const MOST_VERTICES: usize = 50_000;
/// Points on a quarter of a disc's rim.
const RIM: usize = 24;

/// The ink of a role.
pub(super) fn colour(role: Role) -> &'static str {
    match role {
        Role::Relay => ink::BLACK,
        Role::Hidden => ink::BLUE,
        Role::Occluder => ink::PURPLE,
    }
}

/// A surface with ticks on its front; the hidden one from above with its albedo.
pub(super) fn surface(svg: &mut Svg, surface: &Surface, p: &Projection) {
    let ink = colour(surface.role);
    let fill = match surface.role {
        Role::Relay => "fill=\"#808080\" fill-opacity=\"0.08\"",
        Role::Hidden => "fill=\"none\"",
        Role::Occluder => "fill=\"#a5467d\" fill-opacity=\"0.15\"",
    };
    let style = format!("{fill} stroke=\"{ink}\" stroke-width=\"2.2\" stroke-linejoin=\"round\"");
    let fronts: Vec<(DVec3, DVec3)> = match &surface.shape {
        Shape::Parallelogram(patch) => {
            if surface.role == Role::Hidden && p.view == View::Above {
                texture(svg, surface, p);
            }
            svg.path(&patch.corners().map(|c| p.at(c)), Close::Yes, &style);
            let along = [1.0, 3.0, 5.0].map(|k| k / 6.0);
            let both = along.into_iter().flat_map(|t| [[t, 0.5], [0.5, t]]);
            both.map(|uv| patch.at(uv))
                .map(|s| (s.position, s.normal))
                .collect()
        }
        Shape::Sphere(sphere) => {
            svg.circle(p.at(sphere.centre), sphere.radius * p.scale, &style);
            let ways = [
                DVec3::X,
                DVec3::Y,
                DVec3::Z,
                DVec3::NEG_X,
                DVec3::NEG_Y,
                DVec3::NEG_Z,
            ];
            let rim = ways.map(|w| surface.shape.at_position(sphere.centre + w * sphere.radius));
            rim.map(|s| (s.position, s.normal)).to_vec()
        }
        Shape::Disc(disc) => {
            let edges = |k: usize| [[1.0, k as f64 / RIM as f64], [k as f64 / RIM as f64, 1.0]];
            let half = (0..RIM)
                .flat_map(edges)
                .map(|uv| disc.at(uv).position - disc.centre());
            let both = half.flat_map(|d| [disc.centre() + d, disc.centre() - d]);
            let outline = hull(both.map(|q| p.at(q)).collect());
            svg.path(&outline, Close::Yes, &style);
            vec![(disc.centre(), disc.normal())]
        }
        Shape::Instance(body) => {
            let vertices = body.mesh().positions();
            let thin = vertices.len().div_ceil(MOST_VERTICES);
            let place = |v: &DVec3| p.at(body.placement().transform_point3(*v));
            let outline = hull(vertices.iter().step_by(thin).map(place).collect());
            svg.path(&outline, Close::Yes, &style);
            Vec::new()
        }
    };
    let style = stroke(ink, 1.2);
    for (position, normal) in fronts {
        let [x, y] = p.at(position);
        let [dx, dy] = p.direction(normal);
        if dx * dx + dy * dy > 0.04 {
            svg.line([x, y], [x + 9.0 * dx, y + 9.0 * dy], &style);
        }
    }
}

/// The albedo as greys, one path for all cells of one grey.
fn texture(svg: &mut Svg, surface: &Surface, p: &Projection) {
    let cells = match &surface.albedo {
        Texture::Ramp(_) => [32, 1],
        other => other.smooth_cells().map(|n| n.min(MOST_CELLS)),
    };
    let mut greys: BTreeMap<u8, String> = BTreeMap::new();
    for iv in 0..cells[1] {
        for iu in 0..cells[0] {
            let uv = |a: f64, b: f64| {
                [
                    (iu as f64 + a) / cells[0] as f64,
                    (iv as f64 + b) / cells[1] as f64,
                ]
            };
            let grey = (255.0 * surface.albedo.albedo(uv(0.5, 0.5))).round() as u8;
            let d = greys.entry(grey).or_default();
            for (i, (a, b)) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
                .into_iter()
                .enumerate()
            {
                let [x, y] = p.at(surface.shape.at(uv(a, b)).position);
                let _ = write!(
                    d,
                    "{}{} {}",
                    if i == 0 { 'M' } else { 'L' },
                    number(x),
                    number(y)
                );
            }
            d.push('Z');
        }
    }
    for (grey, d) in greys {
        let c = format!("#{grey:02x}{grey:02x}{grey:02x}");
        svg.raw(&format!(
            "<path d=\"{d}\" fill=\"{c}\" stroke=\"{c}\" stroke-width=\"0.3\"/>"
        ));
    }
}

/// The camera's view with its pixel grid where that is not too fine.
pub(super) fn view(svg: &mut Svg, scene: &Scene, p: &Projection) {
    let camera = &scene.camera;
    let at = |a: f64, b: f64| p.at(camera.view.at([a, b]).position);
    let outline = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
    let grid = stroke(ink::GREEN, 0.4);
    if p.view == View::Above {
        let fine = |e: DVec3, n: usize| e.length() * p.scale / (n as f64) < 3.0;
        let [u, v] = [camera.view.u(), camera.view.v()];
        for i in 1..if fine(u, camera.columns) {
            0
        } else {
            camera.columns
        } {
            let t = i as f64 / camera.columns as f64;
            svg.line(at(t, 0.0), at(t, 1.0), &grid);
        }
        for j in 1..if fine(v, camera.rows) { 0 } else { camera.rows } {
            let t = j as f64 / camera.rows as f64;
            svg.line(at(0.0, t), at(1.0, t), &grid);
        }
    }
    let width = if p.view == View::Above { 1.8 } else { 10.0 };
    let style = stroke(ink::GREEN, width);
    svg.path(&outline, Close::Yes, &style);
}

/// A few beams, the edges of the camera's sight, and one way of the light around the corner.
pub(super) fn lines(svg: &mut Svg, scene: &Scene, p: &Projection) {
    let spots = scene.laser.beams();
    let beam = stroke(ink::VERMILLION, 0.9) + " stroke-opacity=\"0.6\"";
    for spot in spots.iter().step_by(spots.len().div_ceil(6).max(1)) {
        svg.line(
            p.at(scene.laser.position),
            p.at(spot.target.position),
            &beam,
        );
    }
    let sight = stroke(ink::GREEN, 0.9) + " stroke-dasharray=\"5 3\"";
    for corner in scene.camera.view.corners() {
        svg.line(p.at(scene.camera.position), p.at(corner), &sight);
    }
    let centre = scene.camera.view.at([0.5, 0.5]).position;
    if let Some((_, hidden)) = scene.hidden().next() {
        let start = spots.first().map(|spot| spot.target.position);
        let rest = [hidden.shape.at([0.5, 0.5]).position, centre];
        let way: Vec<[f64; 2]> = start.into_iter().chain(rest).map(|q| p.at(q)).collect();
        svg.path(&way, Close::No, &stroke(ink::BLUE, 1.6));
    }
}

/// All spots, as one path of dots.
pub(super) fn spots(svg: &mut Svg, scene: &Scene, p: &Projection, labels: &mut Labels) {
    let spots = scene.laser.beams();
    if spots.is_empty() {
        return;
    }
    let mut d = String::new();
    for spot in spots
        .iter()
        .step_by(spots.len().div_ceil(MOST_SPOTS).max(1))
    {
        let [x, y] = p.at(spot.target.position);
        let _ = write!(d, "M{} {}h.01", number(x), number(y));
        if spots.len() <= 1000 {
            labels.avoid([x - 2.0, y - 2.0, x + 2.0, y + 2.0]);
        }
    }
    for (stroke, width) in [("#ffffff", 6.0), (ink::VERMILLION, 4.2)] {
        svg.raw(&format!(
            "<path d=\"{d}\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{width}\" stroke-linecap=\"round\"/>"
        ));
    }
}
