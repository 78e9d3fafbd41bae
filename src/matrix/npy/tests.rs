//! Held against bytes written by hand after NumPy's format description, and against forged headers.

use super::*;
use proptest::prelude::*;

/// A `.npy` file of version 1.0 as the format description asks: the header padded so that the
/// numbers start at a multiple of 64 bytes.
fn file(descr: &str, fortran: &str, shape: &str, numbers: &[u8]) -> Vec<u8> {
    let mut text =
        format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}");
    while (10 + text.len() + 1) % 64 != 0 {
        text.push(' ');
    }
    text.push('\n');
    let length = u16::try_from(text.len()).unwrap().to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], text.as_bytes(), numbers].concat()
}

fn bytes_of(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn read_bytes(bytes: &[u8]) -> Result<Matrix, NpyError> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.npy");
    std::fs::write(&path, bytes).unwrap();
    read(&path)
}

/// (0 1 2; 3 4 5).
fn sample() -> Matrix {
    Matrix::from_row_slice(2, 3, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
}

#[test]
fn written_bytes_are_those_of_the_format_description() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.npy");
    write(&path, &sample()).unwrap();
    let numbers = bytes_of(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    let written = std::fs::read(&path).unwrap();
    let start = written.len() - numbers.len();
    assert_eq!(&written[start..], numbers);
    assert_eq!(start % 16, 0, "the format asks for aligned numbers");
    let squeezed: String = String::from_utf8_lossy(&written[10..start])
        .split_whitespace()
        .collect();
    assert_eq!(
        squeezed.replace(",}", "}").replace(",)", ")"),
        "{'descr':'<f8','fortran_order':False,'shape':(2,3)}"
    );
    assert_eq!(&written[..8], b"\x93NUMPY\x01\x00");
}

#[test]
fn every_order_type_and_dimension_reads_as_documented() {
    let c = bytes_of(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    let fortran = bytes_of(&[0.0, 3.0, 1.0, 4.0, 2.0, 5.0]);
    let single: Vec<u8> = (0..6u8).flat_map(|v| f32::from(v).to_le_bytes()).collect();
    let big: Vec<u8> = (0..6u8).flat_map(|v| f64::from(v).to_be_bytes()).collect();
    assert_eq!(
        read_bytes(&file("<f8", "False", "(2, 3)", &c)).unwrap(),
        sample()
    );
    assert_eq!(
        read_bytes(&file("<f8", "True", "(2, 3)", &fortran)).unwrap(),
        sample()
    );
    assert_eq!(
        read_bytes(&file("<f4", "False", "(2, 3)", &single)).unwrap(),
        sample()
    );
    assert_eq!(
        read_bytes(&file(">f8", "False", "(2, 3)", &big)).unwrap(),
        sample()
    );
    let column = Matrix::from_column_slice(6, 1, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    assert_eq!(
        read_bytes(&file("<f8", "False", "(6,)", &c)).unwrap(),
        column
    );
}

#[test]
fn what_is_no_matrix_is_refused_for_its_reason() {
    let c = bytes_of(&[0.0; 6]);
    let outcome = |descr, shape| read_bytes(&file(descr, "False", shape, &c));
    for dtype in ["<i8", "<c16", "|b1", "<f2", "|O"] {
        assert!(
            matches!(outcome(dtype, "(2, 3)"), Err(NpyError::Type { .. })),
            "{dtype}"
        );
    }
    for shape in ["()", "(1, 2, 3)", "(0, 3)", "(3, 0)"] {
        assert!(
            matches!(outcome("<f8", shape), Err(NpyError::Shape { .. })),
            "{shape}"
        );
    }
    for shape in [
        "(2, 4)",
        "(1, 3)",
        "(999999999, 99999999)",
        "(4294967296, 536870912)",
    ] {
        let refused = outcome("<f8", shape);
        assert!(
            matches!(
                refused,
                Err(NpyError::Length { .. } | NpyError::NotNpy { .. })
            ),
            "{shape}: {refused:?}"
        );
    }
    let missing = read(Path::new("no/such/file.npy"));
    assert!(
        matches!(missing, Err(NpyError::Unreadable { .. })),
        "{missing:?}"
    );
}

#[test]
fn forged_headers_are_refused_without_harm() {
    let huge = file(
        "<f8",
        "False",
        "(18446744073709551615, 18446744073709551615)",
        &[],
    );
    let hexadecimal = file(
        "<f8",
        "False",
        "(0xffffffffffffffff, 0xffffffffffffffff)",
        &[],
    );
    let deep = file("<f8", "False", &"(".repeat(60_000), &[]);
    let nested = file("<f8", "False", &"[".repeat(900), &[]);
    let mut long = b"\x93NUMPY\x02\x00".to_vec();
    long.extend(u32::MAX.to_le_bytes());
    for bytes in [huge, hexadecimal, deep, nested, long] {
        let refused = read_bytes(&bytes);
        assert!(
            matches!(refused, Err(NpyError::NotNpy { .. })),
            "{refused:?}"
        );
    }
}

#[test]
fn a_header_that_changes_meanwhile_is_still_the_one_that_was_checked() {
    use std::io::{Seek, Write};
    use std::sync::atomic::{AtomicBool, Ordering};

    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.npy");
    write(&path, &sample()).unwrap();
    // Version 1, or version 2 with 256 MiB of header.
    let whole = std::fs::read(&path).unwrap();
    let huge = [2, 0, 0, 0, 0, 0x10];
    let done = AtomicBool::new(false);
    let mut counts = [0; 2];
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut file = File::options().write(true).open(&path).unwrap();
            while !done.load(Ordering::Relaxed) {
                for bytes in [&huge[..], &whole[6..12]] {
                    file.seek(SeekFrom::Start(6)).unwrap();
                    file.write_all(bytes).unwrap();
                }
            }
        });
        let mut wrong = None;
        for _ in 0..20_000 {
            match open(&path) {
                Ok(_) => counts[0] += 1,
                // Said before anything of that length is allocated.
                Err(e) if e.to_string().contains("claims 268435456 bytes") => counts[1] += 1,
                Err(e) => wrong = Some(e.to_string()),
            }
        }
        done.store(true, Ordering::Relaxed);
        assert_eq!(wrong, None);
    });
    assert!(counts[0] > 0 && counts[1] > 0, "{counts:?}");
}

#[test]
fn a_refusal_is_one_line() {
    for (descr, fortran, shape) in [
        ("<f8", "Maybe\n\n\n", "(6, 5)"),
        ("<f8", "False", "\n(6\n\r\x1b[2J, 5"),
        ("<\nf8", "False", "(6, 5)"),
        ("|S8", "False", "(6,\n 5)"),
    ] {
        let refused = read_bytes(&file(descr, fortran, shape, &[0; 240]));
        let words = refused.unwrap_err().to_string();
        assert!(!words.contains(char::is_control), "{words:?}");
    }
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let whole = file("<f8", "False", "(2, 3)", &bytes_of(&[1.0; 6]));
    for length in 0..whole.len() {
        assert!(
            read_bytes(&whole[..length]).is_err(),
            "{length} of {} bytes",
            whole.len()
        );
    }
}

#[test]
fn read_finite_names_the_first_bad_entry() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.npy");
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut matrix = sample();
        matrix[(1, 2)] = bad;
        write(&path, &matrix).unwrap();
        assert_eq!(read(&path).unwrap()[(1, 2)].to_bits(), bad.to_bits());
        let refused = read_finite(&path);
        assert!(
            matches!(
                refused,
                Err(NpyError::NotFinite {
                    row: 1,
                    column: 2,
                    ..
                })
            ),
            "{refused:?}"
        );
    }
    write(&path, &sample()).unwrap();
    assert_eq!(read_finite(&path).unwrap(), sample());
}

proptest! {
    #[test]
    #[ignore = "slow"]
    fn every_bit_survives_the_round_trip(rows in 1usize..7, columns in 1usize..7, seed in any::<u64>()) {
        // Any 64 bits are a f64: take them from a linear congruence (Knuth's MMIX).
        let mut state = seed;
        let matrix = Matrix::from_fn(rows, columns, |_, _| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from_bits(state)
        });
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.npy");
        write(&path, &matrix).unwrap();
        let back = read(&path).unwrap();
        prop_assert_eq!(back.shape(), matrix.shape());
        prop_assert!(back.iter().zip(matrix.iter()).all(|(a, b)| a.to_bits() == b.to_bits()));
    }

    #[test]
    fn no_change_of_the_header_panics(flips in prop::collection::vec((0usize..128, any::<u8>()), 1..6)) {
        let mut bytes = file("<f8", "False", "(2, 3)", &bytes_of(&[1.0; 6]));
        for (at, value) in flips {
            bytes[at] = value;
        }
        let _ = read_bytes(&bytes);
    }

    #[test]
    fn no_header_of_python_like_text_panics(text in "[-+0-9(){}\\[\\],:'<>fiO|_. eEjTrueFals]{0,200}") {
        let _ = read_bytes(&file("<f8", "False", &text, &[0; 48]));
        let length = u16::try_from(text.len()).unwrap().to_le_bytes();
        let _ = read_bytes(&[b"\x93NUMPY\x01\x00", &length[..], text.as_bytes()].concat());
    }
}
