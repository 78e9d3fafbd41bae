//! The hash of what the light of a scene depends on.

use sha2::{Digest, Sha256};

use super::error::{Fault, keys};
use super::file::SceneFile;
use super::files::Referenced;

/// SHA-256 (hex) of what the light depends on: the tables, and the bytes of the files they name.
pub(super) fn content_hash(file: &SceneFile, files: &[Referenced]) -> Result<String, Fault> {
    let unfinite =
        |e: serde_json::Error| Fault::new(keys![], e.to_string(), "use finite numbers only");
    let json = serde_json::to_vec(&file.of_the_light()).map_err(unfinite)?;
    let mut digest = Sha256::new_with_prefix(json);
    for file in files {
        digest.update(&file.digest);
    }
    Ok(crate::store::hex(&digest.finalize()))
}
