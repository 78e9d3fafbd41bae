//! Figures of a page: a matrix as an inline SVG with axes, and the legend of a scale.

use super::colour::Scale;
use super::legend::{colour_bar, outside};
use super::panel::Panel;
use super::svg::{END, MIDDLE, Svg, escape, number};

/// Length of a picture's longer side on the page, px.
const SIDE: f64 = 240.0;

/// Size of type, px.
const TYPE: f64 = 11.0;
const FRAME: &str = "fill=\"none\" stroke=\"currentColor\" stroke-opacity=\"0.5\"";

/// Frames and recoveries are shown with at most this many pixels a side, Φcam with twice as many. A
/// picture of that size that cannot be compressed takes 0.26 MB (Φcam 1.05 MB): 3 frames, 3 maps
/// and 16 recoveries stay below 10 MB.
pub(super) const MOST: usize = 256;

/// How a matrix that is too large for the page is made smaller; the data stay as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reduction {
    /// The mean of each block.
    Mean,
    /// The middle entry of each block.
    Pick,
}

/// A panel of at most `most` entries a side made from `value(iu, iv)`, and what had to be done to
/// the matrix.
pub(super) fn reduced(
    title: String,
    axes: [&str; 2],
    [nu, nv]: [usize; 2],
    most: usize,
    reduction: Reduction,
    value: impl Fn(usize, usize) -> f64,
) -> (Panel, Option<String>) {
    let step = [nu, nv].map(|n| n.div_ceil(most.max(1)).max(1));
    let size = [nu.div_ceil(step[0]), nv.div_ceil(step[1])];
    let mut values = Vec::with_capacity(size[0] * size[1]);
    for b in 0..size[1] {
        for a in 0..size[0] {
            let ends = [((a + 1) * step[0]).min(nu), ((b + 1) * step[1]).min(nv)];
            let (u, v) = (a * step[0]..ends[0], b * step[1]..ends[1]);
            values.push(match reduction {
                Reduction::Pick => value((u.start + u.end - 1) / 2, (v.start + v.end - 1) / 2),
                Reduction::Mean => {
                    let count = (u.len() * v.len()) as f64;
                    v.flat_map(|j| u.clone().map(move |i| (i, j)))
                        .map(|(i, j)| value(i, j))
                        .sum::<f64>()
                        / count
                }
            });
        }
    }
    let what = match reduction {
        Reduction::Mean => "each pixel of the picture is the mean of",
        Reduction::Pick => "each pixel of the picture is the middle one of",
    };
    let note = (step != [1, 1])
        .then(|| format!("for display only, {what} {} × {} entries", step[0], step[1]));
    let axes = axes.map(str::to_owned);
    (
        Panel {
            title,
            size,
            values,
            axes,
            scale_bar: None,
        },
        note,
    )
}

/// A note of what was done to a matrix for display.
pub(super) fn note(text: Option<String>) -> String {
    text.map_or(String::new(), |t| {
        format!("<p class=\"note\">{}.</p>\n", escape(&capital(&t)))
    })
}

/// The text with a capital letter first.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or(String::new(), |c| c.to_uppercase().chain(letters).collect())
}

/// The shape of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Entries {
    /// As wide as high: pixels, elements.
    Square,
    /// Whatever fills the figure: rows and columns have nothing in common.
    Stretched,
}

/// A figure with its caption: first index to the right, second upwards. `ends` are the last indices
/// of the matrix before any reduction; `more` is HTML below the title.
pub(super) fn figure(
    panel: &Panel,
    ends: [usize; 2],
    entries: Entries,
    scale: &Scale,
    more: &str,
) -> String {
    let uri = match panel.data_uri(scale) {
        Ok(uri) => uri,
        Err(e) => {
            return format!(
                "<p>{}: {}</p>\n",
                escape(&panel.title),
                escape(&e.to_string())
            );
        }
    };
    let [w, h] = sides(panel, entries);
    let (left, top) = (42.0, 6.0);
    let mut svg = Svg::default();
    svg.raw(&opening(
        "",
        &panel.title,
        [left + SIDE + 6.0, top + h + 24.0],
    ));
    svg.image([left, top], [w, h], &uri);
    svg.rect([left, top], [w, h], FRAME);
    let [across, up] = &panel.axes;
    let y = top + h + 15.0;
    svg.text([left, y], "", "0");
    svg.text([left + 0.5 * w, y], MIDDLE, &format!("{across} →"));
    svg.upright([26.0, top + 0.5 * h], MIDDLE, &format!("{up} →"));
    if w > 80.0 {
        svg.text([left + w, y], END, &ends[0].to_string());
    }
    if h > 80.0 {
        svg.text([left - 4.0, top + 9.0], END, &ends[1].to_string());
    }
    svg.raw("</svg>");
    format!(
        "<figure>\n{}<figcaption><b>{}</b>{more}</figcaption>\n</figure>\n",
        svg.text,
        escape(&panel.title)
    )
}

/// A picture without axes, as small as its room; `caption` is HTML.
pub(super) fn shot(panel: &Panel, scale: &Scale, caption: &str) -> String {
    let name = escape(&panel.title);
    let uri = match panel.data_uri(scale) {
        Ok(uri) => uri,
        Err(e) => return format!("<p>{name}: {}</p>\n", escape(&e.to_string())),
    };
    let [w, h] = sides(panel, Entries::Square);
    let mut svg = Svg::default();
    svg.image([0.0; 2], [w, h], &uri);
    let [width, height] = [w, h].map(number);
    format!(
        "<figure class=\"shot\"><svg viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" role=\"img\" \
         aria-label=\"{name}\">\n{}</svg><figcaption>{caption}</figcaption></figure>\n",
        svg.text
    )
}

/// Width and height of a picture, px. A strip is widened until it can be seen; its entries are then
/// no squares.
fn sides(panel: &Panel, entries: Entries) -> [f64; 2] {
    let [nu, nv] = panel.size.map(|n| n.max(1) as f64);
    match entries {
        Entries::Square => [nu, nv].map(|n| (SIDE * n / nu.max(nv)).max(40.0)),
        Entries::Stretched => [SIDE; 2],
    }
}

/// The tag that opens a drawing of the page, in the page's ink.
fn opening(class: &str, name: &str, size: [f64; 2]) -> String {
    let [w, h] = size.map(number);
    format!(
        "<svg {class}viewBox=\"0 0 {w} {h}\" width=\"{w}\" height=\"{h}\" font-size=\"{TYPE}\" fill=\"currentColor\" role=\"img\" aria-label=\"{}\">",
        escape(name)
    )
}

/// The colours of `scale` with ticks in `unit`, and what the colours outside it mean in `panels`.
pub(super) fn legend(scale: &Scale, unit: &str, panels: &[Panel]) -> String {
    let mut svg = Svg::default();
    svg.raw(&opening("class=\"legend\" ", "colour scale", [372.0, 40.0]));
    if colour_bar(&mut svg, [42.0, 2.0], [216.0, 14.0], TYPE, scale, unit).is_err() {
        return String::new();
    }
    svg.raw("</svg>");
    let mut html = format!("<div class=\"scale\">{}", svg.text);
    for ([r, g, b], text) in outside(scale, panels, "", 0) {
        html.push_str(&format!(
            "<div class=\"mark\"><svg width=\"16\" height=\"12\" aria-hidden=\"true\"><rect width=\"16\" height=\"12\" \
             fill=\"#{r:02x}{g:02x}{b:02x}\" stroke=\"currentColor\"/></svg> {}</div>",
            escape(&text)
        ));
    }
    html.push_str("</div>\n");
    html
}

#[cfg(test)]
mod tests {
    use super::super::svg::well_formed;
    use super::*;

    #[test]
    fn small_matrices_are_shown_as_they_are() {
        let (panel, note) = reduced(
            "t".into(),
            ["a", "b"],
            [3, 2],
            4,
            Reduction::Mean,
            |i, j| (i + 10 * j) as f64,
        );
        assert_eq!(panel.values, [0.0, 1.0, 2.0, 10.0, 11.0, 12.0]);
        assert!(note.is_none());
    }

    #[test]
    fn means_keep_the_mean_and_picks_keep_entries() {
        let value = |i: usize, j: usize| (i * i + 7 * j) as f64;
        let (mean, note) = reduced("t".into(), ["a", "b"], [8, 6], 2, Reduction::Mean, value);
        assert_eq!(mean.size, [2, 2]);
        let all: f64 = (0..8)
            .flat_map(|i| (0..6).map(move |j| value(i, j)))
            .sum::<f64>()
            / 48.0;
        assert!((mean.values.iter().sum::<f64>() / 4.0 - all).abs() < 1e-12);
        assert!(note.unwrap().contains("4 × 3"));
        let (pick, _) = reduced("t".into(), ["a", "b"], [8, 6], 2, Reduction::Pick, value);
        assert_eq!(
            pick.values,
            [value(1, 1), value(5, 1), value(1, 4), value(5, 4)]
        );
        // A last block that is not full.
        let (mean, _) = reduced(
            "t".into(),
            ["a", "b"],
            [5, 1],
            2,
            Reduction::Mean,
            |i, _| i as f64,
        );
        assert_eq!(mean.values, [1.0, 3.5]);
    }

    #[test]
    fn figures_are_well_formed_whatever_the_title() {
        let panel = Panel::elements("<&\"ü", [2, 1], vec![0.0, f64::NAN]);
        let scale = Scale::reflectance();
        let html =
            figure(&panel, [1, 0], Entries::Square, &scale, "") + &legend(&scale, "W", &[panel]);
        well_formed(&html).unwrap();
    }
}
