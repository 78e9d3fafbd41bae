//! An answer before it is sent: what was asked for, or why it is refused.

use hyper::body::Bytes;
use hyper::header::{
    ALLOW, CACHE_CONTROL, CONTENT_LENGTH, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderName,
    HeaderValue, X_CONTENT_TYPE_OPTIONS,
};
use hyper::{Response, StatusCode};

use super::body::{Content, Pieces, Source};
use crate::matrix::npy::NpyError;

/// What a page may do: its own inline script and style, pictures of this server, questions to this
/// server, nothing else.
const PAGE: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src 'self' data: blob:; font-src data:; \
    connect-src 'self' data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// What anything else may do that a browser shows: nothing but look.
const PICTURE: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; sandbox";

/// Status, headers and bytes.
pub(super) type Answer = Response<Content>;

/// An answer whose bytes are there.
pub(super) fn bytes(kind: &'static str, bytes: impl Into<Bytes>) -> Answer {
    let bytes = bytes.into();
    answer(kind, bytes.len() as u64, Content::Bytes(bytes))
}

/// An answer of `length` bytes that are read when they are wanted.
pub(super) fn pieces(kind: &'static str, source: Source, length: u64) -> Answer {
    answer(kind, length, Content::Pieces(Pieces::new(source, length)))
}

fn answer(kind: &'static str, length: u64, content: Content) -> Answer {
    let policy = if kind.starts_with("text/html") {
        PAGE
    } else {
        PICTURE
    };
    let mut answer = Response::new(content);
    let headers = answer.headers_mut();
    headers.insert(CONTENT_LENGTH, length.into());
    for (name, value) in [
        (CONTENT_TYPE, kind),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (CACHE_CONTROL, "no-store"),
        (CONTENT_SECURITY_POLICY, policy),
        (
            HeaderName::from_static("cross-origin-resource-policy"),
            "same-origin",
        ),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    answer
}

/// Sets a header; a value that no header can have is left out.
pub(super) fn set(answer: &mut Answer, name: HeaderName, value: &str) {
    if let Ok(value) = value.parse() {
        answer.headers_mut().insert(name, value);
    }
}

/// What a request is told that gets no result.
#[derive(Debug)]
pub(super) struct Refusal {
    pub status: StatusCode,
    pub words: String,
}

impl Refusal {
    pub(super) fn new(status: StatusCode, words: impl Into<String>) -> Self {
        Self {
            status,
            words: words.into(),
        }
    }

    /// 400: what was asked has no meaning here.
    pub(super) fn meaningless(words: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, words)
    }

    /// 404 for the file `name`.
    pub(super) fn not_found(name: &str) -> Self {
        let words = format!("{name}: no such file in this folder, or none that may be read");
        Self::new(StatusCode::NOT_FOUND, words)
    }

    /// 500: what is there cannot be read.
    pub(super) fn broken(words: impl Into<String>) -> Self {
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, words)
    }

    /// A line of text.
    pub(super) fn answer(self) -> Answer {
        let mut answer = bytes("text/plain; charset=utf-8", self.words + "\n");
        *answer.status_mut() = self.status;
        if self.status == StatusCode::METHOD_NOT_ALLOWED {
            set(&mut answer, ALLOW, "GET, HEAD");
        }
        answer
    }
}

impl From<NpyError> for Refusal {
    fn from(error: NpyError) -> Self {
        Self::broken(error.to_string())
    }
}
