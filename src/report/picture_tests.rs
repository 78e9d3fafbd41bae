use super::super::colour::{Map, NOT_A_NUMBER};
use super::super::encode::decoded;
use super::*;

fn panel(values: Vec<f64>) -> Panel {
    Panel::elements("board", [2, 2], values)
}

/// Colours at the centres of the four entries (iu, iv) = (0,0), (1,0), (0,1), (1,1) of the first
/// panel of `panels` below one line of title each for the picture and for the panel.
fn quarters(bytes: &[u8], panels: usize) -> [[u8; 3]; 4] {
    let (w, _, pixels) = decoded(bytes);
    let [left, top] = [MARGIN + AXIS, MARGIN + LINE + 12 + LINE + 8];
    let side = longest_side(panels) / 2 * 2;
    let at = |x: usize, y: usize| {
        let i = 3 * (left + x * side / 4 + (top + y * side / 4) * w);
        [pixels[i], pixels[i + 1], pixels[i + 2]]
    };
    // iv grows upwards: the first row is the lower one.
    [at(1, 3), at(3, 3), at(1, 1), at(3, 1)]
}

#[test]
fn greys_are_those_of_the_fixed_scale_and_iv_grows_upwards() {
    let bytes = grey_png("t", &[panel(vec![0.0, 1.0, 0.25, 0.5])]).unwrap();
    // 255·0.25 = 63.75 and 255·0.5 = 127.5, rounded.
    assert_eq!(quarters(&bytes, 1), [[0; 3], [255; 3], [64; 3], [128; 3]]);
}

#[test]
fn the_grey_scale_does_not_follow_the_data() {
    let faint = quarters(
        &grey_png("t", &[panel(vec![0.0, 0.2, 0.2, 0.2])]).unwrap(),
        1,
    );
    let strong = quarters(
        &grey_png("t", &[panel(vec![0.0, 0.2, 1.0, 9.0])]).unwrap(),
        1,
    );
    assert_eq!(faint[1], [51; 3]);
    assert_eq!(faint[..2], strong[..2]);
}

#[test]
fn values_outside_are_marked_not_clamped() {
    let scale = Scale::reflectance();
    let bytes = grey_png("t", &[panel(vec![-0.1, 1.1, f64::NAN])]).unwrap();
    let marks = quarters(&bytes, 1);
    assert_eq!(marks[0], scale.below().0);
    assert_eq!(marks[1], scale.above().0);
    // The fourth value is missing.
    assert_eq!(marks[2..], [NOT_A_NUMBER.0; 2]);
    let legend = outside(&scale, &[panel(vec![-0.1, 1.1, f64::NAN])], "", 0);
    assert_eq!(legend.len(), 3);
    assert_eq!(
        legend[0].1,
        "blue: 1 of 4 values below 0, clipped in the picture only"
    );
    assert_eq!(legend[2].1, "purple: 2 of 4 values not a number");
}

#[test]
fn panels_share_one_scale() {
    let panels = [
        panel(vec![1.0, 2.0, 1.0, 1.0]),
        panel(vec![5.0, 3.0, 1.0, 1.0]),
    ];
    let scale = Scale::sequential(panels.iter().flat_map(|p| &p.values));
    let got = quarters(&colour_png("t", &panels, &scale, "W").unwrap(), 2);
    assert_eq!(got[0], Map::Viridis.at(0.0));
    assert_eq!(got[1], Map::Viridis.at(0.25));
}

#[test]
fn the_bare_picture_has_the_last_row_on_top() {
    let png = panel(vec![0.0, 1.0, 0.25, 0.5]).plain_png(&Scale::reflectance());
    let (w, h, pixels) = decoded(&png.unwrap());
    assert_eq!((w, h), (256, 256));
    let at = |x: usize, y: usize| pixels[3 * (x + y * w)];
    // Four flat quarters: nearest neighbour, nothing smoothed.
    for (x, y, want) in [
        (0, 0, 64),
        (127, 127, 64),
        (128, 127, 128),
        (127, 128, 0),
        (128, 128, 255),
    ] {
        assert_eq!(at(x, y), want, "{x} {y}");
    }
}

#[test]
fn any_size_makes_a_picture() {
    for size in [[0, 0], [1, 1], [1, 300], [300, 1], [257, 3]] {
        let panel = Panel::elements(
            "a very long title that does not fit above it",
            size,
            vec![0.5; size[0] * size[1]],
        );
        let (w, h, _) = decoded(&grey_png("", &vec![panel; 9]).unwrap());
        assert!(
            w >= WIDTH && h >= 3 * size[1].max(LINE),
            "{size:?}: {w} × {h}"
        );
    }
    // No entry is left out: a matrix of more entries than pixels makes the sheet wider.
    let wide = Panel::elements("", [3000, 1], vec![0.5; 3000]);
    assert!(decoded(&grey_png("", &[wide]).unwrap()).0 > 3000);
    assert!(grey_png("nothing", &[]).is_ok());
}

#[test]
fn numbers_are_set_with_powers() {
    assert_eq!(scientific("1.2e-7"), "1.2 × 10⁻⁷");
    assert_eq!(
        (scientific("1e12"), scientific("0.02")),
        ("10¹²".to_owned(), "0.02".to_owned())
    );
}

#[test]
fn panels_are_lettered() {
    assert_eq!(lettered(0, 1, "noise 1e-8 %"), "noise 10⁻⁸\u{a0}%");
    assert_eq!(
        (lettered(0, 2, "t"), lettered(15, 16, "t")),
        ("(a)\u{a0}t".to_owned(), "(p)\u{a0}t".to_owned())
    );
    assert_eq!(lettered(26, 30, "t"), "t");
}

#[test]
fn lines_break_at_spaces_and_in_long_words() {
    assert_eq!(wrapped("aa bb cc dddd", 8), ["aa bb cc", "dddd"]);
    assert_eq!(
        wrapped("0123456789abcdefghij", 8),
        ["01234567", "89abcdef", "ghij"]
    );
    assert!(wrapped("", 8).is_empty());
    let text = "traced and physical model agree over all of the entries that there are";
    assert_eq!(wrapped(text, 20).join(" "), text);
    assert!(wrapped(text, 20).iter().all(|l| l.chars().count() <= 20));
}
