#![no_main]
//! `mesh` of `readers.rs`.

use phicam_fuzz::{readers::MESH, run};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(&MESH, bytes));
