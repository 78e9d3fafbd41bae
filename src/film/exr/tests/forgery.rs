//! Random damage: a file is refused or read, never a panic and never memory beyond its bound.

use super::*;
use proptest::prelude::*;

/// Every type of attribute that OpenEXR documents.
const KINDS: [&str; 26] = [
    "box2i",
    "box2f",
    "bytes",
    "chlist",
    "chromaticities",
    "compression",
    "deepImageState",
    "double",
    "envmap",
    "float",
    "floatvector",
    "int",
    "keycode",
    "lineOrder",
    "m33f",
    "m44f",
    "preview",
    "rational",
    "string",
    "stringvector",
    "tiledesc",
    "timecode",
    "v2f",
    "v2i",
    "v3f",
    "v3i",
];

proptest! {
    #[test]
    fn no_flipped_bit_of_the_header_panics(flips in prop::collection::vec((any::<prop::sample::Index>(), 0u8..8), 1..4)) {
        let mut bytes = file();
        let end = envelope::check_list(&bytes).unwrap() + 24;
        for (at, bit) in flips {
            bytes[at.index(end)] ^= 1 << bit;
        }
        if let Ok(frame) = read_bytes(&bytes) {
            prop_assert!(4 * frame.pixels() * frame.channels.len() <= DEFLATE_RATIO_MAX * bytes.len());
        }
    }

    #[test]
    fn no_flipped_bit_of_the_pixels_passes_or_panics(at in any::<prop::sample::Index>(), bit in 0u8..8) {
        let mut bytes = file();
        let before = read_bytes(&bytes).unwrap();
        let start = envelope::check_list(&bytes).unwrap() + 24;
        let at = start + at.index(bytes.len() - start);
        bytes[at] ^= 1 << bit;
        // Adler-32 sees every single flipped bit of what it covers; bits of the deflate stream that
        // mean nothing may pass.
        if let Ok(after) = read_bytes(&bytes) {
            for channel in &before.channels {
                prop_assert_eq!(bits(&after, &channel.name), bits(&before, &channel.name), "byte {}", at);
            }
        }
    }

    #[test]
    fn no_replaced_stretch_panics(at in any::<prop::sample::Index>(), stretch in prop::collection::vec(any::<u8>(), 1..40)) {
        let mut bytes = file();
        let at = at.index(bytes.len());
        let end = (at + stretch.len()).min(bytes.len());
        bytes[at..end].copy_from_slice(&stretch[..end - at]);
        let _ = read_bytes(&bytes);
    }

    #[test]
    fn no_foreign_attribute_panics(
        name in "(extra|tiles|name|type|version|maxSamplesPerPixel|channels|preview|timeCode|view)",
        kind in prop::sample::select(&KINDS[..]),
        words in prop::collection::vec(prop_oneof![Just(u32::MAX), Just(0), Just(1), Just(0x8000_0000), any::<u32>()], 0..20),
        size in prop_oneof![9 => Just(None), 1 => any::<i32>().prop_map(Some)],
    ) {
        let value: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
        let size = size.unwrap_or(value.len() as i32).to_le_bytes();
        let attribute = [name.as_bytes(), b"\0", kind.as_bytes(), b"\0", &size, &value].concat();
        let whole = file();
        let _ = read_bytes(&[&whole[..8], &attribute, &whole[8..]].concat());
    }
}
