//! SHA-256 of files and bytes.

use std::io::Read;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::reading::{ReadError, open};

/// SHA-256 of a file, in hexadecimal digits.
///
/// # Errors
/// [`ReadError`] if it cannot be read.
pub fn digest(path: &Path) -> Result<String, ReadError> {
    let mut file = open(path)?;
    let mut digest = Sha256::new();
    let mut stretch = vec![0; 1 << 16];
    loop {
        match file.read(&mut stretch) {
            Ok(0) => return Ok(hex(&digest.finalize())),
            Ok(n) => digest.update(&stretch[..n]),
            Err(e) => return Err(ReadError::system(path, e)),
        }
    }
}

/// SHA-256 of these bytes, in hexadecimal digits.
pub fn digest_of(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Hexadecimal digits of a digest.
pub fn hex(digest: &[u8]) -> String {
    digest.iter().map(|b| format!("{b:02x}")).collect()
}
