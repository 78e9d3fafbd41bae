#![no_main]
//! `frame` of `readers.rs`.

use phicam_fuzz::{readers::FRAME, run};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(&FRAME, bytes));
