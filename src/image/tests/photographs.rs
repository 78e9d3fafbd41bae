//! Photographs as tifffile and Pillow wrote them: `tests/photographs/make_files.py`.

use super::super::{Channel, Samples, grey16_png, samples};

macro_rules! file {
    ($name:literal) => {
        include_bytes!(concat!("../../../tests/photographs/", $name))
    };
}

const TURNED: [&[u8]; 8] = [
    file!("grey8-s1-turned-1.png"),
    file!("grey8-s1-turned-2.png"),
    file!("grey8-s1-turned-3.png"),
    file!("grey8-s1-turned-4.png"),
    file!("grey8-s1-turned-5.png"),
    file!("grey8-s1-turned-6.png"),
    file!("grey8-s1-turned-7.png"),
    file!("grey8-s1-turned-8.png"),
];

fn only(bytes: &[u8]) -> Samples {
    let mut frames = samples("a", bytes).unwrap();
    assert_eq!(frames.len(), 1);
    frames.remove(0)
}

/// The samples of page `page`, `channels` a pixel, as `make_files.py` defines them.
fn expected([columns, rows]: [usize; 2], channels: usize, page: usize, step: f64) -> Vec<f64> {
    let pixels = (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c)));
    let all = pixels.flat_map(|(r, c)| (0..channels).map(move |k| (r, c, k)));
    all.map(|(r, c, k)| step * ((37 * r + 101 * c + 11 * k + 5 * page) % 251) as f64)
        .collect()
}

#[test]
fn samples_are_those_that_were_saved() {
    let (grey, colour) = (1, 3);
    type Saved = (&'static [u8], [usize; 2], usize, f64, Option<f64>);
    let all: [Saved; 9] = [
        (
            file!("grey8-s1-strips-lzw.tif"),
            [7, 5],
            grey,
            1.0,
            Some(255.0),
        ),
        (
            file!("grey16-s257-big-endian.tif"),
            [7, 5],
            grey,
            257.0,
            Some(65535.0),
        ),
        (
            file!("grey16-s257-20x37-tiles-deflate.tif"),
            [37, 20],
            grey,
            257.0,
            Some(65535.0),
        ),
        (
            file!("grey32-s16777259.tif"),
            [7, 5],
            grey,
            16_777_259.0,
            Some(4_294_967_295.0),
        ),
        (
            file!("float32-s0.25-packbits.tif"),
            [7, 5],
            grey,
            0.25,
            None,
        ),
        (
            file!("colour16-s257-planar.tif"),
            [7, 5],
            colour,
            257.0,
            Some(65535.0),
        ),
        (file!("colour8-s1.tif"), [7, 5], colour, 1.0, Some(255.0)),
        (
            file!("colour8-s1-32x48-tiled-planes.tif"),
            [48, 32],
            colour,
            1.0,
            Some(255.0),
        ),
        (
            file!("grey8-s1-turned-6.tif"),
            [7, 5],
            grey,
            1.0,
            Some(255.0),
        ),
    ];
    for (k, (bytes, size, channels, step, full_scale)) in all.into_iter().enumerate() {
        let frame = only(bytes);
        assert_eq!([frame.width, frame.height], size, "{k}");
        assert_eq!(
            (frame.channels.len(), frame.full_scale),
            (channels, full_scale),
            "{k}"
        );
        assert_eq!(frame.values, expected(size, channels, 0, step), "{k}");
    }
    let pages = samples("a", file!("pages8-s1-3.tif")).unwrap();
    assert_eq!(pages.len(), 3);
    for (page, frame) in pages.iter().enumerate() {
        assert_eq!(frame.values, expected([7, 5], 1, page, 1.0));
    }
}

/// However the camera was held, the picture stands upright (Pillow's `exif_transpose` agrees).
#[test]
fn the_noted_orientation_is_applied() {
    for bytes in TURNED {
        let frame = only(bytes);
        assert_eq!([frame.width, frame.height], [7, 5]);
        assert_eq!(frame.values, expected([7, 5], 1, 0, 1.0));
    }
    let jpeg = only(file!("halves-turned-6.jpg"));
    assert_eq!(
        [jpeg.width, jpeg.height, usize::from(jpeg.is_lossy)],
        [8, 16, 1]
    );
    for (k, value) in jpeg.values.iter().enumerate() {
        let saved = if k < 64 { 200.0 } else { 40.0 };
        assert!((value - saved).abs() <= 1.0, "{k}: {value}");
    }
    // A number that means nothing is refused: big-endian, the value of the note ends at its tenth
    // byte.
    let mut odd = TURNED[5].to_vec();
    let at = odd.windows(4).position(|w| w == b"eXIf").unwrap() + 4;
    let note = at + odd[at..].windows(2).position(|w| w == [1, 0x12]).unwrap() + 9;
    assert_eq!(odd[note], 6);
    odd[note] = 9;
    let error = samples("a", &odd).unwrap_err().to_string();
    assert!(error.contains("orientation 9"), "{error}");
}

/// 16 bits are exact, and a transparent pixel, a palette and few bits are refused.
#[test]
fn integers_stay_integers_and_what_is_no_light_is_refused() {
    let codes: Vec<u16> = (0..=u16::MAX).collect();
    let frame = only(&grey16_png([256, 256], &codes).unwrap());
    assert_eq!(frame.channels, [Channel::Grey]);
    assert!(
        frame
            .values
            .iter()
            .zip(codes)
            .all(|(x, c)| *x == f64::from(c))
    );
    use super::bytes;
    let refused: [(&[u8], &str); 9] = [
        (&bytes::RGBA, "alpha"),
        (&bytes::PALETTE, "palette"),
        (&bytes::BITS, "1 bits"),
        (file!("white-is-zero.tif"), "zero is white"),
        (file!("alpha.tif"), "without alpha"),
        (file!("tiled-planes-cut.tif"), "save it in strips"),
        (file!("tiled-lzw.tif"), "uncompressed or with Deflate"),
        (&bytes::JPEG_CMYK, "save it as RGB"),
        (b"II*\0", "damaged"),
    ];
    for (bytes, words) in refused {
        let error = samples("a.tif", bytes).unwrap_err().to_string();
        assert!(
            error.contains(words) && error.contains("`a.tif`"),
            "{error}"
        );
    }
    // An opaque alpha says nothing, and is left out.
    assert_eq!(only(&bytes::GREY_ALPHA).values, [9.0, 17.0]);
}

/// Chunks as the PNG specification writes them: gAMA of 1/2.2 and of 1, sRGB.
#[test]
fn an_encoding_that_a_png_states_is_told() {
    let plain = grey16_png([2, 1], &[7, 9]).unwrap();
    let with = |chunk: &[u8]| only(&[&plain[..33], chunk, &plain[33..]].concat());
    let encoded = with(b"\0\0\0\x04gAMA\0\0\xb1\x8f\x0b\xfc\x61\x05");
    assert!((encoded.gamma.unwrap() - 2.2).abs() < 1e-4, "{encoded:?}");
    assert_eq!(encoded.values, [7.0, 9.0]);
    let srgb = with(b"\0\0\0\x01sRGB\0\xae\xce\x1c\xe9");
    assert!((srgb.gamma.unwrap() - 2.2).abs() < 1e-4, "{srgb:?}");
    let linear = with(b"\0\0\0\x04gAMA\0\x01\x86\xa0\x31\xe8\x96\x5f");
    assert_eq!([linear.gamma, only(&plain).gamma], [None; 2]);
}

/// A header that promises 2³¹ pixels is refused before memory is taken, and no prefix panics.
#[test]
fn cut_and_forged_files_are_refused() {
    let whole: &[u8] = file!("grey16-s257-big-endian.tif");
    for length in 4..whole.len() {
        let _ = samples("a", &whole[..length]);
    }
    // Tags 256 to 278, width, height and rows of a strip, in the directory: type LONG or SHORT,
    // big-endian.
    let mut forged = whole.to_vec();
    for tag in [256u16, 257, 278] {
        let head = [&tag.to_be_bytes()[..], &[0]].concat();
        let at = forged.windows(3).position(|w| w == head).unwrap();
        forged[at + 2..at + 4].copy_from_slice(&4u16.to_be_bytes());
        forged[at + 8..at + 12].copy_from_slice(&46_000u32.to_be_bytes());
    }
    let error = samples("a", &forged).unwrap_err().to_string();
    assert!(
        error.contains("46000 × 46000") && error.contains("too short"),
        "{error}"
    );
    let cut = samples("a", &whole[..whole.len() - 40])
        .unwrap_err()
        .to_string();
    assert!(cut.contains("damaged"), "{cut}");
}
