use std::sync::atomic::AtomicBool;

use super::super::canvas::decoded;
use super::super::svg::well_formed;
use super::*;
use crate::study::reproduce::{Item, ReproducePlan, Verdict, reproduce};

fn computed(item: Item) -> Reproduction {
    let plan = ReproducePlan {
        most_elements: 8,
        seeds: 2,
        first_seed: 1,
    };
    reproduce(item, &plan, &AtomicBool::new(false)).unwrap()
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
    // Diamonds and squares: 8 printed points and one in the legend each.
    assert_eq!(svg.matches("stroke-width=\"1.6\"").count(), 2 * (8 + 1));
    let (width, height, pixels) = decoded(file(&files, "table3.png"));
    assert!(width > 1000 && height > 600);
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
    let html = reproduction_html(std::slice::from_ref(&summary));
    well_formed(html.trim_start_matches("<!DOCTYPE html>\n")).unwrap();
    let markdown = reproduction_markdown(std::slice::from_ref(&summary));
    assert!(
        markdown.contains("reproduced (26 of 26 checks hold)"),
        "{markdown}"
    );
    assert!(reproduction_table(&[summary]).contains("26 of  26"));
}

#[test]
fn pictures_are_shown() {
    let files = reproduction_files(&computed(Item::Fig20)).unwrap();
    for name in ["fig20-images.png", "fig20-images-2.png"] {
        let (width, height, _) = decoded(file(&files, name));
        assert!(width > 500 && height > 300, "{name}");
    }
}
