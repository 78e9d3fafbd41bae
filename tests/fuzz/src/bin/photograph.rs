#![no_main]
//! `photograph` of `readers.rs`.

use phicam_fuzz::{readers::PHOTOGRAPH, run};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(&PHOTOGRAPH, bytes));
