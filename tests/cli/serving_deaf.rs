//! `phicam serve` under clients that ask and do not read.
#![cfg(target_os = "linux")]

use std::fs::File;
use std::io::Write;
use std::thread;
use std::time::{Duration, Instant};

use crate::server::{Server, narrow, request};
use crate::workspace::Workspace;

/// More than the server holds at once.
const CLIENTS: usize = 300;
/// What the server may ever have in memory, KiB: a fraction of what the answers to all of them
/// together have.
const MEMORY: u64 = 96 * 1024;
/// Lengths of answers around what the system takes without a reader, 1000 bytes.
const LENGTHS: [usize; 6] = [32, 64, 128, 164, 256, 1049];

#[test]
#[ignore = "slow"]
fn whoever_does_not_read_is_left_however_short_the_answer() {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render tiny.toml -o out --samples 32")
        .exits(0);
    let large = File::create(workspace.path("out/large.bin")).expect("a file");
    large.set_len(4 << 20).expect("longer");
    let server = Server::of(&workspace, "out");
    let page = server.get("/").body;
    assert!(page.len() > 512 * 1024, "{} bytes", page.len());
    let start = Instant::now();
    // Every other one wants the page that is made, the rest a part of a file.
    let ask = |n: usize| {
        let mut stream = narrow(server.address());
        let last = LENGTHS[n / 2 % LENGTHS.len()] * 1000 - 1;
        let asked = match n % 2 {
            0 => request("GET", "/", &[]),
            _ => request(
                "GET",
                "/files/large.bin",
                &[&format!("Range: bytes=0-{last}")],
            ),
        };
        stream.write_all(asked.as_bytes()).expect("sent");
        stream
    };
    let deaf: Vec<_> = (0..CLIENTS).map(ask).collect();
    let (mut slowest, mut most) = (Duration::ZERO, 0);
    let left = loop {
        let asked = Instant::now();
        most = most.max(server.connections());
        assert_eq!(server.get("/").body.len(), page.len());
        slowest = slowest.max(asked.elapsed());
        let (open, passed) = (server.connections(), start.elapsed().as_secs_f64());
        if open == 0 || passed > 45.0 {
            break (open, passed);
        }
        thread::sleep(Duration::from_millis(100));
    };
    let peak = server.peak();
    eprintln!(
        "{most} connections at most, {left:?} at last and after s, slowest answer {slowest:?}, {peak} KiB"
    );
    assert!(most >= 200, "{most} connections hung");
    assert_eq!(left.0, 0, "connections after {} s", left.1);
    // 15 s until the first are left, and those after them in the queue do not count.
    assert!(slowest < Duration::from_secs(20), "{slowest:?}");
    assert!(peak < MEMORY, "{peak} KiB");
    drop(deaf);
    server.ends();
}
