//! The bench to scale.

use super::axis::{step, tick, ticks};
use super::key::entries;
use super::label::Labels;
use super::legend::samples;
use super::mark::{lines, names, spots, surface, view};
use super::projection::{Frame, Projection, View};
use super::svg::{
    Close, END, FAMILIES, MIDDLE, Svg, escape, ink, lettering, number, shortened, stroke,
};
use crate::scene::{Role, Scene};

/// Width of the paper, px.
const WIDTH: f64 = 1000.0;
const LEFT: f64 = 58.0;
const GAP: f64 = 74.0;
const TOP: f64 = 66.0;
/// Room for both panels.
const PANELS: [f64; 2] = [WIDTH - LEFT - GAP - 24.0, 470.0];

/// The bench from the side (along −x) and from above the wall (along −z), both to the same scale,
/// as SVG: surfaces with ticks on their front sides, the hidden surface's albedo, laser and camera
/// (an arrow with their coordinates where they are far outside), some beams, all spots, the view
/// with its pixel grid, axes in the scene's unit, a scale bar and a legend. Names from the scene
/// are escaped and every number is finite.
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
    bottom += samples(
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
         font-family=\"{FAMILIES}\">\n<title>{}</title>",
        escape(&format!("Scene {name}, drawn to scale"))
    ));
    out.rect([0.0, 0.0], [WIDTH, bottom], "fill=\"#ffffff\"");
    let bold = lettering(ink::BLACK, 17.0) + " font-weight=\"600\"";
    out.text([LEFT - 40.0, 28.0], &bold, &name);
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
    svg.rect(p.corner, size, &stroke(ink::GREY, 1.0));
    names(svg, scene, p, &mut labels);
}

fn axes(svg: &mut Svg, scene: &Scene, p: &Projection) {
    let ([left, top], [w, h]) = (p.corner, p.size());
    let bottom = top + h;
    let Frame { low, high } = p.frame;
    let grid = stroke(ink::PALE, 0.6);
    let small = lettering(ink::GREY, 11.0);
    let [middle, end] = [MIDDLE, END].map(|anchor| format!("{small} {anchor}"));
    let most = |length: f64| ((length / 45.0) as usize).clamp(2, 12);
    for t in ticks(low[0], high[0], most(w)) {
        let [x, _] = p.at_plane([t, low[1]]);
        svg.line([x, top], [x, bottom + 5.0], &grid);
        svg.text([x, bottom + 17.0], &middle, &tick(t));
    }
    for t in ticks(low[1], high[1], most(h)) {
        let [_, y] = p.at_plane([low[0], t]);
        svg.line([left - 5.0, y], [left + w, y], &grid);
        svg.text([left - 8.0, y + 4.0], &end, &tick(t));
    }
    let unit = scene.unit.symbol();
    let [across, up] = p.view.axes().map(|a| format!("{a} / {unit}"));
    let style = lettering(ink::BLACK, 12.0);
    let middle = format!("{style} {MIDDLE}");
    svg.text([left + 0.5 * w, bottom + 34.0], &middle, &across);
    svg.upright([left - 40.0, top + 0.5 * h], &middle, &up);
    let bold = format!("{style} font-weight=\"600\"");
    svg.text([left, top - 10.0], &bold, p.view.caption());
}

fn scale_bar(svg: &mut Svg, scene: &Scene, scale: f64, y: f64) {
    let Some(length) = step(200.0 / scale, 2) else {
        return;
    };
    let style = stroke(ink::BLACK, 2.0);
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
    svg.text([right + 10.0, y + 1.0], &lettering(ink::BLACK, 12.0), &text);
}

#[cfg(test)]
#[path = "drawing_tests.rs"]
mod tests;
