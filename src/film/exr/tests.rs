use super::*;
use crate::film::{FrameMeta, RunMeta};

mod forgery;

/// Values that a careless path loses: subnormals, signed zero, the largest, NaN with a payload.
const ODD: [u32; 8] = [
    1,
    0x8000_0000,
    0x007f_ffff,
    0x7f7f_ffff,
    0xff80_0000,
    0x7fc1_2345,
    0x3f80_0001,
    0x8000_0001,
];

fn frame(columns: usize, rows: usize, names: &[&str]) -> Frame {
    let values = |c: usize| {
        (0..columns * rows)
            .map(|k| f32::from_bits(ODD[(k + c) % ODD.len()]))
            .collect()
    };
    let channels = names
        .iter()
        .enumerate()
        .map(|(c, name)| Channel {
            name: (*name).into(),
            values: values(c),
        })
        .collect();
    let run = RunMeta {
        scene_name: "bänch – 试".into(),
        scene_hash: "0123456789abcdef".repeat(4),
        unit: "in".into(),
        spot_count: 120,
        seed: u64::MAX,
        samples: u64::MAX - 1,
        estimator: "independent".into(),
        sampler: "sobol".into(),
        version: "0.1.0".into(),
    };
    let meta = FrameMeta {
        run,
        spot_index: 3,
        spot_position: [0.1, f64::MIN_POSITIVE / 3.0, -1.0e300],
    };
    Frame {
        columns,
        rows,
        channels,
        meta,
    }
}

fn file() -> Vec<u8> {
    encode(&frame(5, 33, &["flux", "flux.stderr", "flux.b3"])).unwrap()
}

fn read_bytes(bytes: &[u8]) -> Result<Frame, FrameError> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("spot-0003.exr");
    std::fs::write(&path, bytes).unwrap();
    read(&path)
}

fn bits(frame: &Frame, name: &str) -> Vec<u32> {
    frame
        .channel(name)
        .unwrap()
        .iter()
        .map(|v| v.to_bits())
        .collect()
}

/// Replaces the first occurrence of `old` by as many bytes of `new`.
fn replaced(bytes: &[u8], old: &[u8], new: &[u8]) -> Vec<u8> {
    assert_eq!(old.len(), new.len());
    let at = bytes
        .windows(old.len())
        .position(|w| w == old)
        .expect("the bytes to replace");
    [&bytes[..at], new, &bytes[at + old.len()..]].concat()
}

/// The file with the value of the attribute that begins with `head` replaced.
fn with_value(bytes: &[u8], head: &[u8], value: &[u8]) -> Vec<u8> {
    let at = bytes
        .windows(head.len())
        .position(|w| w == head)
        .expect("the attribute")
        + head.len()
        + 4;
    [&bytes[..at], value, &bytes[at + value.len()..]].concat()
}

#[test]
fn every_bit_survives_whatever_the_order_of_channels() {
    // flux.b10 sorts before flux.b3: values must stay with their names.
    let names = ["flux.stderr", "flux.b3", "flux", "flux.b10"];
    for (columns, rows) in [(1, 1), (5, 33), (16, 16), (100, 1), (1, 100)] {
        let before = frame(columns, rows, &names);
        let after = read_bytes(&encode(&before).unwrap()).unwrap();
        assert_eq!((after.columns, after.rows), (columns, rows));
        assert_eq!(after.meta, before.meta);
        assert_eq!(after.channels.len(), names.len());
        for name in names {
            assert_eq!(
                bits(&after, name),
                bits(&before, name),
                "{name} of {columns} × {rows}"
            );
        }
    }
}

#[test]
fn the_same_frame_gives_the_same_bytes() {
    // The crate writes attributes in the order of a hash map with a random key: 20 writings agree
    // by chance never.
    let first = file();
    assert!((0..20).all(|_| file() == first));
}

#[test]
fn values_lie_where_the_format_puts_them() {
    // Noise does not compress, so the block is stored raw: y, size, then for each line each channel
    // by name. Row 0 first, columns along x.
    let mut frame = frame(2, 2, &["flux"]);
    frame.channels[0].values = vec![1.5, -2.25, 1.0e-20, 7.75e9];
    let bytes = encode(&frame).unwrap();
    let raw: Vec<u8> = frame.channels[0]
        .values
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    assert!(bytes.ends_with(&[&0i32.to_le_bytes()[..], &16i32.to_le_bytes(), &raw].concat()));
}

#[test]
fn a_frame_that_contradicts_itself_is_not_written() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("spot-0000.exr");
    let good = frame(2, 2, &["flux", "flux.b3"]);
    let mut short = good.clone();
    short.channels[0].values.pop();
    let mut double = good.clone();
    double.channels[1].name = "flux".into();
    let mut unnamed = good.clone();
    unnamed.channels[1].name = String::new();
    let mut empty = good.clone();
    empty.channels.clear();
    let mut flat = good.clone();
    flat.rows = 0;
    let mut vast = good.clone();
    (vast.rows, vast.columns) = (usize::MAX, 2);
    let mut many = good;
    many.meta.run.spot_count = u32::MAX;
    for bad in [short, double, unnamed, empty, flat, vast, many] {
        let refused = write(&path, &bad);
        assert!(
            matches!(refused, Err(FrameError::Malformed { .. })),
            "{refused:?}"
        );
    }
    assert!(!path.exists());
}

#[test]
#[ignore = "slow"]
fn a_file_cut_anywhere_is_refused() {
    let whole = file();
    for length in 0..whole.len() {
        assert!(
            read_bytes(&whole[..length]).is_err(),
            "{length} of {} bytes",
            whole.len()
        );
    }
    assert!(read_bytes(&whole).is_ok());
}

#[test]
fn what_is_no_frame_is_refused_for_its_reason() {
    let whole = file();
    let reason = |bytes: &[u8]| read_bytes(bytes).unwrap_err().to_string();
    assert!(reason(b"\x89PNG\r\n\x1a\n").contains("not those of OpenEXR"));
    assert!(
        reason(&replaced(&whole, b"phicam.seed\0", b"phicam.seet\0"))
            .contains("no attribute phicam.seed")
    );
    assert!(reason(&replaced(&whole, b"0xffff", b"0xfffg")).contains("phicam.seed is malformed"));
    assert!(
        reason(&replaced(&whole, b"0123456789abcdef", b"0123456789abcdeg")).contains("sceneHash")
    );
    // Sample type of the first channel: 2 is FLOAT, 1 HALF, 0 UINT.
    for kind in [0, 1] {
        let other = replaced(&whole, b"flux\0\x02", &[b"flux\0", &[kind][..]].concat());
        assert!(
            reason(&other).contains("channel flux is not f32"),
            "{}",
            reason(&other)
        );
    }
    // Compression: 3 is ZIP, 4 PIZ, which would let most damage through.
    let piz = with_value(&whole, b"compression\0compression\0", &[4]);
    let piz = with_value(&piz, b"chunkCount\0int\0", &2i32.to_le_bytes());
    assert!(reason(&piz).contains("not ZIP"), "{}", reason(&piz));
    // Bit 12 of the version: several parts.
    let mut parts = whole.clone();
    parts[5] |= 0x10;
    assert!(reason(&parts).contains("single-part"), "{}", reason(&parts));
}

#[test]
fn a_claim_larger_than_the_file_is_refused_before_memory_is_taken() {
    let corner: Vec<u8> = [0i32, 0, 1_000_000, 1_000_000]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let forged = with_value(&file(), b"dataWindow\0box2i\0", &corner);
    let forged = with_value(&forged, b"displayWindow\0box2i\0", &corner);
    // Once with the count of blocks that fits, once without any.
    let fitting = with_value(&forged, b"chunkCount\0int\0", &62_501i32.to_le_bytes());
    let without = replaced(&forged, b"chunkCount\0", b"chunkCounu\0");
    for forged in [fitting, without] {
        let refused = read_bytes(&forged).unwrap_err().to_string();
        let claim = "claims 1000001 × 1000001 pixels in 3 channels";
        assert!(refused.contains(claim), "{refused}");
    }
}

#[test]
fn a_black_frame_is_not_taken_for_a_forgery() {
    // Nothing shrinks better than zeros.
    let mut black = frame(2048, 512, &["flux"]);
    black.channels[0].values.fill(0.0);
    let bytes = encode(&black).unwrap();
    assert!(
        bytes.len() < 4 * black.pixels() / 100,
        "{} bytes",
        bytes.len()
    );
    assert_eq!(read_bytes(&bytes).unwrap(), black);
}

#[test]
fn a_line_block_that_is_missing_is_noticed() {
    // 33 lines are blocks at y = 0, 16 and 32. Pointing the second at the first would leave lines
    // 16 to 31 black.
    let whole = file();
    let table = envelope::check_list(&whole).unwrap();
    let mut forged = whole.clone();
    forged.copy_within(table..table + 8, table + 8);
    let refused = read_bytes(&forged).unwrap_err().to_string();
    assert!(refused.contains("out of order"), "{refused}");
}
