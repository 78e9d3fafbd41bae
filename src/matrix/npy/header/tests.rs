use super::*;

/// A file of version 1.0 with this header.
fn of(text: &str) -> Result<Header, String> {
    let length = u16::try_from(text.len()).unwrap().to_le_bytes();
    Header::of(&[b"\x93NUMPY\x01\x00", &length[..], text.as_bytes()].concat())
}

#[test]
fn what_numpy_writes_is_read() {
    // As printed by numpy 2.3: of a (256, 120) array of f64, a vector of f32 in Fortran order, a
    // number, one whose name stands in double quotes, and Python 2's.
    for (text, descr, fortran, shape) in [
        (
            "{'descr': '<f8', 'fortran_order': False, 'shape': (256, 120), }   \n",
            "<f8",
            false,
            &[256, 120][..],
        ),
        (
            "{'descr': '>f4', 'fortran_order': True, 'shape': (6,), }\n",
            ">f4",
            true,
            &[6],
        ),
        (
            "{\"descr\": \"|u1\", \"shape\": (), \"fortran_order\": False}\n",
            "|u1",
            false,
            &[],
        ),
        (
            "{'shape': (3L, 4L), 'fortran_order': False, 'descr': '<i2'}",
            "<i2",
            false,
            &[3, 4],
        ),
        (
            "{'descr': [('a', '<f8'), ('b', '<i4')], 'fortran_order': False, 'shape': (2,), }\n",
            "[('a', '<f8'), ('b', '<i4')]",
            false,
            &[2],
        ),
    ] {
        let header = of(text).unwrap();
        let found = (&header.descr[..], header.fortran, &header.shape[..]);
        assert_eq!(found, (descr, fortran, shape));
        assert_eq!(header.length, 10 + text.len());
    }
}

#[test]
fn what_is_no_header_is_refused() {
    for text in [
        "",
        "{}",
        "{'descr': '<f8', 'fortran_order': False}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (6), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (-6,), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (6 5), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (0x6,), }",
        "{'descr': '<f8', 'fortran_order': Falsehood, 'shape': (6,), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (6,), } more",
        "{'descr': '<f8', 'descr': '<f8', 'fortran_order': False, 'shape': (6,), }",
        "{'descr': '<f8', 'other': 1, 'fortran_order': False, 'shape': (6,), }",
        "{'descr': '<\\x66', 'fortran_order': False, 'shape': (6,), }",
        "{'descr': [('a', '<f8'), 'fortran_order': False, 'shape': (6,), }",
    ] {
        assert!(of(text).is_err(), "{text}");
    }
}

#[test]
fn plain_numbers_are_told_from_others() {
    let plain = |descr: &str| {
        let header = Header {
            descr: descr.to_owned(),
            fortran: false,
            shape: vec![1],
            length: 0,
        };
        header.plain().map(|p| (p.kind, p.bytes, p.big_endian))
    };
    assert_eq!(plain("<f8"), Some(('f', 8, false)));
    assert_eq!(plain(">u2"), Some(('u', 2, true)));
    assert_eq!(plain("|b1"), Some(('b', 1, false)));
    for other in [
        "", "f8", "<", "<f", "<c16", "|O", "<U3", "<f+8", "<f 8", "M8[ns]",
    ] {
        assert_eq!(plain(other), None, "{other}");
    }
}

#[test]
fn numbers_start_at_a_multiple_of_64_bytes() {
    for shape in [&[2, 3][..], &[256, 120], &[u64::MAX, 1, 1], &[]] {
        let bytes = Header::of_f64(shape);
        assert_eq!(bytes.len() % 64, 0, "{shape:?}");
        assert_eq!(bytes.last(), Some(&b'\n'));
    }
}
