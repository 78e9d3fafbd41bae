//! `phicam serve` under many clients, and under clients that hang.
#![cfg(target_os = "linux")]

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use phicam::matrix::{Matrix, npy};

use crate::server::{Ends, Reply, Server, connect, record, reply, request};
use crate::workspace::Workspace;

/// What the server may ever have in memory, KiB: 22 MiB when it starts, two pieces of 64 KiB of
/// each of 256 connections, and the allocator's share.
const MEMORY: u64 = 96 * 1024;
const CLIENTS: usize = 1000;
/// Most connections that it holds at once.
const CONNECTIONS: usize = 256;
/// Longer than what the system holds of it for a client that does not read.
const LARGE: u64 = 256 << 20;

/// A client that keeps its connection, and connects again when the server has ended it.
struct Client<'a> {
    server: &'a Server,
    stream: Option<BufReader<TcpStream>>,
}

impl Client<'_> {
    fn get(&mut self, path: &str) -> Reply {
        // A connection may be closed between two questions; a new one has to be answered.
        if let Some(Ok(reply)) = self.stream.is_some().then(|| self.try_get(path)) {
            return reply;
        }
        self.stream = Some(BufReader::new(connect(self.server.address())));
        self.try_get(path).unwrap_or_else(|e| panic!("{path}: {e}"))
    }

    fn try_get(&mut self, path: &str) -> io::Result<Reply> {
        let Some(stream) = &mut self.stream else {
            return Err(io::ErrorKind::NotConnected.into());
        };
        let request = request("GET", path, &[]);
        let sent = stream.get_mut().write_all(request.as_bytes());
        let answer = sent.and_then(|()| reply(stream, false));
        let ends = |r: &Reply| r.header("connection") == "close";
        if answer.as_ref().map_or(true, ends) {
            self.stream = None;
        }
        answer
    }
}

#[test]
fn a_thousand_clients_at_once_are_all_answered() {
    let workspace = Workspace::new();
    record(&workspace.path("out"), 40, 25, 120);
    let phi = Matrix::from_fn(1000, 120, |p, s| (p * 120 + s) as f64);
    npy::write(&workspace.path("out/phi.npy"), &phi).expect("written");
    let file = workspace.read("out/phi.npy");
    let server = Server::of(&workspace, "out");
    let answered = AtomicUsize::new(0);
    let mut most = 0;
    let start = Instant::now();
    thread::scope(|scope| {
        for n in 0..CLIENTS {
            let (server, answered, phi, file) = (&server, &answered, &phi, &file);
            let client = move || {
                let mut client = Client {
                    server,
                    stream: None,
                };
                let spot = n % 120;
                let path = format!("/api/frame?matrix=traced&spot={spot}&x=0&y=0&w=40&h=25&step=1");
                let column: Vec<u64> = phi.column(spot).iter().map(|v| v.to_bits()).collect();
                assert!(client.get(&path).numbers() == column, "frame {spot}");
                let path = format!("/api/row?matrix=traced&pixel={n}");
                let row: Vec<u64> = phi.row(n).iter().map(|v| v.to_bits()).collect();
                assert!(client.get(&path).numbers() == row, "row {n}");
                assert!(client.get("/files/phi.npy").body == *file, "file");
                answered.fetch_add(1, Ordering::Relaxed);
                // Half of them stay until all have their answers, or they are sent away.
                let Some(stream) = client.stream.as_mut().filter(|_| n % 2 == 0) else {
                    return;
                };
                let soon = Some(Duration::from_millis(50));
                stream.get_ref().set_read_timeout(soon).expect("a timeout");
                let waits = |e: &io::Error| e.kind() == io::ErrorKind::WouldBlock;
                while answered.load(Ordering::Relaxed) < CLIENTS
                    && stream.read(&mut [0]).is_err_and(|e| waits(&e))
                {}
            };
            let small = thread::Builder::new().stack_size(256 * 1024);
            small.spawn_scoped(scope, client).expect("a thread");
        }
        while answered.load(Ordering::Relaxed) < CLIENTS {
            let long = start.elapsed().as_secs();
            assert!(long < 100, "{answered:?} clients answered in {long} s");
            most = most.max(server.connections());
            thread::sleep(Duration::from_millis(10));
        }
    });
    let peak = server.peak();
    eprintln!(
        "{CLIENTS} clients, 3 questions each: {:?}, {most} at once, {peak} KiB",
        start.elapsed()
    );
    assert!(most >= 200, "{most} at once");
    assert!(peak < MEMORY, "{peak} KiB");
    server.ends();
}

#[test]
fn whoever_has_had_an_answer_makes_room_for_the_next() {
    let workspace = Workspace::new();
    record(&workspace.path("out"), 40, 25, 120);
    let server = Server::of(&workspace, "out");
    let start = Instant::now();
    let ask = || {
        let mut stream = BufReader::new(connect(server.address()));
        let request = request("GET", "/api/about", &[]);
        stream
            .get_mut()
            .write_all(request.as_bytes())
            .expect("sent");
        assert_eq!(reply(&mut stream, false).expect("an answer").status, 200);
        stream
    };
    // Connections that nobody uses are ended after 10 s: this is sooner.
    let kept: Vec<_> = (0..CONNECTIONS + 1).map(|_| ask()).collect();
    let passed = start.elapsed();
    assert!(passed < Duration::from_secs(9), "{passed:?}");
    drop(kept);
    // Of more that say nothing it holds as many as it may, and the system the others.
    let silent: Vec<_> = (0..CONNECTIONS + 50)
        .map(|_| connect(server.address()))
        .collect();
    let start = Instant::now();
    while server.connections() < CONNECTIONS && start.elapsed() < Duration::from_secs(5) {
        thread::sleep(Duration::from_millis(10));
    }
    thread::sleep(Duration::from_millis(500));
    assert_eq!(server.connections(), CONNECTIONS);
    drop(silent);
    server.ends();
}

#[test]
#[ignore = "slow"]
fn clients_that_hang_are_left_and_hold_up_nobody() {
    let workspace = Workspace::new();
    record(&workspace.path("out"), 40, 25, 120);
    let phi = Matrix::from_fn(1000, 120, |p, s| (p * 120 + s) as f64);
    npy::write(&workspace.path("out/phi.npy"), &phi).expect("written");
    // All holes: it takes no room on disk.
    let large = File::create(workspace.path("out/large.bin")).expect("a file");
    large.set_len(LARGE).expect("longer");
    let server = Server::of(&workspace, "out");
    let start = Instant::now();
    let whole = request("GET", "/files/large.bin", &[]);
    let send = |text: &str| {
        let mut stream = connect(server.address());
        stream.write_all(text.as_bytes()).expect("sent");
        stream
    };
    // Nothing at all, half a header, a header that never ends, a whole one and then nothing is
    // read.
    let silent: Vec<_> = (0..30).map(|_| send("")).collect();
    let halves: Vec<_> = (0..30).map(|_| send(&whole[..whole.len() / 2])).collect();
    let mut endless: Vec<_> = (0..30).map(|_| send(&whole[..whole.len() - 2])).collect();
    let deaf: Vec<_> = (0..120).map(|_| send(&whole)).collect();
    let trickling = send(&whole);
    let steady = send(&request(
        "GET",
        "/files/large.bin",
        &["Range: bytes=0-5242879"],
    ));
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        let _over = Ends(&over);
        // 2 kB/s is too little; a quarter of a MiB each second is slow, but enough.
        scope.spawn(|| {
            let mut stream = trickling;
            while !over.load(Ordering::Relaxed) {
                if stream.read(&mut [0; 200]).is_ok_and(|n| n == 0) {
                    break;
                }
                thread::sleep(Duration::from_millis(100));
            }
        });
        let steady = scope.spawn(|| {
            let mut stream = BufReader::with_capacity(64, steady);
            let mut bytes = vec![0; 256 * 1024];
            for second in 1..=20 {
                stream
                    .read_exact(&mut bytes)
                    .unwrap_or_else(|e| panic!("after {second} s: {e}"));
                thread::sleep(Duration::from_secs(second).saturating_sub(start.elapsed()));
            }
        });
        let (mut slowest, mut most) = (Duration::ZERO, 0);
        let left = loop {
            let asked = Instant::now();
            assert_eq!(
                server.get("/api/row?matrix=traced&pixel=7").numbers().len(),
                120
            );
            slowest = slowest.max(asked.elapsed());
            for stream in &mut endless {
                // That the server has gone is found out below.
                let _ = stream.write_all(b"A: b\r\n");
            }
            let open = server.connections();
            let passed = start.elapsed().as_secs_f64();
            most = most.max(open);
            if open == 0 || passed > 40.0 {
                break (open, passed);
            }
            thread::sleep(Duration::from_millis(200));
        };
        let peak = server.peak();
        eprintln!(
            "{most} connections at most, {left:?} at last and after s, slowest answer {slowest:?}, {peak} KiB"
        );
        assert!(most >= 200, "{most} connections hung");
        assert_eq!(left.0, 0, "connections after {} s", left.1);
        // Nobody waits for the timeouts of others, 10 and 15 s.
        assert!(slowest < Duration::from_secs(8), "{slowest:?}");
        assert!(peak < MEMORY, "{peak} KiB");
        steady.join().expect("a slow client has its answer");
    });
    drop((silent, halves, deaf));
    server.ends();
}

#[test]
fn a_file_cut_short_while_it_is_sent_ends_the_connection() {
    let workspace = Workspace::new();
    record(&workspace.path("out"), 40, 25, 120);
    let large = File::create(workspace.path("out/large.bin")).expect("a file");
    large.set_len(LARGE).expect("longer");
    let server = Server::of(&workspace, "out");
    let mut stream = connect(server.address());
    let whole = request("GET", "/files/large.bin", &[]);
    stream.write_all(whole.as_bytes()).expect("sent");
    stream.read_exact(&mut [0; 1000]).expect("it begins");
    large.set_len(1 << 20).expect("shorter");
    let mut rest = Vec::new();
    let ended = stream.read_to_end(&mut rest);
    assert!(rest.len() < LARGE as usize - 1000, "{ended:?}");
    assert_eq!(server.get("/files/large.bin").body.len(), 1 << 20);
    // Ctrl-C does not wait for a client that reads nothing.
    large.set_len(LARGE).expect("longer");
    let mut deaf = connect(server.address());
    deaf.write_all(whole.as_bytes()).expect("sent");
    deaf.read_exact(&mut [0; 1000]).expect("it begins");
    server.ends();
}
