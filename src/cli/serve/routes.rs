//! From a request to its answer.

use std::net::IpAddr;

use hyper::body::{Body, Bytes, Incoming};
use hyper::header::{IF_RANGE, RANGE};
use hyper::{Method, Request, StatusCode, Uri};
use tokio::sync::{Mutex, MutexGuard};
use tokio::task::spawn_blocking;

use super::answer::{Answer, Refusal, bytes};
use super::body::{Content, Place};
use super::folder::Served;
use super::made::Kept;
use super::{files, host, tiles};
use crate::cli::run_folder::REPORT;

/// The page of `phicam reproduce`.
pub(super) const REPRODUCTION: &str = "reproduction.html";

/// What is served, and by which address.
#[derive(Debug)]
pub(super) struct Site {
    pub folder: Served,
    pub address: IpAddr,
    /// The page of a run that has no report.
    pub page: Mutex<Kept>,
}

/// Answers a request. Files are read on a thread for that, not on one that others wait for.
pub(super) async fn respond(
    site: &'static Site,
    request: Request<Incoming>,
    place: &Place,
) -> Answer {
    let found = match check(&request, site.address) {
        Ok(()) => {
            let range = range(&request);
            let uri = request.uri().clone();
            let place = place.clone();
            // One at a time makes the page; the others wait, on no thread.
            let kept = match uri.path() {
                "/" => Some(site.page.lock().await),
                _ => None,
            };
            let read = move || {
                let found = find(&site.folder, &uri, range.as_deref(), kept);
                drop(place);
                found
            };
            let found = spawn_blocking(read).await;
            found.unwrap_or_else(|e| Err(Refusal::broken(e.to_string())))
        }
        Err(refusal) => Err(refusal),
    };
    let mut answer = found.unwrap_or_else(Refusal::answer);
    match answer.body_mut() {
        body if request.method() == Method::HEAD => *body = Content::Bytes(Bytes::new()),
        Content::Pieces(pieces) => pieces.place = Some(place.clone()),
        Content::Bytes(_) => {}
    }
    answer
}

/// Whether the request is one to this server that only reads.
fn check(request: &Request<Incoming>, address: IpAddr) -> Result<(), Refusal> {
    host::check(request, address)?;
    if ![Method::GET, Method::HEAD].contains(request.method()) {
        let status = StatusCode::METHOD_NOT_ALLOWED;
        return Err(Refusal::new(
            status,
            "only GET and HEAD: nothing here can be changed",
        ));
    }
    if !request.body().is_end_stream() {
        let status = StatusCode::PAYLOAD_TOO_LARGE;
        return Err(Refusal::new(status, "a request has no body here"));
    }
    Ok(())
}

/// The `Range`, if there is one that counts: of a GET, and without `If-Range`, which no answer of
/// this server gives anything for to compare with.
fn range(request: &Request<Incoming>) -> Option<String> {
    let headers = request.headers();
    let mut ranges = headers.get_all(RANGE).iter();
    let (Some(range), None) = (ranges.next(), ranges.next()) else {
        return None;
    };
    let counts = request.method() == Method::GET && !headers.contains_key(IF_RANGE);
    range.to_str().ok().filter(|_| counts).map(str::to_owned)
}

fn find(
    folder: &Served,
    uri: &Uri,
    range: Option<&str>,
    kept: Option<MutexGuard<'_, Kept>>,
) -> Result<Answer, Refusal> {
    match (uri.path(), kept) {
        (_, Some(mut kept)) => page(folder, &mut kept),
        ("/api/about", _) => tiles::about(folder, uri.query()),
        ("/api/frame", _) => tiles::frame(folder, uri.query()),
        ("/api/row", _) => tiles::row(folder, uri.query()),
        (path, _) => match path.strip_prefix("/files/").and_then(decoded) {
            Some(name) => files::file(folder, &name, range),
            None => Err(Refusal::new(StatusCode::NOT_FOUND, "nothing is here")),
        },
    }
}

/// The page of the folder: the one that lies in it, else the one that is made of what lies in it.
fn page(folder: &Served, kept: &mut Kept) -> Result<Answer, Refusal> {
    for name in [REPORT, REPRODUCTION] {
        match files::file(folder, name, None) {
            Err(refusal) if refusal.status == StatusCode::NOT_FOUND => {}
            answer => return answer,
        }
    }
    kept.page(folder, |_| {})?.map(|page| bytes(files::PAGE, page)).ok_or_else(|| {
        let words = format!(
            "there is no {REPORT} in this folder: `phicam run SCENE -o DIR` makes one of a run, `phicam study` of a study, `phicam reproduce -o DIR` a {REPRODUCTION}"
        );
        Refusal::new(StatusCode::NOT_FOUND, words)
    })
}

/// A path with its percent codes replaced, once. `None` for half a code, a slash in a code, or what
/// is not UTF-8 then.
fn decoded(path: &str) -> Option<String> {
    let mut rest = path.as_bytes();
    let mut bytes = Vec::with_capacity(rest.len());
    while let [first, later @ ..] = rest {
        rest = later;
        if *first != b'%' {
            bytes.push(*first);
            continue;
        }
        let (code, later) = rest.split_at_checked(2)?;
        let digit = |c: u8| char::from(c).to_digit(16);
        let byte = (digit(code[0])? * 16 + digit(code[1])?) as u8;
        if byte == b'/' {
            return None;
        }
        bytes.push(byte);
        rest = later;
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_replaced_once() {
        for (path, expected) in [
            ("a/b.npy", Some("a/b.npy")),
            ("a%20b", Some("a b")),
            ("%ce%a6cam", Some("Φcam")),
            ("%252e%252e", Some("%2e%2e")),
            ("%2e%2E/a", Some("../a")),
            ("%00", Some("\0")),
            ("a%2fb", None),
            ("a%2Fb", None),
            ("a%", None),
            ("a%2", None),
            ("a%zz", None),
            ("a%+1", None),
            ("%ff", None),
        ] {
            assert_eq!(decoded(path).as_deref(), expected, "{path}");
        }
    }
}
