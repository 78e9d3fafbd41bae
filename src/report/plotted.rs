//! What a panel leaves of its data in the figure: JSON in a `<metadata>` element, with every point
//! and digit, drawn or not. Viewers pass over it; the page's script makes an interactive plot of
//! it, and a figure that was written once can be read again.

use serde::Serialize;

use crate::store::shown_json;

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
pub(super) struct Direction<'a> {
    /// What it shows.
    pub title: &'a str,
    /// `linear` or `logarithmic`.
    pub run: &'static str,
    /// Values at its two ends.
    pub ends: [f64; 2],
}

/// A series.
#[derive(Serialize)]
pub(super) struct Series<'a> {
    /// Its name.
    pub name: &'a str,
    /// How it is drawn.
    pub kind: Kind,
    /// Number of its ink, dash and mark (`look.rs`).
    pub look: usize,
    /// (x, y); what is not finite is `null`.
    pub points: Vec<[f64; 2]>,
}

/// The data of a panel.
#[derive(Serialize)]
pub(super) struct Plotted<'a> {
    /// What it shows.
    pub title: &'a str,
    /// The plotting area in the figure: left, top, width, height.
    pub area: [f64; 4],
    /// Across.
    pub x: Direction<'a>,
    /// Upwards.
    pub y: Direction<'a>,
    /// Those that have points.
    pub series: Vec<Series<'a>>,
}

impl Plotted<'_> {
    /// The element that holds it.
    pub(super) fn metadata(&self) -> String {
        // Numbers and text always serialise.
        let json = shown_json(&serde_json::to_string(self).unwrap_or_default());
        // As JSON writes them these signs are no markup.
        let json = ['&', '<', '>'].iter().fold(json, |text, c| {
            text.replace(*c, &format!("\\u{:04x}", u32::from(*c)))
        });
        format!("<metadata>{json}</metadata>")
    }
}
