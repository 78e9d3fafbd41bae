//! `phicam serve` as a process, and a client for it.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use phicam::matrix::{Matrix, npy};

use crate::workspace::Workspace;

/// A server of a folder on a free port; it ends with its owner.
pub(crate) struct Server {
    child: Child,
    address: SocketAddr,
}

/// What came back.
#[derive(Clone, Debug)]
pub(crate) struct Reply {
    pub status: u16,
    pub headers: BTreeMap<String, String>,
    pub body: Vec<u8>,
}

impl Server {
    pub(crate) fn of(workspace: &Workspace, folder: &str) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_phicam"))
            .args(["serve", folder, "--port", "0"])
            .current_dir(workspace.path(""))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut line = String::new();
        let stdout = child.stdout.as_mut().expect("piped");
        BufReader::new(stdout).read_line(&mut line).expect("a line");
        let port = line
            .trim_end()
            .strip_prefix("http://127.0.0.1:")
            .and_then(|l| l.strip_suffix('/'))
            .and_then(|p| p.parse().ok());
        let address = (
            Ipv4Addr::LOCALHOST,
            port.unwrap_or_else(|| panic!("{line}")),
        )
            .into();
        Self { child, address }
    }

    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Sends bytes as they are, and reads one answer.
    pub(crate) fn ask(&self, request: &[u8]) -> Reply {
        let mut stream = connect(self.address);
        stream.write_all(request).expect("sent");
        let head = request.starts_with(b"HEAD ");
        reply(&mut BufReader::new(stream), head).unwrap_or_else(|e| {
            panic!("{e} after {:?}", String::from_utf8_lossy(request));
        })
    }

    /// GET of a path as it is, with more header lines.
    pub(crate) fn get_with(&self, path: &str, headers: &[&str]) -> Reply {
        self.ask(request("GET", path, headers).as_bytes())
    }

    pub(crate) fn get(&self, path: &str) -> Reply {
        self.get_with(path, &[])
    }

    /// The most memory that it has had, KiB.
    pub(crate) fn peak(&self) -> u64 {
        let path = format!("/proc/{}/status", self.child.id());
        let status = fs::read_to_string(path).expect("it lives");
        let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
        let number = line.and_then(|l| l.trim().strip_suffix(" kB"));
        number.and_then(|n| n.parse().ok()).expect("a size")
    }

    /// Connections that it has open.
    pub(crate) fn connections(&self) -> usize {
        let folder = format!("/proc/{}/fd", self.child.id());
        let links = fs::read_dir(folder).expect("it lives").flatten();
        let sockets = links.filter_map(|l| fs::read_link(l.path()).ok());
        let sockets = sockets.filter(|l| l.to_string_lossy().starts_with("socket:"));
        // One listens, and two are the waker of the signals.
        sockets.count().saturating_sub(3)
    }

    /// Ctrl-C ends it with exit code 0, and none of its threads has panicked; returns what it had
    /// said on standard error.
    pub(crate) fn ends(mut self) -> String {
        let kill = format!("kill -INT {}", self.child.id());
        let sent = Command::new("sh").args(["-c", &kill]).status();
        assert!(sent.expect("a shell").success());
        let start = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("a child") {
                break status;
            }
            assert!(start.elapsed() < Duration::from_secs(10), "it goes on");
            std::thread::sleep(Duration::from_millis(10));
        };
        let mut words = String::new();
        let stderr = self.child.stderr.as_mut().expect("piped");
        stderr.read_to_string(&mut words).expect("text");
        let well = status.code() == Some(0) && !words.contains("panicked");
        assert!(well, "{status}: {words}");
        words
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The lines of a request.
pub(crate) fn request(method: &str, path: &str, headers: &[&str]) -> String {
    let more: String = headers.iter().map(|h| format!("{h}\r\n")).collect();
    format!("{method} {path} HTTP/1.1\r\nHost: localhost\r\n{more}\r\n")
}

/// A connection on which nothing is waited for longer than a minute. Tried again while this process
/// has too many files open.
pub(crate) fn connect(address: SocketAddr) -> TcpStream {
    let start = Instant::now();
    loop {
        match TcpStream::connect(address) {
            Ok(stream) => {
                let minute = Some(Duration::from_secs(60));
                stream.set_read_timeout(minute).expect("a timeout");
                stream.set_write_timeout(minute).expect("a timeout");
                return stream;
            }
            Err(e) if start.elapsed() > Duration::from_secs(30) => panic!("{e}"),
            Err(_) => std::thread::sleep(Duration::from_millis(20)),
        }
    }
}

/// A connection of which the system takes next to nothing that is not read.
pub(crate) fn narrow(address: SocketAddr) -> TcpStream {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_io()
        .build();
    let stream = runtime.expect("a runtime").block_on(async {
        let socket = tokio::net::TcpSocket::new_v4()?;
        socket.set_recv_buffer_size(2304)?;
        socket.connect(address).await?.into_std()
    });
    let stream = stream.expect("a connection");
    stream.set_nonblocking(false).expect("a socket");
    stream
}

/// Reads an answer up to its last byte, and no further.
pub(crate) fn reply(stream: &mut impl BufRead, head: bool) -> io::Result<Reply> {
    let mut line = || -> io::Result<String> {
        let mut text = String::new();
        match stream.read_line(&mut text)? {
            0 => Err(ErrorKind::UnexpectedEof.into()),
            _ => Ok(text.trim_end().to_owned()),
        }
    };
    let first = line()?;
    let status = first.split(' ').nth(1).and_then(|s| s.parse().ok());
    let mut headers = BTreeMap::new();
    while let Some((name, value)) = line()?.split_once(": ") {
        headers.insert(name.to_lowercase(), value.to_owned());
    }
    let length = headers.get("content-length").and_then(|l| l.parse().ok());
    let mut body = vec![0; if head { 0 } else { length.unwrap_or(0) }];
    stream.read_exact(&mut body)?;
    Ok(Reply {
        status: status.ok_or(ErrorKind::InvalidData)?,
        headers,
        body,
    })
}

impl Reply {
    pub(crate) fn header(&self, name: &str) -> &str {
        self.headers.get(name).map_or("", String::as_str)
    }

    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    /// The body as f64, bit by bit, of an answer that went well.
    pub(crate) fn numbers(&self) -> Vec<u64> {
        assert_eq!(self.status, 200, "{}", self.text());
        let numbers = self.body.chunks(8).map(|b| b.try_into().expect("8 bytes"));
        numbers.map(u64::from_le_bytes).collect()
    }

    /// The answer refuses with `status`, in a short text.
    pub(crate) fn refuses(&self, status: u16, what: &str) {
        let text = self.text();
        assert_eq!(self.status, status, "{what}: {text}");
        let short = text.len() < 400 && text.lines().count() == 1;
        assert!(short, "{what}: {text}");
        assert!(
            self.header("content-type").starts_with("text/plain"),
            "{what}"
        );
    }
}

/// A run's folder with its record alone: `columns` × `rows` pixels, `spots` spots.
pub(crate) fn record(folder: &Path, columns: usize, rows: usize, spots: usize) {
    fs::create_dir_all(folder.join("model")).expect("a folder");
    let record = serde_json::json!({
        "version": "0.1.0", "scene": "made up", "scene_hash": "0", "unit": "in", "seed": u64::MAX, "samples": 32, "blocks": 32,
        "estimator": "independent", "sampler": "sobol", "pixels": [columns, rows], "spots": spots, "finished": spots,
        "threads": 1, "seconds": 0.0
    });
    fs::write(folder.join("run.json"), record.to_string()).expect("written");
}

/// A run's folder `name` with made-up matrices, in which no two numbers are equal; some are not
/// finite.
pub(crate) fn made_up(
    workspace: &Workspace,
    name: &str,
    shape: (usize, usize, usize),
) -> [Matrix; 4] {
    let (columns, rows, spots) = shape;
    let folder = workspace.path(name);
    record(&folder, columns, rows, spots);
    let files = ["phi.npy", "phi.stderr.npy", "model/phi.npy", "model/z.npy"];
    [0, 1, 2, 3].map(|kind| {
        let matrix = Matrix::from_fn(columns * rows, spots, |p, s| match (p, s) {
            (3, 2) => f64::NAN,
            (4, 2) => f64::NEG_INFINITY,
            (5, 2) => -0.0,
            _ => (kind * 10_000_000 + p * 1000 + s) as f64 * 1e-15,
        });
        npy::write(&folder.join(files[kind]), &matrix).expect("written");
        matrix
    })
}

/// Set when the test is over, failed or not.
pub(crate) struct Ends<'a>(pub &'a AtomicBool);

impl Drop for Ends<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}
