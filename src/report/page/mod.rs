//! Pages: one HTML file each, which needs no network and no other file.
//!
//! A page is readable without its script: figures are SVG, numbers are tables. The script
//! (`script/*.js`, plain JavaScript whose types are checked) takes what is there and makes it
//! answer: it explores, turns, hides, zooms. What it needs lies in the page as data blocks. Plots
//! and the drawing in three dimensions are the work of libraries ([`Library`]), bundled from their
//! packages by `tests/browser/vendor.js`, each in the pages that use it.

mod embed;
mod packed;
mod table;
mod term;

use std::collections::BTreeSet;

use serde::Serialize;

use super::colour::Map;
use super::encode::base64;
use super::look::looks;
use super::svg::escape;
use crate::store::shown_json;

pub(super) use crate::lab::finding::Tone;
pub(super) use embed::Room;
pub(super) use packed::{Packed, Precision};
pub(super) use table::{bare, framed, table};
pub use term::meaning;
pub(super) use term::{explained, term};

/// A library that a page may use; each is one script, with its licence beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Library {
    /// Observable Plot, ISC: the global `Plot`.
    Plot,
    /// three.js with its `OrbitControls`, MIT: the global `THREE`.
    Three,
}

impl Library {
    fn text(self) -> &'static str {
        match self {
            Self::Plot => include_str!("vendor/plot.min.js"),
            Self::Three => include_str!("vendor/three.min.js"),
        }
    }
}

/// The licences of the libraries, whole: those of MIT and ISC ask to be wherever the code is.
const LICENCES: &str = include_str!("vendor/LICENSES.txt");

/// The page's own script, in the order in which it runs.
const SCRIPT: [&str; 22] = [
    include_str!("script/page.js"),
    include_str!("script/axes.js"),
    include_str!("script/bench.js"),
    include_str!("script/bench_build.js"),
    include_str!("script/bench_choose.js"),
    include_str!("script/bench_labels.js"),
    include_str!("script/bench_parts.js"),
    include_str!("script/bench_steer.js"),
    include_str!("script/bench_view.js"),
    include_str!("script/download.js"),
    include_str!("script/explorer.js"),
    include_str!("script/figures.js"),
    include_str!("script/frames.js"),
    include_str!("script/look.js"),
    include_str!("script/plan.js"),
    include_str!("script/plots.js"),
    include_str!("script/read.js"),
    include_str!("script/row.js"),
    include_str!("script/slides.js"),
    include_str!("script/scroll.js"),
    include_str!("script/source.js"),
    include_str!("script/thin.js"),
];

/// The page's own style.
const STYLE: [&str; 2] = [include_str!("page.css"), include_str!("plots.css")];

/// A picture of 16 × 16 px for the tab: a wall, what leans over it, a spot. A server is asked for
/// none then.
const ICON: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 16 16\"><path d=\"M1 14h14\" stroke=\"#888\" stroke-width=\"2\"/><path d=\"M8 2l6 6\" stroke=\"#0072b2\" stroke-width=\"2.4\"/><circle cx=\"3.5\" cy=\"12.5\" r=\"2\" fill=\"#d55e00\"/></svg>";

/// A page that grows section by section.
pub(super) struct Page {
    title: String,
    answer: String,
    contents: String,
    body: String,
    data: String,
    libraries: BTreeSet<Library>,
}

impl Page {
    /// An empty page; `title` is text.
    pub(super) fn new(title: &str) -> Self {
        Self {
            title: escape(title),
            answer: String::new(),
            contents: String::new(),
            body: String::new(),
            data: String::new(),
            libraries: BTreeSet::new(),
        }
    }

    /// What was found, in a sentence (text), on top of the page.
    pub(super) fn verdict(&mut self, tone: Tone, sentence: &str) {
        let class = class(tone);
        self.answer += &format!("<p class=\"verdict{class}\">{}</p>\n", explained(sentence));
    }

    /// What was found, as HTML, on top of the page.
    pub(super) fn answer(&mut self, html: &str) {
        self.answer += html;
    }

    /// A section: its name in the address, its heading (text) and its HTML. Without HTML there is
    /// no section.
    pub(super) fn section(&mut self, id: &str, heading: &str, html: &str) {
        if html.is_empty() {
            return;
        }
        let heading = escape(heading);
        self.contents += &format!("<li><a href=\"#{id}\">{heading}</a></li>\n");
        self.body += &format!("<section id=\"{id}\">\n<h2>{heading}</h2>\n{html}</section>\n");
    }

    /// Values for the script under a name.
    pub(super) fn json(&mut self, id: &str, value: &impl Serialize) {
        // What serialises to a file serialises here; a block that does not is left out, and the
        // page stays as it is without script.
        if let Ok(text) = serde_json::to_string(value) {
            // Inside of a script element nothing may look like its end.
            let text = shown_json(&text.replace('<', "\\u003c"));
            self.data +=
                &format!("<script type=\"application/json\" id=\"{id}\">{text}</script>\n");
        }
    }

    /// Numbers for the script under a name.
    pub(super) fn numbers(&mut self, id: &str, packed: &Packed) {
        self.data += &packed.element(id);
    }

    /// Says that the page's script uses a library.
    pub(super) fn needs(&mut self, library: Library) {
        self.libraries.insert(library);
    }

    /// Bytes of the page as it is now, without the colour maps and the markup around its parts: a
    /// few kB.
    pub(super) fn len(&self) -> usize {
        let parts = [&self.answer, &self.contents, &self.body, &self.data];
        let own: usize = SCRIPT.iter().chain(&STYLE).map(|text| text.len()).sum();
        let libraries: usize = self.libraries.iter().map(|l| l.text().len()).sum();
        // Every `<` of the licences is written with four characters.
        let rest = own + libraries + LICENCES.len() + 20_000;
        parts.into_iter().map(String::len).sum::<usize>() + rest
    }

    /// The whole page.
    pub(super) fn html(mut self) -> String {
        self.json("colours", &colours());
        self.json("looks", &looks());
        let libraries: String = self.libraries.iter().map(|l| script(l.text())).collect();
        let licences = if self.libraries.is_empty() {
            String::new()
        } else {
            format!(
                "<details class=\"licences\"><summary>Libraries in this page, and their licences</summary>\n<pre>{}</pre>\n</details>\n",
                escape(LICENCES)
            )
        };
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"generator\" content=\"phicam {}\">\n<link rel=\"icon\" href=\"data:image/svg+xml;base64,{}\">\n<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n\
             <a class=\"skip\" href=\"#main\">To the content</a>\n<header>\n<h1>{}</h1>\n</header>\n\
             <main id=\"main\">\n{}<nav aria-label=\"Contents\"><ul>\n{}</ul></nav>\n{}</main>\n<footer>\n{licences}</footer>\n{}{libraries}{}</body>\n</html>\n",
            env!("CARGO_PKG_VERSION"),
            base64(ICON.as_bytes()),
            self.title,
            STYLE.concat(),
            self.title,
            self.answer,
            self.contents,
            self.body,
            self.data,
            script(&format!(
                "(() => {{\n\"use strict\";\n{}}})();\n",
                SCRIPT.map(without_comments).concat()
            )),
        )
    }
}

/// A claim (text) under what it is about, for [`Page::answer`]; of a judgement what stands before
/// its numbers stands out.
pub(super) fn claim(tone: Tone, about: &str, sentence: &str) -> String {
    let (head, rest) = match sentence.split_once(':') {
        Some((head, rest)) if tone != Tone::Plain => (head, rest),
        _ => ("", sentence),
    };
    let head = match head {
        "" => String::new(),
        head => format!("<strong>{}:</strong>", escape(head)),
    };
    format!(
        "<p class=\"claim{}\"><b>{}:</b> {head}{}.</p>\n",
        class(tone),
        escape(about),
        explained(rest)
    )
}

/// The class of what sounds so.
fn class(tone: Tone) -> &'static str {
    match tone {
        Tone::Good => " agree",
        Tone::Bad => " disagree",
        Tone::Plain => "",
    }
}

/// A script without the lines that are comments, and nothing else: a fifth of it.
fn without_comments(script: &str) -> String {
    let mut inside = false;
    let is_code = |line: &&str| {
        let line = line.trim();
        let starts = line.starts_with("/**");
        let comment = inside || line.starts_with("//") || (starts && line.ends_with("*/"));
        inside = (inside || starts) && !line.contains("*/");
        !(comment || inside)
    };
    let lines = script.lines().filter(is_code);
    lines.flat_map(|line| [line, "\n"]).collect()
}

/// A script inside of a page.
fn script(text: &str) -> String {
    format!("<script>\n{text}</script>\n")
}

/// The colour maps of the static pictures for those that the script draws: 256 colours each,
/// `#rrggbb` without the sign.
fn colours() -> serde_json::Value {
    let table = |map: Map| -> String {
        (0..256)
            .map(|i| {
                let [r, g, b] = map.at(f64::from(i) / 255.0);
                format!("{r:02x}{g:02x}{b:02x}")
            })
            .collect()
    };
    serde_json::json!({ "viridis": table(Map::Viridis), "grey": table(Map::Grey), "diverging": table(Map::Diverging) })
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
