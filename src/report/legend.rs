//! Legends: what colours, lines and marks mean.

use super::axis::{tick, ticks};
use super::colour::{Law, NOT_A_NUMBER, Rgb, Scale};
use super::encode::PictureError;
use super::label::{CHARACTER, SIZE};
use super::panel::Panel;
use super::svg::{MIDDLE, Svg, ink, lettering, number, stroke};
use crate::num::digits::{scientific, significant};

/// Colours of a bar.
const STEPS: usize = 256;

/// Lines and marks with their names, in rows of `width`: each a sample of up to 30 px and its text.
/// Returns the height.
pub(super) fn samples(
    svg: &mut Svg,
    [x, y]: [f64; 2],
    width: f64,
    entries: &[(String, String)],
) -> f64 {
    let (mut left, mut top) = (0.0, 0.0);
    for (sample, text) in entries {
        let needed = 38.0 + CHARACTER * text.chars().count() as f64 + 14.0;
        if left > 0.0 && left + needed > width {
            left = 0.0;
            top += 22.0;
        }
        let (sx, sy) = (number(x + left), number(y + top));
        svg.raw(&format!(
            "<g transform=\"translate({sx} {sy})\">{sample}</g>"
        ));
        let style = lettering(ink::BLACK, SIZE);
        svg.text([x + left + 37.0, y + top + 4.0], &style, text);
        left += needed;
    }
    top + 22.0
}

/// The colours of a scale with its ticks and, to the right, the name of its unit. Ink and type are
/// those of the text around it, in `type_size`.
pub(super) fn colour_bar(
    svg: &mut Svg,
    [x, y]: [f64; 2],
    [w, h]: [f64; 2],
    type_size: f64,
    scale: &Scale,
    unit: &str,
) -> Result<(), PictureError> {
    let values = (0..STEPS).map(|i| scale.value(i as f64 / (STEPS - 1) as f64));
    let colours = Panel::elements("", [STEPS, 1], values.collect());
    let line = stroke("currentColor", type_size / 15.0);
    svg.image([x, y], [w, h], &colours.data_uri(scale)?);
    svg.rect([x, y], [w, h], &line);
    for (share, text) in bar_ticks(scale) {
        let (across, below) = (x + share * w, y + h);
        svg.line([across, below], [across, below + 0.3 * type_size], &line);
        let place = [across, below + 1.4 * type_size];
        svg.text(place, MIDDLE, &text);
    }
    let middle = y + 0.5 * h + 0.35 * type_size;
    svg.text([x + w + 1.3 * type_size, middle], "", unit);
    Ok(())
}

/// Where along the bar there is a tick, and its text: 0, 0.5, 1 on the grey scale, both ends and
/// round values between on the others.
pub(super) fn bar_ticks(scale: &Scale) -> Vec<(f64, String)> {
    let [low, high] = scale.range();
    let along = |x: f64| scale.share(x);
    if *scale == Scale::reflectance() {
        return [0.0, 0.5, 1.0].map(|x| (along(x), tick(x))).to_vec();
    }
    let round = match scale.law() {
        Law::Linear => ticks(low, high, 3),
        Law::Logarithmic => ticks(libm::log10(low), libm::log10(high), 3)
            .into_iter()
            .filter(|x| x.fract() == 0.0)
            .map(libm::exp10)
            .collect(),
    };
    let inner = round
        .into_iter()
        .filter(|x| (0.3..0.7).contains(&along(*x)));
    let inner: Vec<f64> = inner.take(1).collect();
    let ends = [(0.0, low), (1.0, high)].map(|(t, x)| (t, scientific(&significant(x, 3))));
    let mut all = inner
        .into_iter()
        .map(|x| (along(x), scientific(&tick(x))))
        .collect::<Vec<_>>();
    all.extend(ends);
    all
}

/// What the colours outside the scale mean and how many values have them, where there are any: "3
/// of 256 values above 1.2e-9 W". Of the values that are missing or not a number `infinite` ones
/// are infinite.
pub(super) fn outside(
    scale: &Scale,
    panels: &[Panel],
    unit: &str,
    infinite: usize,
) -> Vec<(Rgb, String)> {
    let [low, high] = scale.range();
    let values = || panels.iter().flat_map(|p| p.values.iter());
    let all: usize = panels.iter().map(|p| p.size[0] * p.size[1]).sum();
    let count = |f: &dyn Fn(f64) -> bool| values().filter(|v| f(**v)).count();
    let limit = |x: f64| {
        let fixed = *scale == Scale::reflectance();
        let text = if fixed { tick(x) } else { significant(x, 3) };
        format!("{text} {unit}").trim_end().to_owned()
    };
    let clipped = |side: &str, x: f64| format!("{side} {}, clipped in the picture only", limit(x));
    let strange = all.saturating_sub(count(&|v| !v.is_nan()));
    let strangers = match infinite {
        0 => "not a number".to_owned(),
        n if n == strange => "infinite".to_owned(),
        n => format!("not finite ({n} infinite, {} not a number)", strange - n),
    };
    let said = |(colour, name): (Rgb, &str), n: usize, what: String| {
        (n > 0).then(|| (colour, format!("{name}: {n} of {all} values {what}")))
    };
    let lines = [
        said(scale.below(), count(&|v| v < low), clipped("below", low)),
        said(scale.above(), count(&|v| v > high), clipped("above", high)),
        said(NOT_A_NUMBER, strange, strangers),
    ];
    lines.into_iter().flatten().collect()
}
