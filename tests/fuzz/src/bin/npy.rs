#![no_main]
//! `npy` of `readers.rs`.

use phicam_fuzz::{readers::NPY, run};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(&NPY, bytes));
