#![no_main]
//! `scene` of `readers.rs`. Every third change puts another number in the place of one: what a
//! mutation of bytes seldom does to a text.

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use phicam_fuzz::{readers::SCENE, run};

fuzz_target!(|bytes: &[u8]| run(&SCENE, bytes));

fuzz_mutator!(|data: &mut [u8], size: usize, most: usize, seed: u32| {
    match seed % 3 {
        0 => another_number(data, size, most, seed as usize / 3).unwrap_or(size),
        _ => fuzzer_mutate(data, size, most),
    }
});

/// Ends of ranges: of the format's, of integers, of single and of double precision, of what can be
/// squared.
const NUMBERS: [&str; 40] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "3",
    "0.5",
    "-0.5",
    "1.0000000000000002",
    "0.9999999999999999",
    "1e-9",
    "1e-12",
    "1e-17",
    "1e16",
    "1000",
    "1024",
    "4096",
    "65536",
    "100000",
    "16777216",
    "67108864",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "1e38",
    "3.5e38",
    "-3.5e38",
    "1e-38",
    "1e-46",
    "1e154",
    "1e155",
    "1e-155",
    "1e308",
    "-1e308",
    "1e-308",
    "5e-324",
    "nan",
    "inf",
    "-inf",
];

/// The new size, if there is a number and room for the other.
fn another_number(data: &mut [u8], size: usize, most: usize, seed: usize) -> Option<usize> {
    let part = |b: &u8| b.is_ascii_digit() || b"+-.eE_".contains(b);
    let mut numbers = Vec::new();
    let mut at = 0;
    while at < size {
        let length = data[at..size].iter().take_while(|b| part(b)).count();
        if data[at..at + length].iter().any(u8::is_ascii_digit) {
            numbers.push(at..at + length);
        }
        at += length.max(1);
    }
    let old = numbers.get(seed.checked_rem(numbers.len())?)?.clone();
    let new = NUMBERS[seed / numbers.len() % NUMBERS.len()];
    let longer = size - old.len() + new.len();
    if longer > most.min(data.len()) {
        return None;
    }
    data.copy_within(old.end..size, old.start + new.len());
    data[old.start..old.start + new.len()].copy_from_slice(new.as_bytes());
    Some(longer)
}
