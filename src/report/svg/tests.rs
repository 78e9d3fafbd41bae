//! Text, numbers and marks of an SVG.

use super::*;

#[test]
fn text_cannot_become_markup() {
    assert_eq!(escape("<&\"'>ü\u{1}"), "&lt;&amp;&quot;&#39;&gt;ü\u{fffd}");
    let mut svg = Svg::default();
    svg.text([0.0, 1.0], "fill=\"#000\"", "</text><script>&");
    assert!(well_formed(&svg.text).is_ok());
    assert!(!svg.text.contains("<script"));
}

#[test]
fn raised_signs_stand_above_the_line_and_the_rest_on_it() {
    assert_eq!(raised("a < b"), "a &lt; b");
    let up = |t: &str| format!("<tspan font-size=\"70%\" dy=\"-0.5em\">{t}</tspan>");
    assert_eq!(raised("10⁻¹²"), format!("10{}", up("−12")));
    let both = format!(
        "in.{}<tspan dy=\"0.35em\"> &amp; m</tspan>{}",
        up("2"),
        up("T")
    );
    assert_eq!(raised("in.² & mᵀ"), both);
    assert!(well_formed(&both).is_ok());
}

#[test]
fn numbers_are_short_and_finite() {
    assert_eq!(number(1.50), "1.5");
    assert_eq!(number(-0.001), "0");
    assert_eq!(number(100.0), "100");
    assert_eq!(number(f64::NAN), "0");
    assert_eq!(number(f64::INFINITY), "0");
}

#[test]
fn the_checker_tells_good_from_bad() {
    assert!(well_formed("<a b=\"c\">x &amp; y<d/></a>").is_ok());
    for bad in [
        "<a>",
        "<a></b>",
        "<a>&</a>",
        "<a b=c></a>",
        "<a b=\"<\"></a>",
        "<a> > </a>",
        "</a>",
    ] {
        assert!(well_formed(bad).is_err(), "{bad}");
    }
}
