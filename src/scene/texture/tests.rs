use super::*;
use crate::image::tests::bytes;
use crate::image::{Transfer, grey16_png, rgb_png};
use crate::scene::target::Target;

/// A texture of a scene with a red helium-neon laser, in whose folder lie the given files.
fn with_files(text: &str, folder: &[(&str, &[u8])]) -> Result<Texture, Fault> {
    #[derive(serde::Deserialize)]
    struct Holder {
        a: AlbedoTable,
    }
    let mut files = |name: &str| {
        let found = folder.iter().find(|(n, _)| *n == name);
        let bytes = found.map(|(_, bytes)| bytes.to_vec());
        bytes.ok_or_else(|| "there is no such file".to_owned())
    };
    let table = toml::from_str::<Holder>(&format!("a = {text}")).unwrap().a;
    Texture::from_table(&table, 632.8e-9, &mut files)
}

fn texture(text: &str) -> Result<Texture, Fault> {
    with_files(text, &[])
}

#[test]
fn the_first_check_is_dark() {
    let board = texture("{ checkerboard = [2, 4], dark = 0.1, light = 0.9 }").unwrap();
    assert_eq!(board.albedo([0.1, 0.1]), 0.1);
    assert_eq!(board.albedo([0.6, 0.1]), 0.9);
    assert_eq!(board.albedo([0.1, 0.3]), 0.9);
    assert_eq!(board.albedo([0.6, 0.3]), 0.1);
    assert_eq!(board.albedo([1.0, 1.0]), board.albedo([0.99, 0.99]));
}

#[test]
fn cells_run_along_u_and_ramps_are_linear() {
    let cells = texture("{ cells = [[0, 0.5, 1], [0.1, 0.2, 0.3]] }").unwrap();
    assert_eq!(cells.albedo([0.5, 0.25]), 0.5);
    assert_eq!(cells.albedo([0.9, 0.75]), 0.3);
    assert!(
        (texture("{ ramp = [0.2, 0.6] }")
            .unwrap()
            .albedo([0.25, 0.9])
            - 0.3)
            .abs()
            < 1e-15
    );
}

#[test]
fn impossible_albedos_are_refused() {
    for text in [
        "1.2",
        "-0.1",
        "nan",
        "\"unknown\"",
        "{ checkerboard = [2, 2], dark = 0, light = 2 }",
        "{ checkerboard = [0, 2], dark = 0, light = 1 }",
        "{ checkerboard = [2, 2], dark = 0 }",
        "{ cells = [[1], [1, 0]] }",
        "{ cells = [] }",
        "{ ramp = [0, 1.5] }",
        "{ dark = 0.5 }",
        "{ ramp = [0, 1], light = 1 }",
    ] {
        assert!(texture(text).is_err(), "{text}");
    }
}

/// Three columns and two rows: 8-bit codes 0 128 255 / 10 64 200.
const GREY: (&str, &[u8]) = ("grey.png", &bytes::GREY_8);
/// One row: f32 0 0.25 1 / 0.5 2 −1.
const FLOATS: (&str, &[u8]) = ("grey.exr", &bytes::EXR_GREY);
/// One row of two pixels: (0.5, 0.25, 0.125) and a quarter of it.
const COLOURS: (&str, &[u8]) = ("colour.exr", &bytes::EXR_COLOUR);

fn cells_of(texture: Texture) -> Vec<f64> {
    match texture {
        Texture::Cells(cells) => cells.albedo,
        other => panic!("{other:?}"),
    }
}

/// The picture stands upright: its lower row is at v = 0. sRGB is that of the standard, worked out
/// here once more.
#[test]
fn a_picture_is_its_pixels_as_cells() {
    let plain = with_files("{ image = \"grey.png\", transfer = \"linear\" }", &[GREY]).unwrap();
    let codes = [10.0, 64.0, 200.0, 0.0, 128.0, 255.0];
    for (albedo, code) in cells_of(plain.clone()).into_iter().zip(codes) {
        // Values of an image are f32.
        assert!((albedo - code / 255.0).abs() < 6e-8);
    }
    assert_eq!(plain.albedo([1.0, 1.0]), 1.0);
    assert_eq!(plain.albedo([0.0, 0.9]), 0.0);
    let text = "{ image = \"grey.png\", transfer = \"srgb\", dark = 0.1, light = 0.6 }";
    let srgb = cells_of(with_files(text, &[GREY]).unwrap());
    for (albedo, code) in srgb.into_iter().zip(codes) {
        let e: f64 = code / 255.0;
        let x = if e <= 0.04045 {
            e / 12.92
        } else {
            ((e + 0.055) / 1.055).powf(2.4)
        };
        assert!((albedo - (0.1 + 0.5 * x)).abs() < 1e-7, "{code}");
    }
}

#[test]
fn channels_are_weighted_on_linear_values() {
    let one = |channel: &str| {
        let text = format!("{{ image = \"colour.exr\", channel = \"{channel}\" }}");
        cells_of(with_files(&text, &[COLOURS]).unwrap())
    };
    assert_eq!(one("red"), [0.5, 0.125]);
    assert_eq!(one("green"), [0.25, 0.0625]);
    assert_eq!(one("blue"), [0.125, 0.03125]);
    let y = 0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722 * 0.125;
    assert!((one("luminance")[0] - y).abs() < 1e-15);
    // Beyond the red primary.
    assert_eq!(one("wavelength"), one("red"));
    // sRGB is undone before the sum: luminance of (255, 0, 128).
    let png = rgb_png([1, 1], &[255, 0, 128], None).unwrap();
    let text = "{ image = \"c.png\", transfer = \"srgb\", channel = \"luminance\" }";
    let y = 0.2126 + 0.0722 * Transfer::Srgb.decode(128.0 / 255.0);
    assert!((cells_of(with_files(text, &[("c.png", &png)]).unwrap())[0] - y).abs() < 1e-8);
}

/// At the three wavelengths one colour alone, half-way half of each, always one in sum.
#[test]
fn the_wavelength_interpolates_between_the_primaries() {
    let [blue, green, red] = picture::DOMINANT;
    let near = |wavelength: f64, truth: [f64; 3]| {
        let weights = picture::by_wavelength(wavelength);
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        assert!(
            weights
                .iter()
                .zip(truth)
                .all(|(w, t)| (w - t).abs() < 1e-12),
            "{weights:?}"
        );
    };
    near(405e-9, [0.0, 0.0, 1.0]);
    near(blue, [0.0, 0.0, 1.0]);
    near(0.5 * (blue + green), [0.0, 0.5, 0.5]);
    near(green, [0.0, 1.0, 0.0]);
    near(0.5 * (green + red), [0.5, 0.5, 0.0]);
    near(1064e-9, [1.0, 0.0, 0.0]);
}

/// The stated wavelengths, from the published chromaticities of the spectral locus (CIE 1931, every
/// 5 nm): where the line from D65 (0.3127, 0.3290) through the primary crosses the chord.
#[test]
fn dominant_wavelengths_follow_from_the_spectral_locus() {
    let white = [0.3127, 0.3290];
    let chords = [
        ([0.15, 0.06], 460.0, [0.1440, 0.0297], [0.1355, 0.0399]),
        ([0.30, 0.60], 545.0, [0.2658, 0.7243], [0.3016, 0.6923]),
        ([0.64, 0.33], 610.0, [0.6658, 0.3340], [0.6801, 0.3197]),
    ];
    for ((primary, start, p, q), stated) in chords.into_iter().zip(picture::DOMINANT) {
        let [dx, dy] = [primary[0] - white[0], primary[1] - white[1]];
        let side = |r: [f64; 2]| dx * (r[1] - white[1]) - dy * (r[0] - white[0]);
        let wavelength = start + 5.0 * side(p) / (side(p) - side(q));
        assert!((wavelength - 1e9 * stated).abs() < 0.06, "{wavelength}");
    }
}

/// A saddle, given at four texels: exact everywhere between their centres, level outside, and its
/// means are values at centres of half-texels.
#[test]
fn bilinear_albedo_is_the_closed_form() {
    let saddle = |u: f64, v: f64| 0.1 + 0.3 * u + 0.2 * v + 0.35 * u * v;
    let albedo = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]];
    let texture = Texture::Bilinear(Bilinear {
        count: [2, 2],
        albedo: albedo.map(|[u, v]| saddle(u, v)).to_vec(),
        wrap: Wrap::Clamp,
    });
    for i in 0..=40 {
        for j in 0..=40 {
            let [u, v] = [f64::from(i) / 40.0, f64::from(j) / 40.0];
            let truth = saddle(u.clamp(0.25, 0.75), v.clamp(0.25, 0.75));
            assert!((texture.albedo([u, v]) - truth).abs() < 1e-15, "{u} {v}");
        }
    }
    assert_eq!(texture.albedo([-3.0, 7.0]), texture.albedo([0.0, 1.0]));
    assert_eq!(texture.smooth_cells(), [4, 4]);
    // Brute force over each half-texel; the midpoint rule is exact for what is bilinear.
    for cell in 0..16 {
        let [iu, iv] = [(cell % 4) as f64, (cell / 4) as f64];
        let n = 8;
        let at = |k: usize| {
            let [a, b] = [(k % n) as f64, (k / n) as f64].map(|x| (x + 0.5) / n as f64);
            texture.albedo([(iu + a) / 4.0, (iv + b) / 4.0])
        };
        let mean = (0..n * n).map(at).sum::<f64>() / (n * n) as f64;
        assert!((texture.cell_mean(cell) - mean).abs() < 1e-14, "{cell}");
    }
}

#[test]
fn a_texture_repeats_only_when_told() {
    let codes: [u16; 3] = [0, 65535, 13107];
    let png = grey16_png([3, 1], &codes).unwrap();
    let of = |rest: &str| {
        let text = format!("{{ image = \"a.png\", transfer = \"linear\"{rest} }}");
        with_files(&text, &[("a.png", &png)]).unwrap()
    };
    let near = |x: f64, y: f64| assert!((x - y).abs() < 1e-7, "{x} {y}");
    near(of("").albedo([1.1, 0.5]), 0.2);
    near(of(", wrap = \"repeat\"").albedo([1.5, -3.0]), 1.0);
    near(of(", wrap = \"repeat\"").albedo([-0.1, 0.5]), 0.2);
    let clamped = of(", filter = \"bilinear\", wrap = \"clamp\"");
    let tiled = of(", filter = \"bilinear\", wrap = \"repeat\"");
    near(clamped.albedo([0.0, 0.5]), 0.0);
    // Half-way between the last texel and the first.
    for u in [0.0, 1.0, 5.0, -1e-20] {
        near(tiled.albedo([u, 0.5]), 0.1);
    }
    // Within, both are the same; a period later the tiled one is itself.
    for k in 0..60 {
        let u = (f64::from(k) + 0.5) / 60.0;
        near(tiled.albedo([u + 2.0, 0.5]), tiled.albedo([u, 0.5]));
        if (1.0 / 6.0..=5.0 / 6.0).contains(&u) {
            near(tiled.albedo([u, 0.5]), clamped.albedo([u, 0.5]));
        }
    }
    let sum: f64 = (0..12).map(|c| tiled.cell_mean(c)).sum();
    near(sum / 12.0, (0.0 + 1.0 + 0.2) / 3.0);
    near(tiled.largest(), 1.0);
}

#[test]
fn a_target_is_a_texture_without_a_file() {
    let text = "{ target = \"card\", size = [47, 31], dark = 0.05, light = 0.9 }";
    let card = cells_of(texture(text).unwrap());
    let drawn = Target::Card.picture([47, 31]).unwrap();
    for (k, albedo) in card.iter().enumerate() {
        let value = drawn.values[k % 47 + (30 - k / 47) * 47];
        assert!((albedo - (0.05 + 0.85 * value)).abs() < 1e-15);
    }
    assert_eq!(
        texture("{ target = \"ramp\" }").unwrap().smooth_cells(),
        [256, 32]
    );
}

#[test]
fn what_is_wrong_with_a_picture_is_named_with_its_cure() {
    let clear: (&str, &[u8]) = ("clear.png", &bytes::RGBA);
    let opaque: (&str, &[u8]) = ("opaque.png", &bytes::GREY_ALPHA);
    let wide = grey16_png([4097, 1], &[0; 4097]).unwrap();
    let files = [
        GREY,
        FLOATS,
        COLOURS,
        clear,
        opaque,
        ("bad.png", &b"\x89PNG\r\n"[..]),
        ("wide.png", &wide),
    ];
    for (text, words) in [
        (
            "{ image = \"none.png\" }",
            "`none.png` cannot be read: there is no such file",
        ),
        (
            "{ image = \"bad.png\", transfer = \"srgb\" }",
            "`bad.png` is damaged",
        ),
        (
            "{ image = \"wide.png\", transfer = \"srgb\" }",
            "4097 × 1 pixels",
        ),
        (
            "{ image = \"grey.png\" }",
            "does not say what its values mean",
        ),
        (
            "{ image = \"grey.png\", transfer = \"srgb\", channel = \"red\" }",
            "no colours",
        ),
        (
            "{ image = \"clear.png\", transfer = \"srgb\", channel = \"red\" }",
            "not opaque at pixel (1, 0)",
        ),
        ("{ image = \"grey.exr\" }", "pixel (1, 1) of `grey.exr`"),
        ("{ image = \"colour.exr\" }", "has colours"),
        ("{ image = \"colour.exr\", channel = \"grey\" }", "no grey"),
        (
            "{ image = \"colour.exr\", transfer = \"srgb\", channel = \"red\" }",
            "linear by its definition",
        ),
        (
            "{ image = \"colour.exr\", channel = \"red\", light = 1.5 }",
            "outside [0, 1]",
        ),
        (
            "{ image = \"colour.exr\", channel = \"red\", size = [2, 2] }",
            "`size` belongs to `target`",
        ),
        ("{ target = \"joker\" }", "no target `joker`"),
        ("{ target = \"card\", size = [0, 4] }", "0 × 4"),
        ("{ target = \"card\", size = [5000, 4] }", "5000 × 4"),
        (
            "{ target = \"card\", transfer = \"srgb\" }",
            "`transfer` belongs to `image`",
        ),
        (
            "{ target = \"card\", image = \"grey.png\" }",
            "exactly one of",
        ),
        (
            "{ checkerboard = [2, 2], dark = 0, light = 1, filter = \"bilinear\" }",
            "`filter` belongs to",
        ),
        ("{ ramp = [0, 1], wrap = \"repeat\" }", "`wrap` belongs to"),
    ] {
        let fault = with_files(text, &files).unwrap_err();
        assert!(fault.cause.contains(words), "{text}: {}", fault.cause);
        assert!(!fault.cure.is_empty(), "{text}");
    }
    // A channel of opacity that is 1 throughout is no hindrance.
    let text = "{ image = \"opaque.png\", transfer = \"linear\" }";
    let albedo = cells_of(with_files(text, &files).unwrap());
    assert!((albedo[0] - 9.0 / 255.0).abs() < 1e-8 && (albedo[1] - 17.0 / 255.0).abs() < 1e-8);
}
