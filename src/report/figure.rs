//! Figures of a page: a matrix as an inline SVG with axes, and the legend of a scale.

use super::colour::Scale;
use super::picture::{Panel, bar_ticks, legend_lines};
use super::svg::{Svg, escape, number};

/// Length of a picture's longer side on the page, px.
const SIDE: f64 = 240.0;

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
    let [nu, nv] = panel.size.map(|n| n.max(1) as f64);
    // A strip of a picture is widened until it can be seen; its entries are then no squares.
    let [w, h] = match entries {
        Entries::Square => [nu, nv].map(|n| (SIDE * n / nu.max(nv)).max(40.0)),
        Entries::Stretched => [SIDE; 2],
    };
    let (left, top) = (42.0, 6.0);
    let mut svg = Svg::default();
    let (full, tall) = (number(left + SIDE + 6.0), number(top + h + 24.0));
    svg.raw(&format!(
        "<svg viewBox=\"0 0 {full} {tall}\" width=\"{full}\" height=\"{tall}\" role=\"img\" aria-label=\"{}\">",
        escape(&panel.title)
    ));
    svg.raw(&format!(
        "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" \
         style=\"image-rendering:pixelated\" href=\"{uri}\"/>",
        number(left),
        number(top),
        number(w),
        number(h)
    ));
    svg.rect(
        [left, top],
        [w, h],
        "fill=\"none\" stroke=\"currentColor\" stroke-opacity=\"0.5\"",
    );
    let small = "font-size=\"11\" fill=\"currentColor\"";
    let [across, up] = &panel.axes;
    let y = top + h + 15.0;
    svg.text([left, y], small, "0");
    svg.text(
        [left + 0.5 * w, y],
        "font-size=\"11\" fill=\"currentColor\" text-anchor=\"middle\"",
        &format!("{across} →"),
    );
    if w > 80.0 {
        svg.text(
            [left + w, y],
            "font-size=\"11\" fill=\"currentColor\" text-anchor=\"end\"",
            &ends[0].to_string(),
        );
    }
    let middle = top + 0.5 * h;
    let turn = format!(
        "font-size=\"11\" fill=\"currentColor\" text-anchor=\"middle\" transform=\"rotate(-90 26 {})\"",
        number(middle)
    );
    svg.text([26.0, middle], &turn, &format!("{up} →"));
    if h > 80.0 {
        svg.text(
            [left - 4.0, top + 9.0],
            "font-size=\"11\" fill=\"currentColor\" text-anchor=\"end\"",
            &ends[1].to_string(),
        );
    }
    svg.raw("</svg>");
    format!(
        "<figure>\n{}<figcaption><b>{}</b>{more}</figcaption>\n</figure>\n",
        svg.text,
        escape(&panel.title)
    )
}

/// The colours of `scale` with ticks in `unit`, and what the colours outside it mean in `panels`.
pub(super) fn legend(scale: &Scale, unit: &str, panels: &[Panel]) -> String {
    let [low, high] = scale.range();
    let steps = 128;
    let along = |i: usize| i as f64 / (steps - 1) as f64;
    let bar = Panel::elements(
        "",
        [steps, 1],
        (0..steps)
            .map(|i| low * (1.0 - along(i)) + high * along(i))
            .collect(),
    );
    let Ok(uri) = bar.data_uri(scale) else {
        return String::new();
    };
    let mut svg = Svg::default();
    svg.raw("<svg class=\"legend\" viewBox=\"0 0 480 40\" width=\"480\" height=\"40\" role=\"img\" aria-label=\"colour scale\">");
    svg.raw(&format!(
        "<image x=\"42\" y=\"2\" width=\"300\" height=\"14\" preserveAspectRatio=\"none\" href=\"{uri}\"/>"
    ));
    svg.rect(
        [42.0, 2.0],
        [300.0, 14.0],
        "fill=\"none\" stroke=\"currentColor\" stroke-opacity=\"0.5\"",
    );
    for (t, text) in bar_ticks(scale) {
        let x = 42.0 + 300.0 * t;
        svg.line([x, 16.0], [x, 21.0], "stroke=\"currentColor\"");
        svg.text(
            [x, 34.0],
            "font-size=\"11\" fill=\"currentColor\" text-anchor=\"middle\"",
            &text,
        );
    }
    svg.text(
        [352.0, 14.0],
        "font-size=\"11\" fill=\"currentColor\"",
        unit,
    );
    svg.raw("</svg>");
    let mut html = format!("<div class=\"scale\">{}", svg.text);
    for ([r, g, b], text) in legend_lines(scale, panels) {
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
