//! The bench to scale.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::axis::{step, tick, ticks};
use super::label::{Labels, legend};
use super::projection::{Frame, Projection, View};
use super::svg::{Close, Svg, escape, ink, number, shortened};
use crate::geometry::{DVec3, Shape};
use crate::scene::{Role, Scene, Surface};

/// Width of the paper, px.
const WIDTH: f64 = 1000.0;
const LEFT: f64 = 58.0;
const GAP: f64 = 74.0;
const TOP: f64 = 66.0;
/// Room for both panels.
const PANELS: [f64; 2] = [WIDTH - LEFT - GAP - 24.0, 470.0];
/// More spots than this are thinned out.
const MOST_SPOTS: usize = 20_000;
/// A texture is drawn with at most this many cells a side.
const MOST_CELLS: usize = 64;

/// The bench from the side (along −x) and from above the wall (along −z), both to the same scale, as SVG: surfaces with
/// ticks on their front sides, the hidden surface's albedo, laser and camera (an arrow with their coordinates where they
/// are far outside), some beams, all spots, the view with its pixel grid, axes in the scene's unit, a scale bar and a
/// legend. Names from the scene are escaped and every number is finite.
pub fn bench_svg(scene: &Scene) -> String {
    let frames = [View::Side, View::Above].map(|view| (view, Frame::of(scene, view)));
    let [a, b] = [frames[0].1.extent(), frames[1].1.extent()];
    let scale = (PANELS[0] / (a[0] + b[0])).min(PANELS[1] / a[1].max(b[1]));
    let height = a[1].max(b[1]) * scale;
    let mut left = LEFT + 0.5 * (PANELS[0] - (a[0] + b[0]) * scale);
    let mut svg = Svg::default();
    for (k, (view, frame)) in frames.into_iter().enumerate() {
        let [w, h] = frame.extent().map(|e| e * scale);
        let corner = [left, TOP + height - h];
        let projection = Projection {
            view,
            frame,
            corner,
            scale,
        };
        panel(&mut svg, scene, &projection, k);
        left += w + GAP;
    }
    let mut bottom = TOP + height + 58.0;
    scale_bar(&mut svg, scene, scale, bottom);
    bottom += 26.0;
    bottom += legend(
        &mut svg,
        [LEFT, bottom],
        WIDTH - LEFT - 20.0,
        &entries(scene),
    );
    let (w, h) = (number(WIDTH), number(bottom));
    let name = shortened(&scene.name, 60);
    let mut out = Svg::default();
    out.raw(&format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" height=\"{h}\" role=\"img\" \
         font-family=\"system-ui, 'DejaVu Sans', Arial, sans-serif\">\n<title>{}</title>",
        escape(&format!("Scene {name}, drawn to scale"))
    ));
    out.rect([0.0, 0.0], [WIDTH, bottom], "fill=\"#ffffff\"");
    let style = format!(
        "fill=\"{}\" font-size=\"17\" font-weight=\"600\"",
        ink::BLACK
    );
    out.text([LEFT - 40.0, 28.0], &style, &name);
    out.text.push_str(&svg.text);
    out.raw("</svg>");
    out.text
}

/// One view: what it shows is cut at its frame, its labels are not.
fn panel(svg: &mut Svg, scene: &Scene, p: &Projection, k: usize) {
    let size = p.size();
    axes(svg, scene, p);
    svg.raw(&format!("<clipPath id=\"frame-{k}\">"));
    svg.rect(p.corner, size, "");
    svg.raw(&format!("</clipPath>\n<g clip-path=\"url(#frame-{k})\">"));
    let mut labels = Labels::new(p.corner, size);
    for role in [Role::Relay, Role::Hidden, Role::Occluder] {
        if role == Role::Hidden {
            view(svg, scene, p);
            lines(svg, scene, p);
        }
        for s in scene.surfaces.iter().filter(|s| s.role == role) {
            surface(svg, s, p);
        }
    }
    spots(svg, scene, p, &mut labels);
    svg.raw("</g>");
    svg.rect(
        p.corner,
        size,
        &format!("fill=\"none\" stroke=\"{}\"", ink::GREY),
    );
    names(svg, scene, p, &mut labels);
}

fn colour(role: Role) -> &'static str {
    match role {
        Role::Relay => ink::BLACK,
        Role::Hidden => ink::BLUE,
        Role::Occluder => ink::PURPLE,
    }
}

fn surface(svg: &mut Svg, surface: &Surface, p: &Projection) {
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
    };
    let style = format!("fill=\"none\" stroke=\"{ink}\" stroke-width=\"1.2\"");
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
        crate::scene::Texture::Ramp(_) => [32, 1],
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
fn view(svg: &mut Svg, scene: &Scene, p: &Projection) {
    let camera = &scene.camera;
    let at = |a: f64, b: f64| p.at(camera.view.at([a, b]).position);
    let outline = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
    let grid = format!(
        "fill=\"none\" stroke=\"{}\" stroke-width=\"0.4\"",
        ink::GREEN
    );
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
    let width = if p.view == View::Above { 1.8 } else { 5.0 };
    let style = format!(
        "fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\"",
        ink::GREEN
    );
    svg.path(&outline, Close::Yes, &style);
}

/// A few beams, the edges of the camera's sight, and one way of the light around the corner.
fn lines(svg: &mut Svg, scene: &Scene, p: &Projection) {
    let spots = &scene.laser.spots;
    let beam = format!(
        "fill=\"none\" stroke=\"{}\" stroke-width=\"0.9\" stroke-opacity=\"0.6\"",
        ink::VERMILLION
    );
    for spot in spots.iter().step_by(spots.len().div_ceil(6).max(1)) {
        svg.line(
            p.at(scene.laser.position),
            p.at(spot.target.position),
            &beam,
        );
    }
    let sight = format!(
        "fill=\"none\" stroke=\"{}\" stroke-width=\"0.9\" stroke-dasharray=\"5 3\"",
        ink::GREEN
    );
    for corner in scene.camera.view.corners() {
        svg.line(p.at(scene.camera.position), p.at(corner), &sight);
    }
    let centre = scene.camera.view.at([0.5, 0.5]).position;
    if let (Some(spot), Some((_, hidden))) = (spots.first(), scene.hidden().next()) {
        let way = [
            spot.target.position,
            hidden.shape.at([0.5, 0.5]).position,
            centre,
        ]
        .map(|q| p.at(q));
        svg.path(
            &way,
            Close::No,
            &format!(
                "fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"",
                ink::BLUE
            ),
        );
    }
}

fn spots(svg: &mut Svg, scene: &Scene, p: &Projection, labels: &mut Labels) {
    let spots = &scene.laser.spots;
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

/// Devices (or arrows towards them) and the names of everything.
fn names(svg: &mut Svg, scene: &Scene, p: &Projection, labels: &mut Labels) {
    let [laser, camera] = [scene.laser.position, scene.camera.position];
    let place = |q: DVec3| format!("({}, {}, {})", tick(q.x), tick(q.y), tick(q.z));
    let devices = if laser == camera {
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
        labels.place(svg, anchor, ink, &text);
    }
    if let Some(spot) = scene.laser.spots.first() {
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

/// An arrow that ends at the frame; returns where it starts.
fn arrow(svg: &mut Svg, [x, y]: [f64; 2], [dx, dy]: [f64; 2], ink: &str) -> [f64; 2] {
    let back = |t: f64, side: f64| [x - t * dx - side * dy, y - t * dy + side * dx];
    svg.line(
        back(26.0, 0.0),
        back(6.0, 0.0),
        &format!("stroke=\"{ink}\" stroke-width=\"2.4\""),
    );
    svg.path(
        &[back(0.0, 0.0), back(10.0, 5.0), back(10.0, -5.0)],
        Close::Yes,
        &format!("fill=\"{ink}\""),
    );
    back(14.0, 0.0)
}

fn axes(svg: &mut Svg, scene: &Scene, p: &Projection) {
    let ([left, top], [w, h]) = (p.corner, p.size());
    let bottom = top + h;
    let Frame { low, high } = p.frame;
    let grid = format!("stroke=\"{}\" stroke-width=\"0.6\"", ink::PALE);
    let text = format!("fill=\"{}\" font-size=\"11\"", ink::GREY);
    let most = |length: f64| ((length / 45.0) as usize).clamp(2, 12);
    for t in ticks(low[0], high[0], most(w)) {
        let [x, _] = p.at_plane([t, low[1]]);
        svg.line([x, top], [x, bottom + 5.0], &grid);
        svg.text(
            [x, bottom + 17.0],
            &format!("{text} text-anchor=\"middle\""),
            &tick(t),
        );
    }
    for t in ticks(low[1], high[1], most(h)) {
        let [_, y] = p.at_plane([low[0], t]);
        svg.line([left - 5.0, y], [left + w, y], &grid);
        svg.text(
            [left - 8.0, y + 4.0],
            &format!("{text} text-anchor=\"end\""),
            &tick(t),
        );
    }
    let [across, up] = p
        .view
        .axes()
        .map(|a| format!("{a} / {}", scene.unit.symbol()));
    let style = format!("fill=\"{}\" font-size=\"12\"", ink::BLACK);
    svg.text(
        [left + 0.5 * w, bottom + 34.0],
        &format!("{style} text-anchor=\"middle\""),
        &across,
    );
    let (x, y) = (left - 40.0, top + 0.5 * h);
    let turn = format!(
        "{style} text-anchor=\"middle\" transform=\"rotate(-90 {} {})\"",
        number(x),
        number(y)
    );
    svg.text([x, y], &turn, &up);
    svg.text(
        [left, top - 10.0],
        &format!("{style} font-weight=\"600\""),
        p.view.caption(),
    );
}

fn scale_bar(svg: &mut Svg, scene: &Scene, scale: f64, y: f64) {
    let Some(length) = step(200.0 / scale, 2) else {
        return;
    };
    let style = format!("fill=\"none\" stroke=\"{}\" stroke-width=\"2\"", ink::BLACK);
    let right = LEFT + length * scale;
    svg.path(
        &[[LEFT, y - 5.0], [LEFT, y], [right, y], [right, y - 5.0]],
        Close::No,
        &style,
    );
    let text = format!(
        "{} {}, both views to the same scale",
        tick(length),
        scene.unit.symbol()
    );
    svg.text(
        [right + 10.0, y + 1.0],
        &format!("fill=\"{}\" font-size=\"12\"", ink::BLACK),
        &text,
    );
}

/// Samples and texts of the legend.
fn entries(scene: &Scene) -> Vec<(String, String)> {
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

#[cfg(test)]
#[path = "drawing_tests.rs"]
mod tests;
