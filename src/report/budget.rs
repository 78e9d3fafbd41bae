//! The error budget as text and as a figure.

use super::axis::significant;
use super::chart::superscript;
use super::raster::FAMILIES;
use super::svg::{Close, Svg, escape, ink};
use crate::study::{ErrorBudget, Estimate, Term};

/// The budget as plain text of at most 80 columns: one line a cause, in parts of ‖Φ‖.
pub fn budget_table(budget: &ErrorBudget) -> String {
    let mut out = format!(
        "{}: what the matrix model leaves out, relative to the flux (norm over all entries)\n\n\
         {:<28} {:>10} {:>9} {:>13} {:>12}\n",
        budget.scene, "cause", "size", "± s.e.", "after scale", "of signal"
    );
    for t in &budget.terms {
        let aside = if t.in_sum { "" } else { " *" };
        out += &format!(
            "{:<28} {:>10} {:>9} {:>13} {:>12}\n",
            format!("{}{aside}", t.name),
            figure(t.size.value),
            figure(t.size.stderr),
            figure(t.after_scale.value),
            figure(t.of_signal),
        );
    }
    let c = &budget.closure;
    let both = |e: Estimate| format!("{} ± {}", significant(e.value, 3), significant(e.stderr, 2));
    out += &format!(
        "\n* not in the sum: a model without per-pixel étendue would add it\n\
         object's signal, the part of Φ that its pattern causes: {}\n\
         frames minus model: {}; sum of the parts: {}\n\
         {}: what is left, {}, is {} of {} expected from noise (z = {})\n",
        figure(budget.signal),
        both(c.total),
        both(c.sum),
        if c.closes {
            "the parts add up"
        } else {
            "the parts DO NOT ADD UP"
        },
        figure(c.rest),
        significant(
            if c.expected > 0.0 {
                c.rest / c.expected
            } else {
                0.0
            },
            3
        ),
        figure(c.expected),
        significant(c.z, 2),
    );
    out
}

fn figure(x: f64) -> String {
    if x == 0.0 {
        "0".to_owned()
    } else {
        format!("{x:.2e}")
    }
}

/// The budget as comma-separated values with a header line; figures relative to ‖Φ‖, with all digits.
pub fn budget_csv(budget: &ErrorBudget) -> String {
    let mut out =
        "cause,size,size_stderr,after_scale,after_scale_stderr,of_signal,in_sum\n".to_owned();
    for t in &budget.terms {
        let (s, a) = (t.size, t.after_scale);
        out += &format!(
            "\"{}\",{:e},{:e},{:e},{:e},{:e},{}\n",
            t.name, s.value, s.stderr, a.value, a.stderr, t.of_signal, t.in_sum
        );
    }
    out
}

const WIDTH: f64 = 860.0;
const LEFT: f64 = 230.0;
const RIGHT: f64 = 30.0;
const TOP: f64 = 92.0;
const ROW: f64 = 30.0;

/// The budget as a figure: one bar a cause on a logarithmic axis, relative to the flux, with the part that survives the best
/// single scale below it, error whiskers, and the object's signal as a line.
pub fn budget_svg(budget: &ErrorBudget) -> String {
    let shown: Vec<&Term> = budget.terms.iter().filter(|t| t.size.value > 0.0).collect();
    let values = shown
        .iter()
        .flat_map(|t| [t.size.value, t.after_scale.value]);
    let range = values.chain([budget.signal]).filter(|x| *x > 0.0);
    let (low, high) = range.fold((f64::INFINITY, 0.0f64), |(l, h), x| (l.min(x), h.max(x)));
    let (low, high) = if high > 0.0 {
        (low.max(1e-12), high)
    } else {
        (1e-6, 1.0)
    };
    let decades = (libm::log10(low).floor(), libm::log10(high).ceil());
    let decades = (decades.0, decades.1.max(decades.0 + 1.0));
    let at = |x: f64| {
        let t = (libm::log10(x.max(1e-300)) - decades.0) / (decades.1 - decades.0);
        LEFT + (WIDTH - LEFT - RIGHT) * t.clamp(0.0, 1.0)
    };
    let bottom = TOP + ROW * shown.len() as f64;
    let height = bottom + 62.0;
    let mut svg = Svg::default();
    svg.raw(&format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" font-family=\"{FAMILIES}\" \
         font-size=\"13\" role=\"img\" aria-label=\"Error budget of {}\"><rect width=\"100%\" height=\"100%\" fill=\"white\"/>",
        escape(&budget.scene)
    ));
    let bold = "font-weight=\"bold\" font-size=\"16\" fill=\"#222222\"";
    svg.text(
        [16.0, 28.0],
        bold,
        &format!("What the matrix model leaves out: {}", budget.scene),
    );
    let grey = format!("fill=\"{}\"", ink::GREY);
    for (x, colour, text) in [
        (16.0, ink::BLUE, "relative to the flux"),
        (200.0, ink::GREEN, "after the best single scale"),
    ] {
        svg.rect([x, 46.0], [12.0, 12.0], &format!("fill=\"{colour}\""));
        svg.text([x + 18.0, 57.0], &grey, text);
    }
    let dashed = format!(
        "stroke=\"{}\" stroke-width=\"1.5\" stroke-dasharray=\"5 4\"",
        ink::VERMILLION
    );
    svg.line([430.0, 52.0], [454.0, 52.0], &dashed);
    svg.text([460.0, 57.0], &grey, "the object's signal");
    svg.text([620.0, 57.0], &grey, "whiskers: ± 1 standard error");
    let mut decade = decades.0;
    while decade <= decades.1 {
        let x = at(libm::pow(10.0, decade));
        svg.line(
            [x, TOP - 8.0],
            [x, bottom],
            &format!("stroke=\"{}\"", ink::PALE),
        );
        let label = "text-anchor=\"middle\" fill=\"#6b6b6b\"";
        svg.text(
            [x, bottom + 20.0],
            label,
            &format!("10{}", superscript(decade as i32)),
        );
        decade += 1.0;
    }
    svg.text(
        [0.5 * (LEFT + WIDTH - RIGHT), bottom + 44.0],
        "text-anchor=\"middle\" fill=\"#222222\"",
        "‖term‖ / ‖Φcam‖ over all pixels and spots",
    );
    for (i, t) in shown.iter().enumerate() {
        let y = TOP + ROW * i as f64;
        let name = if t.in_sum {
            t.name.clone()
        } else {
            format!("({})", t.name)
        };
        svg.text(
            [LEFT - 10.0, y + 15.0],
            "text-anchor=\"end\" fill=\"#222222\"",
            &name,
        );
        for (e, dy, colour) in [(t.size, 2.0, ink::BLUE), (t.after_scale, 13.0, ink::GREEN)] {
            if e.value > 0.0 {
                let end = at(e.value);
                let fill = format!(
                    "fill=\"{colour}\" fill-opacity=\"{}\"",
                    if t.in_sum { 1.0 } else { 0.4 }
                );
                svg.rect([LEFT, y + dy], [(end - LEFT).max(1.0), 9.0], &fill);
                whisker(
                    &mut svg,
                    [at((e.value - e.stderr).max(0.0)), at(e.value + e.stderr)],
                    y + dy + 4.5,
                );
            }
        }
    }
    if budget.signal > 0.0 {
        svg.line(
            [at(budget.signal), TOP - 8.0],
            [at(budget.signal), bottom],
            &dashed,
        );
    }
    svg.path(
        &[[LEFT, TOP - 8.0], [LEFT, bottom], [WIDTH - RIGHT, bottom]],
        Close::No,
        "fill=\"none\" stroke=\"#222222\"",
    );
    svg.raw("</svg>\n");
    svg.text
}

fn whisker(svg: &mut Svg, [a, b]: [f64; 2], y: f64) {
    let style = "stroke=\"#222222\"";
    svg.line([a, y], [b, y], style);
    for x in [a, b] {
        svg.line([x, y - 3.0], [x, y + 3.0], style);
    }
}
