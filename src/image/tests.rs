use super::*;
use proptest::prelude::*;

pub(crate) mod bytes;
mod photographs;

/// Every file of [`bytes`] that is a picture of ours, with its name.
const WHOLE: [(&str, &[u8]); 10] = [
    ("grey 8", &bytes::GREY_8),
    ("grey 16", &bytes::GREY_16),
    ("colour and alpha", &bytes::RGBA),
    ("grey and alpha", &bytes::GREY_ALPHA),
    ("palette", &bytes::PALETTE),
    ("one bit", &bytes::BITS),
    ("JPEG grey", &bytes::JPEG_GREY),
    ("JPEG colour", &bytes::JPEG_COLOUR),
    ("EXR Y", &bytes::EXR_GREY),
    ("EXR RGB", &bytes::EXR_COLOUR),
];

fn read(bytes: &[u8]) -> Image {
    decode("test", bytes).unwrap()
}

/// The integers that a picture stored, `most` its largest.
fn codes(image: &Image, most: f64) -> Vec<u32> {
    assert_eq!(image.encoding, Encoding::Integer);
    let code = |v: &f32| (f64::from(*v) * most).round() as u32;
    image.values.iter().map(code).collect()
}

#[test]
fn integers_are_those_that_were_saved() {
    let image = read(&bytes::GREY_8);
    assert_eq!((image.width, image.height), (3, 2));
    assert_eq!(image.channels, [Channel::Grey]);
    assert_eq!(codes(&image, 255.0), [0, 128, 255, 10, 64, 200]);
    let deep = read(&bytes::GREY_16);
    assert_eq!(codes(&deep, 65535.0), [0, 1, 65535, 256, 32768, 4660]);
    let colours = read(&bytes::RGBA);
    assert_eq!(
        colours.channels,
        [Channel::Red, Channel::Green, Channel::Blue, Channel::Alpha]
    );
    assert_eq!(codes(&colours, 255.0), [255, 0, 1, 255, 2, 3, 4, 128]);
    let alpha: Vec<f32> = colours.channel(Channel::Alpha).unwrap().collect();
    assert_eq!(alpha, [1.0, (128.0 / 255.0) as f32]);
    let grey = read(&bytes::GREY_ALPHA);
    assert_eq!(grey.channels, [Channel::Grey, Channel::Alpha]);
    assert_eq!(codes(&grey, 255.0), [9, 255, 17, 255]);
    let palette = read(&bytes::PALETTE);
    let [r, g, b] = [[255, 0, 0], [0, 254, 0], [3, 2, 253]];
    assert_eq!(codes(&palette, 255.0), [r, g, b, b, g, r].concat());
    assert_eq!(codes(&read(&bytes::BITS), 255.0), [0, 255, 255, 0, 255]);
}

/// Four flat blocks of 8 × 8: quality 95 quantises their mean in steps of 2/8 codes. Colours pass
/// through YCbCr, rounded to whole codes in between.
#[test]
fn flat_blocks_of_a_jpeg_are_within_a_code() {
    let image = read(&bytes::JPEG_GREY);
    assert_eq!((image.width, image.height), (16, 16));
    assert_eq!(image.channels, [Channel::Grey]);
    for (i, code) in codes(&image, 255.0).into_iter().enumerate() {
        let saved: u32 = [[10, 90], [160, 250]][i / 16 / 8][i % 16 / 8];
        assert!(code.abs_diff(saved) <= 1, "pixel {i}: {code} for {saved}");
    }
    let image = read(&bytes::JPEG_COLOUR);
    assert_eq!(image.channels.len(), 3);
    for pixel in codes(&image, 255.0).chunks(3) {
        for (code, saved) in pixel.iter().zip([200u32, 60, 20]) {
            assert!(code.abs_diff(saved) <= 2, "{pixel:?}");
        }
    }
}

#[test]
fn floating_point_values_are_those_that_were_saved() {
    let image = read(&bytes::EXR_GREY);
    assert_eq!((image.width, image.height), (3, 2));
    assert_eq!(
        (image.channels.as_slice(), image.encoding),
        (&[Channel::Grey][..], Encoding::Float)
    );
    assert_eq!(image.values, [0.0, 0.25, 1.0, 0.5, 2.0, -1.0]);
    let image = read(&bytes::EXR_COLOUR);
    assert_eq!(
        image.channels,
        [Channel::Red, Channel::Green, Channel::Blue]
    );
    assert_eq!(image.values, [0.5, 0.25, 0.125, 0.125, 0.0625, 0.03125]);
}

/// An OpenEXR file whose display window goes from `low` to `high`; its data stay at (0, 0)–(2, 1).
fn shown(low: [i32; 2], high: [i32; 2]) -> Vec<u8> {
    let mut exr = bytes::EXR_GREY.to_vec();
    let name = b"displayWindow\0box2i\0";
    let at = exr.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
    for (k, corner) in [low, high].as_flattened().iter().enumerate() {
        exr[at + 4 * k..][..4].copy_from_slice(&corner.to_le_bytes());
    }
    exr
}

/// The data of an OpenEXR file lie where they are in its display window; outside it is black. A
/// photograph has to be whole.
#[test]
fn a_picture_is_its_display_window() {
    let wide = read(&shown([-1, -2], [3, 1]));
    assert_eq!((wide.width, wide.height), (5, 4));
    let rows: [[f32; 5]; 4] = [
        [0.0; 5],
        [0.0; 5],
        [0.0, 0.0, 0.25, 1.0, 0.0],
        [0.0, 0.5, 2.0, -1.0, 0.0],
    ];
    assert_eq!(wide.values, rows.as_flattened());
    assert_eq!(size(&shown([-1, -2], [3, 1])), Some([5, 4]));
    let narrow = read(&shown([1, 0], [2, 0]));
    assert_eq!((narrow.width, narrow.height), (2, 1));
    assert_eq!(narrow.values, [0.25, 1.0]);
    assert_eq!(read(&shown([9, 9], [9, 9])).values, [0.0]);
    let error = samples("p.exr", &shown([-1, -2], [3, 1]))
        .unwrap_err()
        .to_string();
    assert!(error.contains("data window"), "{error}");
    assert!(samples("p.exr", &shown([0, 0], [2, 1])).is_ok());
    let huge = decode("h.exr", &shown([0, 0], [1 << 20, 1 << 20])).unwrap_err();
    assert!(matches!(huge, ImageError::Size { .. }), "{huge}");
    // Few bytes stand for few pixels, whatever the display window.
    let sparse = decode("s.exr", &shown([0, 0], [4095, 4095])).unwrap_err();
    assert!(
        sparse.to_string().contains("crop the display window"),
        "{sparse}"
    );
}

#[test]
fn what_is_encoded_is_decoded() {
    let pixels: Vec<u8> = (0..18).collect();
    let png = rgb_png([3, 2], &pixels, Some(11_811)).unwrap();
    let image = read(&png);
    assert_eq!((image.width, image.height), (3, 2));
    assert_eq!(codes(&image, 255.0), (0..18).collect::<Vec<u32>>());
    // The chunk pHYs: two words for the pixels of a metre, and 1 for the metre.
    let at = png.windows(4).position(|w| w == b"pHYs").unwrap() + 4;
    let stated = [11_811u32.to_be_bytes(), 11_811u32.to_be_bytes()].concat();
    assert_eq!(png[at..at + 8], stated);
    assert_eq!(png[at + 8], 1);
    let deep = grey16_png([2, 1], &[0x1234, 0xfffe]).unwrap();
    assert_eq!(codes(&read(&deep), 65535.0), [0x1234, 0xfffe]);
}

#[test]
fn what_is_no_picture_of_ours_is_refused_with_a_cure() {
    for (bytes, words) in [
        (&b"GIF89a"[..], "save it as one of them"),
        (&b""[..], "save it as one of them"),
        (&bytes::JPEG_CMYK, "save it as RGB or grey"),
    ] {
        let error = decode("card.gif", bytes).unwrap_err().to_string();
        assert!(
            error.contains(words) && error.contains("`card.gif`"),
            "{error}"
        );
    }
    // The flags of an OpenEXR file's version are its second and third byte.
    for (flag, words) in [
        (0x02, "it is tiled"),
        (0x08, "deep"),
        (0x10, "more than one part"),
    ] {
        let mut exr = bytes::EXR_GREY.to_vec();
        exr[5] |= flag;
        let error = decode("card.exr", &exr).unwrap_err();
        assert!(matches!(error, ImageError::Unsupported { .. }), "{error}");
        assert!(error.to_string().contains(words), "{error}");
    }
}

#[test]
fn a_picture_cut_short_anywhere_is_refused() {
    for (name, whole) in WHOLE {
        for n in 0..whole.len() {
            assert!(
                decode(name, &whole[..n]).is_err(),
                "{name}: {n} of {} bytes",
                whole.len()
            );
        }
    }
}

/// The chunk `kind` of a PNG, with its checksum (CRC-32 of ISO 3309).
fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let covered = [&kind[..], data].concat();
    let crc = covered.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| {
            (c >> 1) ^ (0xedb8_8320 * (c & 1))
        })
    });
    let length = (data.len() as u32).to_be_bytes();
    [&length[..], &covered, &(!crc).to_be_bytes()].concat()
}

/// A PNG that claims `size` of 16-bit RGBA, with the given bytes as its pixels.
fn forged(size: [u32; 2], data: &[u8]) -> Vec<u8> {
    let [w, h] = size.map(u32::to_be_bytes);
    let header = [&w[..], &h, &[16, 6, 0, 0, 0]].concat();
    let parts = [
        chunk(b"IHDR", &header),
        chunk(b"IDAT", data),
        chunk(b"IEND", &[]),
    ];
    [b"\x89PNG\r\n\x1a\n".to_vec(), parts.concat()].concat()
}

#[test]
fn forged_sizes_are_refused_before_memory_is_taken() {
    let most = i32::MAX as u32;
    let claims = [
        [most, most],
        [most, 1],
        [1, most],
        [70_000, 70_000],
        [4096, 4096],
        [500, 500],
    ];
    for size in claims {
        let error = decode("bomb.png", &forged(size, &[0x78, 0x9c])).unwrap_err();
        assert!(
            matches!(error, ImageError::Size { .. }),
            "{size:?}: {error}"
        );
    }
    assert!(decode("bomb.png", &forged([0, 5], &[0x78, 0x9c])).is_err());
    // Long enough for the claim by its length, but its bytes do not inflate to anything.
    let long = forged([1000, 1000], &vec![0; 10_000]);
    assert!(matches!(
        decode("bomb.png", &long),
        Err(ImageError::Damaged { .. })
    ));
    // A JPEG's size stands behind its marker SOF0 or SOF2: length, bits, then height and width.
    for mut jpeg in [bytes::JPEG_GREY.to_vec(), bytes::JPEG_COLOUR.to_vec()] {
        let at = jpeg
            .windows(2)
            .position(|w| w[0] == 0xff && (w[1] == 0xc0 || w[1] == 0xc2));
        let at = at.unwrap() + 5;
        jpeg[at..at + 4].copy_from_slice(&[0xff, 0xf0, 0xff, 0xf0]);
        assert!(matches!(
            decode("bomb.jpg", &jpeg),
            Err(ImageError::Size { .. })
        ));
    }
    // Both windows of an OpenEXR header: xmax and ymax at their ends.
    let mut exr = bytes::EXR_GREY.to_vec();
    for name in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        let at = exr.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
        exr[at + 8..at + 16].copy_from_slice(&[0xff, 0xff, 0xff, 0x3f, 0xff, 0xff, 0xff, 0x3f]);
    }
    assert!(decode("bomb.exr", &exr).is_err());
}

/// A whole PNG of one more pixel than is allowed is refused although its file could hold it.
#[test]
fn more_pixels_than_a_texture_has_are_refused() {
    let error = checked_size("wide.png", [4096, 4097], usize::MAX, MOST_PIXELS).unwrap_err();
    assert!(
        error.to_string().contains("more than 4096 × 4096"),
        "{error}"
    );
    assert!(checked_size("wide.png", [4096, 4096], usize::MAX, MOST_PIXELS).is_ok());
}

proptest! {
    #[test]
    fn no_flipped_bits_panic(which in 0..WHOLE.len(), flips in prop::collection::vec((any::<prop::sample::Index>(), 0u8..8), 1..5)) {
        let (name, whole) = WHOLE[which];
        let mut bytes = whole.to_vec();
        for (at, bit) in flips {
            bytes[at.index(whole.len())] ^= 1 << bit;
        }
        if let Ok(image) = decode(name, &bytes) {
            prop_assert!(image.width * image.height <= 8 * DEFLATE_RATIO_MAX * bytes.len());
            prop_assert_eq!(image.values.len(), image.width * image.height * image.channels.len());
        }
    }

    #[test]
    fn no_replaced_stretch_panics(which in 0..WHOLE.len(), at in any::<prop::sample::Index>(), stretch in prop::collection::vec(any::<u8>(), 1..40)) {
        let (name, whole) = WHOLE[which];
        let mut bytes = whole.to_vec();
        let at = at.index(bytes.len());
        let end = (at + stretch.len()).min(bytes.len());
        bytes[at..end].copy_from_slice(&stretch[..end - at]);
        let _ = decode(name, &bytes);
    }
}
