//! `phicam import` of photographs in colour beside grey ones.

use phicam::image::{grey16_png, rgb_png};

use crate::workspace::Workspace;

/// The tiny bench (3 × 2 pixels, 8 spots) with a photograph in colour of 6 × 4 pixels for each
/// spot, and grey ones to be dark frames or flat fields.
fn with_photographs() -> Workspace {
    let w = Workspace::with_scenes();
    for k in 0..8u8 {
        let pixels: Vec<u8> = (0..24).flat_map(|q| [100 + k, 120 + q, 90]).collect();
        w.write(
            &format!("in_{k}.png"),
            rgb_png([6, 4], &pixels, None).unwrap(),
        );
    }
    let uneven: Vec<u16> = (0..24).map(|q| 10 + q).collect();
    w.write("uneven.png", grey16_png([6, 4], &uneven).unwrap());
    w.write("even.png", grey16_png([6, 4], &[7; 24]).unwrap());
    w
}

/// Of 8 and of 16 bits, whose stored values mean the same.
const HEAD: &str = "scene = \"tiny.toml\"\nfull_scale = 65535\n";

/// A grey photograph is no channel of the others: the mean of theirs is not its light.
#[test]
fn photographs_of_two_kinds_are_refused() {
    let w = with_photographs();
    let list = |first: &str, last: &str| {
        let names: Vec<String> = (1..7).map(|k| format!("\"in_{k}.png\"")).collect();
        let frames = format!("[\"{first}\", {}, \"{last}\"]", names.join(", "));
        w.write("set.toml", format!("{HEAD}frames = {frames}\n"));
    };
    for channel in ["mean", "red", "all"] {
        let line = format!("import set.toml --channel {channel} -o out");
        let words = ["uneven.png is grey, and in_", "cure: ", "of one kind"];
        list("in_0.png", "uneven.png");
        w.refuses(&line, &words);
        list("uneven.png", "in_7.png");
        let of_one = ["uneven.png is grey, and has no channel", "cure: "];
        let due: &[&str] = if channel == "mean" { &words } else { &of_one };
        w.refuses(&line, due);
    }
}

/// A dark frame or a flat field without colour serves photographs in colour, and that is told; not
/// of one that is the same everywhere, nor of grey photographs.
#[test]
fn grey_dark_frames_and_flat_fields_of_colour_are_told() {
    let w = with_photographs();
    let grey: Vec<u16> = (0..24).map(|q| 500 + 3 * q).collect();
    w.write("grey.png", grey16_png([6, 4], &grey).unwrap());
    let colour: Vec<String> = (0..7).map(|k| format!("in_{k}.png")).collect();
    for (photographs, shared, is_told) in [
        (&colour[..], "dark = \"uneven.png\"", true),
        (&colour, "dark = \"even.png\"", false),
        (&colour, "flat = \"uneven.png\"", true),
        (&colour, "dark = \"in_7.png\"", false),
        (&["grey.png".to_owned()], "dark = \"uneven.png\"", false),
    ] {
        let frame = |name: &String| format!("[[frame]]\nfile = \"{name}\"\n");
        let frames: String = photographs.iter().map(frame).collect();
        w.write("set.toml", format!("{HEAD}{shared}\n{frames}"));
        let line = "import set.toml --channel mean -o out --replace";
        let told = w.phicam(line).exits(0);
        let words = "are grey and the photographs in colour (uneven.png)";
        assert_eq!(told.stderr.contains(words), is_told, "{}", told.account());
        let account = w.json("out/import.json");
        let mut kept = account["warnings"].as_array().unwrap().iter();
        let is_kept = kept.any(|warning| warning.as_str().unwrap().contains(words));
        assert_eq!(is_kept, is_told, "{account}");
    }
}
