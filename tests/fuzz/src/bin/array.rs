#![no_main]
//! `array` of `readers.rs`.

use phicam_fuzz::{readers::ARRAY, run};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(&ARRAY, bytes));
