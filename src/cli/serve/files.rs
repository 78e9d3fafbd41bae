//! `/files/…`: the files of the folder as they are.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};

use hyper::StatusCode;
use hyper::header::{ACCEPT_RANGES, CONTENT_RANGE};

use super::answer::Answer;
use super::body::{PIECE, Source};
use super::folder::Served;
use super::range::Part;
use super::refusal::Refusal;

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
    let part = range.map_or(Part::Whole, |r| Part::of(r, length));
    let extension = name.rsplit_once('.').map_or("", |(_, ext)| ext);
    let kind = TYPES.iter().find(|(ext, _)| *ext == extension);
    let kind = kind.map_or("application/octet-stream", |(_, kind)| kind);
    let (first, count, status, said) = match part {
        Part::Whole => (0, length, StatusCode::OK, None),
        Part::Bytes { first, last } => {
            let said = format!("bytes {first}-{last}/{length}");
            let status = StatusCode::PARTIAL_CONTENT;
            (first, last - first + 1, status, Some(said))
        }
        Part::Unsatisfiable => {
            let status = StatusCode::RANGE_NOT_SATISFIABLE;
            let words = format!("{name} has {length} bytes, none of them in this range");
            let answer = Answer::from(Refusal::new(status, words));
            return Ok(answer.with(CONTENT_RANGE, &format!("bytes */{length}")));
        }
    };
    found
        .file
        .seek(SeekFrom::Start(first))
        .map_err(|e| Refusal::broken(format!("cannot read {name}: {e}")))?;
    let span = Span {
        file: found.file,
        left: count,
    };
    let answer = Answer::pieces(kind, Box::new(span), count)
        .status(status)
        .with(ACCEPT_RANGES, "bytes");
    Ok(match said {
        Some(said) => answer.with(CONTENT_RANGE, &said),
        None => answer,
    })
}

/// The bytes of a file from where it stands.
struct Span {
    file: File,
    left: u64,
}

impl Source for Span {
    fn piece(&mut self) -> io::Result<Vec<u8>> {
        let count = self.left.min(PIECE as u64);
        let mut bytes = Vec::with_capacity(count as usize);
        (&mut self.file).take(count).read_to_end(&mut bytes)?;
        if (bytes.len() as u64) < count {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        self.left -= count;
        Ok(bytes)
    }
}
