#![no_main]
//! `shard` of `readers.rs`.

use phicam_fuzz::{readers::SHARD, run};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(&SHARD, bytes));
