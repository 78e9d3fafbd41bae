//! Forged and damaged input, read without any fuzzing tool: every seed of the fuzz targets, every
//! input that a fuzzer ever found (kept in `tests/fuzz/found`), and headers and scenes that promise
//! more than any machine holds. Each must end in a value or in an error, within the memory that its
//! reader states.

use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use peak_alloc::PeakAlloc;

#[path = "../fuzz/readers.rs"]
#[expect(unreachable_pub, reason = "the fuzz targets use it from outside")]
mod readers;
#[path = "../fuzz/seeds.rs"]
#[expect(unreachable_pub, reason = "the fuzz targets use it from outside")]
mod seeds;

mod headers;
mod scenes;

use readers::{Outcome, Reader};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Memory is counted for the whole process: each test holds this from its first line to its last.
static ALONE: Mutex<()> = Mutex::new(());

/// A running test, the only one that takes memory.
struct Alone {
    _held: MutexGuard<'static, ()>,
}

impl Alone {
    fn new() -> Self {
        let _held = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        Self { _held }
    }

    /// Reads `bytes` within the reader's bound; what came out, and the most memory that it took.
    fn read(&self, reader: &Reader, bytes: &[u8], what: &str) -> (Outcome, usize) {
        let before = MEMORY.current_usage();
        MEMORY.reset_peak_usage();
        let outcome = (reader.read)(bytes);
        let taken = MEMORY.peak_usage().saturating_sub(before);
        let bound = (reader.memory)(bytes.len());
        assert!(
            taken <= bound,
            "{} of {what} took {taken} bytes of {bound}",
            reader.name
        );
        (outcome, taken)
    }
}

#[test]
fn every_seed_is_accepted() {
    let alone = Alone::new();
    for reader in &readers::ALL {
        let seeds = seeds::of(reader.name);
        assert!(seeds.len() > 1 || reader.name == "frame");
        for (i, seed) in seeds.iter().enumerate() {
            let (outcome, _) = alone.read(reader, seed, &format!("seed {i}"));
            // One of them is a JPEG in four colours, which are not read.
            let refused = reader.name == "picture" && i == 8;
            assert_eq!(
                outcome == Outcome::Accepted,
                !refused,
                "{} {i}",
                reader.name
            );
        }
    }
}

/// Inputs that the fuzzers found, where they found any.
#[test]
fn nothing_that_was_found_comes_back() {
    let alone = Alone::new();
    let mut read_again = 0;
    let found = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/found");
    for reader in &readers::ALL {
        let Ok(files) = std::fs::read_dir(found.join(reader.name)) else {
            continue;
        };
        for file in files {
            let path = file.unwrap().path();
            let what = path.display().to_string();
            alone.read(reader, &std::fs::read(&path).unwrap(), &what);
            read_again += 1;
        }
    }
    assert!(read_again > 0, "nothing is kept in {}", found.display());
}

/// A seed cut off anywhere, and with any byte changed, ends in an error or in a value.
#[test]
fn damaged_seeds_are_read_or_refused() {
    let alone = Alone::new();
    for reader in &readers::ALL {
        for (i, seed) in seeds::of(reader.name).iter().enumerate() {
            let step = (seed.len() / 40).max(1);
            for at in (0..seed.len()).step_by(step) {
                alone.read(reader, &seed[..at], &format!("seed {i} up to byte {at}"));
                let mut changed = seed.clone();
                changed[at] ^= 0x80;
                alone.read(
                    reader,
                    &changed,
                    &format!("seed {i} with byte {at} changed"),
                );
            }
        }
    }
}
