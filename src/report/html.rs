//! A finding as a page: what was found in a sentence, its figures made interactive, its numbers,
//! its files, and how to repeat it.

use super::gallery_svg::gallery_svg;
use super::invocation::Invocation;
use super::page::{Library, Page, Room, explained, table};
use super::plot::figure_svg;
use super::svg::escape;
use super::text::checks;
use crate::lab::finding::{Finding, Gallery, Place};

/// The page of a finding: one HTML file that needs no other. `files` (name and text) are those that
/// lie beside it: the figures among them are shown, the others are there to be saved.
pub fn finding_html(
    finding: &Finding,
    invocation: &Invocation,
    files: &[(String, String)],
) -> String {
    let mut page = Page::new(&finding.title);
    page.verdict(finding.tone, &finding.sentence);
    let mut room = Room::new();
    if !finding.figures.is_empty() {
        page.needs(Library::Plot);
    }
    page.section("figures", "Figures", &figures(finding, &mut room));
    page.section("numbers", "Numbers", &numbers(finding));
    let drawn = |name: &String| finding.figures.iter().any(|f| f.file == *name);
    let others = files.iter().filter(|(name, _)| !drawn(name)).cloned();
    let mut others: Vec<(String, String)> = others.chain([invocation.scene_file()]).collect();
    // Small ones first, so that one that is too large does not leave them out.
    others.sort_by_key(|(_, text)| text.len());
    let others = others
        .iter()
        .map(|(name, text)| (name.as_str(), text.as_bytes()));
    page.section("data", "Data", &room.files(others));
    page.section("run", "What was run", &invocation.html());
    page.html()
}

/// Figures and pictures, as long as there is room.
pub(super) fn figures(finding: &Finding, room: &mut Room) -> String {
    let figures = finding
        .figures
        .iter()
        .map(|f| (f.file.clone(), Ok(figure_svg(f))));
    let picture = |g: &Gallery| (format!("{}.svg", g.title), gallery_svg(g));
    let pictures = finding.galleries.iter().map(picture);
    let shown = |(file, svg): (String, Result<String, _>)| match svg {
        Ok(svg) => room.figure(&file, &svg),
        Err(e) => format!("<p>{}: {}</p>\n", escape(&file), escape(&format!("{e}"))),
    };
    figures.chain(pictures).map(shown).collect()
}

/// Notes, tables and checks.
pub(super) fn numbers(finding: &Finding) -> String {
    let note = |n: &String| format!("<p>{}</p>\n", explained(n));
    let mut html: String = finding.notes.iter().map(note).collect();
    let shown = finding.tables.iter().filter(|t| t.place != Place::File);
    html.extend(shown.map(table));
    if !finding.checks.is_empty() {
        html += &table(&checks(&finding.checks));
    }
    html
}

#[cfg(test)]
mod tests {
    use base64::prelude::{BASE64_STANDARD, Engine};

    use super::super::svg::well_formed;
    use super::*;
    use crate::lab::finding::{Axis, Column, Curve, Figure, Mark, Plot, Table, Tone};
    use crate::scene::Scene;

    fn finding() -> Finding {
        let axis = || Axis::linear("x", [0.0, 1.0]);
        let plot = Plot {
            title: String::new(),
            axes: [axis(), axis()],
            curves: vec![Curve::new("c", Mark::Line, vec![[0.0, 1.0]])],
        };
        let figure = Figure {
            file: "noise.svg".to_owned(),
            title: "A figure".to_owned(),
            plots: vec![plot],
            ..Figure::default()
        };
        let table = Table {
            caption: "Sizes & <signs>".to_owned(),
            columns: vec![
                Column::text("cause", "cause"),
                Column::number("size", "size", "W", 2),
            ],
            rows: vec![vec!["a < b".into(), 1.0.into()]],
            ..Table::default()
        };
        let hidden = Table {
            caption: "In the file".to_owned(),
            place: Place::File,
            ..table.clone()
        };
        Finding {
            title: "A study: bench".to_owned(),
            tone: Tone::Good,
            sentence: "It closes at 3 % & below.".to_owned(),
            notes: vec!["More < words.".to_owned()],
            tables: vec![table, hidden],
            figures: vec![figure],
            ..Finding::default()
        }
    }

    fn invocation() -> Invocation {
        let option = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        Invocation {
            command: ["study", "noise", "bench"].map(str::to_owned).to_vec(),
            scene: Scene::load("bench").unwrap(),
            file: "bench".to_owned(),
            options: vec![
                option("--noise", "1e-3,0.1"),
                option("--sensor", "my sensor"),
            ],
            version: "1.2.3".to_owned(),
        }
    }

    /// Verdict, figure with its data, tables, files as they are, the scene and the command: all in
    /// one page that asks for nothing else.
    #[test]
    fn a_finding_becomes_one_page() {
        let csv = "level,x\n1e-3,0.25\n";
        let files = [("noise.csv", csv), ("noise.svg", "the figure")];
        let files = files.map(|(name, text)| (name.to_owned(), text.to_owned()));
        let html = finding_html(&finding(), &invocation(), &files);
        well_formed(html.trim_start_matches("<!DOCTYPE html>\n")).unwrap();
        for part in [
            "<p class=\"verdict agree\">It closes at 3 % &amp; below.</p>",
            "<figure class=\"plot\" data-name=\"noise\">\n<svg",
            "<p>More &lt; words.</p>",
            "<h3>Sizes &amp; &lt;signs&gt;</h3>",
            "<th scope=\"col\" class=\"n\">size, W</th>",
            "<td>a &lt; b</td><td class=\"n\">1.0</td>",
            "<pre>phicam study noise bench --noise 1e-3,0.1 --sensor &#39;my sensor&#39;</pre>",
            "<th scope=\"row\">--noise</th><td>1e-3,0.1</td>",
        ] {
            assert!(html.contains(part), "no {part}");
        }
        assert!(!html.contains("In the file"));
        let link = html
            .split("download=\"noise.csv\" href=\"data:text/csv;base64,")
            .nth(1)
            .unwrap();
        let link = BASE64_STANDARD
            .decode(link.split('"').next().unwrap())
            .unwrap();
        assert_eq!(link, csv.as_bytes());
        assert!(
            html.contains(&invocation().scene.hash) && html.contains("download=\"bench.toml\"")
        );
        // Nothing is fetched: no source, style or link but inside of the page.
        let own = html.split("<script>\n/*").next().unwrap();
        for way in ["src=\"", "@import", "url("] {
            assert!(!own.contains(way), "{way}");
        }
        let mut addresses = own.split("href=\"").skip(1);
        assert!(addresses.all(|a| a.starts_with('#') || a.starts_with("data:")));
        assert!(html.len() < 1_000_000, "{}", html.len());
    }
}
