//! An answer before it is sent, and its headers.

use hyper::body::Bytes;
use hyper::header::{
    CACHE_CONTROL, CONTENT_LENGTH, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderName, HeaderValue,
    X_CONTENT_TYPE_OPTIONS,
};
use hyper::{Method, Response, StatusCode};

use super::body::{Content, Pieces, Place, Source};
use super::refusal::Refusal;

/// What a page may do: its own inline script and style, pictures of this server, questions to this server, nothing else.
const PAGE: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src 'self' data: blob:; font-src data:; \
    connect-src 'self' data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// What anything else may do that a browser shows: nothing but look.
const PICTURE: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; sandbox";

const TEXT: &str = "text/plain; charset=utf-8";

/// Status, headers and bytes.
pub(super) struct Answer {
    status: StatusCode,
    headers: Vec<(HeaderName, HeaderValue)>,
    kind: &'static str,
    length: u64,
    bytes: Origin,
}

enum Origin {
    Memory(Bytes),
    Source(Box<dyn Source>),
}

impl Answer {
    /// An answer that is there.
    pub(super) fn bytes(kind: &'static str, bytes: impl Into<Bytes>) -> Self {
        let bytes = bytes.into();
        Self {
            status: StatusCode::OK,
            headers: Vec::new(),
            kind,
            length: bytes.len() as u64,
            bytes: Origin::Memory(bytes),
        }
    }

    /// An answer of `length` bytes that are read when they are wanted.
    pub(super) fn pieces(kind: &'static str, source: Box<dyn Source>, length: u64) -> Self {
        Self {
            length,
            bytes: Origin::Source(source),
            ..Self::bytes(kind, Bytes::new())
        }
    }

    /// The same with another status.
    pub(super) fn status(self, status: StatusCode) -> Self {
        Self { status, ..self }
    }

    /// The same with another header; one that no header can be is left out.
    pub(super) fn with(mut self, name: HeaderName, value: &str) -> Self {
        if let Ok(value) = value.parse() {
            self.headers.push((name, value));
        }
        self
    }

    /// What is sent to a request of this method.
    pub(super) fn response(self, method: &Method, place: &Place) -> Response<Content> {
        let content = match self.bytes {
            _ if method == Method::HEAD => Content::Bytes(Bytes::new()),
            Origin::Memory(bytes) => Content::Bytes(bytes),
            Origin::Source(source) => {
                Content::Pieces(Pieces::new(source, self.length, place.clone()))
            }
        };
        let policy = match self.kind.starts_with("text/html") {
            true => PAGE,
            false => PICTURE,
        };
        let mut response = Response::new(content);
        *response.status_mut() = self.status;
        let headers = response.headers_mut();
        headers.insert(CONTENT_TYPE, HeaderValue::from_static(self.kind));
        headers.insert(CONTENT_LENGTH, self.length.into());
        for (name, value) in [
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
        headers.extend(self.headers.into_iter().map(|(n, v)| (Some(n), v)));
        response
    }
}

impl From<Refusal> for Answer {
    fn from(refusal: Refusal) -> Self {
        Self::bytes(TEXT, refusal.words + "\n").status(refusal.status)
    }
}
