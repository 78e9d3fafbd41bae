use super::super::encode::decoded;
use super::super::svg::well_formed;
use super::super::text::finding_text;
use super::*;
use crate::lab::finding::Mark;
use crate::lab::published::{Item, ItemSummary, ReproducePlan, Verdict, reproduce};
use crate::transport::Control;

fn plan() -> ReproducePlan {
    ReproducePlan {
        most_elements: 8,
        seeds: 2,
        first_seed: 1,
    }
}

fn computed(item: Item) -> Finding {
    reproduce(item, &plan(), Control::none()).unwrap()
}

fn file<'a>(files: &'a [(String, Vec<u8>)], name: &str) -> &'a [u8] {
    &files.iter().find(|(n, _)| n == name).unwrap().1
}

/// Table, figure and page of an item: one line a row, well formed, every printed point on the
/// figure, the verdict of the checks.
#[test]
fn an_item_becomes_files_and_a_page() {
    let r = computed(Item::Table3);
    let files = reproduction_files(Item::Table3, &r).unwrap();
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
    let summary = ItemSummary::new(Item::Table3, &r, "settings".to_owned(), names);
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
    let curves = &r.figures[0].plots[0].curves;
    for s in printed {
        let own = curves
            .iter()
            .find(|c| c.mark == Mark::Published && c.name == s["name"]);
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
    let text = finding_text(&overview(&[summary]));
    assert!(text.contains("26 of 26"), "{text}");
}

#[test]
#[ignore = "slow"]
fn pictures_are_shown() {
    let files = reproduction_files(Item::Fig20, &computed(Item::Fig20)).unwrap();
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
