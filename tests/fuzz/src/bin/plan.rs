#![no_main]
//! `plan` of `readers.rs`.

use phicam_fuzz::{readers::PLAN, run};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(&PLAN, bytes));
