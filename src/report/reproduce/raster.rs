//! The same sheet as PNG, with twice the pixels.

use super::super::canvas::{Canvas, PictureError, Type};
use super::super::chart::{Axis, inks, place};
use super::sheet::{AREA, FIRST, axes, corner, legend_top, names, series, size};
use crate::study::reproduce::{Plot, Reproduction, Source};

/// Pixels of the picture per unit of the sheet.
const SCALE: f64 = 2.0;
const BLACK: [u8; 3] = [0x22; 3];
const PALE: [u8; 3] = [0xd0; 3];
/// Width of curves, px.
const WIDE: u32 = 3;

pub(super) fn png(r: &Reproduction) -> Result<Vec<u8>, PictureError> {
    let [width, height] = size(r).map(|n| (SCALE * f64::from(n)) as usize);
    let mut canvas = Canvas::new(width, height)?;
    let [computed, printed] = names(r);
    canvas.text(
        [32, 24],
        Type::Large,
        &plain(&format!("{}: {}", r.item, r.title)),
    );
    for (i, plot) in r.plots.iter().enumerate() {
        draw(&mut canvas, plot, corner(i), &computed, &printed);
    }
    let (left, top) = (FIRST[0] - 20.0, legend_top(r));
    for (i, name) in computed.iter().enumerate() {
        let y = top + 20.0 * i as f64;
        let (ink, dash) = inks(i);
        dashed(&mut canvas, &[[left, y], [left + 30.0, y]], ink, dash);
        canvas.text(pixel([left + 38.0, y - 5.0]), Type::Large, &plain(name));
    }
    for (i, name) in printed.iter().enumerate() {
        let y = top + 20.0 * (computed.len() + i) as f64;
        mark(&mut canvas, [left + 15.0, y], i);
        canvas.text(
            pixel([left + 38.0, y - 5.0]),
            Type::Large,
            &plain(&format!("{name} (published)")),
        );
    }
    canvas.png()
}

/// What the letters of the canvas cannot show, in letters that they can.
fn plain(text: &str) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let mut out = String::new();
    let mut raised = false;
    for c in text.chars() {
        let digit = digits.iter().position(|d| *d == c);
        let high = digit.is_some() || matches!(c, '⁻' | '⁺');
        if high && !raised {
            out.push('^');
        }
        raised = high;
        match (c, digit) {
            (_, Some(d)) => out += &d.to_string(),
            ('⁻', _) => out.push('-'),
            ('⁺', _) => out.push('+'),
            ('‖', _) => out += "||",
            (c, _) => out.push(c),
        }
    }
    out
}

fn pixel([x, y]: [f64; 2]) -> [usize; 2] {
    [x, y].map(|c| (SCALE * c).max(0.0).round() as usize)
}

fn draw(canvas: &mut Canvas, plot: &Plot, corner: [f64; 2], computed: &[&str], printed: &[&str]) {
    let [x, y] = axes(plot);
    let [left, top] = corner;
    let [width, height] = AREA;
    canvas.text(pixel([left, top - 24.0]), Type::Large, &plain(&plot.title));
    grid(canvas, [&x, &y], corner);
    for (i, s) in series(plot, computed).iter().enumerate() {
        let (ink, dash) = inks(i);
        let placed: Vec<Option<[f64; 2]>> = s
            .points
            .iter()
            .map(|p| place(corner, AREA, [&x, &y], p))
            .collect();
        for run in placed.split(Option::is_none) {
            let run: Vec<[f64; 2]> = run.iter().flatten().copied().collect();
            dashed(canvas, &run, ink, dash);
            for [x, y] in run {
                canvas.disc(pixel([x, y]), 4, ink);
            }
        }
    }
    for c in plot.curves.iter().filter(|c| c.source == Source::Published) {
        let which = printed.iter().position(|n| *n == c.name).unwrap_or(0);
        for p in c
            .points
            .iter()
            .filter_map(|p| place(corner, AREA, [&x, &y], p))
        {
            mark(canvas, p, which);
        }
    }
    let title = plain(&x.title);
    let half = 2.5 * title.chars().count() as f64;
    canvas.text(
        pixel([left + 0.5 * width - half, top + height + 28.0]),
        Type::Large,
        &title,
    );
    // Upwards there is no room for upright letters: the name stands above the axis, at the right end of the title's line.
    let title = format!("up: {}", plain(&y.title));
    let wide = 5.0 * title.chars().count() as f64;
    canvas.text(
        pixel([left + width - wide, top - 12.0]),
        Type::Large,
        &title,
    );
}

fn grid(canvas: &mut Canvas, [x, y]: [&Axis; 2], [left, top]: [f64; 2]) {
    let [width, height] = AREA;
    for (t, text) in x.marks() {
        let at = left + width * t;
        canvas.stroke(&[pixel([at, top]), pixel([at, top + height])], 1, PALE);
        let half = 2.5 * plain(&text).chars().count() as f64;
        canvas.text(
            pixel([at - half, top + height + 6.0]),
            Type::Large,
            &plain(&text),
        );
    }
    for (t, text) in y.marks() {
        let at = top + height * (1.0 - t);
        canvas.stroke(&[pixel([left, at]), pixel([left + width, at])], 1, PALE);
        let wide = 5.0 * plain(&text).chars().count() as f64;
        canvas.text(
            pixel([left - wide - 6.0, at - 5.0]),
            Type::Large,
            &plain(&text),
        );
    }
    let [a, b] = [pixel([left, top]), pixel([left + width, top + height])];
    canvas.stroke(&[a, [b[0], a[1]], b, [a[0], b[1]], a], 2, BLACK);
}

/// A published point.
fn mark(canvas: &mut Canvas, [x, y]: [f64; 2], which: usize) {
    let points = match which % 2 {
        0 => [
            [-6.0, 0.0],
            [0.0, -6.0],
            [6.0, 0.0],
            [0.0, 6.0],
            [-6.0, 0.0],
        ],
        _ => [
            [-5.0, -5.0],
            [5.0, -5.0],
            [5.0, 5.0],
            [-5.0, 5.0],
            [-5.0, -5.0],
        ],
    };
    canvas.stroke(&points.map(|[dx, dy]| pixel([x + dx, y + dy])), 3, BLACK);
}

/// A line through points, dashed by lengths of ink and gap; no lengths: solid.
fn dashed(canvas: &mut Canvas, points: &[[f64; 2]], ink: [u8; 3], dash: [f64; 2]) {
    if dash == [0.0, 0.0] {
        let points: Vec<[usize; 2]> = points.iter().map(|p| pixel(*p)).collect();
        canvas.stroke(&points, WIDE, ink);
        return;
    }
    let period = dash[0] + dash[1];
    let mut phase = 0.0;
    for pair in points.windows(2) {
        let [[ax, ay], [bx, by]] = [pair[0], pair[1]];
        let length = ((bx - ax) * (bx - ax) + (by - ay) * (by - ay)).sqrt();
        let mut at = 0.0;
        while at < length {
            let within = phase % period;
            let rest = if within < dash[0] {
                dash[0] - within
            } else {
                period - within
            };
            let end = (at + rest.max(1e-3)).min(length);
            if within < dash[0] {
                let point =
                    |s: f64| pixel([ax + (bx - ax) * s / length, ay + (by - ay) * s / length]);
                canvas.stroke(&[point(at), point(end)], WIDE, ink);
            }
            phase += end - at;
            at = end;
        }
    }
}
