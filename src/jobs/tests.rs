use super::*;
use std::fs;
use std::path::{Path, PathBuf};

use proptest::prelude::*;

const TOTAL: u64 = 40;

fn identity(seed: u32) -> Identity {
    Identity::default()
        .with("scene", "bench")
        .with("seed", seed)
        .with(Identity::NUMERICS, 1)
}

fn provenance() -> Provenance {
    Provenance {
        version: "0.0.0".to_owned(),
        threads: 2,
        seconds: 1.5,
    }
}

fn parts() -> Parts {
    vec![
        (3..4, vec![1, 2, 3]),
        (4..8, Vec::new()),
        (8..9, vec![9; 100_000]),
    ]
}

fn written(dir: &Path, name: &str, parts: &Parts) -> PathBuf {
    let path = dir.join(name);
    write(&path, &identity(1), parts, provenance()).unwrap();
    path
}

fn open(path: &Path) -> Result<BlockFile, JobError> {
    BlockFile::open(path, &identity(1), TOTAL)
}

#[test]
fn what_is_written_is_read() {
    let dir = tempfile::tempdir().unwrap();
    let path = written(dir.path(), "a.phs", &parts());
    let shard = open(&path).unwrap();
    assert_eq!(
        (shard.range.clone(), &shard.provenance),
        (3..9, &provenance())
    );
    let read: Parts = shard.parts(0..TOTAL).map(Result::unwrap).collect();
    assert_eq!(read, parts());
    let inside: Parts = shard.parts(4..9).map(Result::unwrap).collect();
    assert_eq!(inside, parts()[1..]);
    // The layout is pinned: magic, layout number, length of the header.
    let bytes = fs::read(&path).unwrap();
    assert_eq!(bytes[..12], *b"phicam\0\0\x02\0\0\0");
    let header = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    assert_eq!(bytes.len(), 16 + header + 100_003 + 32);
}

#[test]
fn the_payload_alone_tells_equal_from_other() {
    let dir = tempfile::tempdir().unwrap();
    let first = open(&written(dir.path(), "a.phs", &parts())).unwrap();
    let path = dir.path().join("b.phs");
    let later = Provenance {
        seconds: 7.0,
        ..provenance()
    };
    write(&path, &identity(1), &parts(), later).unwrap();
    assert_eq!(open(&path).unwrap().payload, first.payload);
    let mut other = parts();
    other[2].1[5] = 8;
    let other = open(&written(dir.path(), "c.phs", &other)).unwrap();
    assert_ne!(other.payload, first.payload);
    let clash = select(vec![first, other]).unwrap_err().to_string();
    assert!(clash.contains("not the same bits"), "{clash}");
}

#[test]
fn each_fault_has_its_own_message() {
    let dir = tempfile::tempdir().unwrap();
    let path = written(dir.path(), "a.phs", &parts());
    let whole = fs::read(&path).unwrap();
    let with = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        open(&path).unwrap_err()
    };
    let flipped = |at: usize| {
        let mut bytes = whole.clone();
        bytes[at] ^= 4;
        bytes
    };
    let told = |error: JobError, spoilt: bool, word: &str| {
        assert_eq!(error.spoilt().is_some(), spoilt, "{error}");
        assert!(error.to_string().contains(word), "{word}: {error}");
    };
    told(with(&[]), true, "is empty");
    told(with(b"PK\x03\x04 some archive"), false, "is no shard");
    told(with(&flipped(8)), false, "has layout 6");
    for cut in [1, 10, 17, 60, whole.len() - 1] {
        told(with(&whole[..cut]), true, "is cut off");
    }
    told(with(&[&whole[..], &[0]].concat()), true, "1 more than");
    told(with(&flipped(whole.len() - 500)), true, "is damaged");
    told(with(&flipped(whole.len() - 1)), true, "is damaged");
    fs::write(&path, &whole).unwrap();
    let asked = |identity: &Identity, total| BlockFile::open(&path, identity, total).unwrap_err();
    told(
        asked(&identity(2), TOTAL),
        false,
        "its seed is 1, that of this plan is 2",
    );
    let renewed = Identity::default()
        .with("scene", "bench")
        .with("seed", 2)
        .with(Identity::NUMERICS, 7);
    told(asked(&renewed, TOTAL), false, "version 1 of the numerics");
    told(asked(&identity(1), 8), true, "holds blocks 3..9 of 8");
    let torn = vec![(0..1, vec![1]), (2..3, vec![1])];
    let torn = open(&written(dir.path(), "t.phs", &torn)).unwrap_err();
    told(torn, true, "do not make them up");
    told(open(dir.path()).unwrap_err(), false, "is no shard");
}

/// A header that promises more than the file holds costs no memory: it is compared with the file's
/// length first.
#[test]
fn a_forged_length_is_not_believed() {
    let dir = tempfile::tempdir().unwrap();
    let path = written(dir.path(), "a.phs", &parts());
    let mut bytes = fs::read(&path).unwrap();
    bytes[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    fs::write(&path, &bytes).unwrap();
    let cut_off = open(&path).unwrap_err().to_string();
    assert!(cut_off.contains("is cut off"), "{cut_off}");
    let text = String::from_utf8_lossy(&fs::read(written(dir.path(), "b.phs", &parts())).unwrap())
        .into_owned();
    assert!(text.contains("\"bytes\":100000"));
}

#[test]
fn two_identities_never_share_an_id() {
    let ids = [
        Identity::default().with("a", "bc"),
        Identity::default().with("ab", "c"),
        Identity::default().with("a", "b").with("c", ""),
        Identity::default().with("", "abc"),
    ];
    for (i, a) in ids.iter().enumerate() {
        for b in &ids[..i] {
            assert_ne!(a.id(), b.id());
        }
    }
    assert_eq!(ids[0].id().short().len(), 12);
}

proptest! {
    /// Any byte changed, or the end cut anywhere: refused, never taken for the shard.
    #[test]
    #[ignore = "slow"]
    fn no_change_goes_unseen(at in 0usize..100_400, bit in 0u8..8, cut in proptest::bool::ANY) {
        let dir = tempfile::tempdir().unwrap();
        let path = written(dir.path(), "a.phs", &parts());
        let mut bytes = fs::read(&path).unwrap();
        let at = at % bytes.len();
        if cut { bytes.truncate(at); } else { bytes[at] ^= 1 << bit; }
        fs::write(&path, &bytes).unwrap();
        prop_assert!(open(&path).is_err());
    }

    /// Against a list of marks, one for each block.
    #[test]
    fn gaps_are_what_no_range_holds(ranges in proptest::collection::vec((0u64..50, 0u64..20), 0..8), from in 0u64..30, length in 0u64..30) {
        let ranges: Vec<_> = ranges.into_iter().map(|(start, n)| start..start + n).collect();
        let free: Vec<u64> = (from..from + length).filter(|b| !ranges.iter().any(|r| r.contains(b))).collect();
        let found: Vec<u64> = gaps(from..from + length, ranges).into_iter().flatten().collect();
        prop_assert_eq!(found, free);
    }

    /// Where cuts are the same on both sides there is nothing to refuse; the chosen ones follow one
    /// another.
    #[test]
    #[ignore = "slow"]
    fn tilings_are_chosen_in_order(cuts in proptest::collection::btree_set(1u64..TOTAL, 0..6)) {
        let dir = tempfile::tempdir().unwrap();
        let cuts: Vec<u64> = std::iter::once(0).chain(cuts).chain([TOTAL]).collect();
        let mut shards: Vec<BlockFile> = cuts.windows(2).enumerate().map(|(i, pair)| {
            let part = vec![(pair[0]..pair[1], vec![i as u8])];
            open(&written(dir.path(), &format!("{i}.phs"), &part)).unwrap()
        }).collect();
        shards.reverse();
        let chosen = select(shards).unwrap();
        let ends: Vec<u64> = chosen.iter().map(|shard| shard.range.end).collect();
        prop_assert_eq!(&ends, &cuts[1..]);
        let wide = vec![(0..TOTAL, vec![0])];
        let wide = open(&written(dir.path(), "wide.phs", &wide)).unwrap();
        if chosen.len() > 1 {
            let clash = select(chosen.into_iter().chain([wide]).collect()).unwrap_err();
            prop_assert!(clash.to_string().contains("overlap"), "{}", clash);
        }
    }
}
