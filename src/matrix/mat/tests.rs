use super::super::npy::read_array;
use super::*;

const V6: &[u8] = include_bytes!("../../../tests/photographs/stack-v6.mat");
const V7: &[u8] = include_bytes!("../../../tests/photographs/stack-v7.mat");
const ONE: &[u8] = include_bytes!("../../../tests/photographs/one-v7.mat");
const COMPLEX: &[u8] = include_bytes!("../../../tests/photographs/complex-v7.mat");
const FORTRAN: &[u8] = include_bytes!("../../../tests/photographs/stack-i2-fortran.npy");
const BYTES: &[u8] = include_bytes!("../../../tests/photographs/stack-u1.npy");
const FLOATS: &[u8] = include_bytes!("../../../tests/photographs/colour-f4.npy");

/// What `make_files.py` says of its samples.
fn sample(page: usize, row: usize, column: usize, channel: usize) -> f64 {
    ((37 * row + 101 * column + 11 * channel + 5 * page) % 251) as f64
}

/// Three pages of 5 × 7.
fn stack() -> Vec<f64> {
    let pages = (0..3).flat_map(|p| (0..5).flat_map(move |r| (0..7).map(move |c| (p, r, c))));
    pages.map(|(p, r, c)| sample(p, r, c, 0)).collect()
}

fn colour() -> Vec<f64> {
    let all = (0..5).flat_map(|r| (0..7).flat_map(move |c| (0..3).map(move |k| (r, c, k))));
    all.map(|(r, c, k)| sample(0, r, c, k)).collect()
}

#[test]
fn variables_are_those_that_scipy_saved() {
    for bytes in [V6, V7] {
        let frames = read("a.mat", bytes, Some("frames")).unwrap();
        assert_eq!(frames.shape, [3, 5, 7]);
        assert_eq!(frames.full_scale, Some(65535.0));
        assert_eq!(frames.values, stack());
        let picture = read("a.mat", bytes, Some("picture")).unwrap();
        assert_eq!((picture.shape, picture.full_scale), (vec![5, 7, 3], None));
        assert_eq!(picture.values, colour());
    }
    let only = read("a.mat", ONE, None).unwrap();
    assert_eq!((only.shape, only.full_scale), (vec![5, 7], Some(32767.0)));
    let negative: Vec<f64> = stack()[..35].iter().map(|x| 3.0 - x).collect();
    assert_eq!(only.values, negative);
}

#[test]
fn arrays_are_those_that_numpy_saved() {
    let array = read_array("a.npy", BYTES).unwrap();
    assert_eq!(
        (&array.shape[..], array.full_scale),
        (&[3, 5, 7][..], Some(255.0))
    );
    assert_eq!(array.values, stack());
    let array = read_array("a.npy", FORTRAN).unwrap();
    assert_eq!(
        (&array.shape[..], array.full_scale),
        (&[3, 5, 7][..], Some(32767.0))
    );
    assert_eq!(
        array.values,
        stack().iter().map(|x| x - 100.0).collect::<Vec<_>>()
    );
    let array = read_array("a.npy", FLOATS).unwrap();
    assert_eq!((&array.shape[..], array.full_scale), (&[5, 7, 3][..], None));
    assert_eq!(
        array.values,
        colour().iter().map(|x| 0.25 * x).collect::<Vec<_>>()
    );
}

#[test]
fn what_cannot_be_read_is_refused_with_a_cure() {
    let words = |bytes: &[u8], wanted, words: &[&str]| {
        let error = read("a.mat", bytes, wanted).unwrap_err().to_string();
        for word in words {
            assert!(error.contains(word), "{error}");
        }
    };
    words(COMPLEX, None, &["`photo`", "real"]);
    words(V7, None, &["`frames`", "`picture`", "variable"]);
    words(V7, Some("other"), &["`other`", "frames, picture, name"]);
    words(V7, Some("name"), &["`name`", "real"]);
    words(b"MATLAB 5.0", None, &["version 5 or 7.3"]);
    let npy = |bytes: &[u8]| read_array("a.npy", bytes).unwrap_err().to_string();
    assert!(npy(&BYTES[..BYTES.len() - 1]).contains("promises 105"));
    let mut text = BYTES.to_vec();
    let kind = text.windows(3).position(|w| w == b"|u1").unwrap() + 1;
    text[kind] = b'S';
    assert!(npy(&text).contains("astype"));
    let mut nan = FLOATS.to_vec();
    let at = nan.len() - 4;
    nan[at..].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(npy(&nan).contains("not finite"));
}

/// No prefix of a file is taken for the whole of it, and none is a panic.
#[test]
fn a_cut_file_is_refused() {
    for (bytes, wanted) in [(V6, Some("picture")), (ONE, None)] {
        for length in 0..bytes.len() {
            let cut = read("a.mat", &bytes[..length], wanted);
            // What follows a whole variable is not needed, nor is its padding.
            let whole = read("a.mat", bytes, wanted).unwrap();
            assert!(cut.is_err() || cut.unwrap() == whole, "{length}");
        }
        assert!(read("a.mat", &bytes[..bytes.len() / 2], wanted).is_err());
    }
}

/// A variable that claims 2²⁷ entries in a file of 200 bytes takes no memory for them.
#[test]
fn a_forged_length_is_refused() {
    let mut forged = V6.to_vec();
    let at = forged.windows(6).position(|w| w == b"frames").unwrap();
    // The dimensions end before the name's tag.
    let dimensions = at - 8 - 16;
    assert_eq!(forged[dimensions..dimensions + 4], 3u32.to_le_bytes());
    forged[dimensions..dimensions + 4].copy_from_slice(&3_000_000u32.to_le_bytes());
    let error = read("a.mat", &forged, Some("frames"))
        .unwrap_err()
        .to_string();
    assert!(error.contains("cut short"), "{error}");
    forged[dimensions..dimensions + 4].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(
        read("a.mat", &forged, Some("frames"))
            .unwrap_err()
            .to_string()
            .contains("2²⁷")
    );
}
