//! `phicam serve DIR`: the report of a run that is too large to be in one page, over a local
//! address.
//!
//! # Routes
//!
//! GET and HEAD; anything else is answered 405, another path 404, errors as a line of text.
//!
//! | path | answer |
//! | --- | --- |
//! | `/` | report.html, or reproduction.html, or a page made of the scene and run.json, and again when run.json is another or model/phi.npy comes or goes: the scene, what was rendered, and its matrices to look at |
//! | `/files/PATH` | a regular file below DIR, as it is; one `Range` of bytes |
//! | `/api/about` | JSON: `version`, `scene`, `hash` of the scene, `seed` as text (an u64 is no number of JavaScript), `pixels` \[columns, rows\], `spots`, `matrices` that are there and of the run's shape |
//! | `/api/frame?matrix=M&spot=S&x=X&y=Y&w=W&h=H&step=K` | a part of the frame of spot S: of every K × K pixels the middle one, at column X + i·K + ⌊K/2⌋ and row Y + j·K + ⌊K/2⌋ or the last of the part, ⌈W/K⌉ × ⌈H/K⌉ numbers, at most 512 × 512; their counts in `X-Columns` and `X-Rows` |
//! | `/api/row?matrix=M&pixel=P` | what pixel P sees of all spots, at most 10⁶ numbers |
//!
//! Matrices are `traced` (phi.npy), `stderr` (phi.stderr.npy), `modelled` (model/phi.npy), in W,
//! `z` (model/z.npy) and `tails` (phi.tails.npy), pixels × spots. Numbers are f64, little-endian,
//! bit by bit those of the file, a frame row by row from Y upwards. A request has every key once
//! and no other.
//!
//! # Guarantees
//!
//! * Nothing is written. Nothing outside DIR is read, whatever a path or a link says and whoever
//!   swaps one for the other meanwhile; no hidden file, no unfinished one. One exception: to make a
//!   page, scene.toml and what it names are read as `phicam render` reads them, by their paths, and
//!   shown if they are the scene of run.json by its hash.
//! * It listens on a loopback address unless another one is given. Requests that name another host
//!   are refused (DNS rebinding), no other origin may read answers, and what a page may load and
//!   ask is bounded by a policy: its own script, no other server. It does not keep a page from
//!   being left for another address. Who has an account on this machine reaches a loopback address
//!   too.
//! * Memory is bounded: at most 256 connections at once, each with two pieces of 64 KiB of its
//!   answer, 16 KiB of its request and what the system buffers; the others wait. The page that is
//!   made is there once, however many want it, and each one before for as long as someone is still
//!   sent it. Matrices stay on disk: only the numbers asked for are read, or the pages they are on.
//! * A client has 10 s for its headers, and 15 s for each 64 KiB of an answer, and for what is left
//!   at its end, from when the system takes no more for it; then its connection is closed. Up to
//!   255 of them hold up nobody; if more hang, the others wait those 15 s. Eight threads read
//!   files, and what they read for a client that has gone counts as a connection.
//! * What stands in a file is not trusted: a header that lies, a file that is cut short, also while
//!   it is read, ends one answer and nothing else. Files are opened for every request, so that a
//!   run made again is what is shown.

mod answer;
mod body;
mod connection;
mod files;
mod folder;
mod host;
mod made;
mod pace;
mod query;
mod range;
mod routes;
mod run;
mod tiles;

use std::io::{self, ErrorKind};
use std::net::SocketAddr;

use tokio::runtime;

use crate::cli::Outcome;
use crate::cli::args::ServeArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::interrupt::stop_flag;
use crate::cli::output;
use crate::cli::run_folder::{PHI, REPORT};
use crate::folder::Record;
use folder::Served;
use made::Kept;
use routes::{REPRODUCTION, Site};

/// Threads that talk to clients.
const TALKING: usize = 2;
/// Threads that read files.
const READING: usize = 8;

pub(super) fn execute(args: &ServeArgs, console: Console) -> Result<Outcome, Failure> {
    let stop = stop_flag();
    let folder = folder(args)?;
    let site = Site {
        page: page(&folder, console).into(),
        folder,
        address: args.address,
    };
    // As long as the process, and so are its connections.
    let site: &'static Site = Box::leak(Box::new(site));
    let runtime = runtime::Builder::new_multi_thread()
        .worker_threads(TALKING)
        .max_blocking_threads(READING)
        .enable_all()
        .build()?;
    let address = SocketAddr::new(args.address, args.port);
    let (listener, address) = runtime
        .block_on(async {
            let listener = connection::listen(address)?;
            let address = listener.local_addr()?;
            Ok((listener, address))
        })
        .map_err(|e| deaf(address, &e))?;
    if !args.address.is_loopback() {
        console.say(format!(
            "warning: everyone who can reach {address} over the network can read all of {}; without --address only this machine can",
            args.dir.display()
        ));
    }
    output::print(&format!("http://{address}/\n"))?;
    console.say(format!("serving {}; Ctrl-C ends it", args.dir.display()));
    runtime.block_on(connection::serve(listener, site, stop));
    // A device that does not answer is not waited for.
    runtime.shutdown_background();
    Ok(Outcome::Done)
}

/// The folder, if there is something to show in it.
fn folder(args: &ServeArgs) -> Result<Served, Failure> {
    let dir = args.dir.display();
    let cure = "give the folder that `phicam run`, `phicam render`, `phicam reproduce` or `phicam study` has written";
    let folder = Served::at(&args.dir)
        .map_err(|e| Failure::new(format!("cannot open the folder {dir}: {e}"), cure))?;
    let known = [REPORT, REPRODUCTION, Record::FILE, PHI];
    if known.iter().any(|name| folder.has(name)) {
        return Ok(folder);
    }
    let known = known.join(", ");
    let cause = format!("{dir} is not the folder of a run or a study: it has none of {known}");
    Err(Failure::new(cause, cure))
}

/// Makes the page of a run, for as long as it has no report. That there is none is no reason not to
/// serve its files.
fn page(folder: &Served, console: Console) -> Kept {
    let mut kept = Kept::new(console.also_read);
    let mut details = String::new();
    if let Err(refusal) = kept.page(folder, |why| details = format!(" ({why})")) {
        console.say(format!(
            "warning: no page for a run without {REPORT}: {}{details}",
            refusal.words
        ));
    }
    kept
}

/// Why nobody can be heard at this address.
fn deaf(address: SocketAddr, error: &io::Error) -> Failure {
    let cure = match error.kind() {
        ErrorKind::AddrInUse => "choose another port with --port; --port 0 takes one that is free",
        ErrorKind::AddrNotAvailable => "give --address one of this machine's own addresses",
        ErrorKind::PermissionDenied => "choose a port from 1024 on with --port",
        _ => "choose another --address or --port",
    };
    Failure::system(format!("cannot listen on {address}: {error}"), cure)
}
