use std::sync::atomic::AtomicBool;

use super::super::encode::decoded;
use super::super::svg::well_formed;
use super::*;
use crate::study::reproduce::{
    Course, FigureAxis, FigureCurve, Item, Plot, ReproducePlan, Source, Verdict, reproduce,
};

fn plan() -> ReproducePlan {
    ReproducePlan {
        most_elements: 8,
        seeds: 2,
        first_seed: 1,
    }
}

fn computed(item: Item) -> Reproduction {
    reproduce(item, &plan(), &AtomicBool::new(false)).unwrap()
}

fn file<'a>(files: &'a [(String, Vec<u8>)], name: &str) -> &'a [u8] {
    &files.iter().find(|(n, _)| n == name).unwrap().1
}

/// Table, figure and page of an item: one line a row, well formed, every printed point on the figure, the verdict of the checks.
#[test]
fn an_item_becomes_files_and_a_page() {
    let r = computed(Item::Table3);
    let files = reproduction_files(&r).unwrap();
    let text = |name| std::str::from_utf8(file(&files, name)).unwrap();
    assert_eq!(text("table3.csv").lines().count(), 1 + 26);
    let svg = text("table3.svg");
    well_formed(svg).unwrap();
    assert!(!svg.contains("NaN"));
    // Open circles and squares: 8 printed points and one in the legend each.
    for mark in ["r=\"6.2\" fill=\"none\"", "height=\"11.6\" fill=\"none\""] {
        assert_eq!(svg.matches(mark).count(), 8 + 1, "{mark}");
    }
    let (width, height, pixels) = decoded(file(&files, "table3.png"));
    // One column of a journal, 90 mm at 300 pixels an inch.
    assert_eq!(width, 1063);
    assert!(height > 600);
    // Blue and vermillion curves are there.
    for ink in [[0x00, 0x72, 0xb2], [0xd5, 0x5e, 0x00]] {
        assert!(
            pixels.chunks(3).filter(|p| *p == ink).count() > 500,
            "{ink:?}"
        );
    }
    let names = files.iter().map(|f| f.0.clone()).collect();
    let summary = ItemSummary::new(&r, "settings".to_owned(), names);
    assert_eq!(summary.verdict, Verdict::Reproduced);
    let settings = ReproductionSettings {
        plan: &plan(),
        version: "0",
    };
    let read = |name: &str| files.iter().find(|f| f.0 == name).map(|f| f.1.clone());
    let html = reproduction_html(std::slice::from_ref(&summary), settings, read);
    well_formed(html.trim_start_matches("<!DOCTYPE html>\n")).unwrap();
    assert!(html.contains("1 reproduced, 0 reproduced in trend") && html.contains("26 of 26"));
    assert!(!html.contains("src=\"http") && !html.contains("href=\"table3"));
    assert!(html.contains("phicam reproduce table3 --most-elements 8 --seeds 2 --seed 1"));
    // The figure is in the page with its data: the printed points are there as printed.
    let json = html.split("<metadata>").nth(1).unwrap();
    let json: serde_json::Value =
        serde_json::from_str(json.split("</metadata>").next().unwrap()).unwrap();
    let series = json["series"].as_array().unwrap();
    let printed: Vec<_> = series.iter().filter(|s| s["kind"] == "published").collect();
    assert_eq!(printed.len(), 2);
    let curves = &r.plots[0].curves;
    for s in printed {
        let own = curves
            .iter()
            .find(|c| c.source == Source::Published && c.name == s["name"]);
        let points: Vec<[f64; 2]> = serde_json::from_value(s["points"].clone()).unwrap();
        assert_eq!(points, own.unwrap().points);
    }
    let markdown = reproduction_markdown(std::slice::from_ref(&summary));
    assert!(
        markdown.contains("reproduced (26 of 26 checks hold)"),
        "{markdown}"
    );
    // First and last line of the printed table, on both pages.
    assert!(markdown.contains("| lower line | 1 | 0.005900 |") && html.contains("<td>1.354</td>"));
    assert!(reproduction_table(&[summary]).contains("26 of  26"));
}

#[test]
fn pictures_are_shown() {
    let files = reproduction_files(&computed(Item::Fig20)).unwrap();
    for name in ["fig20", "fig20-images", "fig20-images-2"] {
        let svg = std::str::from_utf8(file(&files, &format!("{name}.svg"))).unwrap();
        well_formed(svg).unwrap();
        let png = file(&files, &format!("{name}.png"));
        let (width, height, _) = decoded(png);
        // Two columns of a journal, 180 mm.
        assert!(width == 2126 && height > 500, "{name}: {width} × {height}");
        assert_eq!(png, raster::png(svg).unwrap(), "{name}");
    }
}

/// A curve with one step, drawn: there is ink of its colour along the line from point to point and none elsewhere, and what leaves the stated ends of an axis
/// is on the figure.
#[test]
fn a_curve_lies_where_its_points_say() {
    let curve = FigureCurve {
        name: "c".to_owned(),
        source: Source::Computed,
        points: vec![[0.0, 0.0], [1.0, 2.0]],
    };
    let axis = |title: &str| FigureAxis {
        title: title.to_owned(),
        course: Course::Linear,
        ends: [0.0, 1.0],
    };
    let plot = Plot {
        title: "t".to_owned(),
        axes: [axis("x / m"), axis("y / m")],
        curves: vec![curve],
    };
    let r = Reproduction {
        plots: vec![plot],
        galleries: Vec::new(),
        ..computed(Item::Table3)
    };
    let files = reproduction_files(&r).unwrap();
    let (w, _, pixels) = decoded(file(&files, "table3.png"));
    // The plotting area in pixels, its axes 3 % longer than the data at each end.
    let scale = w as f64 / 415.0;
    let place = |t: f64, side: f64, from: f64| scale * (from + side * (0.03 + t) / 1.06);
    let blue = |t: f64, u: f64| {
        let (x, y) = (place(t, 328.0, 74.0), place(1.0 - u, 226.0, 30.0));
        pixels[3 * (x as usize + y as usize * w)..][..3] == [0x00, 0x72, 0xb2]
    };
    for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
        assert!(blue(t, t), "{t}");
        assert!(!blue(t, 1.0 - t) || t == 0.5, "{t}");
    }
}
