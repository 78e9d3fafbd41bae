#![no_main]
//! `measured` of `readers.rs`.

use phicam_fuzz::{readers::MEASURED, run};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(&MEASURED, bytes));
