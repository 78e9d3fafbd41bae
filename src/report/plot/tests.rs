//! Figures as they are drawn.

use serde_json::Value;

use super::super::encode::decoded;
use super::super::raster;
use super::super::svg::well_formed;
use super::*;
use crate::lab::finding::{Axis, Spacing};

fn plot(axes: [Axis; 2], curves: Vec<Curve>) -> Figure {
    Figure {
        file: "f.svg".to_owned(),
        title: "A <title> & more".to_owned(),
        plots: vec![Plot {
            title: "a title".to_owned(),
            axes,
            curves,
        }],
        ..Figure::default()
    }
}

fn told(svg: &str) -> Value {
    let text = svg.split("<metadata>").nth(1).unwrap();
    serde_json::from_str(text.split("</metadata>").next().unwrap()).unwrap()
}

/// Every point is there to its last bit, beyond the axes too, published ones as such, and no
/// text becomes markup.
#[test]
fn a_plot_holds_exactly_its_points() {
    let all = [[0.1 + 0.2, 1.0 / 3.0], [5e-324, -1.797e308], [0.5, 7.0]];
    let axes = [
        Axis::decades("x </metadata>"),
        Axis::clipped("y & z", [0.1, 1.0]),
    ];
    let curve = |name: &str, mark, points: &[[f64; 2]]| Curve::new(name, mark, points.to_vec());
    let figure = plot(
        axes,
        vec![
            curve("first", Mark::Line, &all),
            curve("none", Mark::Line, &[]),
            curve("third", Mark::Points, &all[..1]),
            curve("printed", Mark::Published, &[[0.2, f64::NAN]]),
            curve("limit", Mark::Level, &[[0.4, 0.0], [0.4, 1.0]]),
        ],
    );
    let svg = figure_svg(&figure);
    well_formed(&svg).unwrap();
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    assert_eq!(svg.matches("<metadata>").count(), 1);
    // Two of the first curve and the published one.
    assert!(svg.contains("3 points lie beyond the axes"), "{svg}");
    let json = told(&svg);
    assert_eq!(json["title"], "a title");
    assert_eq!(json["x"]["title"], "x </metadata>");
    assert_eq!(
        [&json["x"]["run"], &json["y"]["run"]],
        ["logarithmic", "linear"]
    );
    assert_eq!(json["y"]["ends"], serde_json::json!([0.1, 1.0]));
    let of = |i: usize, key: &str| json["series"][i][key].clone();
    let each = |key: &str| [0, 1, 2, 3].map(|i| of(i, key));
    assert_eq!(json["series"].as_array().unwrap().len(), 4);
    assert_eq!(each("name"), ["first", "third", "printed", "limit"]);
    assert_eq!(each("look"), [0, 2, 0, 3]);
    assert_eq!(each("kind"), ["line", "points", "published", "line"]);
    for (i, point) in all.iter().enumerate() {
        let read = |d: usize| json["series"][0]["points"][i][d].as_f64().unwrap();
        assert_eq!(
            [read(0), read(1)].map(f64::to_bits),
            point.map(f64::to_bits)
        );
    }
    assert!(of(2, "points")[0][1].is_null());
    // The limit is upright and as long as the axis.
    assert_eq!(of(3, "points"), serde_json::json!([[0.4, 0.1], [0.4, 1.0]]));
}

/// Viewers and the renderer pass over the data: a figure is the same picture with and without.
#[test]
fn data_leave_no_ink() {
    let axis = Axis::linear("x", [0.0, 1.0]);
    let dot = Curve::new("s", Mark::Points, vec![[0.5, 0.5]]);
    let whole = figure_svg(&plot([axis.clone(), axis], vec![dot]));
    let from = whole.find("<metadata>").unwrap();
    let to = whole.find("</metadata>").unwrap() + "</metadata>".len();
    let bare = format!("{}{}", &whole[..from], &whole[to..]);
    assert_eq!(raster::png(&whole).unwrap(), raster::png(&bare).unwrap());
}

/// A line, drawn: there is ink of its colour from point to point and none elsewhere, and what
/// leaves the stated ends of an axis is on the figure.
#[test]
fn a_curve_lies_where_its_points_say() {
    let axis = |title: &str| Axis::linear(title, [0.0, 1.0]);
    let curve = Curve::new("c", Mark::Line, vec![[0.0, 0.0], [1.0, 2.0]]);
    let svg = figure_svg(&plot([axis("x / m"), axis("y / m")], vec![curve]));
    let area: Vec<f64> = serde_json::from_value(told(&svg)["area"].clone()).unwrap();
    let (w, _, pixels) = decoded(&raster::png(&svg).unwrap());
    // One column of a journal, 90 mm at 300 pixels an inch.
    assert_eq!(w, 1063);
    // The plotting area in pixels, its axes 3 % longer than the data at each end.
    let scale = w as f64 / COLUMN;
    let place = |t: f64, side: f64, from: f64| scale * (from + side * (0.03 + t) / 1.06);
    let blue = |t: f64, u: f64| {
        let (x, y) = (place(t, area[2], area[0]), place(1.0 - u, area[3], area[1]));
        pixels[3 * (x as usize + y as usize * w)..][..3] == [0x00, 0x72, 0xb2]
    };
    for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
        assert!(blue(t, t), "{t}");
        assert!(!blue(t, 1.0 - t) || t == 0.5, "{t}");
    }
}

/// Bars of two curves for each name, the first name on top, with whiskers: as long as their
/// numbers, in their inks.
#[test]
fn bars_are_as_long_as_their_numbers() {
    let names = ["first & name", "second"].map(str::to_owned).to_vec();
    let axes = [
        Axis::linear("size", [0.0, 4.0]),
        Axis {
            title: String::new(),
            spacing: Spacing::Categories(names),
        },
    ];
    let bars = |name: &str, long: [f64; 2]| Curve {
        stderr: vec![0.5; 2],
        ..Curve::new(name, Mark::Bars, vec![[long[0], 0.0], [long[1], 1.0]])
    };
    let curves = vec![bars("whole", [4.0, 1.0]), bars("part", [2.0, 0.5])];
    let svg = figure_svg(&plot(axes, curves));
    well_formed(&svg).unwrap();
    assert!(svg.contains("first &amp; name") && svg.contains("whiskers: ± 1"));
    // The page shows it as it is.
    assert!(!svg.contains("<metadata>"));
    let field = |text: &str, key: &str| -> f64 {
        let value = text.split(&format!("{key}=\"")).nth(1).unwrap();
        value.split('"').next().unwrap().parse().unwrap()
    };
    let wide: Vec<[f64; 2]> = svg
        .lines()
        .filter(|l| l.starts_with("<rect") && l.contains("fill=\"#0072b2\""))
        .map(|l| [field(l, "y"), field(l, "width")])
        .collect();
    // The third is the sample in the legend.
    assert!(wide[0][0] < wide[1][0], "{wide:?}");
    assert!((wide[0][1] / wide[1][1] - 4.0).abs() < 0.01, "{wide:?}");
}

/// Equal axes share their ends, curves of one name their look, and a title of any length ends
/// on the sheet.
#[test]
fn plots_of_a_figure_go_together() {
    let curve = |name: &str, y: f64| Curve::new(name, Mark::Line, vec![[1.0, y], [2.0, y]]);
    let axes = || [Axis::linear("x", [0.0, 1.0]), Axis::decades("y")];
    let mut figure = plot(axes(), vec![curve("a", 1.0), curve("b", 3.0)]);
    figure.plots.push(Plot {
        title: String::new(),
        axes: axes(),
        curves: vec![curve("b", 1e-3)],
    });
    figure.title = "word ".repeat(100);
    let svg = figure_svg(&figure);
    well_formed(&svg).unwrap();
    let told: Vec<Value> = svg
        .split("<metadata>")
        .skip(1)
        .map(|text| serde_json::from_str(text.split('<').next().unwrap()).unwrap())
        .collect();
    assert_eq!(told[0]["y"]["ends"], told[1]["y"]["ends"]);
    assert_eq!(told[1]["series"][0]["look"], 1);
    assert!(svg.matches("font-weight=\"bold\"").count() > 4);
}
