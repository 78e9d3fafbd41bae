//! Coverage-guided fuzzing of everything in phicam that reads bytes from outside.
//!
//! `./run.sh SECONDS [TARGET…]` builds the targets with LLVM's coverage counters and lets libFuzzer
//! work on each for so long, from the seeds of `seeds.rs` and the inputs of `found/TARGET` onwards.
//! It needs a stable Rust compiler and a C++ compiler, nothing else. A panic, an overflow, a failed
//! assertion, an input that takes longer than 30 s, and memory beyond the target's bound (or 1 GiB
//! resident) end it; the input is then in `artifacts/TARGET`.
//!
//! What a target does with its bytes stands in `readers.rs`, which `tests/forged` of phicam
//! compiles too: `cargo test` reads every seed and every input of `found` again without any fuzzing
//! tool.
//!
//! # Adding a target
//!
//! 1. In `readers.rs` a function from bytes to an `Outcome`, and a `Reader` of it in the list
//!    `ALL`: name, function, bound on memory.
//! 2. In `seeds.rs` a few valid inputs under that name.
//! 3. A file `src/bin/NAME.rs` of the same four lines as its neighbours.
//! 4. What it finds: mended in the sources, the input kept as `found/NAME/WHAT-IS-WRONG`.

use std::alloc::System;

use cap::Cap;

#[path = "../readers.rs"]
pub mod readers;
#[path = "../seeds.rs"]
pub mod seeds;

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, usize::MAX);

/// Reads `bytes`; memory beyond the reader's bound is refused by the allocator, which ends the
/// process.
pub fn run(reader: &readers::Reader, bytes: &[u8]) {
    let bound = (reader.memory)(bytes.len());
    let limited = MEMORY.set_limit(MEMORY.allocated().saturating_add(bound));
    assert!(limited.is_ok(), "the limit is above what is allocated");
    (reader.read)(bytes);
    let free = MEMORY.set_limit(usize::MAX);
    assert!(free.is_ok(), "a limit can be raised");
}
