#![no_main]
//! `list` of `readers.rs`.

use phicam_fuzz::{readers::LIST, run};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(&LIST, bytes));
