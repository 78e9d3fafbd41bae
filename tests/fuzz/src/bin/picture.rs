#![no_main]
//! `picture` of `readers.rs`.

use phicam_fuzz::{readers::PICTURE, run};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(&PICTURE, bytes));
