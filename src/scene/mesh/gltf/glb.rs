//! The container of a `.glb` file.

use super::super::{MeshFileError, malformed, unsupported};

const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// The JSON chunk and, if there is one, the binary chunk.
pub(super) fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), MeshFileError> {
    let cut = |what: &str, least: usize, left: usize| MeshFileError::CutShort {
        what: what.to_owned(),
        least: least as u128,
        left,
    };
    if bytes.len() < HEADER + CHUNK_HEADER {
        return Err(cut("the header", HEADER + CHUNK_HEADER, bytes.len()));
    }
    let version = word(bytes, 4);
    if version != 2 {
        let what = format!("binary glTF version {version}");
        return Err(unsupported(what, "as glTF 2.0"));
    }
    let length = word(bytes, 8) as usize;
    if length > bytes.len() {
        return Err(cut("the file by its header", length, bytes.len()));
    }
    let mut rest = bytes.get(HEADER..length).unwrap_or_default();
    let mut found = Vec::new();
    while !rest.is_empty() && found.len() < 2 {
        if rest.len() < CHUNK_HEADER {
            return Err(cut("the header of a chunk", CHUNK_HEADER, rest.len()));
        }
        let (head, body) = rest.split_at(CHUNK_HEADER);
        let size = word(head, 0) as usize;
        if size > body.len() {
            return Err(cut("a chunk", size, body.len()));
        }
        found.push((&head[4..], &body[..size]));
        rest = &body[size..];
    }
    match found[..] {
        [(b"JSON", json)] => Ok((json, None)),
        [(b"JSON", json), (b"BIN\0", chunk)] => Ok((json, Some(chunk))),
        // Chunks of other kinds are to be read over.
        [(b"JSON", json), _] => Ok((json, None)),
        _ => Err(malformed("first chunk", "it is not JSON")),
    }
}

/// Four bytes, little endian.
fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}
