//! Scenes small enough to be traced in a moment, made from the built-in bench by replacing parts of
//! its text.

use std::sync::OnceLock;

use crate::workspace::Workspace;

/// 3 × 2 pixels and 8 spots: for everything that asks only whether files are right.
pub(crate) const TINY: [(&str, &str); 2] = [
    ("pixels = [16, 16]", "pixels = [3, 2]"),
    ("per_side = 30", "per_side = 2"),
];

/// 8 × 8 pixels and 24 spots: `joint` still recovers the 2 × 2 board from it.
pub(crate) const SMALL: [(&str, &str); 2] = [
    ("pixels = [16, 16]", "pixels = [8, 8]"),
    ("per_side = 30", "per_side = 6"),
];

/// Where the spots of the bench are listed.
const SQUARE: [&str; 5] = [
    "layout = \"square\"",
    "centre = [5.0, 4.373476808130942]",
    "half_width = 3.0",
    "per_side = 30",
    "stagger = [-1.0, 1.0, 0.0]",
];

/// The text of the built-in bench, as the program exports it.
pub(crate) fn bench() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(|| {
        Workspace::new()
            .phicam("scene export bench")
            .exits(0)
            .stdout
    })
}

/// The bench with every pair's first half replaced by its second; each must occur exactly once.
pub(crate) fn altered<'a>(pairs: impl IntoIterator<Item = &'a (&'a str, &'a str)>) -> String {
    pairs
        .into_iter()
        .fold(bench().to_owned(), |text, (old, new)| {
            assert_eq!(text.matches(old).count(), 1, "`{old}` in the bench");
            text.replace(old, new)
        })
}

/// The tiny scene with 2 × 2 elements and its spots at `points`, and `surface` (a table's lines)
/// added.
pub(crate) fn with_points_and_surface(points: &str, surface: &str) -> String {
    let list = format!("layout = \"list\"\npoints = {points}");
    let coarse = ("elements = [8, 8]", "elements = [2, 2]");
    let mut pairs = vec![TINY[0], coarse, (SQUARE[0], list.as_str())];
    pairs.extend(SQUARE[1..].iter().map(|line| (*line, "")));
    altered(&pairs) + surface
}

impl Workspace {
    /// A workspace with `tiny.toml` and `small.toml`.
    pub(crate) fn with_scenes() -> Self {
        let workspace = Self::new();
        workspace.write("tiny.toml", altered(&TINY));
        workspace.write("small.toml", altered(&SMALL));
        workspace
    }
}
