//! What a page holds of other files: figures that its script makes interactive, and files to be
//! saved, as long as there is room.

use super::super::encode::base64;
use super::super::svg::escape;

/// A page stays below 10 MB; what is not counted (markup, libraries, tables) has the rest.
const MOST: usize = 8_500_000;

/// The room that is left in a page, bytes.
pub(in super::super) struct Room {
    left: usize,
}

impl Room {
    /// That of an empty page.
    pub(in super::super) fn new() -> Self {
        Self { left: MOST }
    }

    fn takes(&mut self, html: &str) -> bool {
        let fits = html.len() <= self.left;
        if fits {
            self.left -= html.len();
        }
        fits
    }

    /// A drawing; `file` is its name, and what its plots are saved as.
    pub(in super::super) fn figure(&mut self, file: &str, svg: &str) -> String {
        let name = escape(file.trim_end_matches(".svg"));
        let html = format!("<figure class=\"plot\" data-name=\"{name}\">\n{svg}</figure>\n");
        if self.takes(&html) {
            html
        } else {
            format!(
                "<p class=\"note\">{name}.svg is too large for this page; it lies beside it.</p>\n"
            )
        }
    }

    /// A list of files to be saved; those that have no room are named.
    pub(in super::super) fn files<'a>(
        &mut self,
        files: impl IntoIterator<Item = (&'a str, &'a [u8])>,
    ) -> String {
        let mut html = String::new();
        for (name, bytes) in files {
            let kind = match name.rsplit('.').next() {
                Some("json") => "application/json",
                Some("csv") => "text/csv",
                Some("svg") => "image/svg+xml",
                _ => "text/plain",
            };
            let name = escape(name);
            let size = size(bytes.len());
            let link = format!(
                "<li><a download=\"{name}\" href=\"data:{kind};base64,{}\">{name}</a> ({size})</li>\n",
                base64(bytes)
            );
            html += &if self.takes(&link) {
                link
            } else {
                format!("<li>{name} ({size}): too large for this page, it lies beside it</li>\n")
            };
        }
        if html.is_empty() {
            html
        } else {
            format!("<ul class=\"files\">\n{html}</ul>\n")
        }
    }
}

/// A number of bytes for people.
fn size(bytes: usize) -> String {
    match bytes {
        0..1000 => format!("{bytes} bytes"),
        1000..1_000_000 => format!("{} kB", bytes.div_ceil(1000)),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use base64::prelude::{BASE64_STANDARD, Engine};

    use super::super::super::svg::well_formed;
    use super::*;

    #[test]
    fn a_file_comes_out_as_it_went_in() {
        let bytes = "a,b\n\"<1>\",2 & 3\n";
        let html = Room::new().files([("x&y.csv", bytes.as_bytes())]);
        well_formed(&html).unwrap();
        let inside = html.split("text/csv;base64,").nth(1).unwrap();
        let inside = BASE64_STANDARD
            .decode(inside.split('"').next().unwrap())
            .unwrap();
        assert_eq!(inside, bytes.as_bytes());
        assert!(html.contains("download=\"x&amp;y.csv\""));
    }

    #[test]
    fn what_has_no_room_is_named() {
        let mut room = Room::new();
        let large = vec![b'1'; 6_000_000];
        let html = room.files([
            ("first.csv", &large[..]),
            ("second.csv", &large[..]),
            ("third.csv", b"3"),
        ]);
        assert!(html.len() < 10_000_000, "{}", html.len());
        assert!(html.contains("second.csv (6.0 MB): too large"));
        assert_eq!(html.matches("data:text/csv").count(), 2);
        let svg = String::from_utf8(large).unwrap();
        assert!(room.figure("f.svg", &svg).contains("f.svg is too large"));
    }
}
