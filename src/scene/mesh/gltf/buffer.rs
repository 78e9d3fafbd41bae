//! The buffers of a glTF file: in its binary chunk, in the JSON itself, or in a file beside it.

use super::super::{MeshFileError, malformed};
use super::{Beside, missing};
use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf_json::Root;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::rc::Rc;

/// More bytes are not read from files beside a mesh: 2 GiB.
const MOST_BESIDE: u64 = 2 << 30;

/// The bytes of a buffer.
pub(super) type Bytes<'a> = Rc<Cow<'a, [u8]>>;

/// The buffers, each read when it is first asked for.
pub(super) struct Buffers<'a> {
    root: &'a Root,
    chunk: Option<&'a [u8]>,
    beside: Beside<'a>,
    /// By address; several buffers may have one.
    read: BTreeMap<&'a str, Bytes<'a>>,
    bytes_beside: u64,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(root: &'a Root, chunk: Option<&'a [u8]>, beside: Beside<'a>) -> Self {
        Self {
            root,
            chunk,
            beside,
            read: BTreeMap::new(),
            bytes_beside: 0,
        }
    }

    /// Bytes of the files beside the mesh that were read.
    pub(super) fn read_beside(&self) -> u64 {
        self.bytes_beside
    }

    /// A buffer and how many bytes of it count.
    pub(super) fn get(&mut self, at: usize) -> Result<(Bytes<'a>, usize), MeshFileError> {
        let Some(buffer) = self.root.buffers.get(at) else {
            return Err(missing(format!("buffer {at}"), self.root.buffers.len()));
        };
        let bytes = match &buffer.uri {
            None => match self.chunk {
                Some(chunk) if at == 0 => Rc::new(Cow::Borrowed(chunk)),
                _ => {
                    let cause =
                        String::from("it has no address and there is no binary chunk for it");
                    return Err(malformed(format!("buffer {at}"), cause));
                }
            },
            Some(uri) => match self.read.get(uri.as_str()) {
                Some(bytes) => bytes.clone(),
                None => {
                    let bytes: Bytes<'a> = Rc::new(Cow::Owned(self.fetch(uri)?));
                    self.read.insert(uri, bytes.clone());
                    bytes
                }
            },
        };
        match usize::try_from(buffer.byte_length.0) {
            Ok(length) if length <= bytes.len() => Ok((bytes, length)),
            _ => Err(MeshFileError::CutShort {
                what: format!("buffer {at}"),
                least: u128::from(buffer.byte_length.0),
                left: bytes.len(),
            }),
        }
    }

    fn fetch(&mut self, uri: &str) -> Result<Vec<u8>, MeshFileError> {
        if let Some(data) = uri.strip_prefix("data:") {
            return inline(data);
        }
        let short: String = uri.chars().take(100).collect();
        let Some(path) = decoded(uri) else {
            return Err(MeshFileError::Buffer {
                uri: short,
                cause: String::from("its percent signs spell no text"),
            });
        };
        if leads_out(&path) {
            return Err(MeshFileError::Outside { uri: short });
        }
        let bytes = (self.beside)(&path).map_err(|cause| MeshFileError::Buffer {
            uri: short.clone(),
            cause,
        })?;
        // One file may be spelled in many ways.
        self.bytes_beside += bytes.len() as u64;
        if self.bytes_beside > MOST_BESIDE {
            let cause = String::from("with it the buffers have more than 2 GiB");
            return Err(MeshFileError::Buffer { uri: short, cause });
        }
        Ok(bytes)
    }
}

/// Whether a name is anything but one of a file in the same folder or below it.
fn leads_out(path: &str) -> bool {
    path.is_empty()
        || path.contains([':', '\\', '\0'])
        || path.starts_with(['/', '~'])
        || path.split('/').any(|part| part == "..")
}

/// `%41` is `A`.
fn decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'%' => {
                let digit = |b: Option<u8>| char::from(b?).to_digit(16);
                let (high, low) = (digit(rest.next())?, digit(rest.next())?);
                (16 * high + low) as u8
            }
            _ => byte,
        });
    }
    String::from_utf8(bytes).ok()
}

/// The content of a `data:` address, base64 only.
fn inline(data: &str) -> Result<Vec<u8>, MeshFileError> {
    let refuse = |cause: String| MeshFileError::Buffer {
        uri: format!("data:{}…", data.chars().take(40).collect::<String>()),
        cause,
    };
    let Some((_, text)) = data.split_once(";base64,") else {
        return Err(refuse(String::from("it is not in base64")));
    };
    let config =
        GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
    let engine = GeneralPurpose::new(&base64::alphabet::STANDARD, config);
    engine.decode(text).map_err(|e| refuse(e.to_string()))
}
