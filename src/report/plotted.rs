//! What a panel leaves of its data in the figure: JSON in a `<metadata>` element, with every point and digit, drawn or not. Viewers pass over it; the page's script
//! makes an interactive plot of it, and a figure that was written once can be read again.

use serde::Serialize;

use super::chart::{Axis, Run, Series};

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Kind {
    /// A line through its points, with marks.
    Line,
    /// A cloud of points.
    Points,
    /// Published points: open marks.
    Published,
}

/// An axis.
#[derive(Serialize)]
struct Direction<'a> {
    title: &'a str,
    run: &'static str,
    ends: [f64; 2],
}

/// A series; `look` is the number of its ink, dash and mark (`look.rs`).
#[derive(Serialize)]
struct Course<'a> {
    name: &'a str,
    kind: Kind,
    look: usize,
    /// What is not finite is `null`.
    points: &'a [[f64; 2]],
}

/// A panel; `area` is the plotting area in the figure: left, top, width, height.
#[derive(Serialize)]
struct Plotted<'a> {
    title: &'a str,
    area: [f64; 4],
    x: Direction<'a>,
    y: Direction<'a>,
    series: Vec<Course<'a>>,
}

impl<'a> Direction<'a> {
    fn of(axis: &'a Axis) -> Self {
        let run = match axis.run {
            Run::Linear => "linear",
            Run::Logarithmic => "logarithmic",
        };
        Self {
            title: &axis.title,
            run,
            ends: axis.ends,
        }
    }
}

/// The element of a panel whose plotting area has that upper left corner and size. Series without points are left out; those of a kind are numbered by their place.
pub(super) fn metadata(
    title: &str,
    [[left, top], [width, height]]: [[f64; 2]; 2],
    [x, y]: [&Axis; 2],
    kinds: &[(Kind, &[Series])],
) -> String {
    let series = kinds.iter().flat_map(|(kind, all)| {
        let own = all.iter().enumerate().filter(|(_, s)| !s.points.is_empty());
        own.map(|(look, s)| Course {
            name: &s.name,
            kind: *kind,
            look,
            points: &s.points,
        })
    });
    let plotted = Plotted {
        title,
        area: [left, top, width, height],
        x: Direction::of(x),
        y: Direction::of(y),
        series: series.collect(),
    };
    // Numbers and text always serialise.
    let json = serde_json::to_string(&plotted).unwrap_or_default();
    // As JSON writes them these signs are no markup.
    let json = ['&', '<', '>'].iter().fold(json, |text, c| {
        text.replace(*c, &format!("\\u{:04x}", u32::from(*c)))
    });
    format!("<metadata>{json}</metadata>")
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::super::chart::{Panel, scatter};
    use super::super::raster;
    use super::super::svg::{Svg, well_formed};
    use super::*;

    fn series(name: &str, points: &[[f64; 2]]) -> Series {
        Series {
            name: name.to_owned(),
            points: points.to_vec(),
        }
    }

    fn axis(run: Run, title: &str) -> Axis {
        Axis {
            run,
            ends: [0.1, 1.0],
            title: title.to_owned(),
        }
    }

    fn told(svg: &str) -> Value {
        let text = svg.split("<metadata>").nth(1).unwrap();
        serde_json::from_str(text.split("</metadata>").next().unwrap()).unwrap()
    }

    /// Every point is there to its last bit, beyond the axes too, published ones as such, and no text becomes markup.
    #[test]
    fn a_panel_holds_exactly_its_points() {
        let all = [[0.1 + 0.2, 1.0 / 3.0], [5e-324, -1.797e308], [0.5, 7.0]];
        let [x, y] = [
            axis(Run::Logarithmic, "x </metadata>"),
            axis(Run::Linear, "y & z"),
        ];
        let mut svg = Svg::default();
        Panel {
            corner: [80.0, 50.0],
            size: [100.0, 60.0],
            axes: [&x, &y],
            title: "a title",
            series: &[
                series("first", &all),
                series("none", &[]),
                series("third", &all[..1]),
            ],
            published: &[series("printed", &[[0.2, f64::NAN]])],
        }
        .draw(&mut svg);
        well_formed(&svg.text).unwrap();
        assert_eq!(svg.text.matches("<metadata>").count(), 1);
        let json = told(&svg.text);
        assert_eq!(json["title"], "a title");
        assert_eq!(json["area"], serde_json::json!([80.0, 50.0, 100.0, 60.0]));
        assert_eq!(json["x"]["title"], "x </metadata>");
        assert_eq!(
            [&json["x"]["run"], &json["y"]["run"]],
            ["logarithmic", "linear"]
        );
        assert_eq!(json["y"]["ends"], serde_json::json!([0.1, 1.0]));
        let of = |i: usize, key: &str| json["series"][i][key].clone();
        assert_eq!(json["series"].as_array().unwrap().len(), 3);
        assert_eq!([of(0, "name"), of(1, "name")], ["first", "third"]);
        assert_eq!([of(0, "look"), of(1, "look"), of(2, "look")], [0, 2, 0]);
        assert_eq!([of(0, "kind"), of(2, "kind")], ["line", "published"]);
        for (i, point) in all.iter().enumerate() {
            let read = |d: usize| json["series"][0]["points"][i][d].as_f64().unwrap();
            assert_eq!(
                [read(0), read(1)].map(f64::to_bits),
                point.map(f64::to_bits)
            );
        }
        assert!(of(2, "points")[0][1].is_null());
    }

    /// Viewers and the renderer pass over it: a figure is the same picture with and without.
    #[test]
    fn it_leaves_no_ink() {
        let mut svg = Svg::default();
        let x = axis(Run::Linear, "x");
        let one = [series("s", &[[0.5, 0.5]])];
        assert_eq!(
            scatter(&mut svg, [40.0, 20.0], [80.0, 40.0], [&x, &x], &one),
            0
        );
        let open = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"200\" height=\"120\">";
        let whole = format!("{open}{}</svg>", svg.text);
        let from = whole.find("<metadata>").unwrap();
        let to = whole.find("</metadata>").unwrap() + "</metadata>".len();
        let bare = format!("{}{}", &whole[..from], &whole[to..]);
        assert_eq!(raster::png(&whole).unwrap(), raster::png(&bare).unwrap());
        assert_eq!(told(&whole)["series"][0]["kind"], "points");
    }
}
