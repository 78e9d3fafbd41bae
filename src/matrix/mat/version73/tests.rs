//! Against what h5py, hdf5storage and SciPy wrote: `tests/photographs/make_mat73.py`.

use super::super::read;
use crate::matrix::{Array, ArrayError};

macro_rules! stored {
    ($name:literal) => {
        include_bytes!(concat!("../../../../tests/photographs/", $name))
    };
}

const VERSION5: &[u8] = stored!("types-v7.mat");
const TYPES: &[u8] = stored!("types-v73.mat");
const PACKED: &[u8] = stored!("packed-v73.mat");
const OTHERS: &[u8] = stored!("others-v73.mat");
const TREE: &[u8] = stored!("tree-v73.mat");
const LATER: &[u8] = stored!("later-v73.mat");
const PYTHON: &[u8] = stored!("python-v73.mat");
const UNNAMED: &[u8] = stored!("stack-v73.mat");

/// Pages of rows × columns, the page the last index, as `make_mat73.py` says of its values.
fn values([rows, columns, pages]: [usize; 3]) -> Vec<f64> {
    let all =
        (0..rows * columns * pages).map(|k| (k / pages / columns, k / pages % columns, k % pages));
    all.map(|(r, c, p)| ((37 * r + 101 * c + 5 * p) % 251) as f64)
        .collect()
}

fn error(bytes: &[u8], wanted: Option<&str>) -> String {
    read("a.mat", bytes, wanted).unwrap_err().to_string()
}

#[test]
fn every_type_is_that_of_version_5() {
    let names = [
        "double", "single", "logical", "frames", "int8", "int16", "int32", "int64", "uint8",
        "uint16", "uint32", "uint64",
    ];
    for name in names {
        let due = read("a.mat", VERSION5, Some(name)).unwrap();
        assert_eq!(read("a.mat", TYPES, Some(name)), Ok(due), "{name}");
    }
    let frames = read("a.mat", TYPES, Some("frames")).unwrap();
    assert_eq!(frames.shape, [5, 7, 3]);
    let due = values([5, 7, 3]).into_iter().map(|x| 257.0 * x);
    assert_eq!(frames.values, due.collect::<Vec<_>>());
}

/// In chunks that fit and that do not, as they are, and with each filter; `int16` with its most
/// significant byte first.
#[test]
fn chunks_are_the_array_in_one_piece() {
    for name in ["double", "single", "frames", "logical", "int16"] {
        let due = read("a.mat", VERSION5, Some(name)).unwrap();
        assert_eq!(read("a.mat", PACKED, Some(name)), Ok(due), "{name}");
    }
    // 91 chunks, whose tree has two levels.
    let deep = read("a.mat", TREE, None).unwrap();
    assert_eq!(
        (&deep.shape[..], deep.full_scale),
        (&[20, 37][..], Some(255.0))
    );
    assert_eq!(deep.values, values([20, 37, 1]));
}

#[test]
fn other_programs_write_what_is_read() {
    let python = read("a.mat", PYTHON, None).unwrap();
    assert_eq!(
        (python.shape, python.values),
        (vec![5, 7, 3], values([5, 7, 3]))
    );
    let later = read("a.mat", LATER, None).unwrap();
    assert_eq!((later.shape, later.values), (vec![5, 7], values([5, 7, 1])));
}

#[test]
fn what_is_no_array_of_real_numbers_is_refused_with_a_cure() {
    for (name, words) in [
        ("complex", "is complex, no array of real numbers"),
        ("struct", "is a struct, no array"),
        ("sparse", "is sparse, no array"),
        ("cell", "of class cell, no array"),
        ("char", "of class char, no array"),
        ("elsewhere", "a link, no array"),
        ("empty", "use 1 to 2²⁷ entries"),
        ("lzf", "packed by LZF; save it in MATLAB"),
        ("unwritten", "never written; write it again"),
        ("unnamed", "no MATLAB_class"),
    ] {
        let error = error(OTHERS, Some(name));
        assert!(error.contains(words) && error.contains(name), "{error}");
    }
    assert!(error(UNNAMED, None).contains("numpy.save"));
}

#[test]
fn variables_are_chosen_as_in_version_5() {
    let several = error(TYPES, None);
    assert!(several.contains("`double` and `frames`") && several.contains("`variable`"));
    let missing = error(OTHERS, Some("other"));
    assert!(
        missing.contains("no variable `other`, but cell, char, complex"),
        "{missing}"
    );
    assert!(!missing.contains("#refs#"), "{missing}");
}

/// No prefix of a file is taken for the whole of it.
#[test]
fn a_cut_file_is_refused() {
    for whole in [TYPES, PACKED, TREE, LATER, PYTHON] {
        let name = (whole == TYPES || whole == PACKED).then_some("frames");
        assert!(read("a.mat", whole, name).is_ok());
        for length in 0..whole.len() {
            assert!(read("a.mat", &whole[..length], name).is_err(), "{length}");
        }
    }
}

/// Any byte changed, any field of 8 bytes a large number: an error, or an array that keeps its
/// promises.
#[test]
fn a_forged_file_is_read_or_refused() {
    let check = |found: Result<Array, ArrayError>| {
        if let Ok(array) = found {
            assert_eq!(array.shape.iter().product::<usize>(), array.values.len());
        }
    };
    for whole in [TYPES, PACKED, OTHERS, TREE, LATER, PYTHON] {
        let name = (whole == TYPES || whole == PACKED).then_some("frames");
        for at in 512..whole.len() {
            let mut forged = whole.to_vec();
            forged[at] ^= 0x81;
            check(read("a.mat", &forged, name));
            if at % 8 != 0 {
                continue;
            }
            for number in [u64::MAX, 1 << 40, 1 << 20] {
                forged.copy_from_slice(whole);
                let end = (at + 8).min(whole.len());
                forged[at..end].copy_from_slice(&number.to_le_bytes()[..end - at]);
                check(read("a.mat", &forged, name));
            }
        }
    }
}

/// A checksum, a chunk that is there twice, a tree that leads back to itself, and lengths that no
/// file of this size can have.
#[test]
fn damage_is_told_by_its_name() {
    let place =
        |bytes: &[u8], what: &[u8]| bytes.windows(what.len()).position(|w| w == what).unwrap();
    let changed = |bytes: &[u8], at: usize, to: &[u8]| {
        let mut bytes = bytes.to_vec();
        bytes[at..at + to.len()].copy_from_slice(to);
        bytes
    };
    // A key is 32 bytes here: length, filters left out, and three offsets; then the address.
    let node = place(TREE, b"TREE\x01\x00");
    let first = node + 24;
    let twice = changed(TREE, first + 8 + 32, &TREE[first + 8..first + 32]);
    let twice = error(
        &changed(&twice, first + 8 + 40, &TREE[first + 8..first + 32]),
        None,
    );
    assert!(twice.contains("chunk twice"), "{twice}");
    let root = place(TREE, b"TREE\x01\x01");
    let itself = changed(TREE, root + 24 + 32, &((root - 512) as u64).to_le_bytes());
    assert!(error(&itself, None).contains("does not go down"));
    // The dataspace: version, rank, flags, and two lengths.
    let space = place(TREE, &[1, 2, 1, 0, 0, 0, 0, 0, 37, 0, 0, 0]) + 8;
    let wide = changed(TREE, space, &(1u64 << 22).to_le_bytes());
    assert!(error(&wide, None).contains("larger than its file"));
    let chunk = place(TREE, &[3, 0, 0, 0, 3, 0, 0, 0, 1, 0, 0, 0]);
    let wide = changed(&wide, chunk, &(1u32 << 22).to_le_bytes());
    assert!(error(&wide, None).contains("larger than its file"));
    let wider = changed(TREE, space, &(1u64 << 60).to_le_bytes());
    assert!(error(&wider, None).contains("2²⁷"));
    // hdf5storage adds a checksum to each chunk.
    let tree = place(PYTHON, b"TREE\x01\x00") + 24;
    let at = u64::from_le_bytes(PYTHON[tree + 40..tree + 48].try_into().unwrap()) as usize + 512;
    let sum = changed(PYTHON, at + 4, &[PYTHON[at + 4] ^ 1]);
    assert!(
        error(&sum, None).contains("another checksum"),
        "{}",
        error(&sum, None)
    );
    let header = changed(LATER, 0, b"MATLAB 7.3");
    assert!(error(&changed(&header, 512, b"x"), None).contains("no HDF5 signature"));
}
