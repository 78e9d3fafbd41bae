//! `/files/…`: the files of the folder as they are.

use std::io::{ErrorKind, Read, Seek, SeekFrom};

use hyper::StatusCode;
use hyper::header::{ACCEPT_RANGES, CONTENT_RANGE};

use super::answer::{Answer, Refusal, pieces, set};
use super::body::PIECE;
use super::folder::Served;
use super::range::Part;

/// The type of a page.
pub(super) const PAGE: &str = "text/html; charset=utf-8";
/// Types by extension; what is not among them is bytes.
const TYPES: [(&str, &str); 10] = [
    ("html", PAGE),
    ("svg", "image/svg+xml"),
    ("png", "image/png"),
    ("jpg", "image/jpeg"),
    ("json", "application/json"),
    ("csv", "text/csv; charset=utf-8"),
    ("md", "text/plain; charset=utf-8"),
    ("toml", "text/plain; charset=utf-8"),
    ("txt", "text/plain; charset=utf-8"),
    ("py", "text/plain; charset=utf-8"),
];

/// The file `name`, or the part of it that a `Range` asks for.
pub(super) fn file(folder: &Served, name: &str, range: Option<&str>) -> Result<Answer, Refusal> {
    let mut found = folder.open(name)?;
    let length = found.length;
    let (first, count, status, part) = match range.map_or(Part::Whole, |r| Part::of(r, length)) {
        Part::Whole => (0, length, StatusCode::OK, None),
        Part::Bytes { first, last } => {
            let part = format!("bytes {first}-{last}/{length}");
            let status = StatusCode::PARTIAL_CONTENT;
            (first, last - first + 1, status, Some(part))
        }
        Part::Unsatisfiable => {
            let status = StatusCode::RANGE_NOT_SATISFIABLE;
            let words = format!("{name} has {length} bytes, none of them in this range");
            let mut answer = Refusal::new(status, words).answer();
            set(&mut answer, CONTENT_RANGE, &format!("bytes */{length}"));
            return Ok(answer);
        }
    };
    found
        .file
        .seek(SeekFrom::Start(first))
        .map_err(|e| Refusal::broken(format!("cannot read {name}: {e}")))?;
    let mut left = count;
    let source = move || {
        let wanted = left.min(PIECE as u64);
        let mut bytes = Vec::with_capacity(wanted as usize);
        (&mut found.file).take(wanted).read_to_end(&mut bytes)?;
        if (bytes.len() as u64) < wanted {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        left -= wanted;
        Ok(bytes)
    };
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
    let kind = TYPES.iter().find(|(known, _)| *known == extension);
    let kind = kind.map_or("application/octet-stream", |(_, kind)| kind);
    let mut answer = pieces(kind, Box::new(source), count);
    *answer.status_mut() = status;
    set(&mut answer, ACCEPT_RANGES, "bytes");
    if let Some(part) = part {
        set(&mut answer, CONTENT_RANGE, &part);
    }
    Ok(answer)
}
