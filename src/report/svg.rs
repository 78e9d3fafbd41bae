//! SVG text: escaping, numbers, elements.

use std::fmt::Write;

use crate::store::harmless;

/// Families of the type for the attribute `font-family`, the first the one that PNGs are drawn
/// with.
pub(super) const FAMILIES: &str = "DejaVu Sans, Verdana, sans-serif";

/// Pixels an inch.
pub(super) const DPI: f64 = 300.0;

/// Okabe and Ito's colours, told apart by every kind of colour vision.
pub(super) mod ink {
    pub(in super::super) const BLACK: &str = "#222222";
    pub(in super::super) const GREY: &str = "#6b6b6b";
    pub(in super::super) const PALE: &str = "#d0d0d0";
    pub(in super::super) const BLUE: &str = "#0072b2";
    pub(in super::super) const GREEN: &str = "#009e73";
    pub(in super::super) const VERMILLION: &str = "#d55e00";
    pub(in super::super) const PURPLE: &str = "#a5467d";
    pub(in super::super) const ORANGE: &str = "#e69f00";
}

/// The style of a line.
pub(super) fn stroke(ink: &str, width: f64) -> String {
    format!("fill=\"none\" stroke=\"{ink}\" stroke-width=\"{width}\"")
}

/// The style of an area, or of text.
pub(super) fn fill(ink: &str) -> String {
    format!("fill=\"{ink}\"")
}

/// The style of type of a size.
pub(super) fn lettering(ink: &str, size: f64) -> String {
    format!("fill=\"{ink}\" font-size=\"{size}\"")
}

/// Where text stands on its place, if not to the right of it.
pub(super) const MIDDLE: &str = "text-anchor=\"middle\"";
pub(super) const END: &str = "text-anchor=\"end\"";

/// `text` for XML and HTML, as content or as a quoted attribute. Characters that XML 1.0 cannot
/// hold become U+FFFD.
pub(super) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    // Control characters are no part of XML.
    let shown = |c: char| c.is_control() && !matches!(c, '\t' | '\n');
    let text = harmless(&text.replace(shown, "\u{fffd}"));
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// At most `most` characters of `text`, the rest as an ellipsis.
pub(super) fn shortened(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars()
        .take(most.saturating_sub(1))
        .chain(['…'])
        .collect()
}

/// A coordinate with two decimals; always finite and within ±1e6, which no drawing reaches.
pub(super) fn number(x: f64) -> String {
    let x = if x.is_finite() {
        x.clamp(-1e6, 1e6)
    } else {
        0.0
    };
    let text = format!("{x:.2}");
    match text.trim_end_matches('0').trim_end_matches('.') {
        "-0" => "0".to_owned(),
        short => short.to_owned(),
    }
}

/// A growing SVG fragment.
#[derive(Default)]
pub(super) struct Svg {
    /// The elements so far.
    pub text: String,
}

impl Svg {
    /// Appends raw markup.
    pub(super) fn raw(&mut self, markup: &str) {
        self.text.push_str(markup);
        self.text.push('\n');
    }

    /// A polyline (or, with `close`, polygon) with the given presentation attributes.
    pub(super) fn path(&mut self, points: &[[f64; 2]], close: Close, style: &str) {
        let mut d = String::new();
        for (i, [x, y]) in points.iter().enumerate() {
            let command = if i == 0 { 'M' } else { 'L' };
            let _ = write!(d, "{command}{} {}", number(*x), number(*y));
        }
        if close == Close::Yes {
            d.push('Z');
        }
        let _ = writeln!(self.text, "<path d=\"{d}\" {style}/>");
    }

    /// A line.
    pub(super) fn line(&mut self, a: [f64; 2], b: [f64; 2], style: &str) {
        self.path(&[a, b], Close::No, style);
    }

    /// A circle.
    pub(super) fn circle(&mut self, [x, y]: [f64; 2], r: f64, style: &str) {
        let (x, y, r) = (number(x), number(y), number(r));
        let _ = writeln!(
            self.text,
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" {style}/>"
        );
    }

    /// A rectangle from its upper left corner.
    pub(super) fn rect(&mut self, [x, y]: [f64; 2], [w, h]: [f64; 2], style: &str) {
        let [x, y, w, h] = [x, y, w.max(0.0), h.max(0.0)].map(number);
        let _ = writeln!(
            self.text,
            "<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" {style}/>"
        );
    }

    /// A picture whose pixels stay squares, from its upper left corner.
    pub(super) fn image(&mut self, [x, y]: [f64; 2], [w, h]: [f64; 2], uri: &str) {
        let [x, y, w, h] = [x, y, w, h].map(number);
        let _ = writeln!(
            self.text,
            "<image x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" preserveAspectRatio=\"none\" \
             style=\"image-rendering:pixelated\" href=\"{uri}\"/>"
        );
    }

    /// Text, escaped and its raised signs set here.
    pub(super) fn text(&mut self, [x, y]: [f64; 2], style: &str, text: &str) {
        let (x, y) = (number(x), number(y));
        let _ = writeln!(
            self.text,
            "<text x=\"{x}\" y=\"{y}\" {style}>{}</text>",
            raised(text)
        );
    }

    /// Text that runs upwards.
    pub(super) fn upright(&mut self, at: [f64; 2], style: &str, text: &str) {
        let [x, y] = at.map(number);
        let turned = format!("{style} transform=\"rotate(-90 {x} {y})\"");
        self.text(at, &turned, text);
    }
}

/// Signs that Unicode has raised, and what they are.
const RAISED: [(char, char); 13] = [
    ('⁰', '0'),
    ('¹', '1'),
    ('²', '2'),
    ('³', '3'),
    ('⁴', '4'),
    ('⁵', '5'),
    ('⁶', '6'),
    ('⁷', '7'),
    ('⁸', '8'),
    ('⁹', '9'),
    ('⁻', '−'),
    ('⁺', '+'),
    ('ᵀ', 'T'),
];

/// `text` escaped, with raised signs as small ordinary ones above the line: a viewer's type need
/// not have the raised ones, and they look alike.
pub(super) fn raised(text: &str) -> String {
    let plain = |c: char| RAISED.iter().find(|(r, _)| *r == c).map(|(_, p)| *p);
    let letters: Vec<char> = text.chars().collect();
    let mut out = String::new();
    let mut below = "";
    for run in letters.chunk_by(|a, b| plain(*a).is_some() == plain(*b).is_some()) {
        let words: String = run.iter().map(|c| plain(*c).unwrap_or(*c)).collect();
        let words = escape(&words);
        if run.first().is_some_and(|c| plain(*c).is_some()) {
            out += &format!("<tspan font-size=\"70%\" dy=\"-0.5em\">{words}</tspan>");
            // As far down again, in units of the larger type.
            below = "0.35em";
        } else if below.is_empty() {
            out += &words;
        } else {
            out += &format!("<tspan dy=\"{below}\">{words}</tspan>");
            below = "";
        }
    }
    out
}

/// Whether a path returns to its start.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Close {
    /// Polygon.
    Yes,
    /// Polyline.
    No,
}

/// Whether markup is well formed: tags nest, attributes are quoted, no bare `&` or `<`. Void HTML
/// elements count as closed. Enough for what this floor writes.
#[cfg(test)]
pub(super) fn well_formed(markup: &str) -> Result<(), String> {
    let void = ["meta", "br", "hr", "img", "link", "input"];
    let mut open: Vec<&str> = Vec::new();
    let mut rest = markup;
    let entity = |text: &str| {
        text.match_indices('&').all(|(i, _)| {
            let tail = &text[i + 1..];
            tail.find(';').is_some_and(|end| {
                end > 0
                    && tail[..end]
                        .chars()
                        .all(|c| c.is_ascii_alphanumeric() || c == '#')
            })
        })
    };
    while let Some(start) = rest.find('<') {
        if !entity(&rest[..start]) || rest[..start].contains('>') {
            return Err(format!("bare & or > in {:?}", &rest[..start]));
        }
        rest = &rest[start + 1..];
        let mut quote = false;
        let end = rest.find(|c: char| {
            quote ^= c == '"';
            c == '>' && !quote
        });
        let end = end.ok_or_else(|| format!("a tag that does not end: {rest:.60}"))?;
        let tag = &rest[..end];
        rest = &rest[end + 1..];
        if tag.contains('<') || !entity(tag) || tag.matches('"').count() % 2 == 1 {
            return Err(format!("bare < or & in tag {tag:?}"));
        }
        let attributes: String = tag.split('"').step_by(2).collect();
        let unquoted = attributes
            .split_whitespace()
            .skip(1)
            .any(|a| a.contains('=') && !a.ends_with('=') && !a.contains("=/"));
        if unquoted {
            return Err(format!("unquoted attribute in {tag:?}"));
        }
        let name = tag
            .trim_start_matches('/')
            .split([' ', '\n', '/'])
            .next()
            .unwrap_or("");
        // What a script holds is no markup.
        if name == "script" && !tag.starts_with('/') {
            rest = &rest[rest.find("</script>").ok_or("a script without an end")?..];
        }
        if tag.starts_with('!')
            || tag.starts_with('?')
            || tag.ends_with('/')
            || void.contains(&name)
        {
            continue;
        }
        if tag.starts_with('/') {
            match open.pop() {
                Some(last) if last == name => {}
                other => return Err(format!("</{name}> closes {other:?}")),
            }
        } else {
            open.push(name);
            if name == "style" {
                let close = rest.find("</style>").ok_or("style does not end")?;
                rest = &rest[close..];
            }
        }
    }
    if open.is_empty() {
        Ok(())
    } else {
        Err(format!("left open: {open:?}"))
    }
}

#[cfg(test)]
mod tests;
